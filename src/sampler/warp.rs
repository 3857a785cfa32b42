//! From uniform numbers to distributions: every warp is a pair, `sample` and `pdf`.

use crate::geom::Dir;
use crate::num::Uniform;
use crate::num::{ONE_Q16, Turn, Wide, isqrt, mul_hi, mul_q16, sin_cos};

/// A direction about +z with density cos θ / π per solid angle (Malley's method on a polar disk).
#[inline]
pub fn sample_cosine_hemisphere(u: [Uniform; 2]) -> Dir {
    // r = √u0, cos θ = √(1 − u0); the middle of the last bit's cell, so that cos θ is never 0.
    let bits = u[0].to_bits();
    let r = isqrt(bits) as i32;
    let cos = isqrt(!bits).max(1) as i32;
    let (sin_phi, cos_phi) = sin_cos(Turn::from_bits(u[1].to_bits()));
    Dir([mul_q16(r, cos_phi), mul_q16(r, sin_phi), cos])
}

/// Density of [`sample_cosine_hemisphere`] at a direction with this cosine (Q16); 0 below the horizon.
#[inline]
pub fn pdf_cosine_hemisphere(cos: i32) -> Wide {
    Wide::from_q16(cos) * Wide::INV_PI
}

/// A direction of the whole sphere with density 1/(4π): cos θ = 1 − 2 u0 about z.
#[inline]
pub fn sample_sphere(u: [Uniform; 2]) -> Dir {
    let bits = u[0].to_bits();
    let z = ONE_Q16 - (bits >> 15) as i32;
    // sin² θ = 4 u0 (1 − u0), at most 1.
    let square = mul_hi(bits, !bits);
    let r = isqrt(if square >= 1 << 30 { u32::MAX } else { square << 2 }) as i32;
    let (sin_phi, cos_phi) = sin_cos(Turn::from_bits(u[1].to_bits()));
    Dir([mul_q16(r, cos_phi), mul_q16(r, sin_phi), z])
}

/// A point of the unit disk, both coordinates Q16, with density 1/π.
#[inline]
pub fn sample_disk(u: [Uniform; 2]) -> [i32; 2] {
    let r = isqrt(u[0].to_bits()) as i32;
    let (sin_phi, cos_phi) = sin_cos(Turn::from_bits(u[1].to_bits()));
    [mul_q16(r, cos_phi), mul_q16(r, sin_phi)]
}

/// Barycentric weights of the second and third corner, Q16, uniform over a triangle.
///
/// b1 = 1 − √u0, b2 = u1 √u0 (Turk, "Generating Random Points in Triangles", Graphics Gems, 1990).
#[inline]
pub fn sample_triangle(u: [Uniform; 2]) -> [i32; 2] {
    let root = isqrt(u[0].to_bits()) as i32;
    [ONE_Q16 - root, mul_q16(root, (u[1].to_bits() >> 16) as i32)]
}
