/// Number of zero bits above the highest one; 32 for 0.
///
/// One function, so that a core without CLZ can have its own form of the same answer.
#[inline]
pub const fn leading_zeros(x: u32) -> u32 {
    x.leading_zeros()
}

/// The right shift that brings three components under `2^bits`; 0 if they are already.
///
/// Range: 0 ..= 32 − `bits`. The largest magnitude decides; `i32::MIN` counts as 2^31.
#[inline]
pub const fn normalize_shift(v: [i32; 3], bits: u32) -> u32 {
    // x ^ (x >> 31) is |x| or |x| - 1: -2^bits itself needs one bit fewer than +2^bits, and fits.
    let m = (v[0] ^ (v[0] >> 31)) | (v[1] ^ (v[1] >> 31)) | (v[2] ^ (v[2] >> 31));
    (32 - leading_zeros(m as u32)).saturating_sub(bits)
}

/// x / 2^`shift`, rounded to nearest (halves up); `shift` in 0 ..= 31.
#[inline(always)]
pub const fn round_shift(x: i32, shift: u32) -> i32 {
    if shift == 0 {
        x
    } else {
        ((x >> (shift - 1)) + 1) >> 1
    }
}
