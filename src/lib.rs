#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod num;

pub mod color;

pub mod geom;

pub mod sampler;

pub mod shape;

pub mod bvh;

pub mod material;

pub mod light;

pub mod camera;

pub mod scene;

pub mod integrator;

pub mod film;

pub mod render;
