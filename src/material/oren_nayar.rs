use super::{BsdfSample, Local, MaterialError, facing};
use crate::color::{Albedo, Radiance};
use crate::geom::{Dir, Frame};
use crate::num::{ONE_Q16, Share, Turn, Uniform, Wide, acos, isqrt, mul_hi, mul_shift, recip};
use crate::sampler::warp;

/// Which of the formulas for rough diffuse surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrenNayarModel {
    /// The sum of both terms of the 1994 paper: facets lit directly, and once by one another (equations 27 to 30).
    ///
    /// A fit, not a law: at grazing angles and with a reflectance near 1 it gives back up to 4.4 % more than it gets
    /// (`tests/bsdf_laws`), and where it would be negative (both directions grazing, on opposite sides) it is 0.
    Full,
    /// Its section 4.4: no interreflection, and the first two terms of the other. Up to 1.5 % more than it gets, at
    /// grazing angles and with a reflectance near 1 (`tests/bsdf_laws`).
    Qualitative,
    /// Portsmouth, Kutz and Hill, "EON: A Practical Energy-Preserving Rough Diffuse BRDF", JCGT 14(1), 2025, listing 1
    /// with the exact albedo: what single scattering loses comes back diffusely, so that white stays white.
    ///
    /// Its roughness r, 0 to 1, is σ as a share of 90°, as the authors compare it with the older model.
    EnergyPreserving,
}

/// Rough diffuse reflection: M. Oren and S. Nayar, "Generalization of Lambert's Reflectance Model", SIGGRAPH 1994.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrenNayar {
    reflectance: Albedo,
    /// Colour of what is reflected more than once: ρ², or EON's ρ_ms.
    again: Albedo,
    /// What is missing to 1 of C1 (or A_F), then the factors of C2, C3 and of the interreflection (or A_F r, that of the
    /// second term, and none): Q16.
    factors: [u16; 4],
    /// σ as a share of a quarter turn.
    sigma: Share,
    model: OrenNayarModel,
    two_sided: bool,
}

/// s/(s + c), Q16, of numbers in Q28.
fn saturation(s: u32, c: u32) -> u32 {
    ((recip(s + c).times(s as i32, 17) + 1) >> 1) as u32
}

/// A share of at most 1 in Q16 times a constant in Q16 below 1.
fn part(share: u32, of: u32) -> u16 {
    ((share * of + (1 << 15)) >> 16) as u16
}

/// a·b of Q16 numbers, rounded to nearest.
fn product(a: i32, b: i32) -> i32 {
    (mul_shift(a, b, 15) + 1) >> 1
}

/// a/b of Q16 numbers, rounded to nearest; b ≥ 1, answers under 2^14.
fn quotient(a: i32, b: i32) -> i32 {
    (recip(b as u32).times(a, 17) + 1) >> 1
}

/// √(1 − x²), Q16.
fn other_leg(x: i32) -> i32 {
    let bits = (x.clamp(0, ONE_Q16 - 1) as u32) << 16;
    isqrt(!mul_hi(bits, bits)) as i32
}

