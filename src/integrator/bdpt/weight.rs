//! Weights of the strategies that could have found a path, by two running quantities a vertex.
//!
//! A path of n vertices can be found by every split into s vertices from a light and t from the camera. The power
//! heuristic with exponent 2 (Veach 1997, equation 9.13) weighs what one of them found by 1 over the sum, over all of
//! them, of the squared ratio of their density to its own. Densities of neighbouring strategies differ by one factor, so
//! that the sum over all shorter light subpaths is a quantity of the light subpath, and that over all longer ones a
//! quantity of the camera subpath: `d_vcm` and `d_vc` below, which grow by a step a vertex.
//!
//! "(n)" is equation n of Georgiev, "Implementing Vertex Connection and Merging", technical report, Saarland University,
//! 2012, without merging (η = 0); after van Antwerpen, "Recursive MIS Computation for Streaming BDPT on the GPU",
//! technical report, Delft University of Technology, 2011. Chances of roulette are left out of all densities: weights
//! need but add up to 1 for each path.

use crate::num::Wide;

/// What the power heuristic makes of a ratio of densities.
#[inline(always)]
pub fn mis(ratio: Wide) -> Wide {
    ratio * ratio
}

/// The running quantities of a subpath, either on its way or, after [`Partial::arrive`], at a vertex.
///
/// d_vcm is 1 over the density, by area, of the subpath's last vertex; d_vc is the sum over the shorter subpaths, but
/// for the factors that depend on what is connected.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Partial {
    d_vcm: Wide,
    d_vc: Wide,
}

impl Partial {
    /// From the lens into a direction of this density per solid angle: (31), (32). No subpath is shorter.
    ///
    /// Without splats no light is connected to the lens, and that strategy has no share.
    #[inline]
    pub fn from_camera(density: Wide, splats: bool) -> Partial {
        let d_vcm = if splats { mis(density.recip()) } else { Wide::ZERO };
        Partial {
            d_vcm,
            d_vc: Wide::ZERO,
        }
    }

    /// From a light, as it arrives on the first surface: (31), (32).
    ///
    /// `sample` is the density per solid angle with which a light sample there leads back to the place on the light, and
    /// `emission` that of the ray which led here, by place and direction over the cosine at the light. A light that no
    /// ray meets has no shorter subpath. Cosine and distance at the light are in both densities, or in none.
    #[inline]
    pub fn from_light(sample: Wide, emission: Wide, is_delta: bool) -> Partial {
        let per_emission = emission.recip();
        Partial {
            d_vcm: mis(sample * per_emission),
            d_vc: if is_delta { Wide::ZERO } else { mis(per_emission) },
        }
    }

    /// On a surface, the squared distance and the cosine there turning solid angle into area: (31) to (36).
    #[inline]
    pub fn arrive(self, square: Wide, cos: Wide) -> Partial {
        let per_cos = mis(cos.recip());
        Partial {
            d_vcm: self.d_vcm * mis(square) * per_cos,
            d_vc: self.d_vc * per_cos,
        }
    }

    /// Onwards by a direction at this cosine, drawn with density `pdf`, whose `reverse` is that of the way here when one
    /// comes from there: (34), (35).
    #[inline]
    pub fn scatter(self, cos: Wide, pdf: Wide, reverse: Wide) -> Partial {
        let per_pdf = pdf.recip();
        Partial {
            d_vcm: mis(per_pdf),
            d_vc: mis(cos * per_pdf) * (self.d_vcm + mis(reverse) * self.d_vc),
        }
    }

    /// The same by a direction of no choice, as probable both ways: (53), (54). Nothing can be connected to this vertex.
    #[inline]
    pub fn scatter_delta(self, cos: Wide) -> Partial {
        Partial {
            d_vcm: Wide::ZERO,
            d_vc: mis(cos) * self.d_vc,
        }
    }

    /// The share of strategies that have this subpath shorter, at a vertex that is connected to another: (40), (41), (45),
    /// (46).
    ///
    /// `density` is that of this vertex, by area, if it came from the other subpath; `reverse` that, per solid angle, of
    /// the vertex before.
    #[inline]
    pub fn shorter(self, density: Wide, reverse: Wide) -> Wide {
        mis(density) * (self.d_vcm + mis(reverse) * self.d_vc)
    }

    /// The same where a camera subpath has met a light: (43), or an environment. On its way there, not arrived.
    ///
    /// `sample` is the density per solid angle with which a light sample would have led there, `emission` that of a ray
    /// of light from there, as in [`Self::from_light`].
    #[inline]
    pub fn shorter_at_light(self, sample: Wide, emission: Wide) -> Wide {
        mis(sample) * self.d_vcm + mis(emission) * self.d_vc
    }
}

/// The weight of a strategy among those with shorter light subpaths and those with shorter camera subpaths: (37).
#[inline]
pub fn weight(light: Wide, camera: Wide) -> Wide {
    (Wide::ONE + light + camera).recip()
}
