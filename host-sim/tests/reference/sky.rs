//! Light from all around.

use std::f64::consts::PI;

use host_sim::reference::{Gradient, Map, Sky, Sun};

use super::chi_square::{Random, assert_samples_follow, sphere_integral};
use super::*;

fn gradient(up: Vec3) -> Gradient {
    Gradient {
        zenith: vec3(0.2, 0.5, 2.0),
        horizon: vec3(1.0, 1.2, 0.9),
        ground: vec3(0.1, 0.05, 0.0),
        up,
    }
}

/// The same as `mi.load_dict({'type': 'envmap', 'bitmap': mi.Bitmap(pixels)})` below: 6 × 4 pixels of small fractions.
fn small_map() -> Map {
    let (width, height) = (6, 4);
    let pixel = |n: usize| {
        let (i, j) = (n % width, n / width);
        let part = |numerator: usize, over: f64| numerator as f64 / over;
        vec3(
            part(1 + i + 10 * j, 10.0),
            part((3 * i + 5 * j) % 7, 7.0),
            0.25 * part((i * j) % 3, 1.0),
        )
    };
    Map {
        width,
        height,
        pixels: (0..width * height).map(pixel).collect(),
        axes: [vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0)],
    }
}

/// Mitsuba 3.9.1, scalar_rgb: `emitter.eval(si)` with `si.wi` = −direction.
#[test]
fn a_map_is_seen_as_in_mitsuba() {
    let sky = Sky::map(Arc::new(small_map())).expect("it is not black");
    let cases = [
        ([0.0, 0.0, 1.0], [1.85, 0.3928572, 0.1875]),
        ([0.0, 0.0, -1.0], [1.85, 0.6428571, 0.1875]),
        ([1.0, 0.0, 0.0], [1.7, 0.5, 0.375]),
        ([-1.0, 0.0, 0.0], [2.0, 0.2857143, 0.375]),
        ([0.48, 0.6, 0.64], [1.174052, 0.5550718, 0.4174038]),
        ([-0.48, -0.6, 0.64], [2.525948, 0.6292543, 0.05069415]),
        ([0.6, 0.48, -0.64], [1.143831, 0.5875676, 0.05600234]),
        ([-0.1, 0.2, -0.9], [1.695259, 0.7172604, 0.2585569]),
        ([0.01, 0.99, 0.02], [0.3272903, 0.8182676, 0.01016536]),
        ([0.05, 0.1, -1.0], [1.731088, 0.6632015, 0.1803586]),
    ];
    for (direction, expected) in cases {
        let seen = sky.radiance(Vec3::from(direction).normalized());
        let error = (seen - Vec3::from(expected)).abs().max_component();
        assert!(error < 2e-6, "{direction:?}: {seen:?} is not {expected:?}");
    }
}

fn skies() -> Vec<(&'static str, Sky)> {
    let turned = [vec3(0.6, 0.0, 0.8), vec3(0.0, 1.0, 0.0), vec3(-0.8, 0.0, 0.6)];
    let map = |axes| Sky::map(Arc::new(Map { axes, ..small_map() }));
    let sun = |angle| Sun {
        direction: vec3(0.0, 3.0, -4.0),
        radiance: vec3(7.0, 6.0, 5.0),
        angle,
    };
    let dark_below = Gradient {
        horizon: Rgb::ZERO,
        ground: Rgb::ZERO,
        ..gradient(vec3(0.3, 1.0, 0.2))
    };
    [
        ("a gradient", Sky::gradient(gradient(vec3(0.0, 2.0, 0.0)))),
        ("a turned gradient", Sky::gradient(gradient(vec3(0.3, -1.0, 0.2)))),
        ("a sky that is dark below", Sky::gradient(dark_below)),
        ("a map", map(small_map().axes)),
        ("a turned map", map(turned)),
        ("a large sun", Sky::sun(sun(60.0))),
    ]
    .map(|(name, sky)| (name, sky.expect("none of them is dark")))
    .into()
}

#[test]
fn directions_follow_their_density_and_the_density_the_light() {
    for (name, sky) in skies() {
        let mut random = Random::new(1);
        let mut draw = || sky.sample([random.uniform(), random.uniform()]);
        // The test's cells cut the sun's rim and a map's cells; there it is the moments that tell.
        if !name.contains("sun") && !name.contains("map") {
            assert_samples_follow(name, |w| sky.pdf(w), || Some(draw()));
        }
        let share = sphere_integral(|w| sky.pdf(w));
        assert!(
            (share - 1.0).abs() < 3e-3,
            "{name}: the density integrates to {share}"
        );
        // Whatever is integrated: E[g/pdf] = ∫ g.
        for axis in 0..4 {
            let g = |w: Vec3| {
                let light = sky.radiance(w);
                if axis == 3 {
                    light.x
                } else {
                    light.y * (w.get(axis) + 1.0)
                }
            };
            let expected = sphere_integral(g);
            let samples = 200_000;
            let (mut sum, mut squares) = (0.0, 0.0);
            for _ in 0..samples {
                let w = draw();
                let pdf = sky.pdf(w);
                assert!(pdf > 0.0, "{name}: {w:?} has no density");
                assert!((w.length() - 1.0).abs() < 1e-12);
                let estimate = g(w) / pdf;
                sum += estimate;
                squares += estimate * estimate;
            }
            let mean = sum / f64::from(samples);
            let deviation = (squares / f64::from(samples) - mean * mean).max(0.0).sqrt();
            let sigma = deviation / f64::from(samples).sqrt();
            assert!(
                (mean - expected).abs() < 4.0 * sigma + 2e-3 * expected,
                "{name}, moment {axis}: {mean} is not {expected}, sigma {sigma}"
            );
        }
    }
}

