//! Two estimators, any number of threads: one picture.

use std::collections::HashSet;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::{Duration, Instant};

use host_sim::reference::{Capsule, Estimator, Gradient, Implicit, Map, OrenNayarModel, Sun};

use super::*;

/// A room with a lamp of every kind, things before and around them, and colours.
fn lamps_of_every_kind() -> Scene {
    let mut shapes = room(None);
    let face_down = Geometry::Rectangle {
        center: vec3(0.3, 0.95, 0.2),
        u: vec3(0.3, 0.0, 0.0),
        v: vec3(0.0, 0.0, 0.2),
    };
    let disk = Geometry::Disk {
        center: vec3(-0.9, 0.1, -0.2),
        normal: vec3(1.0, 0.3, 0.0),
        radius: 0.3,
    };
    shapes.push(lamp(face_down, 4.0, 0));
    shapes.push(lamp(disk, 3.0, 1));
    shapes.push(lamp(sphere(vec3(0.3, -0.8, 0.1), 0.25), 2.0, 0));
    shapes.push(lamp(
        Geometry::Mesh(Arc::new(cube_mesh(vec3(-0.4, 0.7, -0.5), 0.15))),
        3.0,
        1,
    ));
    shapes.push(shape(sphere(vec3(-0.3, -0.6, 0.2), 0.4), 3));
    shapes.push(shape(sphere(vec3(0.55, -0.1, -0.4), 0.3), 2));
    shapes.push(shape(
        Geometry::Mesh(Arc::new(cube_mesh(vec3(0.4, 0.3, 0.3), 0.2))),
        0,
    ));
    let camera = Camera::look_at(
        vec3(-0.2, 0.1, 0.9),
        vec3(0.05, -0.2, -0.5),
        vec3(0.0, 1.0, 0.0),
        75.0,
    );
    let mut scene = scene(camera, shapes, vec![Light::Constant { radiance: Rgb::ONE }]);
    scene.materials.push(Material::Mirror {
        reflectance: vec3(0.9, 0.8, 0.7),
        two_sided: false,
    });
    // A window to the sky.
    scene.shapes[0].geometry = Geometry::Rectangle {
        center: vec3(-1.0, -0.3, 0.0),
        u: vec3(0.0, 0.7, 0.0),
        v: vec3(0.0, 0.0, 1.0),
    };
    scene
}

/// Every material that has a density, on shapes of every kind, under a sky with a sun and beside a glowing ring.
fn materials_under_a_sky() -> Scene {
    let camera = Camera::look_at(
        vec3(0.0, 0.5, 3.4),
        vec3(0.0, -0.3, 0.0),
        vec3(0.0, 1.0, 0.0),
        60.0,
    );
    let mut shapes = vec![shape(
        Geometry::Plane {
            point: vec3(0.0, -1.0, 0.0),
            normal: vec3(0.0, 1.0, 0.0),
        },
        3,
    )];
    let frame = [vec3(0.8, 0.0, 0.6), vec3(0.0, 1.0, 0.0), vec3(-0.6, 0.0, 0.8)];
    let solid = |solid| Geometry::Implicit(Arc::new(solid));
    shapes.push(shape(sphere(vec3(-1.0, -0.5, 0.0), 0.5), 4));
    shapes.push(shape(sphere(vec3(0.9, -0.5, 0.4), 0.5), 5));
    let block = Implicit::RoundedBox {
        center: vec3(0.0, -0.6, -0.6),
        axes: frame,
        half: vec3(0.5, 0.4, 0.3),
        radius: 0.1,
    };
    shapes.push(shape(solid(block), 6));
    let post = Implicit::Capsule(Capsule {
        a: vec3(-0.3, -0.8, 0.8),
        b: vec3(0.3, -0.8, 0.9),
        radius: 0.2,
    });
    shapes.push(shape(solid(post), 7));
    let ring = Implicit::Torus {
        center: vec3(0.2, 0.5, 0.0),
        axis: vec3(0.0, 0.6, 0.8),
        major: 0.5,
        minor: 0.12,
    };
    shapes.push(lamp(solid(ring), 2.0, 0));
    let lights = vec![
        Light::Gradient(Gradient {
            zenith: vec3(0.2, 0.4, 0.9),
            horizon: vec3(0.6, 0.5, 0.4),
            ground: Rgb::ZERO,
            up: vec3(0.0, 1.0, 0.0),
        }),
        Light::Sun(Sun {
            direction: vec3(1.0, 1.0, 0.7),
            radiance: vec3(4.0, 3.5, 3.0),
            angle: 40.0,
        }),
        Light::Map(Arc::new(Map {
            width: 4,
            height: 3,
            pixels: (0..12).map(|i| Rgb::splat(f64::from(i % 5) / 10.0)).collect(),
            axes: frame,
        })),
    ];
    let mut scene = scene(camera, shapes, lights);
    let oren_nayar = |model| Material::OrenNayar {
        reflectance: vec3(0.8, 0.6, 0.3),
        sigma: 0.6,
        model,
        two_sided: false,
    };
    scene.materials.extend([
        oren_nayar(OrenNayarModel::EnergyPreserving),
        Material::RoughConductor {
            alpha: 0.4,
            reflectance: Rgb::ONE,
            eta_k: Some((vec3(0.2, 0.9, 1.1), vec3(3.9, 2.4, 2.2))),
            two_sided: false,
        },
        Material::RoughDielectric {
            alpha: 0.8,
            eta: 1.5,
            specular_reflectance: Rgb::ONE,
            specular_transmittance: Rgb::ONE,
        },
        Material::BlinnPhong {
            diffuse: vec3(0.2, 0.4, 0.5),
            specular: Rgb::splat(0.4),
            exponent: 8.0,
            normalized: true,
            two_sided: false,
        },
        oren_nayar(OrenNayarModel::Full),
    ]);
    scene
}

