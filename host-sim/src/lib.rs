//! The host side of microlux: the fixed-point core and an independent f64 reference, side by side.

pub use microlux_bake as bake;
pub mod animate;
pub mod builtin;
pub mod classical;
pub mod clean;
pub mod cli;
pub mod code;
pub mod dequantise;
pub mod desc;
pub mod envmap;
pub mod expose;
pub mod flash;
pub mod import;
pub mod metrics;
pub mod oidn;
pub mod picture;
pub mod polygon;
pub mod primary;
pub mod quantise;
pub mod reference;
pub mod report;
pub mod run;
pub mod show;
