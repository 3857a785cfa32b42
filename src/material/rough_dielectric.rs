use super::conductor::{check_alpha, squares};
use super::dielectric::{Dielectric, fresnel_dielectric, fresnel_of_cosines};
use super::microfacet::{Ggx, Half, sum};
use super::{BsdfSample, Local, MaterialError};
use crate::color::{Albedo, Radiance};
use crate::geom::{Dir, Frame};
use crate::num::{Metres, ONE_Q16, Share, Uniform, Wide, mul_q16, mul_shift};

/// A rough boundary between two media; the normal points to the outside.
///
/// Walter et al. 2007, equations 20 and 21, as Mitsuba 3's `roughdielectric` with GGX and visible normals: facets are drawn
/// among those seen, and the Fresnel reflectance decides whether one reflects or refracts. Radiance is transported: what
/// comes through is divided by the squared ratio of refractive indices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughDielectric {
    smooth: Dielectric,
    alpha: Share,
}

/// How near to 1 the ratio of refractive indices may be: nearer, refraction hardly turns a direction, and its half vector
/// is lost in rounding.
const MIN_CONTRAST: i32 = ONE_Q16 / 128;

/// The boundary as seen from one side.
struct Side {
    eta: i32,
    inv_eta: i32,
    normal: Dir,
    cos: i32,
}

impl RoughDielectric {
    /// The roughness of a boundary that is otherwise as `smooth` says, 2^-10 ..= 1.
    pub const fn new(smooth: Dielectric, alpha: Share) -> RoughDielectric {
        RoughDielectric { smooth, alpha }
    }

    pub fn alpha(&self) -> Share {
        self.alpha
    }

    /// The ratio of the refractive index inside to that outside.
    pub fn eta(&self) -> Metres {
        self.smooth.eta()
    }

    /// The colours of reflection and transmission.
    pub fn tints(&self) -> (Albedo, Albedo) {
        self.smooth.tints()
    }

    pub(super) fn check(&self) -> Result<(), MaterialError> {
        self.smooth.check()?;
        if (self.eta().to_bits() - ONE_Q16).abs() < MIN_CONTRAST {
            return Err(MaterialError::Index);
        }
        check_alpha(self.alpha, false)
    }

    fn side(&self, local: &Local) -> Side {
        let cos = local.wo.dot(local.normal);
        let (eta, inv_eta) = self.smooth.ratio(cos >= 0);
        Side {
            eta,
            inv_eta,
            normal: if cos >= 0 { local.normal } else { -local.normal },
            cos: cos.abs(),
        }
    }

    /// f·|cos θi| and density, on both sides of the surface.
    pub(super) fn eval(&self, local: &Local, wi: Dir) -> Option<(Radiance, Wide)> {
        let side = self.side(local);
        let cos_i = wi.dot(side.normal);
        if side.cos == 0 || cos_i == 0 {
            return None;
        }
        let ggx = Ggx::new(self.alpha);
        let seen = ggx.seen(cos_i.abs());
        let (reflectance, transmittance) = self.tints();
        if cos_i > 0 {
            let half = Half::new(sum(wi, local.wo), side.normal)?;
            let cos_half = half.square().sqrt().to_fixed(15) as i32;
            let (share, _) = fresnel_dielectric(cos_half.min(ONE_Q16), side.eta, side.inv_eta);
            let pdf =
                ggx.density(half.along, half.across) / ggx.slope(side.cos).shl(1) * Wide::from_q16(share);
            return Some((Radiance::WHITE.mul_albedo(reflectance).scale(pdf * seen), pdf));
        }
        // The facet that refracts one into the other lies along wo + η wi [Walter (16)], turned to this side.
        let part = |i: usize| local.wo.0[i] + ((mul_shift(wi.0[i], side.eta, 15) + 1) >> 1);
        let half = Half::new([part(0), part(1), part(2)], side.normal)?;
        let turn = if half.is_above { 1 } else { -1 };
        let (on_o, on_i) = (turn * half.dot(local.wo), -turn * half.dot(wi));
        if on_o <= 0 || on_i <= 0 {
            return None;
        }
        let length = half.square().sqrt();
        let (cos_o, cos_t) = (Wide::from_q16(on_o) / length, Wide::from_q16(on_i) / length);
        let q16 = |cos: Wide| (cos.to_fixed(16) as i32).min(ONE_Q16);
        let share = fresnel_of_cosines(q16(cos_o), q16(cos_t), side.eta);
        let density = ggx.density(half.along, half.across) * Wide::from_q16(ONE_Q16 - share);
        let pdf = side.refracted(&ggx, density, cos_o, cos_t, length);
        let inv_eta = Wide::from_q16(side.inv_eta);
        let f = pdf * seen * inv_eta * inv_eta;
        Some((Radiance::WHITE.mul_albedo(transmittance).scale(f), pdf))
    }

