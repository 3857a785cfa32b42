use crate::geom::{Dir, Point, Ray};
use crate::num::short_recip;

/// Fraction bits of a slope.
const BITS: u32 = 13;

/// A ray as seen along its dominant axis: what tells, with two short products, that a shape is clearly missed.
///
/// The dominant axis k is that of the largest component of the direction; the slopes are d_a/d_k of axes k + 1 and k + 2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight {
    pub(crate) axis: u8,
    negative: bool,
    /// Q13, within ±2^13, error 2^-12 at most.
    slopes: [i32; 2],
}

impl Sight {
    #[inline]
    pub(crate) fn new(dir: Dir) -> Sight {
        let [x, y, z] = dir.0;
        let size = dir.0.map(i32::unsigned_abs);
        let (axis, k, a, b) = if size[0] >= size[1] && size[0] >= size[2] {
            (0, x, y, z)
        } else if size[1] >= size[2] {
            (1, y, z, x)
        } else {
            (2, z, x, y)
        };
        // 1/√3 ..= 1: 2^15 ..< 2^16 but for 1 itself, which is a little more.
        let r = short_recip(k.unsigned_abs().min(0xffff));
        let r = if k < 0 { -r } else { r };
        // |a| ≤ |k|, so that a·2^31/k stays within 2^31; half of it fits.
        let slope = |a: i32| ((a >> 1) * r) >> (30 - BITS);
        Sight {
            axis,
            negative: k < 0,
            slopes: [slope(a), slope(b)],
        }
    }

    /// Whether the ray may come within a distance of a point, units; 0 ..= 2^22 + 2^16. `K` is its dominant axis.
    ///
    /// Points within r of the ray lie within r √(1 + s²) ≤ √2 r of it along either other axis, and at most r behind its
    /// origin along the axis itself. What is off here: 2^9 units by the shortened factor, 2^-12 of the way by the slope.
    #[inline(always)]
    pub(crate) fn is_near<const K: usize>(&self, ray: &Ray, point: Point, r: i32) -> bool {
        let step = ray.origin.to(point).0;
        let ahead = step[K];
        // Beyond 2^24 units the products would not fit.
        if ahead.wrapping_add(1 << 24) as u32 >= 1 << 25 {
            return true;
        }
        let r = r + (r >> 1) + (1 << 9);
        if (if self.negative { -ahead } else { ahead }) < -r {
            return false;
        }
        let limit = r + (ahead.unsigned_abs() >> 12) as i32;
        let within = |step: i32, slope: i32| {
            // 2^16 · 2^13
            let aside = step.wrapping_sub(((ahead >> 8) * slope) >> (BITS - 8));
            aside.wrapping_add(limit) as u32 <= 2 * limit as u32
        };
        within(step[(K + 1) % 3], self.slopes[0]) && within(step[(K + 2) % 3], self.slopes[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Sphere;

    #[test]
    fn nothing_that_is_met_counts_as_missed() {
        let mut s = 1u32;
        let mut r = |bits: u32| {
            s = s.wrapping_mul(747796405).wrapping_add(2891336453);
            ((s ^ (s >> 15)) as i32) >> (32 - bits)
        };
        let (mut met, mut near) = (0, 0);
        for round in 0..400_000 {
            let radius = r(22).abs().max(1);
            let spread = 8 + r(4).unsigned_abs() * 2;
            let origin = Point([r(spread), r(spread), r(spread)]);
            // Half of them at about the sphere's rim.
            let rim = Point([r(22), r(22), r(22)]);
            let Some((out, _)) = crate::geom::Offset(rim.0).normalize() else {
                continue;
            };
            let aim = if round & 1 == 0 {
                Point([0; 3]).along(out, radius)
            } else {
                Point([r(spread), r(spread), r(spread)])
            };
            let Some((dir, _)) = origin.to(aim).normalize() else {
                continue;
            };
            let ray = Ray { origin, dir };
            let sphere = Sphere::new(Point([0; 3]), radius);
            let sight = Sight::new(dir);
            let seen = match sight.axis {
                0 => sight.is_near::<0>(&ray, sphere.center, radius),
                1 => sight.is_near::<1>(&ray, sphere.center, radius),
                _ => sight.is_near::<2>(&ray, sphere.center, radius),
            };
            near += seen as u32;
            if sphere.intersect(&ray, i32::MAX).is_some() {
                met += 1;
                assert!(seen, "{ray:?} {radius}");
            }
        }
        assert!(met > 80_000 && near < met + 80_000, "{met} {near}");
    }
}
