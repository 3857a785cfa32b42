//! The scene that the firmware carries in flash, as `build.rs` baked it: a torus knot if nothing else was asked for.

use microlux::scene::{Baked, BakedError};

static BAKED: &[u8] = microlux::include_baked!(concat!(env!("OUT_DIR"), "/mesh.mlx"));

/// Borrowed from flash.
pub fn baked() -> Result<Baked<'static>, BakedError> {
    Baked::open(BAKED)
}
