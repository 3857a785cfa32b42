//! The chores of microlux, one command for each: `cargo xtask --help` lists them.
//!
//! A chore that needs a program which is missing says which one and how to get it. Whatever compiles for a chip asks
//! [`toolchain`] for its cargo, so that rustup's targets and Debian's compiler both serve.

pub mod accuracy;
pub mod bench_bdpt;
pub mod bench_denoiser;
pub mod bench_host;
pub mod bench_seed;
pub mod board;
pub mod ci;
pub mod cli;
pub mod device;
pub mod fuzz;
pub mod golden;
pub mod growth;
pub mod layers;
pub mod no_float;
pub mod peers;
pub mod picture;
pub mod profile;
pub mod rays;
pub mod raystones;
pub mod sampling;
mod section;
pub mod setup;
pub mod shell;
pub mod toolchain;
