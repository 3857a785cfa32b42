use crate::geom::{Dir, Point, Ray};
#[cfg(not(assembly))]
use crate::num::{leading_zeros, short_recip};
use crate::num::{mul_hi_signed, mul_q16, mul_shift, mul_shift_brief, recip, recip_of_large};

/// Fraction bits of a slope.
pub(crate) const SLOPE_BITS: u32 = 13;
/// Fraction bits of a depth along the dominant axis.
pub(crate) const DEPTH_BITS: u32 = 4;
/// Largest grid coordinate.
pub(crate) const LAST: i32 = 65535;

/// A cube of 2^16 steps a side in the scene frame: scene = origin + (g << shift), axes parallel to the scene's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    origin: Point,
    shift: u8,
}

impl Grid {
    /// Largest `shift`: a cube of 2^24 units, twice what [`crate::geom::REACH`] asks for.
    pub const MAX_SHIFT: u8 = 8;
    /// Steps that stay free at each face of the cube, so that padded boxes and entry points never leave it.
    pub const MARGIN: u16 = 8;
    /// Bound of an origin's coordinates, units.
    const MAX_ORIGIN: u32 = 1 << 25;

    /// The cube from the scene frame's origin, steps of one unit.
    pub const UNIT: Grid = Grid {
        origin: Point([0; 3]),
        shift: 0,
    };

    /// `None` if `shift` is above [`Grid::MAX_SHIFT`] or the origin beyond ±2^25 units.
    pub const fn new(origin: Point, shift: u8) -> Option<Grid> {
        let [x, y, z] = origin.0;
        let near = x.unsigned_abs() <= Grid::MAX_ORIGIN
            && y.unsigned_abs() <= Grid::MAX_ORIGIN
            && z.unsigned_abs() <= Grid::MAX_ORIGIN;
        if near && shift <= Grid::MAX_SHIFT {
            Some(Grid { origin, shift })
        } else {
            None
        }
    }

    /// The finest grid that holds the box from `low` to `high` with `margin` steps to spare on each side.
    pub fn around(low: Point, high: Point, margin: u16) -> Option<Grid> {
        Grid::around_in_steps(low, high, margin, 0)
    }

    /// The same with steps of 2^`shift` units or more.
    pub fn around_in_steps(low: Point, high: Point, margin: u16, shift: u32) -> Option<Grid> {
        (shift as u8..=Grid::MAX_SHIFT).find_map(|shift| {
            let grid = Grid::new(
                Point(low.0.map(|c| c.saturating_sub((margin as i32) << shift))),
                shift,
            )?;
            let last = grid.to_scene([u16::MAX - margin; 3]);
            (0..3)
                .all(|a| high.0[a] <= last.0[a] && low.0[a] <= high.0[a])
                .then_some(grid)
        })
    }

    #[inline]
    pub const fn origin(&self) -> Point {
        self.origin
    }

    /// A step is 2^shift scene units.
    #[inline]
    pub const fn shift(&self) -> u32 {
        self.shift as u32
    }

    /// Where a grid point lies, exactly.
    #[inline]
    pub const fn to_scene(&self, g: [u16; 3]) -> Point {
        let (o, s) = (self.origin.0, self.shift);
        Point([
            o[0] + ((g[0] as i32) << s),
            o[1] + ((g[1] as i32) << s),
            o[2] + ((g[2] as i32) << s),
        ])
    }

    /// The smallest box of steps around a box of the scene; what lies outside the cube is cut off.
    pub fn enclose(&self, low: Point, high: Point) -> Bounds {
        let step = |c: i32, o: i32, up: i32| {
            ((c.saturating_sub(o).saturating_add(up)) >> self.shift).clamp(0, LAST) as u16
        };
        let (o, up) = (self.origin.0, (1 << self.shift) - 1);
        Bounds {
            low: [0, 1, 2].map(|a| step(low.0[a], o[a], 0)),
            high: [0, 1, 2].map(|a| step(high.0[a], o[a], up)),
        }
    }
}

