//! From the unit square to disks, hemispheres and cones, keeping strata together.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use super::vec::{Vec3, vec3};

/// Uniform on the unit disk: Shirley and Chiu, "A Low Distortion Map Between Disk and Square" (1997).
pub fn disk([u, v]: [f64; 2]) -> [f64; 2] {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return [0.0, 0.0];
    }
    let (r, angle) = if a.abs() > b.abs() {
        (a, FRAC_PI_4 * (b / a))
    } else {
        (b, FRAC_PI_2 - FRAC_PI_4 * (a / b))
    };
    [r * angle.cos(), r * angle.sin()]
}

/// Density cosθ/π over the hemisphere around +z (Malley's method).
pub fn cosine_hemisphere(u: [f64; 2]) -> Vec3 {
    let [x, y] = disk(u);
    vec3(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
}

/// Uniform over the cone around +z whose half angle has the cosine 1 − `one_minus_cos`; density 1/(2π `one_minus_cos`). 1 is
/// the hemisphere, 2 the sphere.
pub fn cone([u, v]: [f64; 2], one_minus_cos: f64) -> Vec3 {
    let height = u * one_minus_cos;
    let radius = (height * (2.0 - height)).max(0.0).sqrt();
    let (sin, cos) = (TAU * v).sin_cos();
    vec3(radius * cos, radius * sin, 1.0 - height)
}

/// Barycentric coordinates of a uniform point of a triangle (Turk, Graphics Gems 1990).
pub fn triangle([u, v]: [f64; 2]) -> [f64; 3] {
    let root = u.sqrt();
    [1.0 - root, root * (1.0 - v), root * v]
}
