//! The mesh that the firmware carries in flash, as `build.rs` baked it: a torus knot if nothing else was asked for.

use microlux::scene::{Baked, BakedError, Mesh};

static BAKED: &[u8] = microlux::include_baked!(concat!(env!("OUT_DIR"), "/mesh.mlx"));

/// Borrowed from flash; in a cube of 2 m, from (-1, 0, -1) m.
pub fn mesh() -> Result<Mesh<'static>, BakedError> {
    Baked::open(BAKED)?.mesh(0)
}
