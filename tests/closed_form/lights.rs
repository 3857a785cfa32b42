//! One matt surface under one light of each kind: L = ρ/π · E.

use crate::rig::*;
use microlux::color::Rgb9e5;
use microlux::geom::{Dir, Unit};
use microlux::integrator::Path;
use microlux::light::{Light, Map, MapParts, Sky};
use microlux::material::Material;
use microlux::num::Turn;
use std::f64::consts::PI;

const ORIGIN: Vec3 = [0.0; 3];
const UP: Vec3 = [0.0, 1.0, 0.0];
const PATHS: [Path; 2] = [Path::direct(), Path::new(6)];

/// A matt floor through the origin.
fn floor() -> Stage<'static> {
    floor_in(Unit::DEFAULT)
}

fn floor_in(unit: Unit) -> Stage<'static> {
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

/// What a matt surface shows under irradiance `e`, by channel.
fn matt_under(e: Vec3) -> impl Fn(&Path) -> Vec3 {
    move |_| map2(rounded(RHO), e, |rho, e| rho / PI * e)
}

const ZENITH: Vec3 = [0.5, 1.25, 4.0];
const HORIZON: Vec3 = [2.0, 1.5, 0.75];
const GROUND: Vec3 = [0.25, 0.125, 1.0];

fn gradient() -> Sky {
    let [zenith, horizon, ground] = [ZENITH, HORIZON, GROUND].map(radiance);
    Sky::new(Dir::Y, zenith, horizon, ground)
}

/// With s the sine of elevation: overhead E = 2π ∫ (h + (z − h) s) s ds; a wall has π h, and 2/3 of each half's rise.
#[test]
fn sky() {
    let floor_sees = map2(ZENITH, HORIZON, |z, h| PI * (h + 2.0 * z) / 3.0);
    let rise = map2(ZENITH, GROUND, |z, g| 2.0 / 3.0 * (z + g));
    let wall_sees = map2(rise, HORIZON, |rise, h| PI * h + rise - 4.0 / 3.0 * h);
    for (name, normal, eye, exact) in [
        ("floor", UP, [1.1, 0.7, 0.6], floor_sees),
        ("wall", [1.0, 0.0, 0.0], [0.9, 0.4, -0.3], wall_sees),
        ("wall askew", [0.6, 0.0, -0.8], [0.9, 0.4, -0.9], wall_sees),
    ] {
        let mut stage = Stage::new();
        let matt = stage.matt(RHO);
        stage.shape(stage.plane(ORIGIN, normal), matt);
        stage.sky(gradient());
        stage.assert(
            &format!("sky over a {name}"),
            View::at(eye, ORIGIN).effort(16, 256),
            &PATHS,
            &PATTERNED,
            matt_under(exact),
        );
    }
    // Seen as it is: a ray that meets nothing.
    for (name, towards, exact) in [("overhead", UP, ZENITH), ("below", [0.0, -1.0, 0.0], GROUND)] {
        let mut stage = floor();
        stage.sky(gradient());
        let eye = [0.3, 0.5 * towards[1], 0.2];
        let target = [0, 1, 2].map(|i| eye[i] + towards[i]);
        let view = View::at(eye, target).effort(8, 4);
        stage.assert(name, view, &PATHS, &ALL, |_| exact);
    }
}