/// A box of grid coordinates, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds {
    pub low: [u16; 3],
    pub high: [u16; 3],
}

impl Bounds {
    /// Around nothing: the identity of [`Bounds::union`].
    pub const EMPTY: Bounds = Bounds {
        low: [u16::MAX; 3],
        high: [0; 3],
    };

    /// Around some points.
    #[inline]
    pub fn of(points: &[[u16; 3]]) -> Bounds {
        points
            .iter()
            .fold(Bounds::EMPTY, |b, &p| b.union(Bounds { low: p, high: p }))
    }

    #[inline]
    pub fn union(self, other: Bounds) -> Bounds {
        Bounds {
            low: [0, 1, 2].map(|a| self.low[a].min(other.low[a])),
            high: [0, 1, 2].map(|a| self.high[a].max(other.high[a])),
        }
    }

    /// Grown by `steps` on each side, cut at the cube's faces.
    #[inline]
    pub fn pad(self, steps: u16) -> Bounds {
        Bounds {
            low: self.low.map(|c| c.saturating_sub(steps)),
            high: self.high.map(|c| c.saturating_add(steps)),
        }
    }

    #[inline]
    pub fn contains(&self, other: Bounds) -> bool {
        (0..3).all(|a| self.low[a] <= other.low[a] && other.high[a] <= self.high[a])
    }
}

/// What of a ray's direction every grid shares.
///
/// The dominant axis k is that of the largest component; of equals the first of x, y, z. The slopes d_a/d_k of the
/// two axes that follow k in cyclic order lie in −1 ..= 1.
#[derive(Clone, Copy, Debug)]
pub struct Slopes {
    axis: u8,
    negative: bool,
    /// Q13, rounded to nearest: within ±2^13.
    slopes: [i32; 2],
    /// Q30, error 2^-28 at most.
    fine: [i32; 2],
    /// |d_k|, Q16.
    cosine: u32,
    /// 1/|d_k|, Q30, relative error 2^-28 at most: 2^30 ..= √3·2^30.
    inverse: i32,
}

impl Slopes {
    /// Of a unit vector. (Of anything else: slopes within their range, depths that mean nothing.)
    #[cfg_attr(all(target_arch = "arm", not(narrow_mul)), inline(always))]
    #[cfg_attr(not(all(target_arch = "arm", not(narrow_mul))), inline)]
    pub fn new(dir: Dir) -> Slopes {
        Slopes::of::<16>(dir.0)
    }

    /// The same of a unit vector of Q28.
    #[inline]
    pub(crate) fn fine(dir: [i32; 3]) -> Slopes {
        Slopes::of::<28>(dir)
    }

    #[inline(always)]
    fn of<const BITS: u32>(dir: [i32; 3]) -> Slopes {
        let size = dir.map(i32::unsigned_abs);
        let axis = if size[0] >= size[1] && size[0] >= size[2] {
            0
        } else {
            1 + (size[2] > size[1]) as u8
        };
        let [dx, dy, dk] = rotate(axis, dir);
        let cosine = dk.unsigned_abs();
        // Of a unit vector all but an axis have 2^15 ..< 2^16 here.
        let is_plain = BITS == 16 && cosine >> 15 == 1;
        let inverse = if is_plain {
            let mantissa = recip_of_large(cosine << 16);
            ((mantissa >> 1) + (mantissa & 1)) as i32
        } else {
            inverse::<BITS>(cosine)
        };
        let signed = if dk < 0 { -inverse } else { inverse };
        // The same product; what has one word less to shift is cheaper where words are narrow.
        let slope = |d: i32| match BITS {
            16 => mul_q16(signed, d),
            bits => mul_shift(signed, d, bits),
        };
        let fine = [slope(dx), slope(dy)];
        // A quotient of at most 1, 2^-28 off, rounds to 1 at most.
        let slopes = fine.map(|s| {
            let slope = (s >> 16).wrapping_add(1) >> 1;
            if is_plain {
                slope
            } else {
                slope.clamp(-(1 << SLOPE_BITS), 1 << SLOPE_BITS)
            }
        });
        Slopes {
            axis,
            negative: dk < 0,
            slopes,
            fine,
            cosine: cosine >> (BITS - 16),
            inverse,
        }
    }
}

