use super::{leading_zeros, mul_hi};

/// First guesses 2^31/√n for n in [2^30, 2^32) by its top byte (64 ..= 255), at each interval's middle.
static TABLE: [u16; 192] = {
    let mut table = [0; 192];
    let mut i = 0;
    while i < 192 {
        // 2^31/√((2i+1)·2^23) = √(2^62 / ((2i+1) 2^23)) = √(2^39/(2i+1))
        let square = (1u64 << 39) / (2 * (i as u64 + 64) + 1);
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

/// Reciprocal square root: (mantissa, half) with 1/√x = mantissa · 2^(half − 47), mantissa in 2^31 ..= 2^32 − 1 and
/// half in 0 ..= 15, for `x` ≥ 1 (0 answers as 1 would).
///
/// Relative error: max 8.3e-9 (2^-26.8; 2^30 ..= 2^32 − 1 tried one by one), RMS 1.3e-9, mean −7.4e-10
/// (`tests/num_error`). Table of 192, one Newton step in 16 bits, one in 32.
#[inline]
pub fn rsqrt(x: u32) -> (u32, u32) {
    let half = leading_zeros(x | 1) >> 1;
    let n = (x | (x == 0) as u32) << (2 * half);
    let index = ((n >> 24) as usize).saturating_sub(64);
    let r = TABLE[if index < 192 { index } else { 191 }] as u32;
    // r ← r (3 − n r²)/2 with n r² / 2^62 = 1 ± 2^-7 held in 16 bits of fraction; 3·2^16 − it < 2^18, halved twice.
    let square = (r * r) >> 16;
    let product = ((n >> 16) * square) >> 14;
    let r = (r * (((3 << 16) - product) >> 2)) >> 15;
    // R = 2^47/√n to 2^-14; n R² / 2^64 = 2^30 (1 + 2 error); |e| < 2^17, r/4 < 2^14.
    let r = r.min(0xffff);
    let big = r << 16;
    let e = (1i32 << 30) - mul_hi(n, r * r) as i32;
    let correction = (((big >> 18) as i32) * e) >> 13;
    (big.saturating_add_signed(correction).max(1 << 31), half)
}

/// ⌊√x⌋, exactly. On the bits of a U0F32 it answers the root's U0F16, rounded down.
#[inline]
pub fn isqrt(x: u32) -> u32 {
    let (mantissa, half) = rsqrt(x);
    // x·2^(2 half)/√(x·2^(2 half)) = √x · 2^half; mul_hi takes 2^32 of the mantissa's 2^47, 15 are left.
    let n = x << (2 * half);
    let mut root = (mul_hi(n, mantissa) >> 15) >> half;
    // The estimate is within one of the floor.
    if root > 0xffff || root * root > x {
        root -= 1;
    } else if root < 0xffff && (root + 1) * (root + 1) <= x {
        root += 1;
    }
    root
}
