//! A tube along the (2, 3) torus knot.

use std::f64::consts::TAU;

use crate::desc::{MeshDesc, Vec3};
use crate::import::math::{add, cross, dot, scaled, sub, unit};

/// Steps along the knot and around the tube.
const ALONG: u32 = 480;
const AROUND: u32 = 16;
/// Radii in metres: the knot winds around a torus of these, the tube has the last.
const MAJOR: f64 = 0.62;
const MINOR: f64 = 0.27;
const TUBE: f64 = 0.15;

/// The closed tube, standing upright about `center`, with smooth normals.
pub(super) fn mesh(center: Vec3) -> MeshDesc {
    let mut mesh = MeshDesc::default();
    for i in 0..ALONG {
        let t = TAU * f64::from(i) / f64::from(ALONG);
        let tangent = sub(knot(t + 1e-4), knot(t - 1e-4));
        let (side, up) = cross_section(t, tangent);
        for j in 0..AROUND {
            let (sin, cos) = (TAU * f64::from(j) / f64::from(AROUND)).sin_cos();
            let normal = add(scaled(side, cos), scaled(up, sin));
            mesh.vertices
                .push(add(center, add(knot(t), scaled(normal, TUBE))));
            mesh.normals.push(normal);
        }
    }
    let vertex = |i: u32, j: u32| (i % ALONG) * AROUND + j % AROUND;
    for i in 0..ALONG {
        for j in 0..AROUND {
            let [a, b, c, d] = [
                vertex(i, j),
                vertex(i, j + 1),
                vertex(i + 1, j + 1),
                vertex(i + 1, j),
            ];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// Winds twice around the axis (here z) and three times around the torus' core, for t in 0..2π.
fn knot(t: f64) -> Vec3 {
    let r = MAJOR + MINOR * (3.0 * t).cos();
    [r * (2.0 * t).cos(), r * (2.0 * t).sin(), MINOR * (3.0 * t).sin()]
}

/// Unit vectors across the tube, `side × up` along it: `side` leads away from the torus' core, which makes the frame
/// return to itself after one round.
fn cross_section(t: f64, tangent: Vec3) -> (Vec3, Vec3) {
    let core = [MAJOR * (2.0 * t).cos(), MAJOR * (2.0 * t).sin(), 0.0];
    let along = unit(tangent).unwrap_or([0.0, 0.0, 1.0]);
    let out = sub(knot(t), core);
    let side = unit(sub(out, scaled(along, dot(out, along)))).unwrap_or([1.0, 0.0, 0.0]);
    (side, cross(along, side))
}
