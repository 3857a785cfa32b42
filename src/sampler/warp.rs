//! From uniform numbers to distributions: every warp is a pair, `sample` and `pdf`.

use crate::geom::Dir;
use crate::num::Uniform;
use crate::num::{ONE_Q16, Turn, Wide, isqrt, mul_hi, mul_q16, mul_shift, recip, sin_cos};

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

/// [`sample_cosine_hemisphere`] by two tables, Q14: no farther off than 1/24, its square 1 − 1/400 at least.
#[inline]
pub fn coarse_cosine_hemisphere(u: [Uniform; 2]) -> [i32; 3] {
    let share = (u[0].to_bits() >> 24) as usize;
    let angle = (u[1].to_bits() >> 25) as usize;
    let r = ROOTS[share] as i32;
    let cos = ROOTS[255 - share] as i32;
    let (sin_phi, cos_phi) = (SINES[angle] as i32, SINES[angle + 32] as i32);
    [(r * cos_phi) >> 14, (r * sin_phi) >> 14, cos]
}

/// Between √(i/256) and √((i + 1)/256), Q14.
static ROOTS: [i16; 256] = {
    let mut table = [0; 256];
    let mut i = 0;
    while i < 256 {
        let ends = [(i as u64) << 20, (i as u64 + 1) << 20];
        table[i] = ((ends[0].isqrt() + ends[1].isqrt()) / 2) as i16;
        i += 1;
    }
    table
};

/// Sines of (i + ½)/128 turns, Q14: of a turn, and a quarter more for cosines.
static SINES: [i16; 160] = {
    let mut table = [0; 160];
    let mut i = 0;
    while i < 160 {
        let (sin, _) = sin_cos(Turn::from_bits((2 * i as u32 + 1) << 24));
        table[i] = (sin >> 2) as i16;
        i += 1;
    }
    table
};

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

/// A number in 0 ..= 1, Q16, with a density that goes evenly from `a` at 0 to `b` at 1, not both 0: over their mean.
///
/// t = u (a + b) / (a + √((1 − u) a² + u b²)), which is stable for all of them (Heitz, "Can't invert the CDF?", 2020,
/// section 2, for one triangle's height).
pub fn sample_linear(u: Uniform, a: Wide, b: Wide) -> i32 {
    let bits = u.to_bits();
    let (share, rest) = (Wide::new(bits, -32), Wide::new(!bits, -32));
    let root = (rest * a * a + share * b * b).sqrt();
    (share * (a + b) / (a + root)).to_fixed(16).min(ONE_Q16 as u32) as i32
}

/// A direction about +z, even over a cone of given 1 − cos θmax and sin θmax, and (sin θ / sin θmax)², Q32.
///
/// In quantities that keep their precision for cones of any width: with q = 1 − cos θmax, 1 − cos θ = u q, so
/// (sin θ / sin θmax)² = u (2 − u q) / (2 − q).
#[inline]
pub fn sample_cone(u: [Uniform; 2], versine: Wide, sin_max: Wide) -> (Dir, u32) {
    let q = versine.to_fixed(16) as i32;
    let u0 = (u[0].to_bits() >> 16) as i32;
    let uq = mul_q16(u0, q);
    let share = recip((2 * ONE_Q16 - q) as u32).times(mul_q16(u0, 2 * ONE_Q16 - uq), 16);
    let share = (share.clamp(0, ONE_Q16 - 1) as u32) << 16;
    let sin_theta = mul_q16(isqrt(share) as i32, sin_max.to_fixed(16) as i32);
    let (sin_phi, cos_phi) = sin_cos(Turn::from_bits(u[1].to_bits()));
    let local = Dir([
        mul_q16(sin_theta, cos_phi),
        mul_q16(sin_theta, sin_phi),
        ONE_Q16 - uq,
    ]);
    (local, share)
}

/// Density of [`sample_cone`] in the cone: 1 / (2π (1 − cos θmax)).
#[inline]
pub fn pdf_cone(versine: Wide) -> Wide {
    (Wide::PI.shl(1) * versine).recip()
}

/// All directions within an angle of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// 1 − cos θmax.
    versine: Wide,
    sin_max: Wide,
}

impl Cone {
    /// 0.01° in 2^-32 of a turn: less is not seen by directions in steps of 2^-16.
    const LEAST: u32 = 119_305;

    /// Of this half angle, 2^-32 turns, brought into 0.01° ..= 90°.
    pub fn new(half_angle: u32) -> Cone {
        // x = θmax/2, radians: under ½ by the series of the sine, which is 1e-5 of it off at most.
        let half_angle = half_angle.clamp(Self::LEAST, 1 << 30);
        let x = Wide::PI * Wide::new(half_angle, -32);
        let sine = if half_angle < 1 << 29 {
            let x2 = x * x;
            // 1 − x²/6 (1 − x²/20)
            let fifth = Wide::ONE.saturating_sub(x2 * Wide::new(TWENTIETH, -32));
            x * Wide::ONE.saturating_sub(x2 * Wide::new(SIXTH, -32) * fifth)
        } else {
            Wide::from_q16(sin_cos(Turn::from_bits(half_angle / 2)).0)
        };
        let versine = (sine * sine).shl(1);
        let sin_max = (versine * Wide::ONE.shl(1).saturating_sub(versine)).sqrt();
        Cone { versine, sin_max }
    }

    /// 1 − cos θmax.
    pub const fn versine(&self) -> Wide {
        self.versine
    }

    /// 2π (1 − cos θmax).
    pub fn solid_angle(&self) -> Wide {
        Wide::PI.shl(1) * self.versine
    }

    /// A direction about +z, each component to the nearest step.
    pub fn sample(&self, u: [Uniform; 2]) -> Dir {
        let (local, share) = sample_cone(u, self.versine, self.sin_max);
        let (sin_phi, cos_phi) = sin_cos(Turn::from_bits(u[1].to_bits()));
        // Q16 of the rim's radius, times Q24: narrow cones are but a few hundred steps wide.
        let radius = isqrt(share) as i32;
        let sin_max = self.sin_max.to_fixed(24) as i32;
        let component = |trig: i32| (mul_shift(mul_q16(radius, trig), sin_max, 23) + 1) >> 1;
        Dir([component(cos_phi), component(sin_phi), local.0[2]])
    }

    /// The density of [`Self::sample`] in the cone.
    pub fn pdf(&self) -> Wide {
        pdf_cone(self.versine)
    }

    /// Whether a direction lies in the cone about `axis`.
    pub fn holds(&self, axis: Dir, dir: Dir) -> bool {
        let chord = [0, 1, 2].map(|i| dir.0[i].wrapping_sub(axis.0[i]).unsigned_abs());
        // Narrow: chord² = 2 (1 − cos θ), which a cosine would lose. A side under 2^15: squares add up to under 2^32.
        if !self.versine.is_at_least(Wide::new(1, -4)) {
            let limit = self.versine.shl(1).to_fixed(32);
            return chord.iter().all(|c| *c < 1 << 15) && chord.iter().map(|c| c * c).sum::<u32>() <= limit;
        }
        dir.dot_q24(axis) >= (1 << 24) - self.versine.to_fixed(24) as i32
    }
}

/// 1/6 and 1/20, Q32.
const SIXTH: u32 = 715_827_883;
const TWENTIETH: u32 = 214_748_365;
