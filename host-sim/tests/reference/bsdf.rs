//! Materials: what is sampled is what the density says, values are Mitsuba's, and physics is kept.

use std::f64::consts::PI;

use host_sim::reference::{OrenNayarModel, Surface};

use super::chi_square::{Random, assert_samples_follow, sphere_integral};
use super::*;

const UP: Vec3 = vec3(0.0, 0.0, 1.0);

fn direction(theta: f64, phi: f64) -> Vec3 {
    vec3(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

/// Seen along `wo`, from behind where that is below the surface.
fn surface(wo: Vec3) -> Surface {
    let front = wo.z > 0.0;
    let normal = if front { UP } else { -UP };
    Surface {
        point: Vec3::ZERO,
        wo,
        normal,
        shading: normal,
        front,
    }
}

fn gold() -> Option<(Rgb, Rgb)> {
    Some((vec3(0.2, 0.9, 1.1), vec3(3.9, 2.4, 2.2)))
}

fn metal(alpha: f64) -> Material {
    Material::RoughConductor {
        alpha,
        reflectance: Rgb::ONE,
        eta_k: gold(),
        two_sided: false,
    }
}

fn frosted(alpha: f64) -> Material {
    Material::RoughDielectric {
        alpha,
        eta: 1.5,
        specular_reflectance: Rgb::ONE,
        specular_transmittance: Rgb::ONE,
    }
}

fn oren_nayar(model: OrenNayarModel, degrees: f64) -> Material {
    Material::OrenNayar {
        reflectance: vec3(1.0, 0.5, 0.1),
        sigma: degrees.to_radians(),
        model,
        two_sided: false,
    }
}

fn phong(exponent: f64, normalized: bool) -> Material {
    Material::BlinnPhong {
        diffuse: vec3(0.5, 0.4, 0.1),
        specular: vec3(0.3, 0.2, 0.4),
        exponent,
        normalized,
        two_sided: false,
    }
}

/// What has a density, over roughness.
fn materials() -> Vec<Material> {
    vec![
        WHITE,
        oren_nayar(OrenNayarModel::Full, 40.0),
        oren_nayar(OrenNayarModel::Qualitative, 20.0),
        oren_nayar(OrenNayarModel::EnergyPreserving, 60.0),
        phong(0.0, true),
        phong(12.0, true),
        phong(80.0, false),
        metal(0.1),
        metal(0.4),
        metal(1.0),
        frosted(0.1),
        frosted(0.3),
        frosted(1.0),
    ]
}

fn views() -> Vec<Vec3> {
    [3.0f64, 40.0, 75.0]
        .map(|degrees| direction(degrees.to_radians(), 0.4))
        .to_vec()
}

#[test]
fn samples_follow_their_density() {
    for (index, material) in materials().iter().enumerate() {
        for (view, wo) in views().into_iter().enumerate() {
            for wo in [wo, vec3(wo.x, wo.y, -wo.z)] {
                if wo.z < 0.0 && !matches!(material, Material::RoughDielectric { .. }) {
                    continue;
                }
                let surface = surface(wo);
                let mut random = Random::new((index * 8 + view) as u64);
                assert_samples_follow(
                    &format!("{material:?} seen from {wo:?}"),
                    |wi| material.eval(&surface, wi).1,
                    || {
                        let u = [random.uniform(), random.uniform()];
                        material
                            .sample(&surface, u, random.uniform())
                            .map(|bounce| bounce.wi)
                    },
                );
            }
        }
    }
}

#[test]
fn weights_are_value_over_density() {
    let mut random = Random::new(5);
    for material in materials() {
        for wo in views() {
            let surface = surface(wo);
            for _ in 0..200 {
                let u = [random.uniform(), random.uniform()];
                let Some(bounce) = material.sample(&surface, u, random.uniform()) else {
                    continue;
                };
                let (value, pdf) = material.eval(&surface, bounce.wi);
                let error = (bounce.weight * pdf - value).abs().max_component();
                assert!(bounce.pdf == Some(pdf) && error <= 1e-12 * value.max_component());
                let through = bounce.wi.z < 0.0;
                assert_eq!(bounce.eta, if through { 1.5 } else { 1.0 });
            }
        }
    }
}

#[test]
fn what_is_lent_one_way_comes_back_the_other() {
    let mut random = Random::new(3);
    for material in materials() {
        // Without the norm the lobe is not a BRDF: f cosθi is what it gives.
        if matches!(
            material,
            Material::BlinnPhong {
                normalized: false,
                ..
            }
        ) {
            continue;
        }
        let mut told = 0;
        for _ in 0..500 {
            let mut any = || {
                let z: f64 = 2.0 * random.uniform() - 1.0;
                direction(z.acos(), 2.0 * PI * random.uniform())
            };
            let (a, b) = (any(), any());
            let index = |w: Vec3| if w.z < 0.0 { 1.5 } else { 1.0 };
            // f / η² of the side the light leaves to: Veach 1997, equation 5.14.
            let f = |wo: Vec3, wi: Vec3| {
                let (value, _) = material.eval(&surface(wo), wi);
                value / wi.z.abs() * (index(wi) * index(wi))
            };
            let (there, back) = (f(a, b), f(b, a));
            let largest = there.max_component().max(back.max_component());
            told += u32::from(largest > 0.0);
            assert!(
                (there - back).abs().max_component() <= 1e-9 * largest,
                "{material:?} {a:?} {b:?}: {there:?} {back:?}"
            );
        }
        assert!(
            told > 80,
            "{material:?}: only {told} pairs of directions told anything"
        );
    }
}

#[test]
fn no_more_light_leaves_than_arrives() {
    for material in materials() {
        // The unnormalised lobe may shine, which is the paper's; the full Oren-Nayar model is not bounded when white.
        if matches!(
            material,
            Material::BlinnPhong {
                normalized: false,
                ..
            } | Material::OrenNayar {
                model: OrenNayarModel::Full,
                ..
            }
        ) {
            continue;
        }
        for wo in views() {
            let surface = surface(wo);
            let index = |wi: Vec3| if wi.z < 0.0 { 1.5 } else { 1.0 };
            let kept = sphere_integral(|wi| {
                let value = material.eval(&surface, wi).0;
                value.max_component() * index(wi) * index(wi)
            });
            assert!(kept < 1.0 + 3e-3, "{material:?} from {wo:?} gives {kept}");
            assert!(kept > 0.2, "{material:?} from {wo:?} keeps {kept}");
        }
    }
    // Fine facets hardly hide each other: nothing is lost in glass.
    let wo = direction(0.5, 0.0);
    let kept = sphere_integral(|wi| {
        let eta2 = if wi.z < 0.0 { 2.25 } else { 1.0 };
        frosted(0.05).eval(&surface(wo), wi).0.x * eta2
    });
    assert_near(kept, 1.0, 4e-3);
}

#[test]
fn values_are_mitsubas() {
    let mut rows = 0;
    for line in include_str!("mitsuba_bsdf.txt").lines() {
        if line.starts_with('#') {
            continue;
        }
        let (name, rest) = line.split_once(' ').expect("a name");
        let numbers: Vec<f64> = rest
            .split_whitespace()
            .map(|word| word.parse().expect("a number"))
            .collect();
        let [alpha, theta_o, phi_o, theta_i, phi_i, r, g, b, pdf] = numbers[..] else {
            panic!("{line} has not nine numbers")
        };
        let toward = |theta: f64, phi: f64| direction(theta.to_radians(), phi.to_radians());
        let (wo, wi) = (toward(theta_o, phi_o), toward(theta_i, phi_i));
        let expected = vec3(r, g, b);
        let (seen, density) = match name {
            "smooth" => {
                let (eta, k) = gold().expect("gold has an index");
                let smooth = Material::Conductor {
                    reflectance: Rgb::ONE,
                    eta,
                    k,
                    two_sided: false,
                };
                let bounce = smooth
                    .sample(&surface(wo), [0.0; 2], 0.5)
                    .expect("a mirror reflects");
                assert!((bounce.wi - wi).length() < 1e-12 && bounce.pdf.is_none());
                (bounce.weight, 0.0)
            }
            "glass" => frosted(alpha).eval(&surface(wo), wi),
            "gold" => metal(alpha).eval(&surface(wo), wi),
            _ => Material::RoughConductor {
                alpha,
                reflectance: Rgb::ONE,
                eta_k: None,
                two_sided: false,
            }
            .eval(&surface(wo), wi),
        };
        // Mitsuba computes in single precision; the cosines of 85° and the like carry that into the sixth digit.
        let close = |a: f64, b: f64| (a - b).abs() <= 2e-5 * b.abs() + 1e-9;
        assert!(
            close(seen.x, expected.x) && close(seen.y, expected.y) && close(seen.z, expected.z),
            "{line}: {seen:?}"
        );
        assert!(close(density, pdf), "{line}: density {density}");
        rows += 1;
    }
    assert_eq!(rows, 87);
}

#[test]
fn one_sided_materials_are_black_from_behind_and_two_sided_ones_the_same() {
    let (wo, wi) = (direction(0.6, 0.2), direction(0.9, 2.5));
    let below = |w: Vec3| vec3(w.x, w.y, -w.z);
    for material in materials() {
        if matches!(material, Material::RoughDielectric { .. }) {
            continue;
        }
        assert_eq!(material.eval(&surface(below(wo)), below(wi)).0, Rgb::ZERO);
        assert_eq!(material.eval(&surface(wo), below(wi)).0, Rgb::ZERO);
        let mut both = material;
        match &mut both {
            Material::Diffuse { two_sided, .. }
            | Material::OrenNayar { two_sided, .. }
            | Material::BlinnPhong { two_sided, .. }
            | Material::RoughConductor { two_sided, .. } => *two_sided = true,
            _ => unreachable!("these are all"),
        }
        let behind = both.eval(&surface(below(wo)), below(wi));
        let before = material.eval(&surface(wo), wi);
        assert!((behind.0 - before.0).abs().max_component() < 1e-12 && before.0 != Rgb::ZERO);
        assert!((behind.1 - before.1).abs() < 1e-12);
    }
}

#[test]
fn very_fine_facets_are_a_mirror() {
    // Half a sky: the mirror image of the view decides, at nearly the smooth metal's reflectance.
    let wo = direction(0.8, 0.0);
    let (eta, k) = gold().expect("gold has an index");
    let smooth = Material::Conductor {
        reflectance: Rgb::ONE,
        eta,
        k,
        two_sided: false,
    };
    let expected = smooth
        .sample(&surface(wo), [0.0; 2], 0.0)
        .expect("a mirror")
        .weight;
    let fine = metal(0.001);
    let mut random = Random::new(9);
    let mut sum = Rgb::ZERO;
    for _ in 0..2000 {
        let u = [random.uniform(), random.uniform()];
        let bounce = fine.sample(&surface(wo), u, 0.5).expect("few facets look down");
        assert!((bounce.wi - direction(0.8, PI)).length() < 0.4);
        sum += bounce.weight / 2000.0;
    }
    assert!(
        (sum - expected).abs().max_component() < 1e-4,
        "{sum:?} {expected:?}"
    );
}
