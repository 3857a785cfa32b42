//! Every integrator of the core against the f64 reference, in the mean, on the built-in scenes.
//!
//! Small pictures, many seeds: differences are judged by the spread over the seeds, beyond 0.25 % for what rounding may
//! do.

mod caustic;

use std::sync::atomic::AtomicBool;

use host_sim::builtin;
use host_sim::desc::{
    BsdfDesc, GeometryDesc, IntegratorKind, MeshDesc, NamedMaterial, SamplerKind, SceneDesc, ShapeDesc, Vec3,
};
use host_sim::run::{Error, Options, Picture, Stats, render_fixed, render_reference};

const SEEDS: u32 = 24;
const BUDGET: f64 = 0.0025;

/// Paths for the caustics that path tracing cannot find.
const CAUSTIC: u32 = 1 << 21;

/// Student's t with 23 degrees of freedom (the fewer there may be) that is exceeded on either side with probability
/// 0.01/40: there are fewer comparisons.
const MOST: f64 = 4.33;

fn options(desc: &SceneDesc, integrator: IntegratorKind, tiles: bool, seed: u32, spp: u32) -> Options {
    Options {
        width: 12,
        height: 12,
        spp,
        integrator,
        tiles,
        max_depth: Some(if integrator == IntegratorKind::Direct {
            2
        } else {
            7
        }),
        sampler: SamplerKind::Sobol,
        seed,
        threads: 2,
        ..Options::for_scene(desc)
    }
}