/// A disk of radiance L and half angle α wholly above the horizon: E = π sin² α L cos θ, added to the sky's.
#[test]
fn sun() {
    let towards = [0.5, 0.7, -0.2];
    for degrees in [0.53, 5.0, 60.0] {
        let alpha: f64 = f64::to_radians(degrees / 2.0);
        let share = PI * alpha.sin().powi(2);
        // As much light from a narrow one as from a wide one.
        let bright = LIGHT.map(|c| c * 0.5 / share);
        let exact_bright = to_f64(radiance_of(bright));
        for under_sky in [false, true] {
            let mut stage = floor();
            let black = Sky::new(Dir::Y, radiance(ORIGIN), radiance(ORIGIN), radiance(ORIGIN));
            let sky = if under_sky { gradient() } else { black };
            stage.sky(sky.with_sun(dir(towards), Turn::from_num(degrees / 360.0), radiance_of(bright)));
            let from_sky = map2(ZENITH, HORIZON, |z, h| {
                if under_sky { PI * (h + 2.0 * z) / 3.0 } else { 0.0 }
            });
            let cos = towards[1] / norm(towards);
            let exact = map2(from_sky, exact_bright, |sky, sun| sky + share * sun * cos);
            stage.assert(
                &format!("sun of {degrees} degrees, sky {under_sky}"),
                view().effort(16, 256),
                &PATHS,
                &PATTERNED,
                matt_under(exact),
            );
        }
    }
}

/// Linear in the angle from the map's y axis: over a floor E = π a + π/4 b; linear in the angle about it, in two columns
/// whose light peaks at ±x: a wall towards x has E = π m + 2 (peak − m).
#[test]
fn map() {
    // Mantissas and one exponent: 1/64 to 8 in steps of 1/64.
    let texel = |c: Vec3| {
        let [r, g, b] = c.map(|c| (c * 64.0) as u32);
        Rgb9e5(r | g << 9 | b << 18 | 18 << 27)
    };
    let (a, b, c) = ([0.5, 2.0, 4.0], [3.0, 2.0, 0.25], [0.125, 1.5, 0.75]);
    let down = [texel(a), texel(b)];
    let even = [texel(b); 6];
    let around = [texel(b), texel(c), texel(b), texel(c)];
    let skewed = [1 << 14, 1 << 15, 3 << 14];
    let turned = [[0.0, 0.0, 1.0], UP, [-1.0, 0.0, 0.0]];
    let straight = [[1.0, 0.0, 0.0], UP, [0.0, 0.0, 1.0]];
    let mean = map2(b, c, |b, c| (b + c) / 2.0);
    let cases = [
        ("even", 3, &even[..], straight, UP, b.map(|b| PI * b)),
        (
            "down",
            1,
            &down[..],
            straight,
            UP,
            map2(a, b, |a, b| PI * (0.75 * a + 0.25 * b)),
        ),
        (
            "around",
            2,
            &around[..],
            straight,
            [1.0, 0.0, 0.0],
            map2(mean, b, |m, b| PI * m + 2.0 * (b - m)),
        ),
        (
            "turned",
            2,
            &around[..],
            turned,
            [0.0, 0.0, 1.0],
            map2(mean, b, |m, b| PI * m + 2.0 * (b - m)),
        ),
        (
            "from behind",
            2,
            &around[..],
            straight,
            [-1.0, 0.0, 0.0],
            map2(mean, c, |m, c| PI * m + 2.0 * (c - m)),
        ),
    ];
    for (name, width, texels, axes, normal, exact) in cases {
        let map = Map::new(MapParts {
            width,
            height: (texels.len() / width as usize) as u16,
            texels,
            exponent: 0,
            axes: axes.map(dir),
            // One cell, and cells that are drawn unevenly for no reason.
            bands: if width == 1 { &[] } else { &skewed },
            steps: if width == 1 {
                &[]
            } else {
                &[20_000, 30_000, 11_000, 12_000, 1, 65_535, 7, 50_000]
            },
            steps_in_band: if width == 1 { 1 } else { 3 },
        })
        .unwrap();
        let mut stage = Stage::new();
        let matt = stage.matt(RHO);
        stage.shape(stage.plane(ORIGIN, normal), matt);
        let eye = [0, 1, 2].map(|i| 0.8 * normal[i] + [0.2, 0.3, 0.1][i]);
        stage.map(map);
        stage.assert(
            &format!("map, {name}"),
            View::at(eye, ORIGIN).effort(16, 256),
            &PATHS,
            &PATTERNED,
            matt_under(exact),
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
