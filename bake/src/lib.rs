//! Scenes for flash, made on a computer: the tree of a mesh ([`build`]), few bytes a triangle ([`Packed`]), and what
//! [`microlux::scene::Baked`] opens: meshes ([`blob`]), or a whole scene ([`scene_blob`]).

mod blob;
mod pack;
mod scene;
mod tree;

pub use blob::{Aligned, BlobTooLarge, blob, rust, scene_blob};
pub use pack::{PackError, Packed};
pub use tree::build;
