#![no_std]
#![forbid(unsafe_code)]

pub mod color;
pub mod film;
pub mod num;
pub mod geom;
