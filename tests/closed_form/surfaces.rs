//! Furnaces, integrating spheres, mirrors and glass.

use crate::rig::*;
use microlux::integrator::Path;
use microlux::light::Light;
use microlux::material::{Dielectric, Material};
use microlux::num::Metres;
use std::f64::consts::PI;

const ORIGIN: Vec3 = [0.0; 3];
const UP: Vec3 = [0.0, 1.0, 0.0];
const DEPTHS: [Path; 4] = [Path::new(1), Path::direct(), Path::new(3), Path::new(8)];

/// Paths that roulette ends, from the third or the fifth segment on.
const ROULETTE: [Path; 2] = [
    Path::new(300),
    Path {
        rr_depth: 3,
        ..Path::new(300)
    },
];

/// A convex matt body in a uniform sky: ρ L, however near the edge one looks.
#[test]
fn furnace() {
    for (radius, distance) in [(1.0, 4.0), (0.01, 1.0), (20.0, 41.0)] {
        let mut stage = Stage::new();
        let matt = stage.matt(RHO);
        stage.shape(stage.sphere(ORIGIN, radius), matt);
        stage.environment(LIGHT);
        let half_width = 0.6 * radius / distance;
        let view = View::at([0.6 * distance, 0.0, 0.8 * distance], ORIGIN).wide(half_width);
        stage.assert(
            &format!("furnace, ball of {radius}"),
            view.effort(16, 16),
            &[Path::direct(), Path::new(8)],
            &ALL,
            |_| map2(rounded(RHO), LIGHT, |rho, light| rho * light),
        );
    }
}

/// The faces of a box of half side `h` that face inwards.
fn inner_faces(h: f64) -> [(Vec3, Vec3, Vec3); 6] {
    let axis = |i: usize, sign: f64| {
        let mut v = [0.0; 3];
        v[i % 3] = sign * h;
        v
    };
    [0, 1, 2, 3, 4, 5].map(|face| {
        let (i, sign) = (face % 3, if face < 3 { 1.0 } else { -1.0 });
        // At +i the normal is −i: v × u there, u × v at −i.
        let (u, v) = (axis(i + 1, -sign), axis(i + 2, 1.0));
        (axis(i, sign), u, v)
    })
}

/// A closed box whose walls glow and reflect: L = Le (1 + ρ + ... + ρ^(n − 1)), and no ray gets out.
#[test]
fn glowing_box() {
    let exact = |rho: Vec3| {
        move |path: &Path| {
            map2(rounded(rho), LIGHT, |rho, light| {
                light * geometric(rho, path.max_depth as u32)
            })
        }
    };
    let view = View::at([0.1, 0.2, -0.3], [1.0, 0.7, 0.8]).wide(0.8);
    let glowing = |rho: Vec3| {
        let mut stage = Stage::new();
        let matt = stage.matt(rho);
        for (center, u, v) in inner_faces(1.0) {
            stage.emitter(stage.rectangle(center, u, v), matt, LIGHT);
        }
        stage
    };
    glowing(RHO).assert(
        "glowing box",
        view.effort(16, 256),
        &DEPTHS,
        &PATTERNED,
        exact(RHO),
    );
    glowing(RHO).assert_light(
        "glowing box",
        view.effort(16, 8192),
        &DEPTHS,
        &PATTERNED[1..],
        exact(RHO),
    );
    let grey = [0.3, 0.15, 0.25];
    glowing(grey).assert(
        "roulette",
        view.effort(16, 256),
        &ROULETTE,
        &PATTERNED,
        exact(grey),
    );

    let mut stage = Stage::new();
    let matt = stage.matt(RHO);
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for (c, u, v) in inner_faces(1.0) {
        let base = vertices.len() as u16;
        let corner = |s: f64, t: f64| [0, 1, 2].map(|i| c[i] + s * u[i] + t * v[i]);
        vertices.extend([
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(1.0, 1.0),
            corner(-1.0, 1.0),
        ]);
        triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    }
    let geometry = stage.mesh(&vertices, &triangles);
    stage.emitter(geometry, matt, LIGHT);
    stage.assert(
        "glowing box of triangles",
        view.effort(16, 256),
        &DEPTHS,
        &PATTERNED,
        exact(RHO),
    );
}

/// Ulbricht's sphere, lit by a point light in its centre: every bounce is uniform again.
#[test]
fn integrating_sphere() {
    for radius in [0.5, 30.0] {
        let mut stage = Stage::new();
        let matt = stage.matt(RHO);
        stage.shape(stage.sphere(ORIGIN, radius), matt);
        stage.light(Light::Point {
            position: stage.point(ORIGIN),
            intensity: radiance(LIGHT),
        });
        let view = View::at([0.3 * radius, 0.1 * radius, 0.0], [0.0, 0.0, radius])
            .wide(0.8)
            .effort(16, 256);
        let name = format!("integrating sphere of {radius}");
        let exact = |path: &Path| {
            map2(rounded(RHO), LIGHT, |rho, light| {
                rho / PI * light / (radius * radius) * geometric(rho, path.max_depth as u32 - 1)
            })
        };
        stage.assert(&name, view, &DEPTHS[1..], &PATTERNED, exact);
        stage.assert_light(&name, view.effort(16, 2048), &DEPTHS[1..], &PATTERNED[1..], exact);
    }
}

