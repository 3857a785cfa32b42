//! The host side of microlux: the fixed-point core and an independent f64 reference, side by side.

pub mod desc;
pub mod quantise;
pub mod reference;