/// 1/|d_k|, Q30.
#[cfg_attr(narrow_mul, cold, inline(never))]
fn inverse<const BITS: u32>(cosine: u32) -> i32 {
    // 2^BITS/|d_k| = mantissa · 2^(BITS − shift), and shift is 31 + BITS below one, more from one on.
    let r = recip(cosine);
    let down = if r.shift < 32 + BITS { 1 } else { 2 };
    ((r.mantissa >> down) + ((r.mantissa >> (down - 1)) & 1)) as i32
}

/// How far a ray gets along its dominant axis while it goes one step aside: the reciprocal of a slope.
#[cfg(not(assembly))]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rise {
    /// 2^23 over the slope's size in Q13, which is 2^8 or more.
    pub(crate) recip: u32,
    /// The slope's size · 2^8: a way aside as far or farther is none within a node. 0 of slopes under 1/32, which move a ray
    /// by few planes within a node.
    pub(crate) beyond: u32,
    /// All ones where the slope falls.
    pub(crate) fall: i32,
    /// Of a box's two faces, the one that the ray comes to first.
    face: u32,
}

#[cfg(not(assembly))]
impl Rise {
    /// Of a slope, and whether the ray goes down its dominant axis.
    #[inline]
    pub fn new(slope: i32, negative: bool) -> Rise {
        let size = slope.unsigned_abs();
        // 2 ..= 7 of those that are not too small.
        let zeros = leading_zeros(size).wrapping_sub(16) & 31;
        let is_steep = size >= 1 << 8;
        Rise {
            recip: short_recip(size << zeros) as u32 >> (8u32.wrapping_sub(zeros) & 31),
            beyond: if is_steep { size << 8 } else { 0 },
            fall: slope >> 31,
            face: ((slope < 0) != negative) as u32,
        }
    }

    #[inline(always)]
    pub fn face(&self) -> usize {
        (self.face & 1) as usize
    }

    /// A way aside, Q13, over the slope; `None` where it is negative, or 256 or more.
    ///
    /// Up to 1.4 too few: what is after the point is cut off, of five bits less and a reciprocal of ten.
    #[cfg(any(test, not(target_arch = "x86_64")))]
    #[inline(always)]
    pub fn steps(&self, aside: i32) -> Option<i32> {
        let aside = ((aside ^ self.fall) - self.fall) as u32;
        // 2^16 · 2^15
        (aside < self.beyond).then(|| (((aside >> 5) * self.recip) >> 18) as i32)
    }
}

/// A ray as a grid sees it: an integer origin, a dominant axis k, two slopes, of the axes k+1 and k+2.
///
/// Every decision of box and triangle tests is an exact predicate of this ray.
#[derive(Clone, Copy, Debug)]
pub struct GridRay {
    /// Where it starts along the axis, steps: 0 ..= 65535.
    pub(crate) plane: i32,
    /// Q13, within ±2^13: steps across for a step along the (signed) axis.
    pub(crate) slopes: [i32; 2],
    /// What [`GridRay::across`] adds, Q13: slope · plane − where it starts across, + ½.
    pub(crate) offsets: [i32; 2],
    pub(crate) negative: bool,
    pub(crate) axis: u8,
    shift: u8,
    cosine: u32,
    inverse: i32,
    /// From the true origin to this one, scene units; from −√3·2^(shift−1).
    start: i32,
}

impl GridRay {
    /// The ray in a grid, or `None` where it misses the cube.
    ///
    /// The origin is moved along the true ray to an integer plane of the dominant axis: the nearest if it is inside,
    /// else the face it comes to. Then its other two coordinates are rounded to nearest, so that the quantised ray
    /// starts within ½ step of the true one in each. It misses for good if it is beyond the cube and leaving, or
    /// 65536 steps beside it: along the cube it moves across by 65535 steps at most. Origins within ±2^30 units.
    #[cfg_attr(any(narrow_mul, target_arch = "x86_64"), inline)]
    #[cfg_attr(not(any(narrow_mul, target_arch = "x86_64")), inline(always))]
    pub fn enter(grid: &Grid, ray: &Ray, slopes: &Slopes) -> Option<GridRay> {
        GridRay::enter_here(grid, ray, slopes)
    }

