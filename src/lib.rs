#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod color;
pub mod num;
pub mod geom;
pub mod bvh;
pub mod shape;
