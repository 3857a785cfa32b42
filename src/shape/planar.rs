//! Plane, disk and rectangle: one crossing with the plane, three ways to bound it.

use crate::geom::{Dir, FAR, Offset, Point, Ray};
use crate::num::{Wide, leading_zeros, mul_hi, mul_q16, recip, round_shift};

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
pub struct Rectangle {
    pub center: Point,
    pub u: Dir,
    pub v: Dir,
    pub normal: Dir,
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

    #[inline]
    pub fn intersect(&self, ray: &Ray, t_max: i32) -> Option<i32> {
        let t = bounded_crossing(self.center, self.normal, ray, t_max)?;
        // Coordinates are rounded down by up to 3 units.
        let p = self.center.to(ray.at(t));
        let x = dot(p, self.u);
        if x > self.half[0] || x < -self.half[0] - 3 {
            return None;
        }
        let y = dot(p, self.v);
        (y <= self.half[1] && y >= -self.half[1] - 3).then_some(t)
    }

    /// Area, units².
    pub fn area(&self) -> Wide {
        Wide::new(self.half[0] as u32, 1) * Wide::new(self.half[1] as u32, 1)
    }
}

/// Distance along the ray to a plane, t > 0, at most [`FAR`]; perhaps `None` where it is not under `t_max`.
///
/// t = −(o − p)·n / (d·n), the closed form; the quotient's relative error is 2^-24 / |d·n| plus 2^-28.
#[inline(always)]
fn crossing(point: Point, normal: Dir, ray: &Ray, t_max: i32) -> Option<i32> {
    let height = dot(point.to(ray.origin), normal);
    let slope = slope(ray.dir, normal);
    // They meet in front only if one is positive and the other negative.
    if (height ^ slope) >= 0 || slope == 0 {
        return None;
    }
    quotient(height.unsigned_abs(), slope.unsigned_abs(), t_max)
}

/// height / slope, as [`crossing`] wants it; the slope is not 0.
#[inline(never)]
fn quotient(height: u32, slope: u32, t_max: i32) -> Option<i32> {
    if height >> 5 >= slope {
        return (height > 0).then_some(FAR);
    }
    // Clearly beyond t_max, by more than the quotient's error, it is not worth a reciprocal:
    // 2 h > t_max·slope / 2^23 (1 + 2^-20) + 4, with t_max < 2^30 and slope under 2^25.
    let reach = mul_hi((t_max as u32) << 2, slope << 7);
    if height << 1 > reach + (reach >> 20) + 4 {
        return None;
    }
    let t = recip(slope).times(height as i32, 24);
    (t > 0).then_some(t)
}

/// [`crate::geom::Offset::dot`], the same bits with one product where the direction is an axis.
#[inline(always)]
fn dot(v: Offset, d: Dir) -> i32 {
    let [x, y, z] = d.0;
    match (x == 0, y == 0, z == 0) {
        (_, true, true) => mul_q16(v.0[0], x),
        (true, _, true) => mul_q16(v.0[1], y),
        (true, true, _) => mul_q16(v.0[2], z),
        _ => v.dot(d),
    }
}

/// [`Dir::dot_q24`], the same bits with one product where the normal is an axis.
#[inline(always)]
fn slope(dir: Dir, normal: Dir) -> i32 {
    let one = |d: i32, n: i32| (d >> 8) * n + (((d & 255) * n) >> 8);
    let [x, y, z] = normal.0;
    match (x == 0, y == 0, z == 0) {
        (_, true, true) => one(dir.0[0], x),
        (true, _, true) => one(dir.0[1], y),
        (true, true, _) => one(dir.0[2], z),
        _ => dir.dot_q24(normal),
    }
}

/// The same for a shape that ends: under `t_max`, and none that was placed at [`FAR`], where the ray is not on the plane.
#[inline]
fn bounded_crossing(point: Point, normal: Dir, ray: &Ray, t_max: i32) -> Option<i32> {
    crossing(point, normal, ray, t_max).filter(|t| *t < t_max.min(FAR))
}

/// A point near a plane, brought onto it along the normal.
#[inline]
pub fn onto_plane(point: Point, normal: Dir, near: Point) -> Point {
    near.along(normal, -point.to(near).dot(normal))
}