    /// [`Self::enter`], always where it is called: what it answers is not copied.
    #[inline(always)]
    pub(crate) fn enter_here(grid: &Grid, ray: &Ray, slopes: &Slopes) -> Option<GridRay> {
        let shift = grid.shift;
        let half = (1 << shift) >> 1;
        // |from| ≤ 2^30 + 2^25.
        let [x, y, z] = rotate(slopes.axis, grid.origin.to(ray.origin).0);
        let nearest = z.wrapping_add(half) >> shift;
        let inside = nearest as u32 <= LAST as u32;
        let plane = match (inside, slopes.negative) {
            (true, _) => nearest,
            (_, false) if nearest < 0 => 0,
            (_, true) if nearest > LAST => LAST,
            _ => return None,
        };
        let ahead = (plane << shift).wrapping_sub(z);
        // Inside, |ahead| ≤ 2^7 and the short slope is enough: the product is under 2^20.
        let [s0, s1] = slopes.slopes;
        let (aside, start) = if inside {
            let aside = [s0, s1].map(|slope| (ahead * slope) >> SLOPE_BITS);
            (aside, short_product(ahead_of(ahead, slopes), slopes.inverse))
        } else {
            let aside = slopes.fine.map(|fine| product(ahead, fine));
            // √3 (2^30 + 2^26) < 2^31.
            (aside, product(ahead_of(ahead, slopes), slopes.inverse))
        };
        let across = |from: i32, aside: i32| {
            // Both terms are under 2^30 + 2^26. A sum that wraps comes out beyond ±2^31 ∓ 2^27, which is 2^22 steps
            // or more, and is refused as it should be.
            from.wrapping_add(aside).wrapping_add(half) >> shift
        };
        let (x, y) = (across(x, aside[0]), across(y, aside[1]));
        let beside = |c: i32| c.wrapping_add(65536) as u32 >= 3 * 65536;
        if beside(x) || beside(y) {
            return None;
        }
        // 2^13 · 2^16 + 2^17 · 2^13 + 2^12 < 2^31
        let offset = |s: i32, c: i32| s * plane - (c << SLOPE_BITS) + (1 << (SLOPE_BITS - 1));
        Some(GridRay {
            plane,
            slopes: slopes.slopes,
            offsets: [offset(s0, x), offset(s1, y)],
            negative: slopes.negative,
            axis: slopes.axis,
            shift,
            cosine: slopes.cosine,
            inverse: slopes.inverse,
            start,
        })
    }

    /// How far from the ray a grid point lies along axis k + 1 (`A` = 0) or k + 2 (1), seen along the ray: Q13, ½ more.
    ///
    /// An affine function of the point, exact: the two terms of it together are under 2^30, and the sum of all three,
    /// (v_x − o_x)·2^13 − S·(v_k − o_k) + 2^12 with |v_x − o_x| < 2^17 and |v_k − o_k| < 2^16, under
    /// 2^30 + 2^29 + 2^12.
    #[inline(always)]
    pub(crate) fn across<const K: usize, const A: usize>(&self, v: &[u16; 3]) -> i32 {
        ((v[(K + 1 + A) % 3] as i32) << SLOPE_BITS) - self.slopes[A] * v[K] as i32 + self.offsets[A]
    }

    /// Distance along the ray for a depth in 1/16 steps, scene units, at least 1.
    ///
    /// Never falls as the depth grows. Error −2 ..= 0 units and 2^-28 of the distance.
    #[inline]
    pub(crate) fn distance(&self, depth: i32) -> i32 {
        let beyond = if cfg!(narrow_mul) {
            mul_shift(depth, self.inverse, 30 + DEPTH_BITS - self.shift as u32)
        } else {
            // 2^20 · 2^8
            mul_hi_signed(depth << self.shift, self.inverse) >> (DEPTH_BITS - 2)
        };
        self.start.saturating_add(beyond).max(1)
    }

