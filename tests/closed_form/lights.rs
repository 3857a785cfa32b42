//! One matt surface under one light of each kind: L = ρ/π · E.

use crate::rig::*;
use microlux::geom::{Dir, Unit};
use microlux::integrator::Path;
use microlux::light::Light;
use microlux::material::Material;
use std::f64::consts::PI;

const ORIGIN: Vec3 = [0.0; 3];
const UP: Vec3 = [0.0, 1.0, 0.0];
const PATHS: [Path; 2] = [Path::direct(), Path::new(6)];

/// A matt floor through the origin.
fn floor() -> Stage {
    floor_in(Unit::DEFAULT)
}

fn floor_in(unit: Unit) -> Stage {
    let mut stage = Stage::with_unit(unit);
    let matt = stage.matt(RHO);
    stage.shape(stage.plane(ORIGIN, UP), matt);
    stage
}

/// At the origin of the floor, from aside.
fn view() -> View {
    View::at([1.1, 0.7, 0.6], ORIGIN)
}

/// What a matt surface shows under irradiance `e` times the light's colour.
fn matt(e: f64) -> impl Fn(&Path) -> Vec3 {
    move |_| map2(rounded(RHO), LIGHT, |rho, light| rho / PI * light * e)
}

/// Irradiance of a polygon of unit radiance, seen whole from the origin of a surface (Lambert 1760): ½ Σ Θ (n·Γ).
fn polygon(corners: &[Vec3], normal: Vec3) -> f64 {
    let edge = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        let across = cross(a, b);
        let angle = (dot(a, b) / (norm(a) * norm(b))).acos();
        angle * dot(across, normal) / norm(across)
    };
    0.5 * (0..corners.len()).map(edge).sum::<f64>().abs()
}

fn corners(c: Vec3, u: Vec3, v: Vec3) -> [Vec3; 4] {
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
        .map(|[s, t]| [0, 1, 2].map(|i| c[i] + s * u[i] + t * v[i]))
}

#[test]
fn lambert_agrees_with_the_catalogue() {
    // A rectangle a × b over its corner at height h (Howell, configuration B-4): F = E/π.
    let (x, y) = (0.8f64 / 1.3, 0.5f64 / 1.3);
    let (rx, ry) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    let catalogue = (x / rx * (y / rx).atan() + y / ry * (x / ry).atan()) / (2.0 * PI);
    let quarter = [[0.0, 1.3, 0.0], [0.8, 1.3, 0.0], [0.8, 1.3, 0.5], [0.0, 1.3, 0.5]];
    assert!((polygon(&quarter, UP) / PI / catalogue - 1.0).abs() < 1e-12);
}

#[test]
fn point() {
    for bits in [13, 16, 20] {
        let unit = Unit::new(bits);
        for at in [[0.0, 1.0, 0.0], [-1.3, 0.4, 0.9], [0.02, 0.05, 0.03]] {
            let mut stage = floor_in(unit);
            stage.light(Light::Point {
                position: stage.point(at),
                intensity: radiance(LIGHT),
            });
            let at = at.map(|c| stage.held(c));
            let d = norm(at);
            let near = View {
                half_width: 2e-4,
                ..View::at([0.3, 0.2, 0.1], ORIGIN)
            };
            stage.assert(
                &format!("point at {at:?}, 2^-{bits} m"),
                near.effort(8, 4),
                &PATHS,
                &ALL,
                matt(at[1] / d / (d * d)),
            );
        }
    }
}

#[test]
fn point_over_a_rectangle_disk_and_mesh() {
    let at = [-0.4, 0.9, 0.3];
    let side = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
    for kind in 0..3 {
        let mut stage = Stage::new();
        let [u, v] = side;
        let geometry = match kind {
            0 => stage.rectangle(ORIGIN, u, v),
            1 => stage.disk(ORIGIN, UP, 1.0),
            _ => stage.mesh(&corners(ORIGIN, u, v), &[[0, 1, 2], [0, 2, 3]]),
        };
        let material = stage.matt(RHO);
        stage.shape(geometry, material);
        stage.light(Light::Point {
            position: stage.point(at),
            intensity: radiance(LIGHT),
        });
        let d = norm(at);
        stage.assert(
            &format!("{geometry:?}"),
            view().effort(8, 4),
            &PATHS,
            &ALL,
            matt(at[1] / d / (d * d)),
        );
    }
}

#[test]
fn directional() {
    for towards in [[0.0, -1.0, 0.0], [0.5, -0.7, 0.2], [-0.9, -0.1, 0.3]] {
        let mut stage = floor();
        stage.light(Light::Directional {
            direction: dir(towards),
            irradiance: radiance(LIGHT),
        });
        let cos = -towards[1] / norm(towards);
        stage.assert(
            &format!("directional {towards:?}"),
            view().effort(8, 4),
            &PATHS,
            &ALL,
            matt(cos),
        );
    }
}