#[test]
fn no_light_is_no_sky() {
    let dark = Gradient {
        zenith: Rgb::ZERO,
        horizon: Rgb::ZERO,
        ground: Rgb::ZERO,
        up: vec3(0.0, 1.0, 0.0),
    };
    assert!(Sky::gradient(dark).is_none());
    let mut map = small_map();
    map.pixels.fill(Rgb::ZERO);
    assert!(Sky::map(Arc::new(map)).is_none());
}

#[test]
fn a_gradient_lights_the_floor_by_its_closed_form() {
    // E = ∫ (h + s (z − h)) cosθ dω with s = cosθ: π h + 2π/3 (z − h).
    let (zenith, horizon) = (3.0, 0.5);
    let sky = Gradient {
        zenith: Rgb::splat(zenith),
        horizon: Rgb::splat(horizon),
        ground: Rgb::splat(9.0),
        up: vec3(0.0, 1.0, 0.0),
    };
    let lit = scene(peephole(), vec![shape(floor(), 0)], vec![Light::Gradient(sky)]);
    let expected = 0.5 * (horizon + 2.0 / 3.0 * (zenith - horizon));
    assert_near(pixel(&lit, 16384, 2), expected, 1e-3);
    // What the camera sees of it, and that it can be hidden: the peephole looks down by a sine of 0.4 / |(3, 0.4)|.
    let open = scene(peephole(), vec![], lit.lights);
    let s = 0.4 / 3f64.hypot(0.4);
    assert_near(pixel(&open, 4, 1), horizon + s * (9.0 - horizon), 1e-6);
    let hidden = Settings {
        spp: 4,
        hide_emitters: true,
        ..Settings::default()
    };
    assert_eq!(picture(&open, &hidden).pixels[0][0], 0.0);
}

#[test]
fn a_sun_lights_the_floor_by_its_irradiance() {
    // E = π sin²(angle/2) L cosθ while the whole disk is above the horizon.
    for angle in [0.533f64, 10.0] {
        let sun = Sun {
            direction: vec3(3.0, 4.0, 0.0),
            radiance: Rgb::splat(50.0),
            angle,
        };
        let lit = scene(peephole(), vec![shape(floor(), 0)], vec![Light::Sun(sun)]);
        let sin = (angle.to_radians() / 2.0).sin();
        assert_near(
            pixel(&lit, 16384, 2),
            0.5 / PI * (PI * sin * sin * 50.0 * 0.8),
            1e-4,
        );
    }
}

#[test]
fn a_grey_map_is_a_constant_sky() {
    let grey = Map {
        pixels: vec![Rgb::splat(2.0); 24],
        ..small_map()
    };
    let lit = scene(
        peephole(),
        vec![shape(floor(), 0)],
        vec![Light::Map(Arc::new(grey))],
    );
    assert_near(pixel(&lit, 4096, 2), 1.0, 2e-3);
}

#[test]
fn ambient_occlusion_is_one_less_the_form_factor_of_what_is_near() {
    let seen = |shapes: Vec<Shape>, radius: f64| {
        let settings = Settings {
            spp: 16384,
            estimator: host_sim::reference::Estimator::AmbientOcclusion { radius },
            ..Settings::default()
        };
        // Lights do not count, nor what a material does.
        let lights = vec![Light::Constant {
            radiance: Rgb::splat(9.0),
        }];
        picture(&scene(peephole(), shapes, lights), &settings).pixels[0]
    };
    let disk = |y: f64| Geometry::Disk {
        center: vec3(0.0, y, 0.0),
        normal: vec3(0.0, 1.0, 0.0),
        radius: 1.0,
    };
    let endless = f64::INFINITY;
    assert_eq!(seen(vec![], endless), [0.0; 3]);
    assert_eq!(seen(vec![shape(floor(), 1)], endless), [1.0; 3]);
    let under = |radius| seen(vec![shape(floor(), 0), lamp(disk(0.5), 3.0, 1)], radius);
    assert_near(under(endless)[0], 1.0 - 1.0 / 1.25, 1e-2);
    assert_eq!(under(0.49), [1.0; 3]);
    // Within 0.6 the disk hides directions up to cosθ = 0.5/0.6: sin²θ of the cosine-weighted hemisphere.
    assert_near(under(0.6)[1], (0.5f64 / 0.6).powi(2), 5e-3);
    // From below, the side of the eye counts.
    assert_eq!(seen(vec![shape(disk(0.0), 0)], endless), [1.0; 3]);
}
