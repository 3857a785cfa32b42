use crate::geom::{Dir, Point, Ray};
use crate::num::{Wide, isqrt, leading_zeros, round_shift};

/// A sphere, normal outwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sphere {
    pub center: Point,
    /// Units, 1 ..= 2^22.
    pub radius: i32,
}

impl Sphere {
    pub const fn new(center: Point, radius: i32) -> Sphere {
        Sphere { center, radius }
    }

    /// Right shift that brings the radius under 2^14, the sphere's own scale.
    #[inline]
    fn shift(&self) -> u32 {
        (32 - leading_zeros(self.radius as u32)).saturating_sub(14)
    }

    /// Distance to the first crossing with 0 < t < `t_max`.
    ///
    /// From the point of closest approach f, found relative to the centre, so that the error is a share of the sphere
    /// (2^-13 of the radius) wherever the ray comes from: t = t0 ± √(r² − |f|²) (Haines et al., "Precision Improvements
    /// for Ray/Sphere Intersection", Ray Tracing Gems, 2019).
    #[inline]
    pub fn intersect(&self, ray: &Ray, t_max: i32) -> Option<i32> {
        let to_center = ray.origin.to(self.center);
        let t0 = to_center.dot(ray.dir);
        let r = self.radius;
        // Clearly behind, or clearly beyond what is wanted: by more than the 2^-11 of t0 and the few units that `rest`
        // may take from it later, and the 2^-14 of r that half the chord may be longer than r.
        let reach = r + (r >> 6) + 16;
        if t0 < -reach || t0 - (t0 >> 8) - reach >= t_max {
            return None;
        }
        let f = ray.dir.times(t0).minus(to_center);
        // The direction's length is 1 to 2^-14 only: f may still lie that much of t0 before or behind.
        let slack = r + (t0.unsigned_abs() >> 12) as i32;
        if exceeds(f.0, slack) {
            return None;
        }
        let rest = f.dot(ray.dir);
        let t0 = t0.wrapping_sub(rest);
        let f = f.minus(ray.dir.times(rest));
        if exceeds(f.0, r) {
            return None;
        }
        let shift = self.shift();
        let [x, y, z] = f.0.map(|c| round_shift(c, shift));
        let r = round_shift(r, shift);
        // r² ≤ 2^28 and each square too.
        let discriminant = r * r - x * x - y * y - z * z;
        if discriminant < 0 {
            return None;
        }
        // Two more bits of root than of discriminant.
        let root = isqrt((discriminant as u32) << 4) as i32;
        let half = (root << shift) >> 2;
        let near = t0.wrapping_sub(half);
        let t = if near > 0 { near } else { t0.wrapping_add(half) };
        (t > 0 && t < t_max).then_some(t)
    }

    /// The normal where a point on or near the sphere lies, and that point brought onto it.
    pub fn surface(&self, near: Point) -> (Point, Dir) {
        let normal = match self.center.to(near).normalize() {
            Some((normal, _)) => normal,
            None => Dir::Z,
        };
        (self.center.along(normal, self.radius), normal)
    }

    /// How far a ray's origin must be lifted off the surface so that the ray does not meet it again, units.
    ///
    /// [`Self::intersect`] sees the sphere in steps of 2^shift; closest approach, radius and square are each rounded
    /// to one, and three such steps outweigh them. Eight units more cover the point's own rounding.
    #[inline]
    pub fn lift(&self) -> i32 {
        8 + (3 << self.shift())
    }

    /// Squared radius, units².
    #[inline]
    pub fn radius_squared(&self) -> Wide {
        let r = Wide::new(self.radius as u32, 0);
        r * r
    }
}

/// Whether a component lies outside ±`limit`, which is 0 ..< 2^30.
#[inline(always)]
fn exceeds(v: [i32; 3], limit: i32) -> bool {
    let outside = |c: i32| c.wrapping_add(limit) as u32 > 2 * limit as u32;
    outside(v[0]) || outside(v[1]) || outside(v[2])
}
