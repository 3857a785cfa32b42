//! Inner loops of microlux in assembly, where registers handed out by hand spare what a compiler spills.
//!
//! `Walk` goes through a tree along a ray, `Facets` looks at triangles; the core has the portable twin of both, and
//! says why they decide so (`bvh::traverse`, `shape::triangle`). The firmware's job `meshes` compares the two. `convolve`,
//! `convolve_seen`, `merge` and `squeeze`, or `activations`, and `heads` are the network's layers, `Rows`, `kins`, `Nine` and
//! `mean`, or `gather` and `Spread`, its filter; the job `network` holds them against its portable ones. `normalize` is
//! `geom::Offset`'s, `rectangle` meets one (`shape::planar`) and `Upsample` shows the denoiser's pixels twice the size
//! (`film::denoise::upsample`), held by the jobs `normalize`, `rectangles` and `upsampled`.
//!
//! Cores of ARMv6-M, ARMv7-M and RV32IM have `Walk` and `Facets`, those of ARMv7-M `activations` and `heads`, those of ARMv7E-M
//! `gather` and `Spread`, and those of ARMv6-M all that is not named so; elsewhere nothing is there.

#![no_std]

#[cfg(armv6m)]
mod armv6m;
#[cfg(armv7em)]
mod armv7em;
#[cfg(armv7m)]
mod armv7m;
#[cfg(any(armv6m, armv7m))]
mod facets;
#[cfg(armv7m)]
mod layer;
#[cfg(any(armv6m, armv7m, target_arch = "riscv32"))]
mod ray;
#[cfg(target_arch = "riscv32")]
mod rv32;
#[cfg(armv6m)]
pub use armv6m::{
    column::{convolve, convolve_seen},
    gather::Rows,
    mean::{Tables, mean},
    nine::{Kin, Nine, kins},
    normalize::{Normal, normalize},
    pixel::{heads, merge, squeeze},
    rectangle::rectangle,
    upsample::{MIDDLE, Upsample},
    walk::Walk,
};
#[cfg(armv7em)]
pub use armv7em::{Spread, gather};
#[cfg(armv7m)]
pub use armv7m::walk::Walk;
#[cfg(any(armv6m, armv7m))]
pub use facets::Facets;
#[cfg(armv7m)]
pub use layer::{activations, heads};
#[cfg(any(armv6m, armv7m, target_arch = "riscv32"))]
pub use ray::{Corner, DEPTH_BITS, Leaves, Met, Order, Ray, STACK};
#[cfg(target_arch = "riscv32")]
pub use rv32::{facets::Facets, walk::Walk};
