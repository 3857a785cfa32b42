//! Each kind of light over a diffuse floor, and the furnace.

use std::f64::consts::PI;

use super::*;

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
