//! Camera, lens, hits, and what the film shows.

use std::f64::consts::PI;

use host_sim::reference::{Lens, closest, extent, primary_ray};

use super::*;

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

    // In the plane z = 1 the picture is 8 wide and 4 high, and y runs down.
    let hit = closest(&scene, &primary_ray(&scene, [40, 20], 34.0, 8.0)).expect("the cube's front");
    assert!(
        (hit.point - vec3(2.8, 0.4, 1.0)).length() < 1e-14,
        "{:?}",
        hit.point
    );
    assert!(hit.shape == 1 && hit.normal == vec3(0.0, 0.0, 1.0) && matches!(hit.triangle, Some(10 | 11)));
    assert!(closest(&scene, &primary_ray(&scene, [40, 20], 0.5, 0.5)).is_none());
}

#[test]
fn a_hit_lies_on_its_sphere_from_a_million_radii_away() {
    let center = vec3(0.3, -0.2, 0.1);
    let camera = Camera::look_at(vec3(1e6, 2e5, -3e5), center, vec3(0.0, 1.0, 0.0), 1e-4);
    let far = scene(camera, vec![shape(sphere(center, 1.0), 0)], vec![]);
    for step in 0..8 {
        let ray = primary_ray(&far, [8, 8], f64::from(step), 4.0);
        let hit = closest(&far, &ray).expect("the sphere fills the middle");
        assert!(((hit.point - center).length() - 1.0).abs() < 1e-15);
        assert!((hit.point - ray.at(hit.t)).length() < 1e-8);
    }
}
