use super::{leading_zeros, mul_hi};

/// First guesses 2^31/√n for n in [2^30, 2^32) by its top byte (64 ..= 255), at each interval's middle; below, any.
pub(crate) static ROOTS: [u16; 256] = {
    let mut table = [0xffff; 256];
    let mut i = 64;
    while i < 256 {
        // 2^31/√((2i+1)·2^23) = √(2^62 / ((2i+1) 2^23)) = √(2^39/(2i+1))
        let square = (1u64 << 39) / (2 * i as u64 + 1);
        let mut root = 0u64;
        let mut bit = 1u64 << 16;
        while bit > 0 {
            if (root + bit) * (root + bit) <= square {
                root += bit;
            }
            bit >>= 1;
        }
        table[i] = root as u16;
        i += 1;
    }
    table
};

/// 2^31/√n, under 2^16, for n in [2^30, 2^32); for less any such number.
///
/// Relative error: max 5.5e-5 (2^-14.1), RMS 1.8e-5, mean −1.05e-5 (`tests/num_error`). Table of 256, one Newton step in 16 bits: three
/// products.
#[inline(always)]
pub fn short_rsqrt(n: u32) -> u32 {
    let r = ROOTS[(n >> 24) as usize] as u32;
    // r ← r (3 − n r²)/2 with n r² / 2^62 = 1 ± 2^-7 held in 16 bits of fraction; 3·2^16 − it < 2^18, halved twice.
    let square = (r * r) >> 16;
    let product = ((n >> 16) * square) >> 14;
    ((r * (((3 << 16) - product) >> 2)) >> 15).min(0xffff)
}

/// Reciprocal square root: (mantissa, half) with 1/√x = mantissa · 2^(half − 47), mantissa in 2^31 ..= 2^32 − 1 and
/// half in 0 ..= 15, for `x` ≥ 1 (0 answers as 1 would).
///
/// Relative error: max 8.3e-9 (2^-26.8; 2^30 ..= 2^32 − 1 tried one by one), RMS 1.3e-9, mean −7.4e-10
/// (`tests/num_error`). Table of 192, one Newton step in 16 bits, one in 32.
#[inline]
pub fn rsqrt(x: u32) -> (u32, u32) {
    let half = leading_zeros(x | 1) >> 1;
    let n = (x | (x == 0) as u32) << (2 * half);
    (long_rsqrt(n), half)
}

/// [`rsqrt`] of 2^28 and more, without counting zeros.
#[inline]
pub fn rsqrt_of_large(x: u32) -> (u32, u32) {
    let half = (x >> 30 == 0) as u32;
    (long_rsqrt(x << (2 * half)), half)
}

/// 2^47/√n for n in [2^30, 2^32).
#[inline]
fn long_rsqrt(n: u32) -> u32 {
    let r = short_rsqrt(n);
    // R = 2^47/√n to 2^-14; n R² / 2^64 = 2^30 (1 + 2 error); |e| < 2^17, r/4 < 2^14.
    let big = r << 16;
    let e = (1i32 << 30) - mul_hi(n, r * r) as i32;
    let correction = (((big >> 18) as i32) * e) >> 13;
    big.saturating_add_signed(correction).max(1 << 31)
}

/// ⌊√x⌋, exactly (every `x` was tried). On the bits of a U0F32 it answers the root's U0F16, rounded down.
///
/// Table and one Newton step for 1/√n, one for √n by what its square leaves of n, and one off at most is put right: seven
/// products of 32 bits.
#[inline]
pub fn isqrt(x: u32) -> u32 {
    // Three of four numbers need no count.
    let half = if x >> 30 != 0 {
        0
    } else {
        leading_zeros(x | 1) >> 1
    };
    let n = x << (2 * half);
    let r = short_rsqrt(n);
    // √n = n · 2^31/√n / 2^31, to 2^-14: within 4 of it, so that the rest is under 2^19.
    let root = ((n >> 16) * r) >> 15;
    let rest = n.wrapping_sub(root * root) as i32;
    // rest / (2 √n)
    let root = root.wrapping_add_signed(((rest >> 4) * r as i32) >> 28);
    let rest = n.wrapping_sub(root.wrapping_mul(root)) as i32;
    let root = root + (rest > 2 * root as i32) as u32 - (rest < 0) as u32;
    root >> half
}
