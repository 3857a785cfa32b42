//! Lights that the camera sees: their share of the picture, and lights that it is not to see.

use crate::rig::*;
use microlux::integrator::Path;
use microlux::shape::Geometry;
use std::f64::consts::PI;

const ORIGIN: Vec3 = [0.0; 3];
const HALF_WIDTH: f64 = 0.2;

/// Where the camera stands, and the plane through the origin that faces it: unit vectors across.
const EYE: Vec3 = [0.0, 0.0, 4.0];

fn lamp(stage: &mut Stage, kind: usize) -> (Geometry, f64) {
    let (x, y) = ([0.5, 0.0, 0.0], [0.0, 0.4, 0.0]);
    let picture = (2.0 * HALF_WIDTH * EYE[2]).powi(2);
    match kind {
        // Its outline is a cone with sin α = r/d: a circle of tan α at distance 1.
        0 => {
            let sin2 = (0.5 / EYE[2]).powi(2);
            (
                stage.sphere(ORIGIN, 0.5),
                PI * sin2 / (1.0 - sin2) / (2.0 * HALF_WIDTH).powi(2),
            )
        }
        1 => (stage.disk(ORIGIN, [0.0, 0.0, 1.0], 0.5), PI * 0.25 / picture),
        2 => (stage.rectangle(ORIGIN, x, y), 0.8 / picture),
        _ => {
            let corners = [
                [-0.5, -0.4, 0.0],
                [0.5, -0.4, 0.0],
                [0.5, 0.4, 0.0],
                [-0.5, 0.4, 0.0],
            ];
            let mesh = stage.mesh(&corners, &[[0, 1, 2], [0, 2, 3]]);
            (mesh, 0.8 / picture)
        }
    }
}

/// A lamp before nothing: its radiance times its share of the picture.
#[test]
fn lamps() {
    for kind in 0..4 {
        let mut stage = Stage::new();
        let black = stage.black();
        let (geometry, share) = lamp(&mut stage, kind);
        stage.emitter(geometry, black, LIGHT);
        let view = View::at(EYE, ORIGIN).wide(HALF_WIDTH).effort(64, 16);
        stage.assert(
            &format!("{geometry:?}"),
            view,
            &[Path::new(1), Path::direct(), Path::new(6)],
            &PATTERNED,
            |_| LIGHT.map(|light| light * share),
        );
    }
}

/// Spheres that fill the picture, from a bulb close by to a sun.
#[test]
fn sphere_all_over() {
    for (radius, distance) in [(0.002, 0.01), (1.0, 2.0), (31.0, 62.0), (60.0, 60.5)] {
        let mut stage = Stage::new();
        let black = stage.black();
        stage.emitter(stage.sphere(ORIGIN, radius), black, LIGHT);
        let view = View::at([0.0, 0.6 * distance, 0.8 * distance], ORIGIN);
        stage.assert(
            &format!("sphere of {radius} from {distance}"),
            view.wide(0.3 * radius / distance).effort(8, 4),
            &[Path::new(1), Path::direct(), Path::new(6)],
            &ALL,
            |_| LIGHT,
        );
    }
}

/// `hide_emitters`: the camera sees what is behind, and the light goes on lighting.
#[test]
fn hidden() {
    let hide = |path: Path| Path {
        hide_emitters: true,
        ..path
    };
    let paths = [hide(Path::new(1)), hide(Path::direct()), hide(Path::new(6))];
    // Lamp before lamp before nothing, in a sky that is not seen either.
    let mut stage = Stage::new();
    let black = stage.black();
    for z in [0.0, -1.0, -2.0] {
        stage.emitter(stage.sphere([0.0, 0.0, z], 0.4), black, LIGHT);
    }
    stage.environment(LIGHT);
    let view = View::at(EYE, ORIGIN).effort(8, 4);
    stage.assert("lamps in a row", view, &paths, &ALL, |_| [0.0; 3]);
    // A matt wall behind the disk that lights it; the disk is a mirror of nothing, the wall shows ρ/π E.
    let mut stage = Stage::new();
    let (matt, black) = (stage.matt(RHO), stage.black());
    stage.shape(stage.plane([0.0, 0.0, -1.0], [0.0, 0.0, 1.0]), matt);
    stage.emitter(stage.disk(ORIGIN, [0.0, 0.0, -1.0], 0.5), black, LIGHT);
    let view = View::at(EYE, [0.0, 0.0, -1.0]);
    stage.assert("a wall behind a lamp", view, &paths[1..], &PATTERNED, |_| {
        map2(rounded(RHO), LIGHT, |rho, light| rho * light * 0.25 / 1.25)
    });
    // The sky lights the wall still.
    let mut stage = Stage::new();
    let matt = stage.matt(RHO);
    stage.shape(stage.plane([0.0, 0.0, -1.0], [0.0, 0.0, 1.0]), matt);
    stage.environment(LIGHT);
    stage.assert("a wall in a hidden sky", view, &paths[1..], &ALL, |_| {
        map2(rounded(RHO), LIGHT, |rho, light| rho * light)
    });
}
