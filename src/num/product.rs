/// ⌊a·b / 2^16⌋, wrapped to 32 bits: a Q16 factor leaves the other's format as it is.
///
/// Exact floor: error in (−1, 0] ulp, RMS 0.58, mean −½ (`tests/num_error`). |a·b| < 2^47 does not wrap.
#[inline(always)]
pub const fn mul_q16(a: i32, b: i32) -> i32 {
    #[cfg(narrow_mul)]
    return narrow::mul_q16(a, b);
    #[cfg(not(narrow_mul))]
    return ((a as i64 * b as i64) >> 16) as i32;
}

/// ⌊a·b / 2^`shift`⌋, wrapped to 32 bits; `shift` in 0 ..= 63.
///
/// Exact floor: error in (−1, 0] ulp, RMS 0.58, mean −½ (`tests/num_error`).
#[inline(always)]
pub const fn mul_shift(a: i32, b: i32, shift: u32) -> i32 {
    #[cfg(narrow_mul)]
    return narrow::mul_shift(a, b, shift);
    #[cfg(not(narrow_mul))]
    return ((a as i64 * b as i64) >> shift) as i32;
}

/// ⌊a·b / 2^32⌋: the high word.
///
/// Exact floor: error in (−1, 0] ulp, RMS 0.58, mean −½ (`tests/num_error`).
#[inline(always)]
pub const fn mul_hi(a: u32, b: u32) -> u32 {
    #[cfg(narrow_mul)]
    return narrow::mul_hi(a, b);
    #[cfg(not(narrow_mul))]
    return ((a as u64 * b as u64) >> 32) as u32;
}

/// ⌊a·b / 2^32⌋ of signed factors: the high word.
#[inline(always)]
pub const fn mul_hi_signed(a: i32, b: i32) -> i32 {
    #[cfg(narrow_mul)]
    return narrow::mul_hi_signed(a, b);
    #[cfg(not(narrow_mul))]
    return ((a as i64 * b as i64) >> 32) as i32;
}

/// The same products from 32×32→32 multiplications alone; `tests/num_error` holds the twins equal.
pub mod narrow {
    /// See [`super::mul_q16`]. Four products: ah·bh·2^16 + ah·bl + al·bh + ⌊al·bl / 2^16⌋, modulo 2^32.
    #[inline(always)]
    pub const fn mul_q16(a: i32, b: i32) -> i32 {
        let (ah, al) = (a >> 16, a & 0xffff);
        let (bh, bl) = (b >> 16, b & 0xffff);
        let low = (al as u32).wrapping_mul(bl as u32) >> 16;
        (ah.wrapping_mul(bh) << 16)
            .wrapping_add(ah.wrapping_mul(bl))
            .wrapping_add(al.wrapping_mul(bh))
            .wrapping_add(low as i32)
    }

    /// See [`super::mul_hi`]. The middle products carry into the high word.
    #[inline(always)]
    pub const fn mul_hi(a: u32, b: u32) -> u32 {
        wide(a, b).1
    }

    /// See [`super::mul_hi_signed`].
    #[inline(always)]
    pub const fn mul_hi_signed(a: i32, b: i32) -> i32 {
        let (ah, al) = (a >> 16, a & 0xffff);
        let (bh, bl) = (b >> 16, b & 0xffff);
        // |ah·bl| < 2^31, and what the low product carries is under 2^16.
        let carry = (((al as u32).wrapping_mul(bl as u32)) >> 16) as i32;
        let (mid, other) = (ah * bl, al * bh);
        // Each middle product by halves, so that their sum needs no more than 32 bits.
        let low = (mid & 0xffff) + (other & 0xffff) + carry;
        ah * bh + (mid >> 16) + (other >> 16) + (low >> 16)
    }

    /// See [`super::mul_shift`].
    #[inline]
    pub const fn mul_shift(a: i32, b: i32, shift: u32) -> i32 {
        // A signed high word is the unsigned one less the other factor for each negative factor.
        let (low, high) = wide(a as u32, b as u32);
        let high = (high as i32)
            .wrapping_sub((a >> 31) & b)
            .wrapping_sub((b >> 31) & a);
        if shift == 0 {
            low as i32
        } else if shift < 32 {
            ((low >> shift) | ((high as u32) << (32 - shift))) as i32
        } else {
            high >> (shift - 32)
        }
    }

    /// The whole product as (low, high).
    #[inline(always)]
    const fn wide(a: u32, b: u32) -> (u32, u32) {
        let (ah, al) = (a >> 16, a & 0xffff);
        let (bh, bl) = (b >> 16, b & 0xffff);
        let (mid, carry) = ah.wrapping_mul(bl).overflowing_add(al.wrapping_mul(bh));
        let (low, carry_low) = al.wrapping_mul(bl).overflowing_add(mid << 16);
        let high = ah.wrapping_mul(bh) + (mid >> 16) + ((carry as u32) << 16) + carry_low as u32;
        (low, high)
    }
}