    /// A depth in steps that no point nearer than `distance` exceeds; negative if there is none.
    ///
    /// −1 ..= 65535; more than the exact one by 12 at most.
    #[inline]
    pub fn limit(&self, distance: i32) -> i32 {
        let ahead = distance.saturating_sub(self.start);
        if ahead <= 0 {
            return -1;
        }
        let steps = (ahead >> self.shift) as u32 + 1;
        if steps > 1 << 17 {
            return LAST; // 2^17/√3 > 65535
        }
        // Both factors are rounded up: at most (2^17)(2^14 + 1) < 2^32. One more for the reciprocal's error.
        let depth = ((steps * ((self.cosine >> 2).min(1 << 14) + 1)) >> 14) as i32 + 1;
        depth.min(LAST)
    }
}

/// A way along the axis as one along the ray.
#[inline(always)]
fn ahead_of(ahead: i32, slopes: &Slopes) -> i32 {
    if slopes.negative {
        ahead.wrapping_neg()
    } else {
        ahead
    }
}

/// ⌊ahead · by / 2^30⌋: mostly of less than 2^20 units.
#[inline(always)]
fn product(ahead: i32, by: i32) -> i32 {
    if cfg!(narrow_mul) && ahead.unsigned_abs() <= 1 << 20 {
        mul_shift_brief(ahead, by, 30)
    } else {
        far_product(ahead, by)
    }
}

#[cfg_attr(narrow_mul, cold, inline(never))]
fn far_product(ahead: i32, by: i32) -> i32 {
    mul_shift(ahead, by, 30)
}

/// ⌊short · by / 2^30⌋ for |short| under 2^15, in two products of 32 bits.
#[inline]
fn short_product(short: i32, by: i32) -> i32 {
    (short * (by >> 16) + ((short * (by & 0xffff)) >> 16)) >> 14
}

