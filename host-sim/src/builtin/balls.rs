//! Balls of all materials, and balls in the open: the core's own small scenes, as files would say them.

use super::{Draft, camera};
use crate::desc::{BsdfDesc, GeometryDesc, LightDesc, OrenNayarModel, SceneDesc, SunDesc, Vec3};

const WHITE: Vec3 = [1.0; 3];
/// η and k at 630, 530 and 460 nm, rounded.
const GOLD: (Vec3, Vec3) = ([0.19, 0.55, 1.35], [3.30, 2.20, 1.88]);
const COPPER: (Vec3, Vec3) = ([0.25, 1.10, 1.16], [3.45, 2.59, 2.40]);

fn floor(draft: &mut Draft, reflectance: Vec3) {
    let floor = draft.diffuse("floor", reflectance);
    let plane = GeometryDesc::Plane {
        point: [0.0; 3],
        normal: [0.0, 1.0, 0.0],
    };
    draft.shape("floor", floor, plane);
}

/// Two rows of five, each with a name, whether its material has two sides, and the material.
fn row() -> [(&'static str, BsdfDesc); 10] {
    let clay = |model, sigma_degrees| BsdfDesc::OrenNayar {
        reflectance: [0.75, 0.45, 0.30],
        sigma_degrees,
        model,
    };
    let shiny = |diffuse_reflectance, specular: f64, exponent, normalized| BsdfDesc::BlinnPhong {
        diffuse_reflectance,
        specular_reflectance: [specular; 3],
        exponent,
        normalized,
    };
    let metal = |eta_k, alpha| BsdfDesc::RoughConductor {
        alpha,
        specular_reflectance: WHITE,
        eta_k: Some(eta_k),
    };
    let frosted = BsdfDesc::RoughDielectric {
        alpha: 0.2,
        int_ior: 1.5,
        ext_ior: 1.0,
        specular_reflectance: WHITE,
        specular_transmittance: WHITE,
    };
    let clear = BsdfDesc::Dielectric {
        int_ior: 1.5,
        ext_ior: 1.0,
        specular_reflectance: WHITE,
        specular_transmittance: WHITE,
    };
    let copper = BsdfDesc::Conductor {
        specular_reflectance: WHITE,
        eta_k: Some(COPPER),
    };
    [
        ("full clay", clay(OrenNayarModel::Full, 36.0)),
        ("shorter clay", clay(OrenNayarModel::Qualitative, 36.0)),
        ("preserving clay", clay(OrenNayarModel::EnergyPreserving, 72.0)),
        ("red gloss", shiny([0.45, 0.05, 0.05], 0.4, 60.0, true)),
        ("blue gloss", shiny([0.05, 0.12, 0.45], 1.0, 20.0, false)),
        ("copper", copper),
        ("gold", metal(GOLD, 0.1)),
        ("rough copper", metal(COPPER, 0.4)),
        ("frosted glass", frosted),
        ("clear glass", clear),
    ]
}

pub fn materials() -> SceneDesc {
    let mut draft = Draft::new("materials", 8, camera([0.0, 1.9, 4.4], [0.0, 0.22, 0.0], 45.0));
    floor(&mut draft, [0.5, 0.48, 0.45]);
    for (i, (name, bsdf)) in row().into_iter().enumerate() {
        let glass = matches!(
            bsdf,
            BsdfDesc::Dielectric { .. } | BsdfDesc::RoughDielectric { .. }
        );
        let material = draft.material(name, !glass, bsdf);
        let x = 0.75 * (i % 5) as f64 - 1.5;
        let z = if i < 5 { -0.5 } else { 0.4 };
        draft.sphere(name, material, [x, 0.32, z], 0.32);
    }
    let lamp = GeometryDesc::Rectangle {
        center: [-0.6, 3.0, 1.2],
        u: [0.9, 0.0, 0.0],
        v: [0.0, 0.0, 0.6],
    };
    draft.lamp("lamp", [8.0, 7.5, 6.5], lamp);
    draft.0.lights.push(LightDesc::Constant {
        radiance: [0.22, 0.26, 0.32],
    });
    draft.0
}

/// Four balls on a floor.
fn open(name: &str) -> Draft {
    let mut draft = Draft::new(name, 8, camera([0.0, 1.3, 4.6], [0.0, 0.5, 0.0], 36.0));
    floor(&mut draft, [0.42, 0.40, 0.36]);
    let silver = [0.95, 0.93, 0.88];
    let matt = draft.diffuse("matt", [0.7, 0.68, 0.62]);
    let mirror = BsdfDesc::Conductor {
        specular_reflectance: silver,
        eta_k: None,
    };
    let mirror = draft.material("mirror", true, mirror);
    let metal = BsdfDesc::RoughConductor {
        alpha: 0.25,
        specular_reflectance: silver,
        eta_k: None,
    };
    let metal = draft.material("metal", true, metal);
    let glass = draft.glass();
    draft.sphere("matt ball", matt, [-1.05, 0.5, 0.0], 0.5);
    draft.sphere("mirror ball", mirror, [0.05, 0.6, -0.5], 0.6);
    draft.sphere("metal ball", metal, [1.15, 0.5, 0.0], 0.5);
    draft.sphere("glass ball", glass, [0.1, 0.3, 0.8], 0.3);
    draft
}

pub fn sky() -> SceneDesc {
    let mut draft = open("sky");
    let length = 17f64.sqrt();
    draft.0.lights.push(LightDesc::Gradient {
        zenith: [0.15, 0.3, 0.7],
        horizon: [0.7, 0.75, 0.8],
        ground: [0.12, 0.1, 0.08],
        up: [0.0, 1.0, 0.0],
        sun: Some(SunDesc {
            direction: [2.0 / length, 3.0 / length, 2.0 / length],
            radiance: [600.0, 540.0, 430.0],
            angle: 4.0,
        }),
    });
    draft.0
}

pub fn map() -> SceneDesc {
    let (width, height) = (16, 9);
    let colour = |row: u32, column: u32| match (row, column) {
        (2..=3, 3..=4) => [14.0, 12.0, 9.0],
        (1..=3, 11..=12) => [1.5, 2.5, 4.0],
        (row, _) if row < 2 => [6.0 / 32.0, 7.0 / 32.0, 9.0 / 32.0],
        (2..=4, _) => [0.375; 3],
        (5, _) => [0.25, 7.0 / 32.0, 6.0 / 32.0],
        _ => [4.0 / 32.0, 3.0 / 32.0, 3.0 / 32.0],
    };
    let mut draft = open("map");
    draft.0.lights.push(LightDesc::EnvMap {
        width,
        height,
        pixels: (0..width * height)
            .map(|i| colour(i / width, i % width))
            .collect(),
        to_world: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    });
    draft.0
}
