//! A ray as a solid sees it: a line of integers in the solid's own frame and size.

use super::Place;
use crate::geom::{Dir, Offset, Point, Ray};
use crate::num::{isqrt, leading_zeros, mul_hi_signed, round_shift};

/// Fraction bits of a local coordinate: 2^8 fine steps are one step of the march.
pub(super) const FINE: u32 = 8;

/// Steps by which the sphere about a solid is larger than the solid: a ray that comes from outside starts outside of it,
/// however the sphere's own crossing was rounded (by 2 steps).
const MARGIN: i32 = 8;

/// Bits of a solid's reach in fine steps.
const REACH_BITS: u32 = 15 + FINE;

impl Place {
    /// Left shift that makes fine steps of units: the reach becomes 2^22 ..= 2^23 − 1.
    #[inline]
    pub(super) fn up(&self) -> u32 {
        (REACH_BITS + leading_zeros(self.reach as u32)).saturating_sub(32)
    }

    /// The three axes, Q30: of length 1 and at right angles to 2^-22, whatever the two directions' rounding.
    #[inline]
    fn frame(&self) -> Option<[[i32; 3]; 3]> {
        let [x, y] = self.axes?;
        // 1/|x| = 1 − (|x|² − 1)/2 to 2^-28: directions are 1 long to 2^-13. Q24.
        let longer = |d: Dir| (d.dot_q24(d) - (1 << 24)) >> 1;
        let (lx, ly) = (longer(x), longer(y));
        // What of y is along x, Q24: under 2^12, so that products with a component are under 2^29.
        let skew = x.dot_q24(y);
        let x30 = x.0.map(|c| (c << 14) - ((c * lx) >> 10));
        let y30 = [0, 1, 2].map(|i| (y.0[i] << 14) - ((y.0[i] * ly) >> 10) - ((x.0[i] * skew) >> 10));
        let minor = |i: usize, j: usize| (mul_hi_signed(x30[i], y30[j]) - mul_hi_signed(x30[j], y30[i])) << 2;
        Some([x30, y30, [minor(1, 2), minor(2, 0), minor(0, 1)]])
    }

    /// Where a point of the scene near the solid lies in its frame, fine steps.
    #[inline]
    pub(super) fn to_local(&self, point: Point) -> [i32; 3] {
        let up = self.up();
        // A hit lies within the reach; what lies beyond twice that is brought there.
        let bound = 2 << REACH_BITS;
        let v = self
            .center
            .to(point)
            .0
            .map(|c| c.clamp(-(bound >> up), bound >> up) << up);
        match self.frame() {
            None => v,
            Some(axes) => turn(axes, v.map(|c| c << 4), 4),
        }
    }

    /// The direction of a vector of the solid's frame, its components under 2^29.
    #[inline]
    pub(super) fn to_scene(&self, v: [i32; 3]) -> Offset {
        match self.frame() {
            None => Offset(v),
            Some([x, y, z]) => {
                // Half as long as it was.
                let mix = |i: usize| {
                    let along = |c: i32, axis: [i32; 3]| mul_hi_signed(c << 1, axis[i]);
                    along(v[0], x) + along(v[1], y) + along(v[2], z)
                };
                Offset([mix(0), mix(1), mix(2)])
            }
        }
    }
}

/// Components along the axes of a vector under 2^29 with `bits` more bits than wanted; rounded to nearest.
///
/// Error ½ ulp, and 3 · 2^-bits.
#[inline]
fn turn(axes: [[i32; 3]; 3], v: [i32; 3], bits: u32) -> [i32; 3] {
    axes.map(|axis| {
        let along =
            mul_hi_signed(v[0], axis[0]) + mul_hi_signed(v[1], axis[1]) + mul_hi_signed(v[2], axis[2]);
        round_shift(along, bits - 2)
    })
}

/// All points `(base + s·dir)/2^7`, s in steps from the point of closest approach; fine steps.
///
/// The reach has 15 bits in steps, so |s| ≤ 2^15 + 2^4, and base and s·dir are each under 2^30 + 2^15: a point is two
/// small products and sums that are exact until their one rounding, and lies where a straight line has it to 2^-8 step.
pub(super) struct Line {
    /// Q15 steps.
    base: [i32; 3],
    /// Q15.
    dir: [i32; 3],
    /// Where the ray starts, or comes into the solid's sphere.
    pub begin: i32,
    /// Where it leaves the sphere.
    pub end: i32,
    /// From here on the ray is not asked for.
    pub stop: i32,
    /// Of the point of closest approach, in units of 2^-up.
    t0: i32,
    up: u32,
    /// Left shift that makes steps into units of 2^-up; right if negative.
    scale: i32,
}

