use super::microfacet::{Ggx, Half, sum};
use super::{BsdfSample, Local, MaterialError, facing};
use crate::color::{Albedo, Radiance};
use crate::geom::{Dir, Frame};
use crate::num::{ONE_Q16, Share, Uniform, Wide};

/// A real or imaginary part of a refractive index, 0 ..= 16 in steps of 2^-12.
pub type Index = fixed::types::U4F12;

/// A metal, smooth or rough (GGX): coloured by its complex refractive index, or a perfect mirror.
///
/// As Mitsuba 3's `conductor` and `roughconductor` with visible normals: f cos θi = F D G1(ωi) G1(ωo)/(4 cos θo) (Walter
/// et al. 2007, equation 20, with Smith's masking for each direction by itself).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    reflectance: Albedo,
    /// η and k of each channel.
    index: Option<[[Index; 3]; 2]>,
    alpha: Share,
    two_sided: bool,
}

/// The least roughness: 2^-10. Under it the lobe is as narrow as a few steps of a direction.
pub(super) const MIN_ALPHA: Share = Share::from_bits(1 << 5);

impl Conductor {
    /// Smooth, two-sided, reflecting all of each colour's share.
    pub const fn new(reflectance: Albedo) -> Conductor {
        Conductor {
            reflectance,
            index: None,
            alpha: Share::ZERO,
            two_sided: true,
        }
    }

    /// The same with the reflectance of a metal with refractive index η + i k, relative to the medium outside.
    pub const fn with_index(self, eta: [Index; 3], k: [Index; 3]) -> Conductor {
        Conductor {
            index: Some([eta, k]),
            ..self
        }
    }

    /// The same with a rough surface, 2^-10 ..= 1; 0 for a smooth one.
    pub const fn rough(self, alpha: Share) -> Conductor {
        Conductor { alpha, ..self }
    }

    pub(super) fn tinted(self, tint: Albedo) -> Conductor {
        Conductor {
            reflectance: self.reflectance.times(tint),
            ..self
        }
    }

    /// The same, black from behind.
    pub const fn one_sided(self) -> Conductor {
        Conductor {
            two_sided: false,
            ..self
        }
    }

    /// The colour by which all that is reflected is multiplied.
    pub fn reflectance(&self) -> Albedo {
        self.reflectance
    }

    /// η and k of each channel, if it has them.
    pub fn index(&self) -> Option<[[Index; 3]; 2]> {
        self.index
    }

    pub fn alpha(&self) -> Share {
        self.alpha
    }

    pub const fn is_rough(&self) -> bool {
        self.alpha.to_bits() != 0
    }

    pub fn is_two_sided(&self) -> bool {
        self.two_sided
    }

    /// What is reflected straight back.
    pub fn albedo(&self) -> Albedo {
        let Some([eta, k]) = self.index else {
            return self.reflectance;
        };
        let channel = |i: usize| {
            let share =
                fresnel_conductor(ONE_Q16, eta[i], k[i]) as u32 * self.reflectance.0[i].to_bits() as u32;
            Share::from_bits((share >> 16) as u16)
        };
        Albedo([channel(0), channel(1), channel(2)])
    }

    pub(super) fn check(&self) -> Result<(), MaterialError> {
        if !self.reflectance.is_valid() {
            Err(MaterialError::Reflectance)
        } else {
            check_alpha(self.alpha, true)
        }
    }

    /// Reflectance of facets that are seen at this cosine, Q16.
    fn fresnel(&self, cos: i32) -> Radiance {
        let all = match self.index {
            None => Radiance::WHITE,
            Some([eta, k]) => {
                let channel = |i: usize| fresnel_conductor(cos, eta[i], k[i]) as u32;
                Radiance::from_bits([channel(0), channel(1), channel(2)], -16)
            }
        };
        all.mul_albedo(self.reflectance)
    }

    /// f·cos θi and the density of visible normals, mirrored; `None` for a smooth metal.
    pub(super) fn eval(&self, local: &Local, wi: Dir) -> Option<(Radiance, Wide)> {
        if !self.is_rough() {
            return None;
        }
        let normal = facing(self.two_sided, local)?;
        let (cos_i, cos_o) = (wi.dot(normal), local.wo.dot(normal));
        if cos_i <= 0 {
            return None;
        }
        let half = Half::new(sum(wi, local.wo), normal)?;
        let ggx = Ggx::new(self.alpha);
        // D G1(ωo)/(4 cos θo)
        let pdf = ggx.density(half.along, half.across) / ggx.slope(cos_o).shl(1);
        // wo·H is half of |wi + wo|.
        let cos_half = half.square().sqrt().to_fixed(15) as i32;
        Some((self.fresnel(cos_half).scale(pdf * ggx.seen(cos_i)), pdf))
    }