#[test]
fn the_two_estimators_agree_in_the_mean() {
    let lamps = lamps_of_every_kind();
    let materials = materials_under_a_sky();
    for (name, scene, max_depth) in [
        ("lamps", &lamps, Some(2)),
        ("lamps", &lamps, Some(4)),
        ("lamps", &lamps, None),
        ("materials", &materials, Some(2)),
        ("materials", &materials, Some(3)),
    ] {
        // Independent runs give the mean and its standard error.
        let estimate = |estimator, runs: u64, spp| {
            let means: Vec<f64> = (0..runs)
                .map(|seed| {
                    let settings = Settings {
                        width: 12,
                        height: 12,
                        spp,
                        max_depth,
                        seed,
                        estimator,
                        ..Settings::default()
                    };
                    let pixels = picture(scene, &settings).pixels;
                    pixels.iter().map(|p| p[0] + p[1] + p[2]).sum::<f64>() / (3 * pixels.len()) as f64
                })
                .collect();
            let mean = means.iter().sum::<f64>() / runs as f64;
            let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (runs - 1) as f64;
            (mean, variance / runs as f64)
        };
        let (guided, guided_variance) = estimate(Estimator::Guided, 16, 36);
        let (blind, blind_variance) = estimate(Estimator::Blind, 16, 144);
        let sigma = (guided_variance + blind_variance).sqrt();
        println!("{name}, max_depth {max_depth:?}: {guided:.5} and {blind:.5}, sigma {sigma:.5}");
        assert!(sigma / guided < 4e-3, "too noisy to tell: {sigma} of {guided}");
        assert!(
            (guided - blind).abs() < 3.5 * sigma,
            "{name}, {max_depth:?}: {guided} and {blind} differ by more than chance, {sigma}"
        );
    }
}

#[test]
fn the_picture_is_the_same_on_any_number_of_threads() {
    let scene = lamps_of_every_kind();
    let settings = Settings {
        width: 9,
        height: 7,
        spp: 16,
        ..Settings::default()
    };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        let rows = AtomicUsize::new(0);
        let seen = Mutex::new(HashSet::new());
        // No row ends before every thread has one, else a quick thread might do them all.
        let told = |done| {
            rows.fetch_max(done, Relaxed);
            seen.lock().unwrap().insert(rayon::current_thread_index());
            let start = Instant::now();
            while seen.lock().unwrap().len() < threads && start.elapsed() < Duration::from_secs(10) {
                std::thread::yield_now();
            }
        };
        let rendering = pool.install(|| render(&scene, &settings, &told, &AtomicBool::new(false)));
        assert_eq!(
            (rows.into_inner(), seen.into_inner().unwrap().len()),
            (7, threads)
        );
        rendering.expect("nobody cancels")
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert!(one.rays > 9 * 7 * 16);
    let other_seed = picture(&scene, &Settings { seed: 1, ..settings });
    assert_ne!(one.image, other_seed);
}

#[test]
fn a_cancelled_picture_is_none() {
    let scene = lamps_of_every_kind();
    let settings = Settings {
        width: 4,
        height: 8,
        spp: 4,
        ..Settings::default()
    };
    let cancel = AtomicBool::new(false);
    let after_two_rows = |done| cancel.store(done >= 2, Relaxed);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a pool");
    assert_eq!(
        pool.install(|| render(&scene, &settings, &after_two_rows, &cancel)),
        None
    );
}
