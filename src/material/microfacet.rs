//! What Blinn–Phong and the GGX models share: half vectors, and the GGX distribution of normals.

use crate::geom::Dir;
use crate::num::{ONE_Q16, Share, Turn, Uniform, Wide, isqrt, mul_hi, mul_q16, mul_shift, sin_cos};

/// A half vector, not normalised, against the surface's normal.
#[derive(Clone, Copy)]
pub(super) struct Half {
    vector: Dir,
    /// Squares of its parts along the surface and along the normal.
    pub along: Wide,
    pub across: Wide,
    /// Whether it points to the normal's side.
    pub is_above: bool,
}

impl Half {
    /// From a vector in Q16, components under 2^19; `None` for one that lies in the surface.
    ///
    /// The part along the surface is found by itself: as 1 − cos² it would drown in the rounding of the directions.
    pub fn new(vector: [i32; 3], normal: Dir) -> Option<Half> {
        let height = Dir(vector).dot_q24(normal);
        if height == 0 {
            return None;
        }
        // Q20
        let square = |i: usize| {
            let part = (vector[i] << 4) - mul_shift(height, normal.0[i], 20);
            let part = Wide::new(part.unsigned_abs(), -20);
            part * part
        };
        let across = Wide::new(height.unsigned_abs(), -24);
        Some(Half {
            vector: Dir(vector),
            along: square(0) + square(1) + square(2),
            across: across * across,
            is_above: height > 0,
        })
    }

    pub fn square(&self) -> Wide {
        self.along + self.across
    }

    /// Its component along a direction, Q16: not divided by its length.
    pub fn dot(&self, dir: Dir) -> i32 {
        self.vector.dot(dir)
    }
}

/// wi + wo.
pub(super) fn sum(wi: Dir, wo: Dir) -> [i32; 3] {
    let (i, o) = (wi.0, wo.0);
    [i[0] + o[0], i[1] + o[1], i[2] + o[2]]
}

/// The GGX distribution of microfacet normals, isotropic.
///
/// Walter, Marschner, Li and Torrance, "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, section 5.2.
#[derive(Clone, Copy)]
pub(super) struct Ggx {
    /// Q16.
    alpha: i32,
    square: Wide,
}

impl Ggx {
    pub fn new(alpha: Share) -> Ggx {
        let alpha = (alpha.to_bits() as i32) << 1;
        let wide = Wide::from_q16(alpha);
        Ggx {
            alpha,
            square: wide * wide,
        }
    }

    /// Density of normals along a half vector, per solid angle and area of surface [Walter (33)].
    ///
    /// α²/(π (cos² (α² − 1) + 1)²), with T and N the squares along and across: α² (T + N)²/(π (T + α² N)²).
    pub fn density(&self, along: Wide, across: Wide) -> Wide {
        let ratio = (along + across) / (along + self.square * across);
        self.square * ratio * ratio * Wide::INV_PI
    }

    /// cos θ + √(cos² θ + α² sin² θ) of a cosine in Q16: the share that is not masked is 2 cos θ over it [Walter (34)].
    pub fn slope(&self, cos: i32) -> Wide {
        let cos = Wide::from_q16(cos);
        let square = cos * cos;
        cos + (square + self.square * Wide::ONE.saturating_sub(square)).sqrt()
    }

    /// Share of the surface's facets that are seen from a direction with this cosine (Q16): Smith's G1.
    pub fn seen(&self, cos: i32) -> Wide {
        Wide::from_q16(cos).shl(1) / self.slope(cos)
    }

    /// A normal among those seen from `wo`, both in the frame of the surface's normal; `wo` above the surface.
    ///
    /// Density G1(wo) D(m) wo·m / cos θo (Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 7(4), 2018, by
    /// the spherical cap of Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023, listing 3).
    pub fn sample_seen(&self, wo: Dir, u: [Uniform; 2]) -> Option<Dir> {
        // The surface stretched until it is a hemisphere.
        let v = self.stretch(wo.0)?.0;
        // Height of the reflected direction: uniform over the cap above −v. Q30.
        let height =
            mul_hi(((ONE_Q16 + v[2].max(0)) as u32) << 14, !u[0].to_bits()) as i32 - (v[2].max(0) << 14);
        let bits = (height.unsigned_abs().min((1 << 30) - 1)) << 2;
        let sin = isqrt(!mul_hi(bits, bits)) as i32;
        let (sin_phi, cos_phi) = sin_cos(Turn::from_bits(u[1].to_bits()));
        let half = [
            mul_q16(sin, cos_phi) + v[0],
            mul_q16(sin, sin_phi) + v[1],
            ((height + (1 << 13)) >> 14) + v[2],
        ];
        self.stretch(half)
    }

    /// (α x, α y, z), normalised; z from 0 up.
    fn stretch(&self, v: [i32; 3]) -> Option<Dir> {
        // Q28, of components under 2^17.
        let side = |c: i32| mul_shift(self.alpha, c, 4);
        Dir::new([side(v[0]), side(v[1]), v[2].max(0) << 12])
    }
}
