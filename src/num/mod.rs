//! Numbers: roles over `fixed`, products, roots, reciprocals, angles and the wide-range number for densities.
//!
//! | role | type | raw | where |
//! |---|---|---|---|
//! | length given by a user, metres | [`Metres`] (`I16F16`) | i32 | scene set-up |
//! | coordinate, distance | scene units | i32, finite shapes within ±2^22 | [`crate::geom::Unit`] |
//! | component of a unit vector | [`UnitValue`] (`I16F16`) | i32, ±65536 | [`crate::geom::Dir`] |
//! | share 0..=1 (reflectance) | [`Share`] (`U1F15`) | u16, 0..=32768 | [`crate::color::Albedo`] |
//! | uniform random number | [`Uniform`] (`U0F32`) | u32 | [`crate::sampler`] |
//! | angle | [`Turn`] (`U0F32`, whole turns) | u32 | [`sin_cos`] |
//! | density, solid angle, 1/d² | [`Wide`] | u16 mantissa, i16 exponent | lights, BSDFs, weights |
//! | light, throughput, three channels | [`crate::color::Radiance`] | 3×u16 under one i16 exponent | all that shines |
//!
//! Hot kernels take the raw bits and document their products. Each gives the same bits on every target; where a
//! target lacks a 32×32→64 multiplier, the same result is made of 32-bit products (`narrow_mul`, set by `build.rs`).

mod bits;
mod crc;
mod exp;
mod lit;
mod product;
mod recip;
mod root;
mod trig;
mod wide;

#[cfg(normalizes)]
pub(crate) use bits::BYTE_ZEROS;
pub use bits::{leading_zeros, normalize_shift, round_shift};
pub use crc::Crc;
pub use exp::{exp2_neg, neg_log2, pow};
pub use product::{
    dot_q24, dot_sparse, dot_unit, mul_hi, mul_hi_signed, mul_q16, mul_share, mul_shift, mul_shift_brief,
    mul_shift_medium, mul_shift_short, mul_unit,
};
#[cfg(assembly)]
pub(crate) use recip::RECIPS;
pub(crate) use recip::recip_of_large;
pub use recip::{Recip, ratio, recip, short_recip};
#[cfg(normalizes)]
pub(crate) use root::ROOTS;
pub use root::{isqrt, rsqrt, rsqrt_of_large, short_rsqrt};
pub use trig::{acos, atan2, sin_cos};
pub use wide::Wide;

pub use product::narrow;

/// A length in metres as a user writes it: `q!(0.73)`.
pub type Metres = fixed::types::I16F16;
/// A component of a unit vector.
pub type UnitValue = fixed::types::I16F16;
/// A share between nothing and all, both exact.
pub type Share = fixed::types::U1F15;
/// Uniform in [0, 1).
pub type Uniform = fixed::types::U0F32;
/// An angle in whole turns, wrapping.
pub type Turn = fixed::types::U0F32;

/// One, as a raw component of a unit vector.
pub const ONE_Q16: i32 = 1 << 16;
