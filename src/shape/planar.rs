//! Plane, disk and rectangle: one crossing with the plane, three ways to bound it.

#[cfg(not(rectangles))]
use crate::geom::Offset;
use crate::geom::{Dir, FAR, Point, Ray};
#[cfg(rectangles)]
use crate::num::RECIPS;
use crate::num::{Wide, dot_sparse, leading_zeros, mul_shift_short, recip, round_shift};
#[cfg(not(rectangles))]
use crate::num::{mul_q16, mul_unit};
#[cfg(rectangles)]
use zerocopy::{Immutable, IntoBytes, transmute_ref};

/// How far a ray's origin must be lifted off a flat shape so that the ray does not meet it again, units.
///
/// A point brought onto the plane is off it by the rounding of two dot products (3 units each) and of itself (1); the
/// crossing rounds its distance by 3 more, downwards: 8 leaves at least one unit on the right side.
pub const LIFT: i32 = 8;

/// An infinite plane, one-sided only in what it emits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plane {
    pub point: Point,
    pub normal: Dir,
}

/// A disk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Disk {
    pub center: Point,
    pub normal: Dir,
    /// Units, 1 ..= 2^22.
    pub radius: i32,
}

/// The rectangle `center ± half[0]·u ± half[1]·v`, normal u × v.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(rectangles, derive(IntoBytes, Immutable))]
#[repr(C)]
pub struct Rectangle {
    pub normal: Dir,
    pub u: Dir,
    pub v: Dir,
    pub center: Point,
    /// Half the side lengths along u and v, units, 1 ..= 2^22.
    pub half: [i32; 2],
}

impl Plane {
    pub const fn new(point: Point, normal: Dir) -> Plane {
        Plane { point, normal }
    }

    /// Distance to the crossing with 0 < t < `t_max`; one beyond [`FAR`] counts as there.
    #[inline(always)]
    pub fn intersect(&self, ray: &Ray, t_max: i32) -> Option<i32> {
        let t = crossing(self.point, self.normal, ray, t_max)?;
        (t < t_max).then_some(t)
    }
}

impl Disk {
    pub const fn new(center: Point, normal: Dir, radius: i32) -> Disk {
        Disk {
            center,
            normal,
            radius,
        }
    }

    #[inline]
    pub fn intersect(&self, ray: &Ray, t_max: i32) -> Option<i32> {
        let t = bounded_crossing(self.center, self.normal, ray, t_max)?;
        let [x, y, z] = self.center.to(ray.at(t)).0;
        let r = self.radius;
        if x > r || x < -r || y > r || y < -r || z > r || z < -r {
            return None;
        }
        // Squares in steps of 2^shift units, the radius under 2^14 of them.
        let shift = (32 - leading_zeros(r as u32)).saturating_sub(14);
        let square = |c: i32| round_shift(c, shift) * round_shift(c, shift);
        (square(x) + square(y) + square(z) <= square(r)).then_some(t)
    }

    /// Area, units².
    pub fn area(&self) -> Wide {
        let r = Wide::new(self.radius as u32, 0);
        r * r * Wide::PI
    }
}

impl Rectangle {
    /// From its centre, two directions at right angles, and half the side lengths along them.
    ///
    /// `None` where u and v are (nearly) parallel. v is turned within the plane until it is at right angles to u.
    pub fn new(center: Point, u: Dir, v: Dir, half: [i32; 2]) -> Option<Rectangle> {
        let normal = u.cross(v)?;
        let v = normal.cross(u)?;
        Some(Rectangle {
            center,
            u,
            v,
            normal,
            half,
        })
    }

    /// Distance to the crossing with 0 < t < `t_max`, under [`FAR`].
    #[cfg(rectangles)]
    #[inline(always)]
    pub fn intersect(&self, ray: &Ray, t_max: i32) -> Option<i32> {
        microlux_asm::rectangle(transmute_ref!(self), transmute_ref!(ray), t_max, &RECIPS)
    }

    /// Area, units².
    pub fn area(&self) -> Wide {
        let [a, b] = self.half.map(|half| half as u32);
        // Numbers that a `Wide` holds exactly are rounded after their product alone.
        if (a | b) >> 16 == 0 {
            Wide::new(a * b, 2)
        } else {
            Wide::new(a, 1) * Wide::new(b, 1)
        }
    }
}

/// What the assembly does elsewhere.
#[cfg(not(rectangles))]
impl Rectangle {
    /// Distance to the crossing with 0 < t < `t_max`, under [`FAR`].
    #[inline]
    pub fn intersect(&self, ray: &Ray, t_max: i32) -> Option<i32> {
        match self.normal.0 {
            [n, 0, 0] => self.intersect_upright::<0>(n, ray, t_max),
            [0, n, 0] => self.intersect_upright::<1>(n, ray, t_max),
            [0, 0, n] => self.intersect_upright::<2>(n, ray, t_max),
            _ => {
                let t = bounded_crossing(self.center, self.normal, ray, t_max)?;
                self.holds(self.center.to(ray.at(t))).then_some(t)
            }
        }
    }

