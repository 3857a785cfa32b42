//! The metallic-roughness model of glTF 2.0 (appendix B) by the nearest material there is.
//!
//! That model layers a dielectric coat over a diffuse base and blends the whole with a metal. No material here has layers:
//! metals are GGX conductors, what transmits is a dielectric, and the rest is Lambert's, with a Blinn–Phong lobe where it
//! is glossy.

use crate::desc::{BsdfDesc, Vec3};

/// From this metallicness on a surface is a metal alone.
const METAL: f64 = 0.9;
/// Below this roughness the coat of what is no metal is seen as gloss.
const GLOSSY: f64 = 0.7;
/// Below this width of the lobe a surface is smooth.
const SMOOTH: f64 = 1.0 / 1024.0;
/// The core's narrowest Blinn–Phong lobe.
pub(super) const MAX_EXPONENT: f64 = 16384.0;
/// Brightest metal whose n and k are sought.
const BRIGHTEST: f64 = 0.9995;
/// The core's n and k end here.
const MAX_INDEX: f64 = 15.9;

/// The factors, linear, each 0 to 1 but for `ior`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pbr {
    pub base: Vec3,
    pub metallic: f64,
    pub roughness: f64,
    pub transmission: f64,
    pub ior: f64,
}

/// A material, what it is in words, and what of the factors it leaves out.
#[derive(Clone, Debug)]
pub(super) struct Mapped {
    pub bsdf: BsdfDesc,
    pub words: String,
    pub losses: Vec<String>,
}

impl Mapped {
    /// With one loss more, if there is one.
    pub fn losing(mut self, lost: bool, what: &str) -> Mapped {
        self.losses.extend(lost.then(|| what.to_string()));
        self
    }
}

impl Pbr {
    pub fn map(&self) -> Mapped {
        if self.metallic >= METAL {
            return self.metal();
        }
        if self.transmission >= 0.5 {
            return self.glass();
        }
        let mut mapped = self.opaque();
        if self.transmission > 0.0 {
            let share = self.transmission;
            mapped
                .losses
                .push(format!("transmission {share:.2} is left out: opaque below 0.5"));
        }
        mapped
    }

    /// Width of the GGX lobe: the square of the roughness (glTF 2.0, B.3.2).
    fn alpha(&self) -> f64 {
        self.roughness * self.roughness
    }

    fn metal(&self) -> Mapped {
        let eta_k = self.base.map(index_of_metal);
        let eta_k = Some((eta_k.map(|(n, _)| n), eta_k.map(|(_, k)| k)));
        let alpha = self.alpha();
        let specular_reflectance = [1.0; 3];
        let (bsdf, words) = if alpha < SMOOTH {
            (
                BsdfDesc::Conductor {
                    specular_reflectance,
                    eta_k,
                },
                "smooth metal".to_string(),
            )
        } else {
            (
                BsdfDesc::RoughConductor {
                    alpha,
                    specular_reflectance,
                    eta_k,
                },
                format!("GGX metal, alpha {alpha:.3}"),
            )
        };
        Mapped {
            bsdf,
            words,
            losses: Vec::new(),
        }
    }

    fn glass(&self) -> Mapped {
        let alpha = self.alpha();
        // 0 stands for an infinite index, a perfect mirror (KHR_materials_ior); 4 is what the core has at most.
        let int_ior = if self.ior < 1.0 { 4.0 } else { self.ior.min(4.0) };
        let mut losses = Vec::new();
        if int_ior != self.ior {
            losses.push(format!(
                "its index of refraction {} is taken as {int_ior}",
                self.ior
            ));
        }
        if self.transmission < 1.0 {
            losses.push(format!("transmission {:.2} is taken as 1", self.transmission));
        }
        let (specular_reflectance, specular_transmittance) = ([1.0; 3], self.base);
        // Facets between equal indices bend nothing.
        let (bsdf, words) = if alpha < SMOOTH || int_ior < 1.01 {
            (
                BsdfDesc::Dielectric {
                    int_ior,
                    ext_ior: 1.0,
                    specular_reflectance,
                    specular_transmittance,
                },
                format!("glass of index {int_ior:.2}"),
            )
        } else {
            (
                BsdfDesc::RoughDielectric {
                    alpha,
                    int_ior,
                    ext_ior: 1.0,
                    specular_reflectance,
                    specular_transmittance,
                },
                format!("rough glass of index {int_ior:.2}, alpha {alpha:.3}"),
            )
        };
        Mapped { bsdf, words, losses }
    }