/// Mean over the seeds, and its standard error.
fn estimate(made: impl Fn(u32) -> Result<(Picture, Stats), Error>) -> (f64, f64) {
    let mean_of = |picture: Picture| {
        let sum: f64 = picture.rgb.iter().flatten().map(|c| f64::from(*c)).sum();
        sum / (3 * picture.rgb.len()) as f64
    };
    let means: Vec<f64> = (1..=SEEDS).map(|seed| mean_of(made(seed).unwrap().0)).collect();
    let n = means.len() as f64;
    let mean = means.iter().sum::<f64>() / n;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// Instead of its boxes, two coarse balls of triangles in the room, with the normals of round ones; of glass and rough metal
/// if they shall be shiny.
fn smoothen(desc: &mut SceneDesc, shiny: bool) {
    let matt = desc.shapes[0].material;
    desc.shapes
        .retain(|shape| !matches!(shape.geometry, GeometryDesc::Mesh(_)));
    let materials = [
        BsdfDesc::Dielectric {
            int_ior: 1.5,
            ext_ior: 1.0,
            specular_reflectance: [1.0; 3],
            specular_transmittance: [1.0; 3],
        },
        BsdfDesc::RoughConductor {
            alpha: 0.3,
            specular_reflectance: [0.9, 0.8, 0.5],
            eta_k: None,
        },
    ];
    let (low, high) = {
        let [low, high] = host_sim::quantise::bounds_of(desc);
        (low, [0, 1, 2].map(|i| high[i] - low[i]))
    };
    for (place, bsdf) in [0.3, 0.7].into_iter().zip(materials) {
        let centre = [0, 1, 2].map(|i| low[i] + high[i] * [place, 0.25, 0.5][i]);
        let material = if shiny {
            desc.materials.push(NamedMaterial {
                name: format!("ball at {place}"),
                two_sided: false,
                bsdf,
                tint: None,
            });
            desc.materials.len() - 1
        } else {
            matt
        };
        desc.shapes.push(ShapeDesc {
            name: format!("ball at {place}"),
            geometry: GeometryDesc::Mesh(ball(centre, 0.18 * high[0])),
            material,
            emission: None,
        });
    }
}

/// An octahedron, each face cut into 16, blown up to a ball.
fn ball(centre: Vec3, radius: f64) -> MeshDesc {
    const CUTS: i32 = 4;
    let (mut vertices, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    let mut vertex = |p: [i32; 3]| {
        let length = f64::from(p.iter().map(|c| c * c).sum::<i32>()).sqrt();
        let normal = p.map(|c| f64::from(c) / length);
        vertices.push([0, 1, 2].map(|i| centre[i] + radius * normal[i]));
        normals.push(normal);
        vertices.len() as u32 - 1
    };
    for sides in 0..8 {
        let sign = [0, 1, 2].map(|axis| if sides >> axis & 1 == 0 { 1 } else { -1 });
        let turns = sign[0] * sign[1] * sign[2] > 0;
        let mut corner = |x: i32, y: i32| vertex([sign[0] * x, sign[1] * y, sign[2] * (CUTS - x - y)]);
        for x in 0..CUTS {
            for y in 0..CUTS - x {
                let mut push =
                    |[a, b, c]: [u32; 3]| triangles.push(if turns { [a, b, c] } else { [a, c, b] });
                push([corner(x, y), corner(x + 1, y), corner(x, y + 1)]);
                if x + y < CUTS - 1 {
                    push([corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)]);
                }
            }
        }
    }
    MeshDesc {
        vertices,
        triangles,
        normals,
        ..MeshDesc::default()
    }
}

#[test]
#[cfg_attr(
    not(debug_assertions),
    ignore = "three minutes, and no other pixel than with checks for overflow, where it runs"
)]
fn the_core_agrees_with_the_reference() {
    let cancel = AtomicBool::new(false);
    let (direct, path) = (IntegratorKind::Direct, IntegratorKind::Path);
    let (bdpt, light) = (IntegratorKind::Bdpt, IntegratorKind::Light);
    let most = [(direct, false), (path, false), (bdpt, false), (bdpt, true)];
    // Nothing but light tracing sees no mirror or glass, nor all that a sky lights of an endless floor.
    let matt = [&most[..], &[(light, false)]].concat();
    for (name, ways, spp) in [
        ("cornell", &matt[..], 512),
        ("spheres", &most, 256),
        ("seed", &most, 512),
        ("torus-knot", &matt, 256),
        ("implicits", &most, 512),
        ("materials", &most, 256),
        ("sky", &most, 256),
        ("sky, matt", &most, 256),
        ("map", &most, 256),
        ("cornell, smooth", &matt, 512),
        ("cornell, smooth glass and metal", &most, 512),
    ] {
        let (scene, variant) = name.split_once(", ").unwrap_or((name, ""));
        let is_matt = variant == "matt";
        let mut desc = builtin::scene(scene).unwrap();
        if let Some(shiny) = variant.strip_prefix("smooth") {
            smoothen(&mut desc, !shiny.is_empty());
        }
        // Lamps that the camera sees are the most of many pictures' light, and the noise of their rims most of the noise.
        desc.integrator.hide_emitters = true;
        if is_matt {
            // The sun by way of mirror and glass, which chance alone finds, is all the noise that `sky` has.
            for material in &mut desc.materials {
                material.bsdf = BsdfDesc::Diffuse {
                    reflectance: [0.5; 3],
                };
            }
        }
        let reference = |integrator| {
            estimate(|seed| {
                let options = options(&desc, integrator, false, seed, spp);
                render_reference(&desc, &options, &(), &cancel)
            })
        };
        let (short, long) = (reference(direct), reference(path));
        // A point light's caustic is found by light that meets the lens, or by what a frame or tiles connect beyond.
        let caustic = caustic::mean(if name == "spheres" { CAUSTIC } else { 0 }, 7, 1);
        for &(integrator, tiles) in ways {
            let missed = match (name, integrator, tiles) {
                ("spheres", IntegratorKind::Bdpt, false) => caustic[0],
                ("spheres", IntegratorKind::Bdpt, true) => caustic[1],
                _ => 0.0,
            };
            let (truth, truth_error) = if integrator == direct { short } else { long };
            let expected = truth + missed;
            let (mean, error) = estimate(|seed| {
                let options = options(&desc, integrator, tiles, seed, spp);
                render_fixed(&desc, &options, &(), &cancel)
            });
            let error = error.hypot(truth_error);
            let percent = 100.0 * (mean / expected - 1.0);
            println!(
                "{name}, {integrator:?}, tiles {tiles}: {percent:+.3} % with an error of {:.3} %, the reference's {:.3} %, \
                 {:.3} % caustics",
                100.0 * error / truth,
                100.0 * truth_error / truth,
                100.0 * missed / truth
            );
            assert!(
                (mean - expected).abs() <= BUDGET * truth + MOST * error,
                "{name}, {integrator:?}, tiles {tiles}: {mean} is not {expected}"
            );
        }
    }
}

#[test]
fn ambient_occlusion_agrees_with_the_reference() {
    let cancel = AtomicBool::new(false);
    for radius in [None, Some(0.5)] {
        let mut desc = builtin::scene("cornell").unwrap();
        desc.integrator.ao_radius = radius;
        let made = |seed, spp| options(&desc, IntegratorKind::Ao, false, seed, spp);
        let (truth, truth_error) = estimate(|seed| render_reference(&desc, &made(seed, 64), &(), &cancel));
        let (mean, error) = estimate(|seed| render_fixed(&desc, &made(seed, 64), &(), &cancel));
        let error = error.hypot(truth_error);
        println!("ao within {radius:?}: {mean} and {truth}, error {error}");
        assert!(
            (mean - truth).abs() <= BUDGET * truth + MOST * error,
            "{radius:?}: {mean} is not {truth}"
        );
    }
}