    /// Where the normal is axis `K` or its opposite, the same with fewer products.
    #[inline]
    fn intersect_upright<const K: usize>(&self, normal: i32, ray: &Ray, t_max: i32) -> Option<i32> {
        let d = ray.dir.0;
        let from = self.center.to(ray.origin).0;
        let height = mul_unit(from[K], normal);
        let slope = (d[K] >> 8) * normal + (((d[K] & 255) * normal) >> 8);
        let t = meet(height, slope, t_max).filter(|t| *t < t_max.min(FAR))?;
        let mut p = [0; 3];
        for a in [(K + 1) % 3, (K + 2) % 3] {
            p[a] = from[a].wrapping_add(mul_q16(t, d[a]));
        }
        // A side along the normal there is not.
        if self.u.0[K] | self.v.0[K] != 0 {
            return self.holds(self.center.to(ray.at(t))).then_some(t);
        }
        let side = |s: Dir| {
            let (a, b) = ((K + 1) % 3, (K + 2) % 3);
            mul_unit(p[a], s.0[a]).wrapping_add(mul_unit(p[b], s.0[b]))
        };
        (self.holds_along(0, side(self.u)) && self.holds_along(1, side(self.v))).then_some(t)
    }

    /// Whether a place on the plane, seen from the centre, is within the sides.
    #[inline]
    fn holds(&self, p: Offset) -> bool {
        self.holds_along(0, p.dot_normal(self.u)) && self.holds_along(1, p.dot_normal(self.v))
    }

    /// The same along one of the sides. Coordinates are rounded down by up to 3 units.
    #[inline(always)]
    fn holds_along(&self, side: usize, x: i32) -> bool {
        let half = self.half[side];
        x <= half && x >= -half - 3
    }
}

/// Distance along the ray to a plane, t > 0, at most [`FAR`]; perhaps `None` where it is not under `t_max`.
///
/// t = −(o − p)·n / (d·n), the closed form; the quotient's relative error is 2^-24 / |d·n| plus 2^-28.
#[inline(always)]
fn crossing(point: Point, normal: Dir, ray: &Ray, t_max: i32) -> Option<i32> {
    let height = point.to(ray.origin).dot_normal(normal);
    let slope = dot_sparse(ray.dir.0, normal.0);
    meet(height, slope, t_max)
}

/// The same of the height over the plane and what is lost of it along the ray.
#[inline(always)]
fn meet(height: i32, slope: i32, t_max: i32) -> Option<i32> {
    // They meet in front only if one is positive and the other negative.
    if (height ^ slope) >= 0 || slope == 0 {
        return None;
    }
    quotient(height.unsigned_abs(), slope.unsigned_abs(), t_max)
}

/// height / slope, as [`crossing`] wants it; the slope is not 0.
#[inline(always)]
fn quotient(height: u32, slope: u32, t_max: i32) -> Option<i32> {
    if height >> 5 >= slope {
        return (height > 0).then_some(FAR);
    }
    // Clearly beyond t_max, by more than the quotient's error, it is not worth a reciprocal:
    // h/2 > t_max·slope / 2^25 (1 + 2^-20) + 1, with t_max < 2^30 and slope under 2^25, 16 bits of it rounded up.
    let (t_max, short) = (t_max as u32, (slope >> 9) + 1);
    let reach = (t_max >> 16) * short + (((t_max & 0xffff) * short) >> 16) + 1;
    if height >> 1 > reach + (reach >> 20) + 1 {
        return None;
    }
    let t = divide(height, slope);
    (t > 0).then_some(t)
}

/// height / slope, Q24: `times`, of numbers that are not negative and a slope under 2^25, the shift of whose reciprocal is
/// 56 at most.
#[inline(never)]
fn divide(height: u32, slope: u32) -> i32 {
    let r = recip(slope);
    mul_shift_short(height, r.mantissa >> 1, r.shift - 25) as i32
}

/// The same for a shape that ends: under `t_max`, and none that was placed at [`FAR`], where the ray is not on the plane.
#[inline]
fn bounded_crossing(point: Point, normal: Dir, ray: &Ray, t_max: i32) -> Option<i32> {
    crossing(point, normal, ray, t_max).filter(|t| *t < t_max.min(FAR))
}

/// A point near a plane, brought onto it along the normal.
#[inline]
pub fn onto_plane(point: Point, normal: Dir, near: Point) -> Point {
    let height = point.to(near).dot_normal(normal);
    near.along_side(normal, -height)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_area_is_the_product_of_its_sides() {
        let mut s = 1u32;
        let mut half = || {
            s = s.wrapping_mul(747796405).wrapping_add(2891336453);
            let bits = s >> 28;
            (((s ^ (s >> 15)) >> (16 - bits)) & 0x3f_ffff).max(1) as i32
        };
        for round in 0..100_000 {
            let half = match round {
                0 => [65535, 65535],
                1 => [65535, 65536],
                2 => [1, 1],
                _ => [half(), half()],
            };
            let rectangle = Rectangle {
                center: Point([0; 3]),
                u: Dir::X,
                v: Dir::Y,
                normal: Dir::Z,
                half,
            };
            let product = Wide::new(half[0] as u32, 1) * Wide::new(half[1] as u32, 1);
            assert_eq!(rectangle.area(), product, "{half:?}");
        }
    }
}