    pub(super) fn sample(&self, local: &Local, u: [Uniform; 2], lobe: Uniform) -> Option<BsdfSample> {
        let side = self.side(local);
        if side.cos == 0 {
            return None;
        }
        let frame = Frame::about(side.normal);
        let ggx = Ggx::new(self.alpha);
        let seen = ggx.sample_seen(frame.to_local(local.wo), u)?;
        let facet = frame.to_world(seen);
        let cos_half = local.wo.dot(facet);
        if cos_half <= 0 {
            return None;
        }
        let [along, across] = squares(seen);
        let density = ggx.density(along, across);
        let (share, cos_t) = fresnel_dielectric(cos_half.min(ONE_Q16), side.eta, side.inv_eta);
        let (reflectance, transmittance) = self.tints();
        if (lobe.to_bits() >> 16) < share as u32 {
            let wi = local.wo.reflect(facet);
            let cos_i = wi.dot(side.normal);
            if cos_i <= 0 {
                return None;
            }
            return Some(BsdfSample {
                wi,
                weight: Radiance::WHITE.mul_albedo(reflectance).scale(ggx.seen(cos_i)),
                pdf: density / ggx.slope(side.cos).shl(1) * Wide::from_q16(share),
                eta_squared: Wide::ONE,
            });
        }
        // Snell: wi = −wo/η + (cos θi/η − cos θt) m
        let along = mul_q16(cos_half, side.inv_eta) - cos_t;
        let part = |i: usize| mul_q16(along, facet.0[i]) - mul_q16(side.inv_eta, local.wo.0[i]);
        let wi = Dir::new([part(0), part(1), part(2)])?;
        let cos_i = -wi.dot(side.normal);
        if cos_i <= 0 || cos_t == 0 {
            return None;
        }
        let (eta, inv_eta) = (Wide::from_q16(side.eta), Wide::from_q16(side.inv_eta));
        let (cos_half, cos_t) = (Wide::from_q16(cos_half), Wide::from_q16(cos_t));
        // |cos θi − η cos θt| without a difference of neighbours: |η² − 1|/(cos θi + η cos θt).
        let square = eta * eta;
        let contrast = if square.is_at_least(Wide::ONE) {
            square.saturating_sub(Wide::ONE)
        } else {
            Wide::ONE.saturating_sub(square)
        };
        let length = contrast / (cos_half + eta * cos_t);
        let refracted = Wide::from_q16(ONE_Q16 - share);
        Some(BsdfSample {
            wi,
            weight: Radiance::WHITE
                .mul_albedo(transmittance)
                .scale(ggx.seen(cos_i) * inv_eta * inv_eta),
            pdf: side.refracted(&ggx, density * refracted, cos_half, cos_t, length),
            eta_squared: square,
        })
    }
}

impl Side {
    /// Density of a refracted direction: that of the facet, D G1(ωo) ωo·m / cos θo, times η² |ωi·m| / |ωo + η ωi|²
    /// [Walter (17)].
    fn refracted(&self, ggx: &Ggx, density: Wide, cos_o: Wide, cos_i: Wide, length: Wide) -> Wide {
        let facet = density * cos_o.shl(1) / ggx.slope(self.cos);
        let ratio = Wide::from_q16(self.eta) / length;
        facet * cos_i * ratio * ratio
    }
}