/// (x, y, z) in the order (k+1, k+2, k).
#[inline]
fn rotate(k: u8, [x, y, z]: [i32; 3]) -> [i32; 3] {
    match k {
        0 => [y, z, x],
        1 => [z, x, y],
        _ => [x, y, z],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Grid = Grid::new(Point([-1000, 0, 500]), 3).unwrap();

    #[test]
    fn a_rise_is_a_slopes_reciprocal() {
        for slope in 1..=1 << SLOPE_BITS {
            for (rise, sign) in [(Rise::new(slope, false), 1), (Rise::new(-slope, true), -1)] {
                assert_eq!(rise.face(), 0);
                for aside in (0..64)
                    .map(|i| (slope << 8) / 64 * i + i % 7)
                    .chain([(slope << 8) - 1])
                {
                    let exact = f64::from(aside) / f64::from(slope);
                    let steps = rise.steps(sign * aside).filter(|_| exact < 256.0).map(f64::from);
                    assert_eq!(steps.is_some(), slope >= 256 && exact < 256.0);
                    assert!(
                        steps.is_none_or(|steps| steps > exact - 1.4 && steps < exact + 0.02),
                        "{aside} over {slope}: {steps:?}"
                    );
                }
                assert_eq!(rise.steps(-sign), None);
                assert_eq!(rise.steps(sign * (slope << 8)), None);
            }
        }
        assert_eq!(Rise::new(0, false).steps(0), None);
        assert_eq!(Rise::new(-300, false).face(), 1);
    }

    #[test]
    fn short_products_are_products() {
        let mut s = 11u32;
        for _ in 0..100_000 {
            s = s.wrapping_mul(747796405).wrapping_add(2891336453);
            let (short, by) = ((s as i32) >> 16, (s ^ (s >> 15)) as i32 & i32::MAX);
            assert_eq!(short_product(short, by), mul_shift(short, by, 30), "{short} {by}");
        }
        assert_eq!(
            short_product(-1 << 15, i32::MAX),
            mul_shift(-1 << 15, i32::MAX, 30)
        );
    }

    #[test]
    fn products_are_the_same_near_and_far() {
        for ahead in [0, 1, 203_162, 1 << 20, (1 << 20) + 1, 1 << 30] {
            for by in [1, 0x1234_5678, 1 << 30, 1_859_775_393] {
                for (ahead, by) in [(ahead, by), (-ahead, by), (ahead, -by), (-ahead, -by)] {
                    assert_eq!(product(ahead, by), mul_shift(ahead, by, 30), "{ahead} {by}");
                }
            }
        }
    }

    /// Each cosine that a unit vector has, with the steepest slopes: none is out of range, though none is held within it.
    #[test]
    fn slopes_of_unit_vectors_need_no_bounds() {
        for c in 1 << 15..(1 << 16) + 2 {
            for d in [c, -c, c - 1, 1 - c] {
                let slopes = Slopes::new(Dir([c, d, d]));
                assert_eq!(slopes.inverse, inverse::<16>(c as u32), "{c}");
                let exact = (f64::from(d) / f64::from(c) * 8192.0).round() as i32;
                assert!(
                    slopes
                        .slopes
                        .iter()
                        .all(|s| (s - exact).abs() <= 1 && s.abs() <= 8192),
                    "{c} {d} {slopes:?}"
                );
            }
        }
    }

    #[test]
    fn the_dominant_axis_is_the_first_of_equals() {
        let diagonal = Dir::new([1, -1, 1]).unwrap();
        let slopes = Slopes::new(diagonal);
        assert_eq!(
            (slopes.axis, slopes.negative, slopes.slopes),
            (0, false, [-8192, 8192])
        );
        let slopes = Slopes::new(Dir::new([0, -3, 3]).unwrap());
        assert_eq!(
            (slopes.axis, slopes.negative, slopes.slopes),
            (1, true, [-8192, 0])
        );
    }

    #[test]
    fn a_ray_from_outside_starts_on_the_face() {
        // 2^29 units away, straight at the grid point (100, 200, 0).
        let origin = Point([-1000 + 800, 1600, 500 - (1 << 29)]);
        let ray = GridRay::enter(&GRID, &Ray { origin, dir: Dir::Z }, &Slopes::new(Dir::Z)).unwrap();
        assert_eq!(ray.plane, 0);
        assert_eq!(
            [
                ray.across::<2, 0>(&[101, 202, 9]),
                ray.across::<2, 1>(&[101, 202, 9])
            ],
            [12288, 20480]
        );
        assert_eq!(ray.distance(0), 1 << 29);
        assert_eq!(ray.distance(16), (1 << 29) + 8);
        assert!(GridRay::enter(&GRID, &Ray { origin, dir: -Dir::Z }, &Slopes::new(-Dir::Z)).is_none());
    }

    #[test]
    fn limits_hold_every_nearer_depth() {
        let mut s = 1u32;
        for _ in 0..200_000 {
            let mut r = || {
                s = s.wrapping_mul(747796405).wrapping_add(2891336453);
                (s ^ (s >> 15)) as i32
            };
            let Some(dir) = Dir::new([r(), r(), r()]) else {
                continue;
            };
            let far = (r() & 15) as u32;
            let origin = Point([r() >> (far + 5), r() >> (far + 5), r() >> (far + 5)]);
            let grid = Grid::new(Point([0; 3]), (r() & 7) as u8).unwrap();
            let Some(ray) = GridRay::enter(&grid, &Ray { origin, dir }, &Slopes::new(dir)) else {
                continue;
            };
            let depth = r() & 0xfffff;
            let t = ray.distance(depth);
            let limit = ray.limit(t + 1);
            assert!(depth >> DEPTH_BITS <= limit, "{depth} {t} {limit} {ray:?}");
            assert!(
                limit <= (depth >> DEPTH_BITS) + 14 || ray.distance(0) == 1,
                "{depth} {t} {limit} {ray:?}"
            );
        }
    }
}
