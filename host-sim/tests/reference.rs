//! The f64 reference against closed forms, and its two estimators against each other.

use std::f64::consts::PI;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};

use host_sim::reference::{
    Camera, Estimator, Geometry, Image, Lens, Light, Material, Mesh, Rgb, Scene, Settings, Shape, Vec3,
    closest, extent, primary_ray, render, vec3,
};

const WHITE: Material = Material::Diffuse {
    reflectance: Rgb::splat(0.5),
    two_sided: false,
};
const GLASS: Material = Material::Dielectric {
    eta: 1.5,
    specular_reflectance: Rgb::ONE,
    specular_transmittance: Rgb::ONE,
};

fn shape(geometry: Geometry, material: usize) -> Shape {
    Shape {
        geometry,
        material,
        emission: None,
        id: 0,
    }
}

fn lamp(geometry: Geometry, radiance: f64, material: usize) -> Shape {
    Shape {
        emission: Some(Rgb::splat(radiance)),
        ..shape(geometry, material)
    }
}

fn floor() -> Geometry {
    Geometry::Plane {
        point: Vec3::ZERO,
        normal: vec3(0.0, 1.0, 0.0),
    }
}

fn sphere(center: Vec3, radius: f64) -> Geometry {
    Geometry::Sphere { center, radius }
}

/// A camera that sees nothing but the origin, from the side.
fn peephole() -> Camera {
    Camera::look_at(vec3(-3.0, 0.4, 0.0), Vec3::ZERO, vec3(0.0, 1.0, 0.0), 1e-5)
}

/// Materials 0: diffuse one half, 1: black, 2: glass.
fn scene(camera: Camera, shapes: Vec<Shape>, lights: Vec<Light>) -> Scene {
    Scene {
        camera,
        shapes,
        materials: vec![WHITE, Material::Black, GLASS],
        lights,
    }
}

fn picture(scene: &Scene, settings: &Settings) -> Image {
    render(scene, settings, &|_| (), &AtomicBool::new(false))
        .expect("nobody cancels")
        .image
}

/// The one pixel's red channel.
fn pixel(scene: &Scene, spp: u32, max_depth: u32) -> f64 {
    let settings = Settings {
        spp,
        max_depth: Some(max_depth),
        ..Settings::default()
    };
    picture(scene, &settings).pixels[0][0]
}

#[track_caller]
fn assert_near(value: f64, expected: f64, relative: f64) {
    let error = (value / expected - 1.0).abs();
    assert!(
        error <= relative,
        "{value} is not {expected}: off by {error:.2e}, allowed {relative:.0e}"
    );
}

#[test]
fn a_point_light_falls_off_with_the_square_of_the_distance() {
    let light = Light::Point {
        position: vec3(1.0, 2.0, 0.5),
        intensity: Rgb::splat(7.0),
    };
    let lit = scene(peephole(), vec![shape(floor(), 0)], vec![light]);
    let d2: f64 = 1.0 + 4.0 + 0.25;
    for max_depth in [2, 5] {
        assert_near(
            pixel(&lit, 4, max_depth),
            0.5 / PI * 7.0 / d2 * (2.0 / d2.sqrt()),
            1e-6,
        );
    }
    assert_eq!(pixel(&lit, 4, 1), 0.0);
}

#[test]
fn a_directional_light_falls_with_the_cosine_and_casts_shadows() {
    let light = Light::Directional {
        direction: vec3(3.0, -4.0, 0.0),
        irradiance: Rgb::splat(2.0),
    };
    let mut lit = scene(peephole(), vec![shape(floor(), 0)], vec![light]);
    assert_near(pixel(&lit, 4, 2), 0.5 / PI * 2.0 * 0.8, 1e-12);
    lit.shapes.push(shape(sphere(vec3(-300.0, 400.0, 0.0), 1.0), 1));
    assert_eq!(pixel(&lit, 4, 2), 0.0);
}

#[test]
fn a_sphere_lights_by_its_solid_angle_from_near_and_far() {
    // E = πL (r/d)² for a sphere that is wholly above the plane, straight overhead.
    for distance in [1.001, 1.1, 2.0, 50.0] {
        let bulb = lamp(sphere(vec3(0.0, distance, 0.0), 1.0), 3.0, 1);
        let eye = Camera::look_at(vec3(-0.5, 1e-4, 0.0), Vec3::ZERO, vec3(0.0, 1.0, 0.0), 1e-7);
        let lit = scene(eye, vec![shape(floor(), 0), bulb], vec![]);
        assert_near(pixel(&lit, 16384, 2), 0.5 * 3.0 / (distance * distance), 1e-3);
    }
}

