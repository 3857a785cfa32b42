//! From light to a display: one finished [`Tile`] of HDR means, exposed, tone mapped, dithered, drawn.
//!
//! ```text
//! Radiance -> exposure, tone map, sRGB (Tone) -> dither (Dither) -> colour (DisplayColor) -> fill_contiguous
//! ```
//!
//! Each step looks at one pixel and where it stands, never at the tile: however the picture is cut, it is the same.
//! Flash: 644 bytes of curves, and 4 KiB of blue noise. RAM: the iterator on the stack.

mod color;
mod curve;
pub mod denoise;
mod display;
mod dither;
mod exposure;
pub mod feature;
mod tile;
mod tonemap;

pub use color::DisplayColor;
pub use display::{Display, Stops};
pub use dither::Dither;
pub use exposure::Exposure;
pub use feature::Feature;
pub use tile::Tile;
pub use tonemap::{Tone, ToneMap};
