//! Oren–Nayar against tables of its formulas, computed here in f64 from the angles as the papers write them.

use crate::rig::{MODELS, degrees, rgb, to_dir, to_f64, wide};
use microlux::color::Albedo;
use microlux::geom::Dir;
use microlux::material::{Local, Material, OrenNayar, OrenNayarModel};
use microlux::num::Share;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

/// A direction pair: angles to the normal, and between the two azimuths.
struct Angles {
    i: f64,
    o: f64,
    phi: f64,
}

/// Oren and Nayar 1994, equations 27 to 30: the sum of both terms.
fn full(rho: f64, sigma: f64, angles: &Angles) -> f64 {
    let s = sigma * sigma;
    let (alpha, beta) = (angles.i.max(angles.o), angles.i.min(angles.o));
    let cos_phi = angles.phi.cos();
    let c1 = 1.0 - 0.5 * s / (s + 0.33);
    let shadow = if cos_phi < 0.0 {
        (2.0 * beta / PI).powi(3)
    } else {
        0.0
    };
    let c2 = 0.45 * s / (s + 0.09) * (alpha.sin() - shadow);
    let c3 = 0.125 * s / (s + 0.09) * (4.0 * alpha * beta / (PI * PI)).powi(2);
    let first = c1 + cos_phi * c2 * beta.tan() + (1.0 - cos_phi.abs()) * c3 * (0.5 * (alpha + beta)).tan();
    let second = 0.17 * rho * s / (s + 0.13) * (1.0 - cos_phi * (2.0 * beta / PI).powi(2));
    (rho * FRAC_1_PI * (first + second)).max(0.0)
}

/// Its section 4.4.
fn qualitative(rho: f64, sigma: f64, angles: &Angles) -> f64 {
    let s = sigma * sigma;
    let (alpha, beta) = (angles.i.max(angles.o), angles.i.min(angles.o));
    let (a, b) = (1.0 - 0.5 * s / (s + 0.33), 0.45 * s / (s + 0.09));
    rho * FRAC_1_PI * (a + b * angles.phi.cos().max(0.0) * alpha.sin() * beta.tan())
}

/// The share that Fujii's single scattering returns of light from an angle, by integrating it over the hemisphere.
fn fujii_albedo(r: f64, theta: f64) -> f64 {
    let n = 400;
    let mut sum = 0.0;
    for k in 0..n {
        let i = FRAC_PI_2 * (k as f64 + 0.5) / n as f64;
        for l in 0..n {
            let phi = PI * (l as f64 + 0.5) / n as f64;
            sum += fujii(r, &Angles { i, o: theta, phi }) * i.cos() * i.sin();
        }
    }
    // Both halves of the azimuth are alike.
    2.0 * sum * FRAC_PI_2 / n as f64 * PI / n as f64
}

/// Portsmouth et al. 2025, equation of "FON": A (1 + r s/t)/π.
fn fujii(r: f64, angles: &Angles) -> f64 {
    let a = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * r);
    let s = angles.i.sin() * angles.o.sin() * angles.phi.cos();
    let t = if s > 0.0 {
        angles.i.cos().max(angles.o.cos())
    } else {
        1.0
    };
    a * (1.0 + r * s / t) * FRAC_1_PI
}

/// EON with albedos that were integrated: of both directions, and of their mean.
fn energy_preserving(rho: f64, r: f64, angles: &Angles, lost: [f64; 2], mean: f64) -> f64 {
    let again = rho * rho * mean / (1.0 - rho * (1.0 - mean));
    let single = rho * fujii(r, angles);
    if r == 0.0 {
        return single;
    }
    single + again * FRAC_1_PI * lost[0] * lost[1] / (1.0 - mean)
}

fn direction(theta: f64, phi: f64) -> Dir {
    to_dir([theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()])
}

fn share_of(s: Share) -> f64 {
    f64::from(s.to_bits()) / 32768.0
}

const THETAS: [f64; 9] = [0.0, 5.0, 20.0, 35.0, 50.0, 65.0, 75.0, 82.0, 86.0];
const PHIS: [f64; 8] = [0.0, 15.0, 50.0, 85.0, 95.0, 120.0, 150.0, 180.0];
const SIGMAS: [f64; 7] = [0.0, 4.0, 10.0, 20.0, 35.0, 60.0, 90.0];