#[test]
fn a_sphere_aside_lights_with_the_cosine_of_its_centre() {
    let center = vec3(2.0, 3.0, -1.0);
    let lit = scene(
        peephole(),
        vec![shape(floor(), 0), lamp(sphere(center, 1.5), 3.0, 1)],
        vec![],
    );
    let d2: f64 = center.dot(center);
    assert_near(
        pixel(&lit, 16384, 2),
        0.5 * 3.0 * 2.25 / d2 * (3.0 / d2.sqrt()),
        1e-3,
    );
}

#[test]
fn a_sphere_is_dark_inside() {
    let lit = scene(
        peephole(),
        vec![shape(floor(), 0), lamp(sphere(Vec3::ZERO, 10.0), 3.0, 1)],
        vec![],
    );
    assert_eq!(pixel(&lit, 256, 3), 0.0);
}

#[test]
fn a_disk_lights_the_point_below_its_centre() {
    // E = πL r²/(r² + h²).
    for (radius, height) in [(0.1, 1.0), (2.0, 0.5)] {
        let disk = Geometry::Disk {
            center: vec3(0.0, height, 0.0),
            normal: vec3(0.0, -2.0, 0.0),
            radius,
        };
        let lit = scene(peephole(), vec![shape(floor(), 0), lamp(disk, 4.0, 1)], vec![]);
        let expected = 0.5 * 4.0 * radius * radius / (radius * radius + height * height);
        assert_near(pixel(&lit, 16384, 2), expected, 1e-3);
    }
}

/// A rectangle `width` × `depth` at `height`, facing down, with a corner above the origin.
fn corner_rectangle(width: f64, depth: f64, height: f64) -> Geometry {
    let center = vec3(width / 2.0, height, depth / 2.0);
    Geometry::Rectangle {
        center,
        u: vec3(width / 2.0, 0.0, 0.0),
        v: vec3(0.0, 0.0, depth / 2.0),
    }
}

/// Form factor of `corner_rectangle` from the origin: Howell's catalogue of configuration factors, B-3.
fn corner_form_factor(width: f64, depth: f64, height: f64) -> f64 {
    let (a, b) = (width / height, depth / height);
    let (ra, rb) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    (a / ra * (b / ra).atan() + b / rb * (a / rb).atan()) / (2.0 * PI)
}

#[test]
fn a_rectangle_lights_by_its_form_factor_and_only_forwards() {
    let rectangle = corner_rectangle(1.5, 0.7, 0.9);
    let lit = scene(
        peephole(),
        vec![shape(floor(), 0), lamp(rectangle.clone(), 4.0, 1)],
        vec![],
    );
    assert_near(
        pixel(&lit, 16384, 2),
        0.5 * 4.0 * corner_form_factor(1.5, 0.7, 0.9),
        1e-3,
    );
    let Geometry::Rectangle { center, u, v } = rectangle else {
        unreachable!()
    };
    let turned = Geometry::Rectangle { center, u: v, v: u };
    let dark = scene(peephole(), vec![shape(floor(), 0), lamp(turned, 4.0, 1)], vec![]);
    assert_eq!(pixel(&dark, 64, 2), 0.0);
}

#[test]
fn a_mesh_lights_as_the_rectangle_it_covers() {
    // Two unequal triangles, so that a wrong share of the area shows: the corner cut at a quarter and the rest as fan.
    let vertices = vec![
        vec3(0.0, 0.9, 0.0),
        vec3(1.5, 0.9, 0.0),
        vec3(1.5, 0.9, 0.7),
        vec3(0.0, 0.9, 0.7),
        vec3(0.4, 0.9, 0.0),
    ];
    let triangles = vec![[0, 4, 3], [4, 2, 3], [4, 1, 2]];
    let mesh = Geometry::Mesh(Arc::new(Mesh::new(vertices, triangles, vec![])));
    let lit = scene(peephole(), vec![shape(floor(), 0), lamp(mesh, 4.0, 1)], vec![]);
    assert_near(
        pixel(&lit, 16384, 2),
        0.5 * 4.0 * corner_form_factor(1.5, 0.7, 0.9),
        1e-3,
    );
}

