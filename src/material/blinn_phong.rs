use super::microfacet::{Half, sum};
use super::{BsdfSample, Local, MaterialError, facing};
use crate::color::{Albedo, Radiance};
use crate::geom::{Dir, Frame};
use crate::num::{
    Metres, ONE_Q16, Share, Turn, Uniform, Wide, exp2_neg, isqrt, mul_hi, mul_q16, neg_log2, pow, recip,
    sin_cos,
};
use crate::sampler::warp;

/// A diffuse part and a lobe about the half vector: J. Blinn, "Models of Light Reflection for Computer Synthesized
/// Pictures", SIGGRAPH 1977.
///
/// With kd, ks the two reflectances, n the exponent, and H half way between the two directions. Normalised:
/// f = kd/π + ks (n + 8)/(8π) (N·H)^n, which gives back at most kd + 1.08 ks (straight on and n about 12; the factor tends
/// to 1 for large n). As the papers wrote it: f cos θi = kd/π cos θi + ks/π (N·H)^n, which is neither reciprocal nor
/// bounded by 1 for small n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlinnPhong {
    diffuse: Albedo,
    specular: Albedo,
    /// Q16.
    exponent: u32,
    /// Share of the samples that are drawn from the lobe, U0F16 with 1 saturated.
    lobe: u16,
    normalized: bool,
    two_sided: bool,
}

/// The largest exponent: beyond it the lobe is as narrow as a few steps of a direction.
const MAX_EXPONENT: u32 = 1 << 14;

/// 1/(8π).
const INV_8PI: Wide = Wide::INV_PI.shl(-3);

impl BlinnPhong {
    /// Two-sided and normalised; `exponent` 0 ..= 16384.
    pub fn new(diffuse: Albedo, specular: Albedo, exponent: Metres) -> BlinnPhong {
        BlinnPhong {
            diffuse,
            specular,
            exponent: exponent.to_bits() as u32,
            lobe: 0,
            normalized: true,
            two_sided: true,
        }
        .shared()
    }

    /// The same without the factor that keeps the lobe's energy.
    pub fn unnormalized(self) -> BlinnPhong {
        BlinnPhong {
            normalized: false,
            ..self
        }
        .shared()
    }

    /// The same, black from behind.
    pub fn one_sided(self) -> BlinnPhong {
        BlinnPhong {
            two_sided: false,
            ..self
        }
    }

    /// Divides the samples between the parts as they divide the light.
    fn shared(self) -> BlinnPhong {
        let sum = |a: Albedo| a.0.iter().map(|c| c.to_bits() as u32).sum::<u32>();
        // The paper's lobe reflects 8/(n + 8) of what the normalised one does.
        let (diffuse, lobe) = (Wide::new(sum(self.diffuse), 0), Wide::new(sum(self.specular), 0));
        let lobe = if self.normalized {
            lobe
        } else {
            lobe.shl(3) / self.plus(8)
        };
        let share = (lobe / (lobe + diffuse)).to_fixed(16).min(0xffff) as u16;
        // Neither part goes without samples, nor has an absent one any.
        let share = match (lobe.is_zero(), diffuse.is_zero()) {
            (true, _) => 0,
            (_, true) => 0xffff,
            _ => share.clamp(0x800, 0xf800),
        };
        BlinnPhong { lobe: share, ..self }
    }

    /// The diffuse part's colour times another; samples are shared out as they were.
    pub(super) fn tinted(self, tint: Albedo) -> BlinnPhong {
        let diffuse = self.diffuse.times(tint);
        BlinnPhong { diffuse, ..self }
    }

    pub fn diffuse(&self) -> Albedo {
        self.diffuse
    }

    pub fn specular(&self) -> Albedo {
        self.specular
    }

    pub fn exponent(&self) -> Metres {
        Metres::from_bits(self.exponent as i32)
    }

    pub fn is_normalized(&self) -> bool {
        self.normalized
    }

    pub fn is_two_sided(&self) -> bool {
        self.two_sided
    }

    /// Both parts together, at most 1.
    pub fn albedo(&self) -> Albedo {
        let sum = |i: usize| {
            self.diffuse.0[i]
                .saturating_add(self.specular.0[i])
                .min(Share::ONE)
        };
        Albedo([sum(0), sum(1), sum(2)])
    }