impl OrenNayar {
    /// Two-sided, from the standard deviation `sigma` of the facets' slope angle, 0 to a quarter turn.
    pub fn new(model: OrenNayarModel, reflectance: Albedo, sigma: Turn) -> OrenNayar {
        let sigma = ((sigma.to_bits() >> 14) + 1) >> 1;
        let r = sigma.min(1 << 15);
        let square = reflectance.0.map(|c| {
            let c = c.to_bits().min(1 << 15) as u32;
            ((c * c + (1 << 14)) >> 15) as u16
        });
        let (factors, again) = match model {
            OrenNayarModel::Full | OrenNayarModel::Qualitative => {
                // s = σ² in radians: r² Q30 · (π/2)² Q30 → Q28; then constants of Q28: 0.33, 0.09, 0.13
                let s = mul_hi(r * r, 2_649_351_758);
                let (first, second) = (saturation(s, 88_583_700), saturation(s, 24_159_191));
                let factors = [
                    part(first, 1 << 15),
                    part(second, 29_491),
                    part(second, 1 << 13),
                    part(saturation(s, 34_896_609), 11_141),
                ];
                (factors, square)
            }
            OrenNayarModel::EnergyPreserving => {
                let r = (r << 1) as i32;
                let a = quotient(ONE_Q16, ONE_Q16 + product(C1, r));
                let a_r = product(a, r);
                let mean = product(a, ONE_Q16 + product(C2, r));
                // ρ_ms = ρ² E/(1 − ρ (1 − E))
                let again = [0, 1, 2].map(|i| {
                    let rho = (reflectance.0[i].to_bits().min(1 << 15) as i32) << 1;
                    let all = ONE_Q16 - product(rho, ONE_Q16 - mean);
                    let share = quotient(product((square[i] as i32) << 1, mean), all.max(1));
                    (((share + 1) >> 1).clamp(0, 1 << 15)) as u16
                });
                let factors = [ONE_Q16 - a, a_r, product(a_r, SECOND), 0];
                (factors.map(|f| f.clamp(0, 0xffff) as u16), again)
            }
        };
        OrenNayar {
            reflectance,
            again: Albedo(again.map(Share::from_bits)),
            factors,
            sigma: Share::from_bits(sigma.min(0xffff) as u16),
            model,
            two_sided: true,
        }
    }

    /// The same, black from behind.
    pub fn one_sided(self) -> OrenNayar {
        OrenNayar {
            two_sided: false,
            ..self
        }
    }

    pub(super) fn tinted(self, tint: Albedo) -> OrenNayar {
        // Its light reflected twice has another colour, too.
        let sigma = Turn::from_bits(u32::from(self.sigma.to_bits()) << 15);
        OrenNayar {
            two_sided: self.two_sided,
            ..OrenNayar::new(self.model, self.reflectance.times(tint), sigma)
        }
    }

    pub fn model(&self) -> OrenNayarModel {
        self.model
    }

    pub fn reflectance(&self) -> Albedo {
        self.reflectance
    }

    /// The standard deviation of the slope angle, as a share of a quarter turn.
    pub fn sigma(&self) -> Share {
        self.sigma
    }

    pub fn is_two_sided(&self) -> bool {
        self.two_sided
    }

    pub(super) fn check(&self) -> Result<(), MaterialError> {
        if !self.reflectance.is_valid() {
            Err(MaterialError::Reflectance)
        } else if self.sigma > Share::ONE {
            Err(MaterialError::Sigma)
        } else {
            Ok(())
        }
    }

    /// f·cos θi, with the density of a cosine distribution.
    pub(super) fn eval(&self, local: &Local, wi: Dir) -> Option<(Radiance, Wide)> {
        let normal = facing(self.two_sided, local)?;
        let cos_i = wi.dot(normal);
        if cos_i <= 0 {
            return None;
        }
        let pdf = warp::pdf_cosine_hemisphere(cos_i);
        let cos_o = local.wo.dot(normal);
        Some((self.times_pi(cos_i, cos_o, wi.dot(local.wo)).scale(pdf), pdf))
    }

    /// Cosine-distributed about the normal: the weight is π f.
    pub(super) fn sample(&self, local: &Local, u: [Uniform; 2]) -> Option<BsdfSample> {
        let normal = facing(self.two_sided, local)?;
        let drawn = warp::sample_cosine_hemisphere(u);
        let wi = Frame::about(normal).to_world(drawn);
        let (cos_i, cos_o) = (drawn.0[2], local.wo.dot(normal));
        Some(BsdfSample {
            wi,
            weight: self.times_pi(cos_i, cos_o, wi.dot(local.wo)),
            pdf: warp::pdf_cosine_hemisphere(cos_i),
            eta_squared: Wide::ONE,
        })
    }