#[test]
fn a_constant_sky_over_a_convex_body_gives_its_albedo() {
    let sky = || {
        vec![
            Light::Constant {
                radiance: Rgb::splat(1.75),
            },
            Light::Constant {
                radiance: Rgb::splat(0.25),
            },
        ]
    };
    for body in [floor(), sphere(vec3(0.0, -1.0, 0.0), 1.0)] {
        let lit = scene(peephole(), vec![shape(body, 0)], sky());
        for max_depth in [2, 7] {
            assert_near(pixel(&lit, 64, max_depth), 0.5 * 2.0, 1e-12);
        }
    }
    let empty = scene(peephole(), vec![], sky());
    assert_eq!(pixel(&empty, 4, 1), 2.0);
    assert_eq!(pixel(&empty, 4, 0), 0.0);
    let hidden = Settings {
        spp: 4,
        hide_emitters: true,
        ..Settings::default()
    };
    assert_eq!(picture(&empty, &hidden).pixels[0][0], 0.0);
}

/// A cube of edge 2 around the origin whose walls face inwards.
fn room(emission: Option<Rgb>) -> Vec<Shape> {
    let axes = [vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0)];
    let mut walls = Vec::new();
    for axis in 0..3 {
        let (n, u, v) = (axes[axis], axes[(axis + 1) % 3], axes[(axis + 2) % 3]);
        walls.push(Geometry::Rectangle { center: -n, u, v });
        walls.push(Geometry::Rectangle {
            center: n,
            u: v,
            v: u,
        });
    }
    walls
        .into_iter()
        .map(|geometry| Shape {
            emission,
            ..shape(geometry, 0)
        })
        .collect()
}

#[test]
fn a_furnace_glows_with_the_geometric_series() {
    let furnace = scene(peephole(), room(Some(Rgb::splat(1.0))), vec![]);
    let inside = Camera {
        origin: vec3(0.2, 0.1, 0.3),
        ..peephole()
    };
    let furnace = Scene {
        camera: inside,
        ..furnace
    };
    for max_depth in 1..5 {
        let expected = 2.0 - 0.5f64.powi(max_depth as i32 - 1);
        assert_near(pixel(&furnace, 16384, max_depth), expected, 3e-3);
    }
    let unlimited = Settings {
        spp: 16384,
        ..Settings::default()
    };
    assert_near(picture(&furnace, &unlimited).pixels[0][0], 2.0, 3e-3);
    // Roulette from the first segment on must not change the mean.
    let roulette = Settings {
        rr_depth: 1,
        ..unlimited
    };
    assert_near(picture(&furnace, &roulette).pixels[0][0], 2.0, 5e-3);
}

#[test]
fn a_one_sided_surface_is_black_from_behind() {
    let sky = vec![Light::Constant { radiance: Rgb::ONE }];
    let ceiling = Geometry::Plane {
        point: Vec3::ZERO,
        normal: vec3(0.0, -1.0, 0.0),
    };
    let mut behind = scene(peephole(), vec![shape(ceiling, 0)], sky);
    assert_eq!(pixel(&behind, 16, 4), 0.0);
    behind.materials[0] = Material::Diffuse {
        reflectance: Rgb::splat(0.5),
        two_sided: true,
    };
    assert_near(pixel(&behind, 16, 4), 0.5, 1e-12);
    behind.materials[0] = Material::Mirror {
        reflectance: Rgb::splat(0.5),
        two_sided: false,
    };
    assert_eq!(pixel(&behind, 16, 4), 0.0);
    behind.materials[0] = Material::Mirror {
        reflectance: Rgb::splat(0.5),
        two_sided: true,
    };
    assert_near(pixel(&behind, 16, 4), 0.5, 1e-12);
}

#[test]
fn a_mirror_shows_what_lies_in_the_reflected_direction() {
    // The eye at (-3, 0.4, 0) sees by the floor what it would see at (3, 0.4, 0).
    let bulb = lamp(sphere(vec3(3.0, 0.4, 0.0), 0.01), 5.0, 1);
    let mut mirrored = scene(peephole(), vec![shape(floor(), 0), bulb], vec![]);
    mirrored.materials[0] = Material::Mirror {
        reflectance: Rgb::splat(0.8),
        two_sided: false,
    };
    assert_near(pixel(&mirrored, 16, 2), 4.0, 1e-12);
    assert_eq!(pixel(&mirrored, 16, 1), 0.0);
}