    pub(super) fn sample(&self, local: &Local, u: [Uniform; 2]) -> Option<BsdfSample> {
        let normal = facing(self.two_sided, local)?;
        if !self.is_rough() {
            return Some(BsdfSample {
                wi: local.wo.reflect(normal),
                weight: self.fresnel(local.wo.dot(normal)),
                pdf: Wide::ZERO,
                eta_squared: Wide::ONE,
            });
        }
        let frame = Frame::about(normal);
        let ggx = Ggx::new(self.alpha);
        let seen = ggx.sample_seen(frame.to_local(local.wo), u)?;
        let facet = frame.to_world(seen);
        let wi = local.wo.reflect(facet);
        let (cos_i, cos_half) = (wi.dot(normal), local.wo.dot(facet));
        if cos_i <= 0 || cos_half <= 0 {
            return None;
        }
        let [along, across] = squares(seen);
        Some(BsdfSample {
            wi,
            weight: self.fresnel(cos_half).scale(ggx.seen(cos_i)),
            pdf: ggx.density(along, across) / ggx.slope(local.wo.dot(normal)).shl(1),
            eta_squared: Wide::ONE,
        })
    }
}

/// Squares of a local direction's parts along the surface and along the normal.
pub(super) fn squares(local: Dir) -> [Wide; 2] {
    let square = |i: usize| {
        let part = Wide::from_q16(local.0[i].abs());
        part * part
    };
    [square(0) + square(1), square(2)]
}

/// A roughness of at most 1, and no less than can be held; 0 where smooth is meant by it.
pub(super) fn check_alpha(alpha: Share, may_be_smooth: bool) -> Result<(), MaterialError> {
    if (alpha == Share::ZERO && may_be_smooth) || (MIN_ALPHA <= alpha && alpha <= Share::ONE) {
        Ok(())
    } else {
        Err(MaterialError::Roughness)
    }
}

/// Fresnel reflectance of a metal for unpolarised light, Q16; `cos` in 0 ..= 1, Q16.
///
/// With a + i b = √((η + i k)² − sin² θ), r⊥² = ((a − cos)² + b²)/((a + cos)² + b²) and its like for the other
/// polarisation (Born and Wolf, section 14.2; PBR Book, 3rd edition, section 8.2.1). Error for η from 0.05 to 4 and k up
/// to 10: 7.1e-5 at most, RMS 1.3e-5, mean 4e-6 (`tests/bsdf_laws`).
pub fn fresnel_conductor(cos: i32, eta: Index, k: Index) -> i32 {
    let wide = |x: Index| Wide::new(x.to_bits() as u32, -12);
    let (eta, k) = (wide(eta), wide(k));
    let cos = Wide::from_q16(cos.min(ONE_Q16));
    let cos2 = cos * cos;
    let sin2 = Wide::ONE.saturating_sub(cos2);
    // a² − b² = η² − k² − sin², which may be negative; a b = η k
    let (plus, minus) = (eta * eta, k * k + sin2);
    let difference = if plus.is_at_least(minus) {
        plus.saturating_sub(minus)
    } else {
        minus.saturating_sub(plus)
    };
    let ab = eta * k;
    let sum = (difference * difference + (ab * ab).shl(2)).sqrt();
    // The larger of a and b is found by a root, the other by their product: nothing cancels.
    let larger = (sum + difference).shl(-1).sqrt();
    let a = if plus.is_at_least(minus) {
        larger
    } else {
        ab / larger
    };
    let twice = (cos * a).shl(1);
    let s = sum + cos2;
    let s = s.saturating_sub(twice) / (s + twice);
    let (p, twice) = (sum * cos2 + sin2 * sin2, twice * sin2);
    let p = s * (p.saturating_sub(twice) / (p + twice));
    ((s + p).shl(-1).to_fixed(16) as i32).min(ONE_Q16)
}
