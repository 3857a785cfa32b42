use super::{Wide, leading_zeros, mul_hi, mul_hi_signed};

/// 1/m for m in [½, 1) by its six bits below the top one, at each interval's middle, Q15; and its logarithm, Q31.
static LOG: [(u16, u32); 64] = {
    let mut table = [(0, 0); 64];
    let mut i = 0;
    while i < 64 {
        // m = (2 (64 + i) + 1) / 256
        let r = (1u32 << 23) / (2 * (64 + i as u32) + 1);
        table[i] = (r as u16, log2_digits(r));
        i += 1;
    }
    table
};

/// log2 of a Q15 number in [1, 2], Q31: squared again and again, each time it passes 2 is a binary digit.
const fn log2_digits(r: u32) -> u32 {
    let mut v = (r as u128) << 47;
    let mut digits = 0;
    let mut i = 0;
    while i < 32 {
        // Q62 · Q62
        v = (v * v) >> 62;
        let digit = v >> 63;
        v >>= digit;
        digits = (digits << 1) | digit as u64;
        i += 1;
    }
    ((digits + 1) >> 1) as u32
}

/// 2^−x at the middle of each 64th of x in [0, 1), U0F32.
static EXP: [u32; 64] = {
    // Roots of ½: 2^(−1/64) after six, 2^(−1/128) after seven; Q62.
    let mut root = 1u128 << 61;
    let mut step = 0;
    let mut i = 0;
    while i < 7 {
        step = root;
        root = isqrt_wide(root << 62);
        i += 1;
    }
    let mut table = [0; 64];
    let mut value = root;
    let mut i = 0;
    while i < 64 {
        table[i] = ((value + (1 << 29)) >> 30) as u32;
        value = (value * step) >> 62;
        i += 1;
    }
    table
};

const fn isqrt_wide(x: u128) -> u128 {
    let mut root = 0;
    let mut bit = 1u128 << 63;
    while bit > 0 {
        if (root + bit) * (root + bit) <= x {
            root += bit;
        }
        bit >>= 1;
    }
    root
}

/// −log2(x / 2^32), Q26, 0 ..= 32: the logarithm of a share, `x` ≥ 1 (0 answers as 1 would).
///
/// Error: max 0.63 ulp (9.4e-9), RMS 0.29 ulp, mean 0.03 ulp (`tests/num_error`). A table of 64 and a
/// polynomial of degree 3 in what is left (under 2^-7), four wide products.
#[inline]
pub fn neg_log2(x: u32) -> u32 {
    let zeros = leading_zeros(x | 1);
    let n = (x | (x == 0) as u32) << zeros;
    let (r, log) = LOG[((n >> 25) & 63) as usize];
    // m·r = 1 + z, Q31, |z| < 2^-6.9; then six bits more.
    let z = mul_hi(n, (r as u32) << 16).wrapping_sub(1 << 31) as i32;
    let zz = z << 6;
    // log2(1 + z) = z (1.442695 − z (0.721348 − 0.480898 z)): Q37·Q31 → Q36, Q37·Q30 → Q35
    let third = mul_hi_signed(zz, 1_032_721_336) >> 5;
    let second = mul_hi_signed(zz, 1_549_082_005 - third) >> 6;
    let rest = mul_hi_signed(zz, 1_549_082_005 - second) >> 5;
    // Q30, since it may reach 1, or −1 ulp.
    let fraction = (log >> 1) as i32 - rest;
    (zeros << 26).saturating_add_signed((fraction + 8) >> 4)
}

/// 2^−x for `x` ≥ 0, Q26, as (mantissa, exponent): mantissa · 2^(−32 − exponent), mantissa in 2^31 ..= 2^32 − 1 (to one
/// ulp) and exponent 0 ..= 63.
///
/// Relative error: max 4.8e-10 (2^-31), RMS 1.5e-10, no bias (mean within 1e-11; `tests/num_error`). A table of 64 and
/// a polynomial of degree 3, five wide products.
#[inline]
pub fn exp2_neg(x: u32) -> (u32, u32) {
    let whole = EXP[((x >> 20) & 63) as usize];
    // 2^−δ = 1 − w + w²/2 − w³/6 with w = δ ln 2; |δ| ≤ 2^-7, Q37, so |w| ≤ 0.0054
    let delta = ((x & 0xf_ffff) as i32 - (1 << 19)) << 11;
    let w = mul_hi_signed(delta, 1_488_522_236);
    // Q38·Q38 → Q44; Q46·Q38 → Q52
    let square = mul_hi_signed(w << 2, w << 2);
    let cube = mul_hi_signed(square << 2, w << 2);
    let series = (square >> 9) - w - (((cube >> 16) * 10_923) >> 16);
    // Q31·Q38 → Q37
    let change = mul_hi_signed((whole >> 1) as i32, series << 2);
    (whole.saturating_add_signed((change + 16) >> 5), x >> 26)
}

/// A share to a power: (`x` / 2^32)^`n`, `x` ≥ 1 (0 answers as 1 would), `n` ≥ 0 in Q16; 0 below 2^-64.
///
/// Relative error, for n up to 2^14 and powers above 2^-32: max 1.1e-4, RMS 1e-5, no bias (mean within 1e-6;
/// `tests/num_error`); for n up to 30, max 1.6e-5 (half a step of [`Wide`] and a little more), RMS 6.5e-6.
#[inline]
pub fn pow(x: u32, n: u32) -> Wide {
    let log = neg_log2(x);
    if log == 0 || n == 0 {
        return Wide::ONE;
    }
    // Both with their highest bit set: the product is Q42 with 32 − zeros bits below.
    let (a, b) = (leading_zeros(log), leading_zeros(n));
    let product = mul_hi(log << a, n << b);
    let shift = (a + b) as i32 - 16;
    let power = if shift >= 0 {
        product.checked_shr(shift as u32).unwrap_or(0)
    } else if leading_zeros(product) >= -shift as u32 {
        product << -shift
    } else {
        return Wide::ZERO;
    };
    let (mantissa, exponent) = exp2_neg(power);
    Wide::new(mantissa, -32 - exponent as i32)
}
