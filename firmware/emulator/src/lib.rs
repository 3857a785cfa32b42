//! Runs firmware without a board: builds it, starts the emulator, reads what it prints, compares and counts.

pub mod bench;
pub mod count;
pub mod denoiser;
pub mod identity;
pub mod machine;
pub mod pico;
mod process;
pub mod profile;
pub mod rays;
pub mod raystones;
mod segments;
pub mod size;
pub mod stack;
mod symbols;
pub mod toolchain;