impl Line {
    /// `None` if the ray passes by the solid's sphere, or is not asked for where it doesn't.
    ///
    /// As for [`crate::shape::Sphere`], everything is relative to the point of closest approach, so that the error is a
    /// share of the solid wherever the ray comes from; near the solid it is found in fine steps, far off in scene units.
    #[inline]
    pub fn new(place: &Place, ray: &Ray, t_max: i32) -> Option<Line> {
        let to_center = ray.origin.to(place.center).0;
        let size = to_center.iter().fold(0, |size, c| size | (c ^ (c >> 31)));
        // As many fine bits as leave the way to the centre under 2^29.
        let all = place.up();
        let up = all.min(leading_zeros(size as u32).saturating_sub(3));
        let rest = all - up;
        let reach = (place.reach << all) + (MARGIN << FINE);

        let to_center = Offset(to_center.map(|c| c << up));
        let t0 = to_center.dot(ray.dir);
        let f = ray.dir.times(t0).minus(to_center);
        // The direction's length is 1 to 2^-14 only: f may still lie that much of t0 before or behind.
        let bound = (reach >> rest) + 1;
        if exceeds(f.0, bound + (t0.unsigned_abs() >> 12) as i32) {
            return None;
        }
        let before = f.dot(ray.dir);
        let t0 = t0.wrapping_sub(before);
        let f = f.minus(ray.dir.times(before));
        if exceeds(f.0, bound) {
            return None;
        }
        let f = f.0.map(|c| c << rest);

        // In whole steps: squares under 2^30 + 2^20 each.
        let square = |c: i32| {
            let c = round_shift(c, FINE).unsigned_abs();
            c * c
        };
        let half = square(reach).checked_sub(square(f[0]) + square(f[1]) + square(f[2]))?;
        let end = isqrt(half) as i32 + 1;
        let scale = FINE as i32 - rest as i32;
        let begin = steps(t0.wrapping_neg(), scale).max(-end);
        let stop = if t_max > (1 << 30) >> up {
            i32::MAX
        } else {
            steps((t_max << up).saturating_sub(t0), scale)
        };
        if begin >= end.min(stop) {
            return None;
        }
        let (base, dir) = match place.frame() {
            None => (f, ray.dir.0.map(|c| (c + 1) >> 1)),
            Some(axes) => (
                turn(axes, f.map(|c| c << 4), 4),
                turn(axes, ray.dir.0.map(|c| c << 11), 12),
            ),
        };
        Some(Line {
            base: base.map(|c| c << 7),
            dir,
            begin,
            end,
            stop,
            t0,
            up,
            scale,
        })
    }

    /// The point at `s`, fine steps.
    #[inline]
    pub fn point(&self, s: i32) -> [i32; 3] {
        let at = |i: usize| self.base[i].wrapping_add(self.dir[i].wrapping_mul(s)) >> 7;
        [at(0), at(1), at(2)]
    }

    /// Distance along the ray, units, rounded down, at least 1.
    #[inline]
    pub fn distance(&self, s: i32) -> i32 {
        let ahead = if self.scale >= 0 {
            s << self.scale
        } else {
            s >> -self.scale
        };
        (self.t0.wrapping_add(ahead) >> self.up).max(1)
    }
}

/// The least number of steps of 2^`scale` that is no less than `length`; far ones are brought to ±2^24.
#[inline]
fn steps(length: i32, scale: i32) -> i32 {
    let length = length.max(-i32::MAX);
    if scale >= 0 {
        -(-length >> scale)
    } else {
        length.clamp(-1 << 24 >> -scale, 1 << 24 >> -scale) << -scale
    }
}

/// Whether a component lies outside ±`limit`.
#[inline]
fn exceeds(v: [i32; 3], limit: i32) -> bool {
    v.iter().any(|c| *c > limit || *c < -limit)
}
