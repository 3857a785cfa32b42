//! For cores of ARMv7-M and of ARMv8-M with its main extension: thirteen registers, products of 64 bits.
//!
//! Code for each dominant axis, and of the walk for each sign of the slopes. Words of nodes and of triangles are loaded where
//! they lie, at even addresses: as in compiled code, such loads do not trap.
//!
//! Cycles of a Cortex-M4 without wait states: 35 a node before its first child, 23 to 29 a child that is met, 8 to 27 one
//! that is not; where several are met, 25, and 45 for each that is a node. 64 a triangle before its edges, 10 to 35 for
//! these, 80 what is met.
//!
//! Of the network an activation takes 8 instructions for two pixels by two words, 9 or 10 by three or four, 3 where it is 0;
//! then 6 an output. As on ARMv6-M a word of weights holds two sums.

pub(crate) mod facets;
pub(crate) mod layer;
pub(crate) mod walk;