#[test]
fn sphere() {
    // (centre, radius): overhead, aside, near the horizon, a grain of dust, a wall of light.
    let spheres = [
        ([0.0, 1.0, 0.0], 0.3),
        ([0.8, 1.2, -0.5], 0.4),
        ([-3.0, 0.6, 1.0], 0.5),
        ([0.3, 1.0, 0.2], 0.01),
        ([-0.2, 1.5, 0.4], 0.001),
        ([0.0, 10.05, 0.0], 10.0),
    ];
    for (center, radius) in spheres {
        let mut stage = floor();
        let black = stage.black();
        stage.emitter(stage.sphere(center, radius), black, LIGHT);
        let radius = stage.held(radius);
        let d = norm(center);
        // E = π L (r/d)² cos θ, as long as no part of it is below the horizon.
        stage.assert(
            &format!("sphere of {radius} at {center:?}"),
            View::at([0.2, 0.025, 0.15], ORIGIN).effort(16, 256),
            &PATHS,
            &PATTERNED,
            matt(PI * (radius / d).powi(2) * center[1] / d),
        );
    }
}

#[test]
fn disk() {
    for (height, radius) in [(1.0, 0.4), (0.3, 0.9), (2.0, 0.01)] {
        let mut stage = floor();
        let black = stage.black();
        stage.emitter(
            stage.disk([0.0, height, 0.0], [0.0, -1.0, 0.0], radius),
            black,
            LIGHT,
        );
        let r2 = stage.held(radius).powi(2);
        stage.assert(
            &format!("disk of {radius} at {height}"),
            View::at([0.5, 0.2, 0.3], ORIGIN),
            &PATHS,
            &PATTERNED,
            matt(PI * r2 / (r2 + height * height)),
        );
    }
}

/// Rectangles (centre, half sides) that face the origin: parallel to the floor, upright on it, aslant.
const RECTANGLES: [(&str, Vec3, Vec3, Vec3); 4] = [
    ("parallel", [0.0, 1.3, 0.0], [0.8, 0.0, 0.0], [0.0, 0.0, 0.5]),
    ("aside", [1.5, 0.7, -0.4], [0.4, 0.0, 0.0], [0.0, 0.0, 0.3]),
    ("upright", [0.0, 0.5, -0.6], [0.7, 0.0, 0.0], [0.0, 0.5, 0.0]),
    ("aslant", [0.9, 1.1, 0.2], [0.0, 0.0, 0.35], [0.3, -0.2, 0.0]),
];

/// Turned so that the normal u × v faces the origin.
fn facing(c: Vec3, u: Vec3, v: Vec3) -> [Vec3; 2] {
    if dot(cross(u, v), c) < 0.0 { [u, v] } else { [v, u] }
}

#[test]
fn rectangle() {
    for (name, c, u, v) in RECTANGLES {
        let mut stage = floor();
        let black = stage.black();
        let [s, t] = facing(c, u, v);
        stage.emitter(stage.rectangle(c, s, t), black, LIGHT);
        stage.assert(
            &format!("rectangle, {name}"),
            View::at([0.1, 0.4, 0.5], ORIGIN).effort(16, 256),
            &PATHS,
            &PATTERNED,
            matt(polygon(&corners(c, u, v), UP)),
        );
    }
}

/// The same rectangles made of triangles: of two, and of five that differ in size.
#[test]
fn mesh() {
    for (name, c, u, v) in RECTANGLES {
        let [s, t] = facing(c, u, v);
        let mut vertices = corners(c, s, t).to_vec();
        // One more corner on the first side, one within.
        let at = |a: f64, b: f64| [0, 1, 2].map(|i| c[i] + a * s[i] + b * t[i]);
        vertices.extend([at(0.3, -1.0), at(0.2, -0.4)]);
        let two: &[[u16; 3]] = &[[0, 1, 2], [0, 2, 3]];
        let five: &[[u16; 3]] = &[[0, 4, 5], [4, 1, 5], [1, 2, 5], [2, 3, 5], [3, 0, 5]];
        for triangles in [two, five] {
            let mut stage = floor();
            let black = stage.black();
            let geometry = stage.mesh(&vertices, triangles);
            stage.emitter(geometry, black, LIGHT);
            stage.assert(
                &format!("{} triangles, {name}", triangles.len()),
                View::at([0.1, 0.4, 0.5], ORIGIN).effort(16, 400),
                &PATHS,
                &PATTERNED,
                matt(polygon(&corners(c, u, v), UP)),
            );
        }
    }
}