/// The largest relative error of a model over the grid, where it reflects anything to speak of.
fn worst(model: OrenNayarModel) -> f64 {
    let mut worst = 0.0f64;
    let albedo = Albedo([0.9, 0.35, 0.05].map(Share::from_num));
    for sigma in SIGMAS {
        let surface = OrenNayar::new(model, albedo, degrees(sigma));
        // As the core holds them.
        let r = share_of(surface.sigma());
        let sigma = r * FRAC_PI_2;
        let rho = albedo.0.map(share_of);
        let returned = THETAS.map(|theta| fujii_albedo(r, theta.to_radians()));
        // ⅔ − 28/(15π) is the mean of the second term.
        let a = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * r);
        let mean = a * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * PI)) * r);
        for (m, o) in THETAS.into_iter().enumerate() {
            for (n, i) in THETAS.into_iter().enumerate() {
                for phi in PHIS {
                    let angles = Angles {
                        i: i.to_radians(),
                        o: o.to_radians(),
                        phi: phi.to_radians(),
                    };
                    let local = Local {
                        normal: Dir::Z,
                        wo: direction(angles.o, 0.0),
                    };
                    let wi = direction(angles.i, angles.phi);
                    let (f, pdf) = Material::OrenNayar(surface).eval(&local, wi).unwrap();
                    let cos = angles.i.cos();
                    assert!((wide(pdf) / (cos * FRAC_1_PI) - 1.0).abs() < 5e-4);
                    for (c, rho) in rho.into_iter().enumerate() {
                        let exact = match model {
                            OrenNayarModel::Full => full(rho, sigma, &angles),
                            OrenNayarModel::Qualitative => qualitative(rho, sigma, &angles),
                            OrenNayarModel::EnergyPreserving => {
                                let lost = [1.0 - returned[m], 1.0 - returned[n]];
                                energy_preserving(rho, r, &angles, lost, mean)
                            }
                        };
                        // Where the fit of 1994 goes through 0, only the share of a Lambertian's light says anything.
                        let floor = 0.05 * rho * FRAC_1_PI;
                        let error = (rgb(f)[c] / cos - exact).abs() / exact.max(floor);
                        if error > worst {
                            worst = error;
                            println!("{model:?} σ {sigma:.3} {i}° {o}° {phi}° ρ {}: {error:.2e}", rho);
                        }
                    }
                }
            }
        }
    }
    worst
}

#[test]
fn the_full_model_is_the_paper_s_to_half_a_percent() {
    let worst = worst(OrenNayarModel::Full);
    assert!((5e-4..5e-3).contains(&worst), "{worst}");
}

#[test]
fn the_simple_model_is_its_formula_to_a_fifth_of_a_percent() {
    let worst = worst(OrenNayarModel::Qualitative);
    assert!((1e-4..2e-3).contains(&worst), "{worst}");
}

#[test]
fn the_energy_preserving_model_is_its_formula_to_a_fifth_of_a_percent() {
    let worst = worst(OrenNayarModel::EnergyPreserving);
    assert!((1e-4..2e-3).contains(&worst), "{worst}");
}

/// Without roughness, all three are Lambert's law.
#[test]
fn smooth_is_lambertian() {
    let albedo = Albedo([0.7, 0.2, 0.01].map(Share::from_num));
    let wo = direction(1.1, 0.0);
    let local = Local { normal: Dir::Z, wo };
    for model in MODELS {
        let smooth = Material::OrenNayar(OrenNayar::new(model, albedo, degrees(0.0)));
        for theta in [0.0, 0.5, 1.0, 1.5] {
            let wi = direction(theta, 2.0);
            let (a, _) = smooth.eval(&local, wi).unwrap();
            let (b, _) = Material::lambert(albedo).eval(&local, wi).unwrap();
            for c in 0..3 {
                assert!(
                    (rgb(a)[c] - rgb(b)[c]).abs() <= 4e-5 * rgb(b)[0],
                    "{model:?} {theta}"
                );
            }
        }
        // One-sided and two-sided.
        let behind = Local {
            normal: Dir::Z,
            wo: -wo,
        };
        assert!(smooth.eval(&behind, direction(2.0, 0.3)).is_some());
        let one_sided = Material::OrenNayar(OrenNayar::new(model, albedo, degrees(0.0)).one_sided());
        assert!(one_sided.eval(&behind, direction(2.0, 0.3)).is_none());
        assert!(to_f64(wo)[2] > 0.0);
    }
}
