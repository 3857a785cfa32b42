//! Solids given by a function, from the description to the picture.

use std::sync::atomic::AtomicBool;

use host_sim::builtin;
use host_sim::desc::{
    BallDesc, BoundDesc, BsdfDesc, GeometryDesc, ImplicitDesc, IntegratorKind, LightDesc, NamedMaterial,
    PartDesc, SceneDesc, ShapeDesc, Vec3,
};
use host_sim::primary;
use host_sim::quantise::CoreScene;
use host_sim::run::{Options, render_fixed};

const X: [Vec3; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn scene() -> SceneDesc {
    builtin::scene("implicits").unwrap()
}

fn material(bsdf: BsdfDesc) -> NamedMaterial {
    NamedMaterial {
        name: "material".into(),
        two_sided: true,
        bsdf,
        tint: None,
    }
}

/// Looks from `origin` to `target`, neither above the other.
fn look(desc: &mut SceneDesc, origin: Vec3, target: Vec3, fov_x: f64) {
    let unit = |v: Vec3| v.map(|c| c / v.iter().map(|c| c * c).sum::<f64>().sqrt());
    let cross = |a: Vec3, b: Vec3| {
        [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
    };
    let forward = unit([0, 1, 2].map(|i| target[i] - origin[i]));
    let right = unit(cross(forward, X[1]));
    desc.camera.origin = origin;
    desc.camera.forward = forward;
    desc.camera.right = right;
    desc.camera.up = cross(right, forward);
    desc.camera.fov_x = fov_x;
}

/// Mean of a picture in fixed point, and its darkest and brightest pixel.
fn render(desc: &SceneDesc, side: u32, spp: u32, max_depth: u32) -> (f64, f64, f64) {
    let options = Options {
        width: side,
        height: side,
        spp,
        integrator: IntegratorKind::Path,
        max_depth: Some(max_depth),
        threads: 2,
        ..Options::for_scene(desc)
    };
    let (picture, _) = render_fixed(desc, &options, &(), &AtomicBool::new(false)).unwrap();
    let values: Vec<f64> = picture.rgb.iter().flatten().map(|c| f64::from(*c)).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let least = values.iter().copied().fold(f64::MAX, f64::min);
    (mean, least, values.iter().copied().fold(0.0, f64::max))
}

/// The built-in scene's solids, each alone in a sky of `radiance`, seen whole.
fn alone(radiance: f64, bsdf: &BsdfDesc) -> Vec<SceneDesc> {
    let whole = scene();
    let solids = whole.shapes.iter().filter_map(|shape| match &shape.geometry {
        GeometryDesc::Implicit(solid) => Some((shape.name.clone(), solid.clone())),
        _ => None,
    });
    solids
        .map(|(name, solid)| {
            let [low, high] = solid.bounds();
            let middle = [0, 1, 2].map(|i| 0.5 * (low[i] + high[i]));
            let size = (0..3).map(|i| (high[i] - low[i]).powi(2)).sum::<f64>().sqrt();
            let mut desc = whole.clone();
            // No roulette: what is not lost is there to the last bit.
            desc.integrator.rr_depth = 2000;
            let from = [
                middle[0] + 0.5 * size,
                middle[1] + 0.7 * size,
                middle[2] + 1.6 * size,
            ];
            look(&mut desc, from, middle, 28.0);
            desc.materials = vec![material(bsdf.clone())];
            desc.shapes = vec![ShapeDesc {
                name,
                geometry: GeometryDesc::Implicit(solid),
                material: 0,
                emission: None,
            }];
            desc.lights = vec![LightDesc::Constant {
                radiance: [radiance; 3],
            }];
            desc
        })
        .collect()
}

#[test]
fn primary_rays_meet_what_they_meet_in_f64() {
    let core = CoreScene::new(&scene()).unwrap();
    let found = primary::compare(&core, 96, 96, &AtomicBool::new(false))
        .unwrap()
        .unwrap();
    println!("{found:#?}");
    // 9.0e-6, 2.0e-5 and 2.4e-5. With one radius off by a hundredth: 7.2e-4, 4.5e-4 and 2.8e-4.
    assert!(found.rays >= 1_000_000 && found.hit_miss_disagreement <= 3e-5);
    assert!(found.hit_point_error.p99 <= 3e-5);
    assert!(found.hit_point_error_away.p9999 <= 4e-5);
}

/// White surfaces in a white sky are white: no ray stays within a solid, none gets into it.
#[test]
fn white_solids_in_a_white_sky_are_not_seen() {
    let white = BsdfDesc::Diffuse {
        reflectance: [1.0; 3],
    };
    let scenes = alone(1.0, &white);
    assert_eq!(scenes.len(), 6);
    for desc in scenes {
        let (mean, least, most) = render(&desc, 32, 16, 200);
        println!("{}: {mean:.6} {least:.6} {most:.6}", desc.shapes[0].name);
        assert!((mean - 1.0).abs() <= 5e-4, "{}: {mean}", desc.shapes[0].name);
    }
}

/// Light that refracts in and out again, or is reflected within for long, loses nothing.
#[test]
fn glass_solids_in_a_uniform_sky_are_not_seen() {
    let glass = BsdfDesc::Dielectric {
        int_ior: 1.5,
        ext_ior: 1.0,
        specular_reflectance: [1.0; 3],
        specular_transmittance: [1.0; 3],
    };
    for desc in alone(2.0, &glass) {
        let (mean, least, most) = render(&desc, 32, 16, 1000);
        println!("{}: {mean:.6} {least:.6} {most:.6}", desc.shapes[0].name);
        assert!((mean - 2.0).abs() <= 2e-3, "{}: {mean}", desc.shapes[0].name);
    }
}

/// A floor 2 m under a ball of radius R and radiance L: reflectance · L · (R/2)². Three of the solids can be that ball.
#[test]
fn glowing_solids_light_as_the_balls_they_are() {
    let at = [0.0, 2.0, 0.0];
    let ball = |radius| BallDesc { center: at, radius };
    let solids = [
        ImplicitDesc::Metaballs {
            balls: vec![ball(1.2 / (1.0 - 0.343f64.cbrt()).sqrt())],
            threshold: 0.343,
        },
        ImplicitDesc::SmoothUnion {
            parts: vec![PartDesc::Ball(ball(1.2))],
            k: 0.1,
        },
        ImplicitDesc::RoundedBox {
            center: at,
            axes: X,
            half: [1.2; 3],
            radius: 1.2,
        },
    ];
    for solid in solids {
        let mut desc = scene();
        desc.lights.clear();
        desc.materials = vec![
            material(BsdfDesc::Diffuse {
                reflectance: [0.5; 3],
            }),
            material(BsdfDesc::Diffuse {
                reflectance: [0.0; 3],
            }),
        ];
        let shape = |name: &str, geometry, material, emission| ShapeDesc {
            name: name.into(),
            geometry,
            material,
            emission,
        };
        let floor = GeometryDesc::Rectangle {
            center: [0.0; 3],
            u: [0.0, 0.0, 4.0],
            v: [4.0, 0.0, 0.0],
        };
        desc.shapes = vec![
            shape("floor", floor, 0, None),
            shape("ball", GeometryDesc::Implicit(solid), 1, Some([3.0; 3])),
        ];
        look(&mut desc, [-3.0, 0.4, 0.0], [0.0; 3], 0.05);
        let expected = 0.5 * 3.0 * (1.2f64 / 2.0).powi(2);
        let (mean, _, _) = render(&desc, 16, 4096, 2);
        let error = mean / expected - 1.0;
        println!("{:.3} %", 100.0 * error);
        assert!(error.abs() <= 0.0025, "{mean} is not {expected}");
    }
}

#[test]
fn what_the_core_cannot_take_is_told() {
    let refused = |solid: ImplicitDesc| {
        let mut desc = scene();
        desc.shapes[1].geometry = GeometryDesc::Implicit(solid);
        let core = CoreScene::new(&desc).map_err(|error| error.to_string());
        match core {
            Ok(core) => core.scene(&core.lend()).map(|_| ()).unwrap_err().to_string(),
            Err(error) => error,
        }
    };
    let ball = |x: f64| BallDesc {
        center: [x, 1.0, 0.0],
        radius: 0.3,
    };
    let many = ImplicitDesc::Metaballs {
        balls: (0..17).map(|i| ball(f64::from(i) / 20.0)).collect(),
        threshold: 0.5,
    };
    assert_eq!(
        refused(many),
        "gyroid: is made of 17 shapes, and can be of 16; make two of it"
    );
    let gyroid = |cell| ImplicitDesc::Gyroid {
        center: [0.0, 1.0, 0.0],
        axes: X,
        cell,
        thickness: 0.1,
        bound: BoundDesc::Sphere { radius: 0.5 },
    };
    assert_eq!(
        refused(gyroid(2.5)),
        "gyroid: a cell of 2.5 is more than four times the 0.5 of its bound; make the cell smaller"
    );
    let thin = ImplicitDesc::Torus {
        center: [0.0, 1.0, 0.0],
        axis: X[0],
        major: 0.5,
        minor: 0.001,
    };
    let said = refused(thin);
    assert!(said.starts_with("gyroid: ") && said.contains("1/256"), "{said}");
}