#[test]
fn environment() {
    let mut stage = floor();
    stage.environment(LIGHT);
    stage.assert("sky", view(), &PATHS, &ALL, matt(PI));
    // A black wall without end takes half of it away: its form factor is ½ wherever one stands.
    for distance in [0.01, 3.0] {
        let mut stage = floor();
        let black = stage.black();
        stage.shape(stage.plane([0.0, 0.0, -distance], [0.0, 0.0, 1.0]), black);
        stage.environment(LIGHT);
        stage.assert(
            &format!("sky over a wall {distance} m away"),
            view(),
            &PATHS,
            &PATTERNED,
            matt(PI / 2.0),
        );
    }
}

/// Lights add up, each being drawn one time in four.
#[test]
fn all_together() {
    let mut stage = floor();
    let black = stage.black();
    let (_, c, u, v) = RECTANGLES[1];
    let [s, t] = facing(c, u, v);
    stage.emitter(stage.rectangle(c, s, t), black, LIGHT);
    stage.emitter(stage.sphere([-0.9, 0.8, 0.5], 0.3), black, LIGHT);
    stage.light(Light::Point {
        position: stage.point([-0.3, 0.8, -0.6]),
        intensity: radiance(LIGHT),
    });
    stage.light(Light::Directional {
        direction: dir([0.2, -0.7, 0.8]),
        irradiance: radiance(LIGHT),
    });
    let sky = 0.25;
    stage.environment(LIGHT.map(|c| c * sky));
    let rectangle = polygon(&corners(c, u, v), UP);
    let d = norm([-0.9, 0.8, 0.5]);
    let sphere = PI * (0.3 / d).powi(2) * 0.8 / d;
    let d = norm([-0.3, 0.8, -0.6]);
    let point = 0.8 / d.powi(3);
    let parallel = 0.7 / norm([0.2, -0.7, 0.8]);
    // The sky is hidden where the rectangle and the sphere stand.
    let environment = sky * (PI - rectangle - sphere);
    stage.assert(
        "all lights",
        View::at([0.3, 0.9, 0.1], ORIGIN).effort(16, 256),
        &PATHS,
        &PATTERNED,
        matt(rectangle + sphere + point + parallel + environment),
    );
}

/// What stands before a light takes it away, whichever it is.
#[test]
fn shadow() {
    let below = Light::Directional {
        direction: -Dir::Y,
        irradiance: radiance(LIGHT),
    };
    for kind in 0..4 {
        let mut stage = floor();
        let black = stage.black();
        stage.shape(
            stage.rectangle([0.0, 0.4, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
            black,
        );
        let emission = LIGHT;
        match kind {
            0 => stage.light(below),
            1 => stage.light(Light::Point {
                position: stage.point(UP),
                intensity: radiance(LIGHT),
            }),
            2 => stage.emitter(stage.sphere(UP, 0.3), black, emission),
            _ => stage.emitter(stage.disk(UP, [0.0, -1.0, 0.0], 0.3), black, emission),
        }
        stage.assert(
            &format!("shadow {kind}"),
            View::at([0.2, 0.1, 0.1], ORIGIN).effort(8, 16),
            &PATHS,
            &ALL,
            |_| [0.0; 3],
        );
    }
}

/// Flat lights and one-sided surfaces are black from behind.
#[test]
fn from_behind() {
    let (u, v) = ([0.5, 0.0, 0.0], [0.0, 0.0, 0.5]);
    // v × u is up: these lights shine away from the floor, into the camera's face or its back.
    for kind in 0..3 {
        for (name, eye) in [("floor", [0.3, 0.4, 0.2]), ("light", [0.1, 0.3, 0.1])] {
            let mut stage = floor();
            let black = stage.black();
            let geometry = match kind {
                0 => stage.rectangle(UP, v, u),
                1 => stage.disk(UP, UP, 0.5),
                _ => stage.mesh(&corners(UP, v, u), &[[0, 1, 2], [0, 2, 3]]),
            };
            stage.emitter(geometry, black, LIGHT);
            let target = if name == "floor" { ORIGIN } else { UP };
            stage.assert(
                &format!("{name} behind a light, kind {kind}"),
                View::at(eye, target).effort(8, 16),
                &PATHS,
                &ALL,
                |_| [0.0; 3],
            );
        }
    }
    let mut stage = Stage::new();
    let one_sided = stage.material(Material::Lambert {
        albedo: albedo(RHO),
        two_sided: false,
    });
    stage.shape(stage.plane(ORIGIN, UP), one_sided);
    stage.environment(LIGHT);
    let below = View::at([0.2, -0.6, 0.1], ORIGIN).effort(8, 16);
    stage.assert("one-sided, behind", below, &PATHS, &ALL, |_| [0.0; 3]);
    stage.assert(
        "one-sided, in front",
        view().effort(8, 16),
        &PATHS,
        &ALL,
        matt(PI),
    );
    // And a surface that is two-sided is not, under light from its other side.
    let mut stage = floor();
    stage.environment(LIGHT);
    stage.assert("two-sided, behind", below, &PATHS, &ALL, matt(PI));
}