#[test]
fn mirror() {
    let reflected = |_: &Path| map2(rounded(RHO), LIGHT, |rho, light| rho * light);
    let from = |target| View::at([0.6, 0.8, 0.4], target).wide(0.3).effort(16, 16);
    for kind in 0..3 {
        let mut stage = Stage::new();
        let mirror = stage.material(Material::mirror(albedo(RHO)));
        let ball = [0.0, -1.0, 0.0];
        let (geometry, target) = match kind {
            0 => (stage.plane(ORIGIN, UP), ORIGIN),
            1 => (stage.disk(ORIGIN, UP, 2.0), ORIGIN),
            _ => (stage.sphere(ball, 1.0), ball),
        };
        stage.shape(geometry, mirror);
        stage.environment(LIGHT);
        stage.assert(
            &format!("mirror, kind {kind}"),
            from(target),
            &[Path::direct(), Path::new(9)],
            &ALL,
            reflected,
        );
    }
    // Light that is a shape is seen in a mirror, once and whole.
    let mut stage = Stage::new();
    let mirror = stage.material(Material::mirror(albedo(RHO)));
    let black = stage.black();
    stage.shape(stage.plane(ORIGIN, UP), mirror);
    stage.emitter(stage.sphere([-3.0, 4.0, -2.0], 3.0), black, LIGHT);
    stage.assert(
        "a lamp in a mirror",
        from(ORIGIN).wide(0.002),
        &[Path::direct()],
        &ALL,
        reflected,
    );
}

/// Two mirrors face each other, a sky between: paths go on until they are cut, and bring nothing.
#[test]
fn mirrors_without_light_between() {
    let mut stage = Stage::new();
    let mirror = stage.material(Material::mirror(albedo([1.0; 3])));
    stage.shape(stage.plane([0.0, -1.0, 0.0], UP), mirror);
    stage.shape(stage.plane([0.0, 1.0, 0.0], UP), mirror);
    stage.environment(LIGHT);
    let view = View::at(ORIGIN, [0.0, 1.0, 0.001]).effort(4, 4);
    stage.assert("mirrors", view, &[Path::new(50)], &ALL, |_| [0.0; 3]);
}

fn glass(stage: &mut Stage, eta: f64) -> microlux::scene::MaterialId {
    stage.material(Material::Dielectric(Dielectric::new(Metres::from_num(eta))))
}

/// Lossless glass in a uniform sky can't be seen, and the medium's denser radiance comes back down on the way out.
#[test]
fn glass_disappears() {
    let sky = |_: &Path| LIGHT;
    for eta in [1.5, 1.0 / 1.33, 2.4] {
        for (name, kind) in [("ball", 0), ("box", 1), ("slab", 2)] {
            let mut stage = Stage::new();
            let glass = glass(&mut stage, eta);
            match kind {
                0 => stage.shape(stage.sphere(ORIGIN, 0.5), glass),
                1 => {
                    for (center, u, v) in inner_faces(0.5) {
                        stage.shape(stage.rectangle(center, v, u), glass);
                    }
                }
                _ => {
                    stage.shape(stage.plane([0.0, 0.2, 0.0], UP), glass);
                    stage.shape(stage.plane([0.0, -0.2, 0.0], [0.0, -1.0, 0.0]), glass);
                }
            }
            stage.environment(LIGHT);
            let view = View::at([0.7, 1.3, 0.6], ORIGIN).wide(0.35);
            // Within a box light may go round for ever; a hundred segments leave nothing that counts.
            let deep = Path {
                rr_depth: 100,
                ..Path::new(100)
            };
            let name = format!("glass {name}, {eta}");
            stage.assert(
                &name,
                view.effort(16, 256),
                &[deep, Path::new(300)],
                &PATTERNED,
                sky,
            );
        }
    }
}

/// Reflectance of a plane boundary for unpolarised light.
fn fresnel(cos_i: f64, eta: f64) -> f64 {
    let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (eta * eta)).sqrt();
    let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    0.5 * (s * s + p * p)
}

/// Over a black ground under glass only what is reflected comes back.
#[test]
fn reflection_on_glass() {
    for (eta, angle) in [(1.5, 0.0f64), (1.5, 45.0), (1.5, 75.0), (1.33, 85.0), (2.4, 30.0)] {
        let mut stage = Stage::new();
        let (glass, black) = (glass(&mut stage, eta), stage.black());
        stage.shape(stage.plane(ORIGIN, UP), glass);
        stage.shape(stage.plane([0.0, -1.0, 0.0], UP), black);
        stage.environment(LIGHT);
        let (sin, cos) = angle.to_radians().sin_cos();
        let view = View::at([sin, cos, 0.0], ORIGIN).effort(16, 256);
        stage.assert(
            &format!("reflection, {eta} at {angle} degrees"),
            view.wide(1e-4),
            &[Path::direct(), Path::new(5)],
            &PATTERNED,
            |_| LIGHT.map(|light| light * fresnel(cos, eta)),
        );
    }
}

/// A lamp within glass, and one seen through it: transmitted by 1 − R, its radiance the denser medium's.
#[test]
fn through_glass() {
    let mut stage = Stage::new();
    let (glass, black) = (glass(&mut stage, 1.5), stage.black());
    stage.shape(stage.plane(ORIGIN, UP), glass);
    let sides = ([0.0, 0.0, 5.0], [5.0, 0.0, 0.0]);
    stage.emitter(stage.rectangle([0.0, -1.0, 0.0], sides.0, sides.1), black, LIGHT);
    let view = View::at([0.6, 0.8, 0.0], ORIGIN).effort(16, 256);
    stage.assert(
        "a lamp in glass",
        view.wide(1e-4),
        &[Path::direct(), Path::new(5)],
        &PATTERNED,
        |_| LIGHT.map(|light| light * (1.0 - fresnel(0.8, 1.5)) / 2.25),
    );
}
