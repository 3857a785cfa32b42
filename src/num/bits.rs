/// Number of zero bits above the highest one; 32 for 0.
///
/// One function, so that a core without CLZ can have its own form of the same answer.
#[inline]
pub const fn leading_zeros(x: u32) -> u32 {
    #[cfg(counted_zeros)]
    return x.leading_zeros();
    #[cfg(not(counted_zeros))]
    return narrow_leading_zeros(x);
}

/// Zeros above the highest bit of a byte.
#[cfg(any(not(counted_zeros), test))]
pub(crate) static BYTE_ZEROS: [u8; 256] = {
    let mut table = [0; 256];
    let mut i = 0;
    while i < 256 {
        table[i] = (i as u8).leading_zeros() as u8;
        i += 1;
    }
    table
};

/// [`leading_zeros`] where there is no instruction for it: the highest byte that is not 0, and a table.
#[cfg(any(not(counted_zeros), test))]
#[inline]
const fn narrow_leading_zeros(x: u32) -> u32 {
    let (above, byte) = if x >> 24 != 0 {
        (0, x >> 24)
    } else if x >> 16 != 0 {
        (8, x >> 16)
    } else if x >> 8 != 0 {
        (16, x >> 8)
    } else {
        (24, x)
    };
    above + BYTE_ZEROS[byte as usize & 255] as u32
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_count_the_same_zeros() {
        for bit in 0..32 {
            for x in [1u32 << bit, (1 << bit) - 1, (1 << bit) | 1, u32::MAX >> bit] {
                assert_eq!(narrow_leading_zeros(x), x.leading_zeros(), "{x:#x}");
            }
        }
        assert_eq!(narrow_leading_zeros(0), 32);
    }
}
