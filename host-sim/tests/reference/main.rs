//! The f64 reference against closed forms, and its two estimators against each other.

mod agreement;
mod bsdf;
mod chi_square;
mod closed_form;
mod implicit;
mod optics;
mod picture;
mod sky;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use host_sim::reference::{
    Camera, Geometry, Image, Light, Material, Mesh, Rgb, Scene, Settings, Shape, Vec3, render, vec3,
};

const WHITE: Material = Material::Diffuse {
    reflectance: Rgb::splat(0.5),
    two_sided: false,
};
const GLASS: Material = Material::Dielectric {
    eta: 1.5,
    specular_reflectance: Rgb::ONE,
    specular_transmittance: Rgb::ONE,
};

fn shape(geometry: Geometry, material: usize) -> Shape {
    Shape {
        geometry,
        material,
        tint: None,
        emission: None,
        id: 0,
    }
}

fn lamp(geometry: Geometry, radiance: f64, material: usize) -> Shape {
    Shape {
        emission: Some(Rgb::splat(radiance)),
        ..shape(geometry, material)
    }
}

fn floor() -> Geometry {
    Geometry::Plane {
        point: Vec3::ZERO,
        normal: vec3(0.0, 1.0, 0.0),
    }
}

fn sphere(center: Vec3, radius: f64) -> Geometry {
    Geometry::Sphere { center, radius }
}

/// A camera that sees nothing but the origin, from the side.
fn peephole() -> Camera {
    Camera::look_at(vec3(-3.0, 0.4, 0.0), Vec3::ZERO, vec3(0.0, 1.0, 0.0), 1e-5)
}

/// Materials 0: diffuse one half, 1: black, 2: glass.
fn scene(camera: Camera, shapes: Vec<Shape>, lights: Vec<Light>) -> Scene {
    Scene {
        camera,
        shapes,
        materials: vec![WHITE, Material::Black, GLASS],
        lights,
    }
}

fn picture(scene: &Scene, settings: &Settings) -> Image {
    render(scene, settings, &|_| (), &AtomicBool::new(false))
        .expect("nobody cancels")
        .image
}

/// The one pixel's red channel.
fn pixel(scene: &Scene, spp: u32, max_depth: u32) -> f64 {
    let settings = Settings {
        spp,
        max_depth: Some(max_depth),
        ..Settings::default()
    };
    picture(scene, &settings).pixels[0][0]
}

#[track_caller]
fn assert_near(value: f64, expected: f64, relative: f64) {
    let error = (value / expected - 1.0).abs();
    assert!(
        error <= relative,
        "{value} is not {expected}: off by {error:.2e}, allowed {relative:.0e}"
    );
}

/// A cube of edge 2 around the origin whose walls face inwards.
fn room(emission: Option<Rgb>) -> Vec<Shape> {
    let axes = [vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0)];
    let mut walls = Vec::new();
    for axis in 0..3 {
        let (n, u, v) = (axes[axis], axes[(axis + 1) % 3], axes[(axis + 2) % 3]);
        walls.push(Geometry::Rectangle { center: -n, u, v });
        walls.push(Geometry::Rectangle {
            center: n,
            u: v,
            v: u,
        });
    }
    walls
        .into_iter()
        .map(|geometry| Shape {
            emission,
            ..shape(geometry, 0)
        })
        .collect()
}

fn cube_mesh(center: Vec3, half: f64) -> Mesh {
    let corner = |i: u32| {
        let sign = |bit: u32| if i >> bit & 1 == 1 { half } else { -half };
        center + vec3(sign(0), sign(1), sign(2))
    };
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    Mesh::new((0..8).map(corner).collect(), triangles, vec![])
}
