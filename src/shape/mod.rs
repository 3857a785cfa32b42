//! Shapes.

mod grid;
mod mesh;
pub(crate) mod triangle;

pub(crate) use grid::{DEPTH_BITS, SLOPE_BITS};
pub use grid::{Bounds, Grid, GridRay, Slopes};
pub(crate) use mesh::corners;
pub use mesh::{MeshError, MeshHit, TriangleMesh};
