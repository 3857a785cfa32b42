//! Meshes for flash, made on a computer: the tree ([`build`]), few bytes a triangle ([`Packed`]), and what
//! [`microlux::scene::Baked`] opens ([`blob`]).

mod blob;
mod pack;
mod tree;

pub use blob::{Aligned, BlobTooLarge, blob, rust};
pub use pack::{PackError, Packed};
pub use tree::build;
