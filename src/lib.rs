#![no_std]
#![forbid(unsafe_code)]

pub mod color;
pub mod num;
pub mod geom;
