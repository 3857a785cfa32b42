//! Bounding volume hierarchies: 4-wide, 40 bytes a node, 8-bit child planes, built and traversed without a heap.
//!
//! A tree stands over the triangles of one mesh, in the mesh's [`crate::shape::Grid`], or over the boxes of whole
//! shapes, in the scene's. The same node, builder and traversal serve both. Every decision is an exact predicate of
//! the ray as the grid sees it, boxes round outwards, and equal depths go to the lower number: so a tree answers what
//! a linear scan answers, primitive and distance, bit for bit.

#[cfg(assembly)]
mod asm;
mod build;
mod check;
mod mesh;
mod node;
#[cfg(any(test, not(any(assembly, target_arch = "x86_64"))))]
mod one_by_one;
#[cfg(target_arch = "x86_64")]
mod sse2;
mod traverse;

pub use build::{BuildError, Item, build_items, build_mesh, max_nodes};
pub(crate) use check::check_tree;
pub use check::{CheckError, check_items, check_mesh};
pub use mesh::{closest, closest_linear, occluded, occluded_linear};
pub use node::{Child, Node};
pub use traverse::{Order, Visitor, primitives, traverse};

/// Most levels of nodes a tree may have.
pub const MAX_DEPTH: usize = 13;

/// Grid steps by which the boxes of triangles grow before they are rounded outwards: rounding moves what a ray sees
/// of a triangle by ½ step.
pub const MESH_PAD: u16 = 1;

/// The same for the scene's grid, whose primitives are hit by rays that are not quantised (or in another grid).
///
/// The grid's own ray is off by ½ step at its origin and by 2^-14 · 65535 = 4 steps at the far face; a mesh's ray, in
/// a cube no larger than the scene's, by as much again.
pub const SCENE_PAD: u16 = 16;