    fn opaque(&self) -> Mapped {
        let ratio = (self.ior - 1.0) / (self.ior + 1.0);
        let coat = ratio * ratio;
        if self.roughness >= GLOSSY && self.metallic <= 0.1 {
            return Mapped {
                bsdf: BsdfDesc::Diffuse {
                    reflectance: self.base,
                },
                words: "Lambert".to_string(),
                losses: Vec::new(),
            };
        }
        // At normal incidence GGX's peak is F/(4π α²); the normalised lobe's is ks (n + 8)/(8π) with n = 2/α² − 2
        // (Walter et al. 2007, section 5.2), so that ks is F where the lobe is narrow.
        let alpha = self.alpha().max(SMOOTH);
        let exponent = (2.0 / (alpha * alpha) - 2.0).clamp(0.0, MAX_EXPONENT);
        let dielectric = 1.0 - self.metallic;
        let losses = match self.metallic > 0.1 {
            true => vec![format!(
                "metallic {:.2} is taken as a coloured gloss",
                self.metallic
            )],
            false => Vec::new(),
        };
        Mapped {
            bsdf: BsdfDesc::BlinnPhong {
                diffuse_reflectance: self.base.map(|c| c * dielectric * (1.0 - coat)),
                specular_reflectance: self.base.map(|c| coat * dielectric + c * self.metallic),
                exponent,
                normalized: true,
            },
            words: format!("Blinn-Phong, exponent {exponent:.0}"),
            losses,
        }
    }
}

/// Index of refraction n + i k of a metal whose reflectance is nearest to Schlick's, f + (1 − f)(1 − cos)⁵.
///
/// Among the metals that reflect f straight on, as Gulbrandsen has them ("Artist Friendly Metallic Fresnel", JCGT 3(4),
/// 2014, eq. 1 to 3, by the edge tint g), the one with the least squared difference, weighted by the projected solid
/// angle. The RMS difference so weighted is at most 0.0131 for f from 0.3 to 1; it grows to 0.116 towards black, where no
/// metal shines at its edge alone.
fn index_of_metal(f: f64) -> (f64, f64) {
    let f = f.clamp(0.0, BRIGHTEST);
    let tints = (0..=200).map(|i| f64::from(i) / 200.0);
    let candidates = tints.map(|g| gulbrandsen(f, g));
    let fitting = candidates.filter(|(n, k)| *n <= MAX_INDEX && *k <= MAX_INDEX);
    let error = |&(n, k): &(f64, f64)| difference(f, n, k);
    fitting
        .min_by(|a, b| error(a).total_cmp(&error(b)))
        .unwrap_or_else(|| gulbrandsen(f, 1.0))
}

fn gulbrandsen(f: f64, g: f64) -> (f64, f64) {
    let n = g * (1.0 - f) / (1.0 + f) + (1.0 - g) * (1.0 + f.sqrt()) / (1.0 - f.sqrt());
    let k2 = (f * (n + 1.0) * (n + 1.0) - (n - 1.0) * (n - 1.0)) / (1.0 - f);
    (n, k2.max(0.0).sqrt())
}

/// Mean squared difference from Schlick's reflectance over the projected hemisphere.
fn difference(f: f64, n: f64, k: f64) -> f64 {
    let steps = 32;
    let at = |i: i32| {
        let cos = ((f64::from(i) + 0.5) / f64::from(steps)).sqrt();
        let schlick = f + (1.0 - f) * (1.0 - cos).powi(5);
        (fresnel(cos, n, k) - schlick).powi(2)
    };
    (0..steps).map(at).sum::<f64>() / f64::from(steps)
}

