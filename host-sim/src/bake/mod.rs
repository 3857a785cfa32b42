//! Meshes for flash.

mod pack;

pub use pack::{PackError, Packed};
