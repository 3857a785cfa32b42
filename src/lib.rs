#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
// No floats outside tests; clippy.toml disallows the types, `cargo xtask no-float` looks into a linked program.
#![cfg_attr(
    not(test),
    deny(
        clippy::disallowed_types,
        clippy::float_arithmetic,
        clippy::float_cmp,
        clippy::float_cmp_const
    )
)]

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

#[cfg(feature = "micromath")]
pub mod setup;