    /// π f from three cosines: to the normal, and between the directions.
    ///
    /// With tan β = sin β / cos β and cos β the larger cosine t, what the paper writes as cos Δφ sin α tan β is
    /// (ωi·ωo − cos θi cos θo)/t, without any angle (Fujii, "A tiny improvement of Oren–Nayar reflectance model", 2012).
    fn times_pi(&self, cos_i: i32, cos_o: i32, cos_between: i32) -> Radiance {
        let cos_o = cos_o.max(1);
        // The tangent is bounded at 2^13, so that quotients stay within their domain.
        let (l, t) = (cos_i.min(cos_o), cos_i.max(cos_o).max(8));
        let s = cos_between - product(cos_i, cos_o);
        let [missing, f2, f3, f4] = self.factors.map(i32::from);
        let first = ONE_Q16 - missing;
        match self.model {
            OrenNayarModel::Qualitative => self.tint(first + quotient(product(f2, s.max(0)), t), 0),
            OrenNayarModel::EnergyPreserving => {
                let s = if s > 0 { quotient(s, t) } else { s };
                let again = product(lost(cos_i), lost(cos_o));
                self.tint(first + product(f2, s), product(f3, again))
            }
            OrenNayarModel::Full => {
                let (sin_a, sin_b) = (other_leg(l), other_leg(t));
                let sines = product(sin_a, sin_b);
                let cos_phi = if s.abs() >= sines {
                    s.signum() * ONE_Q16
                } else {
                    quotient(s, sines)
                };
                // As shares of a right angle: 2α/π, 2β/π.
                let (a, b) = (acos(l), acos(t));
                let b2 = product(b, b);
                // C2 cos Δφ tan β, over cos β; from behind C2 is less by (2β/π)³.
                let behind = product(product(cos_phi.min(0), sin_b), product(b2, b));
                let second = quotient(product(f2, s - behind), t);
                // C3 (1 − |cos Δφ|) tan((α + β)/2); that tangent is (sin α + sin β)/(cos α + cos β).
                let ab = product(a, b);
                let third = product(product(f3, product(ab, ab)), ONE_Q16 - cos_phi.abs());
                let third = quotient(product(third, sin_a + sin_b), l + t);
                let again = product(f4, ONE_Q16 - product(cos_phi, b2));
                self.tint(first.saturating_add(second).saturating_add(third), again)
            }
        }
    }

    /// ρ·`once` + `again`·its colour, from Q16; 0 where that is negative.
    fn tint(&self, once: i32, again: i32) -> Radiance {
        // Q24, or Q16 where it would not fit.
        let shift = if once.unsigned_abs() < 1 << 22 { 7 } else { 15 };
        let channel = |i: usize| {
            let once = mul_shift(once, self.reflectance.0[i].to_bits() as i32, shift);
            let again = mul_shift(again, self.again.0[i].to_bits() as i32, shift);
            once.saturating_add(again).max(0) as u32
        };
        Radiance::from_bits([channel(0), channel(1), channel(2)], shift as i32 - 31)
    }
}

/// EON's constants, Q16: ½ − 2/(3π), ⅔ − 28/(15π), and C1²/(C1 − C2).
const C1: i32 = 18_861;
const C2: i32 = 4_751;
const SECOND: i32 = 25_211;

/// 1 − G/(π C1): what single scattering loses at this cosine, as a share of the most; Q16 (listing 1, `E_FON_exact`).
///
/// G = S (θ − S μ) + ⅔ (S/μ (1 − S³) − S) with S = sin θ; (1 − S³)/μ is μ (1 + S + S²)/(1 + S), which needs no care at 0.
fn lost(mu: i32) -> i32 {
    let s = other_leg(mu);
    let angle = product(acos(mu), 102_944);
    let first = product(s, angle - product(s, mu));
    let inner = quotient(ONE_Q16 + s + product(s, s), ONE_Q16 + s);
    let second = product(s, product(mu, inner) - ONE_Q16);
    // 1/(π C1), and ⅔ of it
    let g = product(first, 72_485) + product(second, 48_323);
    (ONE_Q16 - g).clamp(0, ONE_Q16)
}