#[test]
fn lossless_glass_in_a_uniform_sky_is_invisible() {
    let camera = Camera::look_at(vec3(-3.0, 0.4, 0.1), Vec3::ZERO, vec3(0.0, 1.0, 0.0), 50.0);
    let cube = cube_mesh(vec3(0.1, 0.2, 0.0), 0.6);
    for glass in [sphere(Vec3::ZERO, 1.0), Geometry::Mesh(Arc::new(cube))] {
        let furnace = scene(
            camera,
            vec![shape(glass, 2)],
            vec![Light::Constant {
                radiance: Rgb::splat(2.0),
            }],
        );
        let settings = Settings {
            width: 8,
            height: 8,
            spp: 256,
            rr_depth: 4000,
            max_depth: Some(4000),
            ..Settings::default()
        };
        for [r, _, _] in picture(&furnace, &settings).pixels {
            assert_near(r, 2.0, 1e-12);
        }
    }
}

#[test]
fn radiance_inside_glass_is_scaled_by_the_square_of_the_index() {
    let inside = Camera {
        origin: Vec3::ZERO,
        ..peephole()
    };
    let sky = vec![Light::Constant { radiance: Rgb::ONE }];
    let ball = scene(inside, vec![shape(sphere(Vec3::ZERO, 1.0), 2)], sky);
    // From the centre every ray leaves at once or, by 4 %, after some more crossings.
    let settings = Settings {
        spp: 64,
        max_depth: Some(400),
        rr_depth: 400,
        ..Settings::default()
    };
    assert_near(picture(&ball, &settings).pixels[0][0], 2.25, 1e-12);
}

#[test]
fn a_glass_slab_transmits_what_its_two_faces_let_through() {
    // At normal incidence F = 0.04, and all internal reflections together give T = (1 − F)/(1 + F).
    let camera = Camera::look_at(vec3(0.0, 3.0, 0.0), Vec3::ZERO, vec3(0.0, 0.0, 1.0), 1e-3);
    let lower = Geometry::Plane {
        point: vec3(0.0, -0.5, 0.0),
        normal: vec3(0.0, -1.0, 0.0),
    };
    let panel = Geometry::Disk {
        center: vec3(0.0, -2.0, 0.0),
        normal: vec3(0.0, 1.0, 0.0),
        radius: 1.0,
    };
    let slab = scene(
        camera,
        vec![shape(floor(), 2), shape(lower, 2), lamp(panel, 5.0, 1)],
        vec![],
    );
    assert_near(pixel(&slab, 1 << 16, 60), 5.0 * 0.96 / 1.04, 3e-3);
}

#[test]
fn roulette_inside_glass_keeps_the_mean() {
    let inside = Camera::look_at(vec3(-3.0, 0.4, 0.1), Vec3::ZERO, vec3(0.0, 1.0, 0.0), 30.0);
    let ball = scene(
        inside,
        vec![shape(sphere(Vec3::ZERO, 1.0), 2)],
        vec![Light::Constant { radiance: Rgb::ONE }],
    );
    let settings = Settings {
        width: 8,
        height: 8,
        spp: 1024,
        rr_depth: 1,
        ..Settings::default()
    };
    let pixels = picture(&ball, &settings).pixels;
    assert_near(pixels.iter().map(|p| p[0]).sum::<f64>() / 64.0, 1.0, 5e-3);
}

#[test]
fn a_lens_is_sharp_in_its_plane_and_blurs_a_point_behind_it_to_its_circle() {
    let look = |focus_distance| {
        let camera = Camera::look_at(vec3(0.0, 0.0, 4.0), Vec3::ZERO, vec3(0.0, 1.0, 0.0), 90.0);
        let camera = Camera {
            lens: Some(Lens {
                aperture_radius: 0.5,
                focus_distance,
            }),
            ..camera
        };
        // A panel as wide as one of the 3 pixels (4 · 2/3) in the plane z = 0.
        let half = 4.0 / 3.0;
        let panel = Geometry::Rectangle {
            center: Vec3::ZERO,
            u: vec3(half, 0.0, 0.0),
            v: vec3(0.0, half, 0.0),
        };
        let panel = scene(camera, vec![lamp(panel, 1.0, 1)], vec![]);
        let settings = Settings {
            width: 3,
            height: 3,
            spp: 1024,
            ..Settings::default()
        };
        picture(&panel, &settings)
            .pixels
            .iter()
            .map(|p| p[0])
            .collect::<Vec<_>>()
    };
    let sharp = look(4.0);
    assert_near(sharp[4], 1.0, 1e-12);
    assert_eq!(sharp.iter().sum::<f64>(), sharp[4]);
    // Focused at 8, what leaves the lens at x passes z = 0 at half its distance to the axis: the picture of a pixel
    // is shifted by x/2, so of the 8/3 of the panel's width |x|/2 is lost. E|x| = 4·0.5/(3π), and the same for y, with
    // E|xy| = 0.25/(2π): the mean of (1 − 3|x|/16)(1 − 3|y|/16).
    let mean_x = 4.0 * 0.5 / (3.0 * PI);
    let mean_xy = 0.25 / (2.0 * PI);
    let expected = 1.0 - 2.0 * (3.0 / 16.0) * mean_x + (9.0 / 256.0) * mean_xy;
    assert_near(look(8.0)[4], expected, 1e-2);
}

