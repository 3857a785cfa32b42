//! Rough diffuse surfaces: Oren and Nayar, "Generalization of Lambert's Reflectance Model" (SIGGRAPH 1994), and EON.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

use super::super::scene::OrenNayarModel;
use super::super::vec::{Rgb, Vec3};

/// The BRDF. Both directions are on the side of `normal`; `sigma` in radians.
pub fn brdf(model: OrenNayarModel, reflectance: Rgb, sigma: f64, normal: Vec3, wo: Vec3, wi: Vec3) -> Rgb {
    let (cos_o, cos_i) = (normal.dot(wo).min(1.0), normal.dot(wi).min(1.0));
    match model {
        OrenNayarModel::Full | OrenNayarModel::Qualitative => {
            // The tangential parts of both directions enclose the difference of the azimuths.
            let (across_o, across_i) = (wo - normal * cos_o, wi - normal * cos_i);
            let lengths = across_o.length() * across_i.length();
            let cos_azimuth = if lengths > 0.0 {
                (across_o.dot(across_i) / lengths).clamp(-1.0, 1.0)
            } else {
                0.0
            };
            let (theta_o, theta_i) = (cos_o.acos(), cos_i.acos());
            let (alpha, beta) = (theta_o.max(theta_i), theta_o.min(theta_i));
            if model == OrenNayarModel::Full {
                full(reflectance, sigma, alpha, beta, cos_azimuth)
            } else {
                reflectance * (FRAC_1_PI * qualitative(sigma, alpha, beta, cos_azimuth))
            }
        }
        OrenNayarModel::EnergyPreserving => {
            energy_preserving(reflectance, sigma / FRAC_PI_2, cos_o, cos_i, wo.dot(wi))
        }
    }
}

/// Sections 4.2 and 4.3: the facets' direct light, and what they throw at each other once.
fn full(reflectance: Rgb, sigma: f64, alpha: f64, beta: f64, cos_azimuth: f64) -> Rgb {
    let s = sigma * sigma;
    let c1 = 1.0 - 0.5 * s / (s + 0.33);
    let bent = if cos_azimuth < 0.0 {
        (2.0 * beta / PI).powi(3)
    } else {
        0.0
    };
    let c2 = 0.45 * s / (s + 0.09) * (alpha.sin() - bent);
    let c3 = 0.125 * s / (s + 0.09) * (4.0 * alpha * beta / (PI * PI)).powi(2);
    let direct =
        c1 + cos_azimuth * c2 * beta.tan() + (1.0 - cos_azimuth.abs()) * c3 * ((alpha + beta) / 2.0).tan();
    let between = 0.17 * s / (s + 0.13) * (1.0 - cos_azimuth * (2.0 * beta / PI).powi(2));
    (reflectance * direct + reflectance * reflectance * between) * FRAC_1_PI
}

/// Section 4.4, without ρ/π.
fn qualitative(sigma: f64, alpha: f64, beta: f64, cos_azimuth: f64) -> f64 {
    let s = sigma * sigma;
    let a = 1.0 - 0.5 * s / (s + 0.33);
    let b = 0.45 * s / (s + 0.09);
    a + b * cos_azimuth.max(0.0) * alpha.sin() * beta.tan()
}

/// EON: Portsmouth, Kutz and Hill, "EON: A practical energy-preserving rough diffuse BRDF" (JCGT 14(1), 2025).
///
/// Fujii's single scattering, and a multiple scattering lobe of the form Kulla and Conty gave to metals, which returns
/// what the first loses. `roughness` 0 to 1.
fn energy_preserving(rho: Rgb, roughness: f64, cos_o: f64, cos_i: f64, cos_between: f64) -> Rgb {
    let s = cos_between - cos_o * cos_i;
    let stretched = if s > 0.0 { s / cos_o.max(cos_i) } else { s };
    let single = rho * (FRAC_1_PI * fujii_scale(roughness) * (1.0 + roughness * stretched));
    let mean = fujii_mean_albedo(roughness);
    let lost = 1.0 - mean;
    if lost <= 0.0 {
        return single;
    }
    // ρ² times the mean albedo, and all that comes of it again and again: a geometric series.
    let series = |rho: f64| rho * rho * mean / (1.0 - rho * lost);
    let multiple = Rgb {
        x: series(rho.x),
        y: series(rho.y),
        z: series(rho.z),
    };
    let lost_by = |cos: f64| 1.0 - fujii_albedo(cos, roughness);
    single + multiple * (FRAC_1_PI * lost_by(cos_o) * lost_by(cos_i) / lost)
}

/// A_F of Fujii's model.
fn fujii_scale(roughness: f64) -> f64 {
    1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * roughness)
}

/// Share that Fujii's model with ρ = 1 reflects of light from a direction at cosine `cos`.
fn fujii_albedo(cos: f64, roughness: f64) -> f64 {
    let cos = cos.clamp(1e-12, 1.0);
    let sin = (1.0 - cos * cos).sqrt();
    let g = sin * (cos.acos() - sin * cos) + 2.0 / 3.0 * (sin / cos * (1.0 - sin * sin * sin) - sin);
    fujii_scale(roughness) * (1.0 + roughness * g * FRAC_1_PI)
}

