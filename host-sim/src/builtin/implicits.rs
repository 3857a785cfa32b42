//! The six solids that are given by a function, on a floor.

use super::{Draft, camera};
use crate::desc::{
    BallDesc, BoundDesc, BsdfDesc, CapsuleDesc, GeometryDesc, ImplicitDesc, LightDesc, PartDesc, SceneDesc,
    Vec3,
};
use crate::import::math::{cross, dot, scaled, sub, unit};

pub(super) fn implicits() -> SceneDesc {
    let mut draft = Draft::new("implicits", 8, camera([0.0, 2.0, 5.2], [0.0, 0.62, 0.0], 39.0));
    let floor = draft.diffuse("floor", [0.5, 0.5, 0.48]);
    let teal = draft.diffuse("teal", [0.1, 0.45, 0.42]);
    let blue = draft.diffuse("blue", [0.16, 0.26, 0.62]);
    let red = draft.diffuse("red", [0.65, 0.12, 0.08]);
    let glass = draft.glass();
    let steel = BsdfDesc::Conductor {
        specular_reflectance: [0.9, 0.88, 0.85],
        eta_k: None,
    };
    let steel = draft.material("steel", true, steel);
    let ground = GeometryDesc::Rectangle {
        center: [0.0; 3],
        u: [0.0, 0.0, 5.0],
        v: [5.0, 0.0, 0.0],
    };
    draft.shape("floor", floor, ground);

    let gyroid = ImplicitDesc::Gyroid {
        center: [0.0, 0.75, -0.55],
        axes: axes([0.8, 0.2, 0.5], [-0.3, 0.9, 0.1]),
        cell: 0.55,
        thickness: 0.07,
        bound: BoundDesc::Sphere { radius: 0.75 },
    };
    draft.shape("gyroid", teal, GeometryDesc::Implicit(gyroid));
    let block = ImplicitDesc::RoundedBox {
        center: [-1.45, 0.4, -0.5],
        axes: axes([0.9, 0.0, -0.45], [0.0, 1.0, 0.0]),
        half: [0.45, 0.4, 0.35],
        radius: 0.1,
    };
    draft.shape("rounded box", blue, GeometryDesc::Implicit(block));
    let balls = [
        ([-1.0, 0.36, 0.95], 0.52),
        ([-0.62, 0.28, 1.15], 0.4),
        ([-0.8, 0.62, 0.8], 0.36),
    ];
    let metaballs = ImplicitDesc::Metaballs {
        balls: balls.map(ball).to_vec(),
        threshold: 0.2,
    };
    draft.shape("metaballs", glass, GeometryDesc::Implicit(metaballs));
    let stem = CapsuleDesc {
        a: [0.95, 0.14, 0.95],
        b: [1.2, 0.6, 0.8],
        radius: 0.1,
    };
    let union = ImplicitDesc::SmoothUnion {
        parts: vec![
            PartDesc::Ball(ball(([0.9, 0.24, 1.0], 0.24))),
            PartDesc::Capsule(stem),
            PartDesc::Ball(ball(([1.22, 0.66, 0.78], 0.2))),
        ],
        k: 0.16,
    };
    draft.shape("smooth union", steel, GeometryDesc::Implicit(union));
    let capsule = CapsuleDesc {
        a: [-0.12, 0.12, 1.45],
        b: [0.42, 0.12, 1.25],
        radius: 0.12,
    };
    draft.shape(
        "capsule",
        red,
        GeometryDesc::Implicit(ImplicitDesc::Capsule(capsule)),
    );
    let ring = ImplicitDesc::Torus {
        center: [1.42, 0.72, -0.5],
        axis: unit([-0.5, 0.25, 0.83]).unwrap_or([0.0, 0.0, 1.0]),
        major: 0.5,
        minor: 0.1,
    };
    draft.lamp("ring", [2.4, 1.15, 0.35], GeometryDesc::Implicit(ring));

    let lamp = GeometryDesc::Rectangle {
        center: [-1.0, 3.4, 1.2],
        u: [0.6, 0.0, 0.0],
        v: [0.0, 0.0, 0.6],
    };
    draft.lamp("lamp", [11.0, 10.6, 10.0], lamp);
    draft.0.lights.push(LightDesc::Constant {
        radiance: [0.16, 0.2, 0.27],
    });
    draft.0
}

fn ball((center, radius): (Vec3, f64)) -> BallDesc {
    BallDesc { center, radius }
}

/// Right-handed, the first along x, the second as near to y as can be.
fn axes(x: Vec3, y: Vec3) -> [Vec3; 3] {
    let x = unit(x).unwrap_or([1.0, 0.0, 0.0]);
    let y = unit(sub(y, scaled(x, dot(x, y)))).unwrap_or([0.0, 1.0, 0.0]);
    [x, y, cross(x, y)]
}
