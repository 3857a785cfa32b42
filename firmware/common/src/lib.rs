//! What every board, emulator and host runs alike: one list of [`jobs`], one picture made of [`tile`]s.
//!
//! A board's own crate brings start-up, a display or a console, and nothing that could change a bit of the result.
//! Each job gives one CRC-32; two targets that disagree about a job name it by its line.

#![no_std]

#[cfg(feature = "roomy")]
pub mod cost;
#[cfg(feature = "roomy")]
pub mod denoise;
mod edges;
pub mod fingerprint;
mod flags;
#[cfg(feature = "roomy")]
pub mod flight;
pub mod golden;
pub mod jobs;
pub mod mesh;
mod meshes;
#[cfg(feature = "roomy")]
mod network;
mod normalize;
mod random;
pub mod rays;
pub mod raystones;
mod rectangles;
pub mod region;
pub mod stage;
pub mod text;
pub mod tile;
mod upsampled;
