//! For cores of ARMv7-M and of ARMv8-M with its main extension: thirteen registers, products of 64 bits.
//!
//! Code for each dominant axis, and of the walk for each sign of the slopes.

pub(crate) mod facets;
pub(crate) mod walk;