    pub(super) fn check(&self) -> Result<(), MaterialError> {
        if !self.diffuse.is_valid() || !self.specular.is_valid() {
            Err(MaterialError::Reflectance)
        } else if self.exponent > MAX_EXPONENT << 16 {
            Err(MaterialError::Exponent)
        } else {
            Ok(())
        }
    }

    /// n + `more`.
    fn plus(&self, more: u32) -> Wide {
        Wide::new(self.exponent.saturating_add(more << 16), -16)
    }

    /// Probability of the lobe, the rest is the diffuse part's.
    fn shares(&self) -> (Wide, Wide) {
        match self.lobe {
            0 => (Wide::ZERO, Wide::ONE),
            0xffff => (Wide::ONE, Wide::ZERO),
            share => (
                Wide::new(share as u32, -16),
                Wide::new((1 << 16) - share as u32, -16),
            ),
        }
    }

    /// f·cos θi, and the density of a cosine distribution and of half vectors with density (n + 1)/(2π) (N·H)^n, mixed.
    pub(super) fn eval(&self, local: &Local, wi: Dir) -> Option<(Radiance, Wide)> {
        let normal = facing(self.two_sided, local)?;
        let cos = wi.dot(normal);
        if cos <= 0 {
            return None;
        }
        let half = Half::new(sum(wi, local.wo), normal)?;
        let square = half.square();
        // (N·H)², whose nearer end decides which way round it is found.
        let cos2 = if half.across.is_at_least(half.along) {
            !(half.along / square).to_fixed(32)
        } else {
            (half.across / square).to_fixed(32)
        };
        let power = pow(cos2, self.exponent >> 1);
        let (lobe, rest) = self.shares();
        let cosine = warp::pdf_cosine_hemisphere(cos);
        // wi is the mirror image of wo: the density of half vectors over 4 wo·H, and wo·H is half of |wi + wo|.
        let pdf = lobe * self.plus(1) * power * INV_8PI.shl(1) / square.sqrt() + rest * cosine;
        let specular = if self.normalized {
            self.plus(8) * INV_8PI * power * Wide::from_q16(cos)
        } else {
            Wide::INV_PI * power
        };
        let f = Radiance::WHITE.mul_albedo(self.diffuse).scale(cosine);
        Some((
            f.add(Radiance::WHITE.mul_albedo(self.specular).scale(specular)),
            pdf,
        ))
    }

    pub(super) fn sample(&self, local: &Local, u: [Uniform; 2], lobe: Uniform) -> Option<BsdfSample> {
        let normal = facing(self.two_sided, local)?;
        let frame = Frame::about(normal);
        let wi = if self.lobe == 0xffff || (lobe.to_bits() >> 16) < self.lobe as u32 {
            let half = frame.to_world(self.sample_half(u));
            if local.wo.dot(half) <= 0 {
                return None;
            }
            local.wo.reflect(half)
        } else {
            frame.to_world(warp::sample_cosine_hemisphere(u))
        };
        let (f, pdf) = self.eval(local, wi)?;
        if pdf.is_zero() {
            return None;
        }
        Some(BsdfSample {
            wi,
            weight: f.scale(pdf.recip()),
            pdf,
            eta_squared: Wide::ONE,
        })
    }

    /// A direction about +z with density (n + 1)/(2π) cos^n θ: cos θ = u^(1/(n + 1)).
    fn sample_half(&self, u: [Uniform; 2]) -> Dir {
        // −log2 cos² θ = −2 log2 u/(n + 1), Q26.
        let r = recip(self.exponent.saturating_add(ONE_Q16 as u32));
        let log = mul_hi(neg_log2(u[0].to_bits()), r.mantissa);
        let log = if r.shift >= 49 {
            log >> (r.shift - 49)
        } else {
            log.saturating_mul(2)
        };
        let (mantissa, exponent) = exp2_neg(log);
        let square = mantissa >> exponent.min(31);
        let (cos, sin) = (isqrt(square) as i32, isqrt(!square) as i32);
        let (sin_phi, cos_phi) = sin_cos(Turn::from_bits(u[1].to_bits()));
        Dir([mul_q16(sin, cos_phi), mul_q16(sin, sin_phi), cos])
    }
}
