use super::{BsdfSample, Local, MaterialError};
use crate::color::{Albedo, Radiance};
use crate::geom::Dir;
use crate::num::{Metres, ONE_Q16, Uniform, Wide, isqrt, mul_hi, mul_q16, recip};

/// A smooth boundary; the normal points to the outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// Refractive index inside over outside, Q16.
    eta: i32,
    /// Its reciprocal, Q16.
    inv_eta: i32,
    reflectance: Albedo,
    transmittance: Albedo,
}

impl Dielectric {
    /// From the ratio of the refractive index inside to that outside, ¼ ..= 4 (others are brought into that range).
    pub fn new(eta: Metres) -> Dielectric {
        let eta = eta.to_bits().clamp(ONE_Q16 / 4, 4 * ONE_Q16);
        let inv_eta = recip(eta as u32).times(ONE_Q16, 16);
        Dielectric {
            eta,
            inv_eta,
            reflectance: Albedo::WHITE,
            transmittance: Albedo::WHITE,
        }
    }

    /// The same with coloured reflection and transmission.
    pub fn tinted(self, reflectance: Albedo, transmittance: Albedo) -> Dielectric {
        Dielectric {
            reflectance,
            transmittance,
            ..self
        }
    }

    /// The ratio of the refractive index inside to that outside.
    pub fn eta(&self) -> Metres {
        Metres::from_bits(self.eta)
    }

    /// The colours of reflection and transmission.
    pub fn tints(&self) -> (Albedo, Albedo) {
        (self.reflectance, self.transmittance)
    }

    /// The ratio η of the index beyond to the index on this side, and its reciprocal, Q16.
    pub(super) fn ratio(&self, is_outside: bool) -> (i32, i32) {
        if is_outside {
            (self.eta, self.inv_eta)
        } else {
            (self.inv_eta, self.eta)
        }
    }

    pub(super) fn check(&self) -> Result<(), MaterialError> {
        if self.reflectance.is_valid() && self.transmittance.is_valid() {
            Ok(())
        } else {
            Err(MaterialError::Reflectance)
        }
    }

    /// Reflection or refraction, chosen with the Fresnel reflectance as probability.
    pub(super) fn sample(&self, local: &Local, lobe: Uniform) -> Option<BsdfSample> {
        let cos = local.wo.dot(local.normal);
        // Seen from inside, the ratio is the other way round and the normal turned.
        let (eta, inv_eta) = self.ratio(cos >= 0);
        let normal = if cos >= 0 { local.normal } else { -local.normal };
        let cos_i = cos.abs().min(ONE_Q16);
        let (reflectance, cos_t) = fresnel_dielectric(cos_i, eta, inv_eta);
        if (lobe.to_bits() >> 16) < reflectance as u32 {
            return Some(BsdfSample {
                wi: local.wo.reflect(normal),
                weight: Radiance::WHITE.mul_albedo(self.reflectance),
                pdf: Wide::ZERO,
                eta_squared: Wide::ONE,
            });
        }
        // Snell: wi = −wo/η + (cos θi/η − cos θt) n
        let along = mul_q16(cos_i, inv_eta) - cos_t;
        let (wo, n) = (local.wo.0, normal.0);
        let part = |i: usize| mul_q16(along, n[i]) - mul_q16(inv_eta, wo[i]);
        let wi = Dir::new([part(0), part(1), part(2)])?;
        // Radiance is squeezed into the cone of the denser medium: 1/η² on the way in (Veach 1997, section 5.2).
        let scale = Wide::from_q16(inv_eta) * Wide::from_q16(inv_eta);
        Some(BsdfSample {
            wi,
            weight: Radiance::WHITE.mul_albedo(self.transmittance).scale(scale),
            pdf: Wide::ZERO,
            eta_squared: Wide::from_q16(eta) * Wide::from_q16(eta),
        })
    }
}

/// Fresnel reflectance for unpolarised light and the cosine of the refracted ray, both Q16; (1, 0) in total reflection.
///
/// `cos_i` in 0 ..= 1 to the normal on the incoming side; `eta` the index beyond over the index here, with its
/// reciprocal. R = ½ (r∥² + r⊥²) (Born and Wolf, section 1.5.2). Error for η from ¼ to 4: 1.9e-4 at most, RMS 2.7e-5, no
/// bias (mean within 1e-6); where the refracted ray grazes (cosine under 0.1) 4e-3 at most, since R is steep there.
pub fn fresnel_dielectric(cos_i: i32, eta: i32, inv_eta: i32) -> (i32, i32) {
    // sin² θt = sin² θi / η², as U0F32 with 1 saturated
    let cos_bits = (cos_i.min(ONE_Q16 - 1) as u32) << 16;
    let sin2_i = !mul_hi(cos_bits, cos_bits);
    let inv2 = mul_q16(inv_eta, inv_eta);
    // 1/η² ≤ 16 in Q16 has 21 bits: as Q27, so is the product.
    let sin2_t = mul_hi(sin2_i, (inv2 as u32) << 11);
    if sin2_t >= 1 << 27 {
        return (ONE_Q16, 0);
    }
    let cos_t = isqrt(!(sin2_t << 5)) as i32;
    (fresnel_of_cosines(cos_i, cos_t, eta), cos_t)
}

/// The reflectance from both cosines, Q16; `eta` the index on the side of `cos_t` over that of `cos_i`.
pub(super) fn fresnel_of_cosines(cos_i: i32, cos_t: i32, eta: i32) -> i32 {
    let ratio = |a: i32, b: i32| {
        let r = recip((a + b).max(1) as u32).times(a - b, 16);
        mul_q16(r, r)
    };
    let s = ratio(cos_i, mul_q16(eta, cos_t));
    let p = ratio(mul_q16(eta, cos_i), cos_t);
    ((s + p + 1) >> 1).min(ONE_Q16)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The formula in f64: reflectance and the cosine beyond.
    fn exact(cos_i: f64, eta: f64) -> (f64, f64) {
        let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
        if sin2_t >= 1.0 {
            return (1.0, 0.0);
        }
        let cos_t = (1.0 - sin2_t).sqrt();
        let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
        let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
        ((s * s + p * p) / 2.0, cos_t)
    }

    #[test]
    fn reflectance_is_as_the_formula_says() {
        let (mut max, mut near, mut squares, mut sum, mut count) = (0.0f64, 0.0f64, 0.0, 0.0, 0.0);
        for eta in [0.25, 0.4, 0.6667, 0.75, 0.9, 1.1, 1.33, 1.5, 1.8, 2.42, 4.0] {
            let eta = (eta * 65536.0) as i32;
            let inv_eta = Dielectric::new(Metres::from_bits(eta)).inv_eta;
            for cos_i in (0..=65536).step_by(13) {
                let (reflectance, _) = fresnel_dielectric(cos_i, eta, inv_eta);
                let (wanted, cos_t) = exact(f64::from(cos_i) / 65536.0, f64::from(eta) / 65536.0);
                let error = f64::from(reflectance) / 65536.0 - wanted;
                if cos_t > 0.1 || cos_t == 0.0 {
                    max = max.max(error.abs());
                } else {
                    near = near.max(error.abs());
                }
                squares += error * error;
                sum += error;
                count += 1.0;
            }
        }
        let (rms, mean) = (f64::sqrt(squares / count), f64::abs(sum / count));
        assert!((1.4e-4..1.9e-4).contains(&max), "{max:e}");
        assert!((2e-3..4e-3).contains(&near), "{near:e}");
        assert!((2e-5..3e-5).contains(&rms) && mean < 1e-6, "{rms:e} {mean:e}");
    }
}
