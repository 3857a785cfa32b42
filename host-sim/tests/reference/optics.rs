//! Mirrors, glass, and the sides of surfaces.

use super::*;

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
fn a_shading_normal_bends_light_but_lets_none_through() {
    // A square in the plane z = 0 that faces +z, whose normals lean to +x.
    let vertices = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| vec3(x, y, 0.0));
    let leaning = vec3(0.8, 0.0, 0.6);
    let mesh = Mesh::new(vertices.to_vec(), vec![[0, 1, 2], [0, 2, 3]], vec![leaning; 4]);
    let mesh = Geometry::Mesh(Arc::new(mesh));
    let seen = |eye, towards_light: Vec3| {
        let camera = Camera::look_at(eye, vec3(0.1, 0.2, 0.0), vec3(0.0, 1.0, 0.0), 1e-5);
        let light = Light::Directional {
            direction: -towards_light,
            irradiance: Rgb::splat(2.0),
        };
        pixel(&scene(camera, vec![shape(mesh.clone(), 0)], vec![light]), 4, 2)
    };
    let overhead = vec3(0.0, 0.0, 1.0);
    assert_near(
        seen(vec3(0.5, 0.0, 3.0), overhead),
        0.5 / std::f64::consts::PI * 2.0 * 0.6,
        1e-12,
    );
    // The light is behind the face, though before the leaning normal.
    assert_eq!(seen(vec3(0.5, 0.0, 3.0), vec3(1.0, 0.0, -0.1)), 0.0);
    // The eye is before the face, though behind the leaning normal: it sees the face itself.
    assert_near(
        seen(vec3(-3.0, 0.0, 1.0), overhead),
        0.5 / std::f64::consts::PI * 2.0,
        1e-12,
    );
}