/// Reflectance of a metal for unpolarised light (Born and Wolf, section 14.2).
fn fresnel(cos: f64, n: f64, k: f64) -> f64 {
    let sin2 = 1.0 - cos * cos;
    let difference = n * n - k * k - sin2;
    let sum = (difference * difference + 4.0 * n * n * k * k).sqrt();
    let a = (0.5 * (sum + difference)).max(0.0).sqrt();
    let across = (sum + cos * cos - 2.0 * a * cos) / (sum + cos * cos + 2.0 * a * cos);
    let (square, twice) = (cos * cos * sum + sin2 * sin2, 2.0 * a * cos * sin2);
    0.5 * (across + across * (square - twice) / (square + twice))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metals_reflect_their_colour_straight_on_and_rise_as_schlicks() {
        let (mut worst, mut darkest) = (0.0_f64, 0.0_f64);
        for i in 0..=100 {
            let f = f64::from(i) / 100.0;
            let (n, k) = index_of_metal(f);
            assert!(
                (fresnel(1.0, n, k) - f).abs() < 1e-3,
                "{f} became {}",
                fresnel(1.0, n, k)
            );
            assert!(
                (0.0..16.0).contains(&n) && (0.0..16.0).contains(&k),
                "{n} + i {k}"
            );
            let rms = difference(f.min(BRIGHTEST), n, k).sqrt();
            if f >= 0.3 {
                worst = worst.max(rms);
            }
            darkest = darkest.max(rms);
        }
        assert!((0.012..0.0131).contains(&worst), "{worst}");
        assert!((0.11..0.116).contains(&darkest), "{darkest}");
    }

    const PLAIN: Pbr = Pbr {
        base: [0.8, 0.4, 0.2],
        metallic: 0.0,
        roughness: 1.0,
        transmission: 0.0,
        ior: 1.5,
    };

    #[test]
    fn each_corner_of_the_model_has_its_material() {
        assert!(matches!(PLAIN.map().bsdf, BsdfDesc::Diffuse { reflectance } if reflectance == PLAIN.base));
        let metal = Pbr {
            metallic: 1.0,
            roughness: 0.5,
            ..PLAIN
        }
        .map();
        assert!(matches!(metal.bsdf, BsdfDesc::RoughConductor { alpha, .. } if alpha == 0.25));
        let mirror = Pbr {
            metallic: 1.0,
            roughness: 0.0,
            ..PLAIN
        }
        .map();
        assert!(matches!(mirror.bsdf, BsdfDesc::Conductor { eta_k: Some(_), .. }));
        let glass = Pbr {
            transmission: 1.0,
            roughness: 0.0,
            ior: 1.33,
            ..PLAIN
        }
        .map();
        assert!(
            matches!(glass.bsdf, BsdfDesc::Dielectric { int_ior, specular_transmittance, .. }
                if int_ior == 1.33 && specular_transmittance == PLAIN.base)
        );
        let frosted = Pbr {
            transmission: 1.0,
            roughness: 0.3,
            ..PLAIN
        }
        .map();
        assert!(matches!(frosted.bsdf, BsdfDesc::RoughDielectric { .. }));
        assert!(metal.losses.is_empty() && glass.losses.is_empty());
    }

    #[test]
    fn gloss_keeps_the_coats_reflectance() {
        let mapped = Pbr {
            roughness: 0.2,
            ..PLAIN
        }
        .map();
        let BsdfDesc::BlinnPhong {
            diffuse_reflectance,
            specular_reflectance,
            exponent,
            ..
        } = mapped.bsdf
        else {
            panic!("{mapped:?}")
        };
        assert!((specular_reflectance[0] - 0.04).abs() < 1e-12 && (exponent - 1248.0).abs() < 1e-6);
        assert!((diffuse_reflectance[0] - 0.8 * 0.96).abs() < 1e-12);
        let half = Pbr {
            metallic: 0.5,
            roughness: 0.5,
            ..PLAIN
        }
        .map();
        assert_eq!(half.losses.len(), 1);
    }
}
