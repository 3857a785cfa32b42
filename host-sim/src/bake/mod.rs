//! Meshes for flash.

mod pack;
mod tree;

pub use pack::{PackError, Packed};
pub use tree::build;