#[test]
fn hidden_emitters_let_the_camera_see_through_but_still_light() {
    let eye = Camera::look_at(vec3(0.0, 3.0, 0.0), Vec3::ZERO, vec3(0.0, 0.0, 1.0), 1e-5);
    let disk = Geometry::Disk {
        center: vec3(0.0, 1.0, 0.0),
        normal: vec3(0.0, -1.0, 0.0),
        radius: 1.0,
    };
    let lit = scene(eye, vec![shape(floor(), 0), lamp(disk, 4.0, 1)], vec![]);
    assert_eq!(pixel(&lit, 16, 2), 0.0);
    let hidden = Settings {
        spp: 16384,
        max_depth: Some(2),
        hide_emitters: true,
        ..Settings::default()
    };
    assert_near(picture(&lit, &hidden).pixels[0][0], 0.5 * 4.0 * 0.5, 1e-3);
}

fn cube_mesh(center: Vec3, half: f64) -> Mesh {
    let corner = |i: u32| {
        let sign = |bit: u32| if i >> bit & 1 == 1 { half } else { -half };
        center + vec3(sign(0), sign(1), sign(2))
    };
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    Mesh::new((0..8).map(corner).collect(), triangles, vec![])
}

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

#[test]
fn the_two_estimators_agree_in_the_mean() {
    let scene = lamps_of_every_kind();
    for max_depth in [Some(2), Some(4), None] {
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
                    let pixels = picture(&scene, &settings).pixels;
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
        println!("max_depth {max_depth:?}: {guided:.5} and {blind:.5}, sigma {sigma:.5}");
        assert!(sigma / guided < 4e-3, "too noisy to tell: {sigma} of {guided}");
        assert!(
            (guided - blind).abs() < 3.5 * sigma,
            "{guided} and {blind} differ by more than chance, {sigma}"
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
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        let rows = AtomicUsize::new(0);
        let told = |done| {
            rows.fetch_max(done, Relaxed);
        };
        let rendering = pool.install(|| render(&scene, &settings, &told, &AtomicBool::new(false)));
        assert_eq!(rows.into_inner(), 7);
        rendering.expect("nobody cancels")
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert!(one.rays > 9 * 7 * 16);
    let other_seed = picture(&scene, &Settings { seed: 1, ..settings });
    assert_ne!(one.image, other_seed);
    assert_eq!(render(&scene, &settings, &|_| (), &AtomicBool::new(true)), None);
}

#[test]
fn primary_rays_hit_where_geometry_says() {
    let camera = Camera::look_at(vec3(0.0, 0.0, 5.0), Vec3::ZERO, vec3(0.0, 1.0, 0.0), 90.0);
    let mut shapes = vec![shape(sphere(Vec3::ZERO, 1.0), 0)];
    shapes.push(shape(
        Geometry::Mesh(Arc::new(cube_mesh(vec3(3.0, 0.0, 0.0), 1.0))),
        0,
    ));
    let scene = scene(camera, shapes, vec![]);
    assert_near(extent(&scene), (25.0f64 + 4.0 + 4.0).sqrt(), 1e-15);

    let hit =
        closest(&scene, &primary_ray(&scene, [40, 20], 20.0, 10.0)).expect("the middle shows the sphere");
    assert!((hit.t - 4.0).abs() < 1e-15 && (hit.point - vec3(0.0, 0.0, 1.0)).length() < 1e-15);
    assert!(hit.front && hit.shape == 0 && hit.triangle.is_none() && hit.normal == vec3(0.0, 0.0, 1.0));

    // x = 4·(2/40)·px − 4·... : in the plane z = 1 the picture is 8 wide and 4 high, and y runs down.
    let hit = closest(&scene, &primary_ray(&scene, [40, 20], 34.0, 8.0)).expect("the cube's front");
    assert!(
        (hit.point - vec3(2.8, 0.4, 1.0)).length() < 1e-14,
        "{:?}",
        hit.point
    );
    assert!(hit.shape == 1 && hit.normal == vec3(0.0, 0.0, 1.0) && matches!(hit.triangle, Some(10 | 11)));
    assert!(closest(&scene, &primary_ray(&scene, [40, 20], 0.5, 0.5)).is_none());
}