/// The mean of `fujii_albedo` over the hemisphere, by the cosine.
fn fujii_mean_albedo(roughness: f64) -> f64 {
    fujii_scale(roughness) * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * PI)) * roughness)
}

#[cfg(test)]
mod tests {
    use super::super::super::vec::vec3;
    use super::*;

    const UP: Vec3 = vec3(0.0, 0.0, 1.0);

    fn direction(theta: f64, phi: f64) -> Vec3 {
        vec3(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
    }

    /// ∫ f cosθ dω by the midpoint rule.
    fn albedo(model: OrenNayarModel, rho: f64, sigma: f64, wo: Vec3) -> f64 {
        let (rows, columns) = (400, 400);
        let mut sum = 0.0;
        for row in 0..rows {
            // Equal steps of sin²θ weigh by the cosine.
            let sin2 = (f64::from(row) + 0.5) / f64::from(rows);
            for column in 0..columns {
                let phi = (f64::from(column) + 0.5) / f64::from(columns) * 2.0 * PI;
                let wi = direction(sin2.sqrt().asin(), phi);
                sum += brdf(model, Rgb::splat(rho), sigma, UP, wo, wi).x;
            }
        }
        sum * PI / f64::from(rows * columns)
    }

    #[test]
    fn smooth_is_lambert() {
        for model in [
            OrenNayarModel::Full,
            OrenNayarModel::Qualitative,
            OrenNayarModel::EnergyPreserving,
        ] {
            let f = brdf(
                model,
                vec3(0.2, 0.5, 0.9),
                0.0,
                UP,
                direction(0.7, 0.0),
                direction(1.2, 2.0),
            );
            assert!((f - vec3(0.2, 0.5, 0.9) * FRAC_1_PI).abs().max_component() < 1e-15);
        }
    }

    #[test]
    fn the_energy_preserving_model_returns_all_energy_and_the_others_no_more() {
        for sigma in [0.1, 0.5, FRAC_PI_2] {
            for theta in [0.0, 0.5, 1.1, 1.5] {
                let wo = direction(theta, 0.3);
                let kept = albedo(OrenNayarModel::EnergyPreserving, 1.0, sigma, wo);
                assert!((kept - 1.0).abs() < 2e-4, "σ {sigma}, θ {theta}: {kept}");
                let grey = albedo(OrenNayarModel::EnergyPreserving, 0.5, sigma, wo);
                assert!(grey < 0.5 + 2e-4 && grey > 0.3, "σ {sigma}, θ {theta}: {grey}");
            }
            // Seen from above, which is where most light comes from.
            for model in [OrenNayarModel::Full, OrenNayarModel::Qualitative] {
                let kept = albedo(model, 1.0, sigma, direction(0.2, 0.0));
                assert!(kept < 1.0, "{model:?}, σ {sigma}: {kept}");
            }
        }
    }

    #[test]
    fn fujiis_albedo_is_the_integral_and_its_mean_the_mean() {
        let roughness: f64 = 0.8;
        let steps = 2000;
        let mut mean = 0.0;
        for step in 0..steps {
            let cos = ((f64::from(step) + 0.5) / f64::from(steps)).sqrt();
            mean += fujii_albedo(cos, roughness) / f64::from(steps);
        }
        assert!((mean - fujii_mean_albedo(roughness)).abs() < 1e-5);
        // What fixes the scale: at grazing incidence nothing is lost.
        assert!((fujii_albedo(1e-9, roughness) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn the_formulas_at_a_worked_point() {
        // σ = 30°: s = 0.274155678. θr = 60°, θi = 30°, azimuths 60° apart, ρ = 0.8, by hand.
        let (wo, wi) = (
            direction(60f64.to_radians(), 0.0),
            direction(30f64.to_radians(), 60f64.to_radians()),
        );
        let sigma = 30f64.to_radians();
        let f = |model| brdf(model, Rgb::splat(0.8), sigma, UP, wo, wi).x;
        // A = 1 − 0.5·0.274156/0.604156 = 0.773108; B = 0.45·0.274156/0.364156 = 0.338784;
        // 0.8/π (A + B·0.5·0.866025·0.577350) = 0.8/π · 0.857804.
        assert!((f(OrenNayarModel::Qualitative) - 0.218439).abs() < 1e-6);
        // C2 = B·0.866025 = 0.293396, C3 = 0.125·0.752853·(4·π/3·π/6/π²)² = 0.00464724,
        // direct 0.773108 + 0.5·0.293396·0.577350 + 0.5·0.00464724·1 = 0.860128,
        // between 0.17·0.274156/0.404156·(1 − 0.5/9) = 0.108912: (0.8·0.860128 + 0.64·0.108912)/π.
        assert!(
            (f(OrenNayarModel::Full) - 0.241218).abs() < 1e-6,
            "{}",
            f(OrenNayarModel::Full)
        );
        // Azimuths 120° apart: C2 = 0.338784·(0.866025 − 1/27) = 0.280848.
        let wi = direction(30f64.to_radians(), 120f64.to_radians());
        let f = brdf(OrenNayarModel::Full, Rgb::splat(0.8), sigma, UP, wo, wi).x;
        // direct 0.773108 − 0.5·0.280848·0.577350 + 0.002324 = 0.694358; between 0.115319·(1 + 0.5/9) = 0.121726.
        assert!((f - 0.201615).abs() < 1e-6, "{f}");
    }
}
