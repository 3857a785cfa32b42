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

/// ⌊a·`share` / 2^8⌋ of a share of 1, Q16, and |a| under 2^16: eight bits below the point.
#[inline(always)]
pub const fn mul_share(a: i32, share: i32) -> i32 {
    #[cfg(narrow_mul)]
    return narrow::mul_share(a, share);
    #[cfg(not(narrow_mul))]
    return mul_q16(a << 8, share);
}

/// [`mul_q16`], quicker on narrow cores where `unit` is −1, 0 or 1 (Q16): of directions that are often axes.
#[inline(always)]
pub const fn mul_unit(a: i32, unit: i32) -> i32 {
    #[cfg(narrow_mul)]
    return narrow::mul_unit(a, unit);
    #[cfg(not(narrow_mul))]
    return mul_q16(a, unit);
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

/// [`mul_shift`] of |a| ≤ 2^20 and `shift` in 22 ..= 53, quicker on narrow cores.
#[inline(always)]
pub const fn mul_shift_brief(a: i32, b: i32, shift: u32) -> i32 {
    #[cfg(narrow_mul)]
    return narrow::mul_shift_brief(a, b, shift);
    #[cfg(not(narrow_mul))]
    return mul_shift(a, b, shift);
}

/// [`mul_shift`] of |a| < 2^26, b ≥ 0 and `shift` in 27 ..= 58, quicker on narrow cores.
#[inline(always)]
pub const fn mul_shift_medium(a: i32, b: i32, shift: u32) -> i32 {
    #[cfg(narrow_mul)]
    return narrow::mul_shift_medium(a, b, shift);
    #[cfg(not(narrow_mul))]
    return mul_shift(a, b, shift);
}

/// ⌊a·b / 2^`shift`⌋ of factors that are not negative, wrapped to 32 bits; `shift` in 1 ..= 31.
#[inline(always)]
pub const fn mul_shift_short(a: u32, b: u32, shift: u32) -> u32 {
    #[cfg(narrow_mul)]
    return narrow::mul_shift_short(a, b, shift);
    #[cfg(not(narrow_mul))]
    return ((a as u64 * b as u64) >> shift) as u32;
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

/// Σ a·b / 2^8 of three components within ±2^16 (and a little), Q16: Q24, rounded down.
#[inline(always)]
pub const fn dot_q24(a: [i32; 3], b: [i32; 3]) -> i32 {
    // a = 2^8 ah + al: Σ ah·b < 2^26 and Σ al·b < 2^26 in magnitude.
    let high = (a[0] >> 8) * b[0] + (a[1] >> 8) * b[1] + (a[2] >> 8) * b[2];
    let low = (a[0] & 255) * b[0] + (a[1] & 255) * b[1] + (a[2] & 255) * b[2];
    high + (low >> 8)
}

/// [`dot_q24`], quicker on narrow cores where `unit` is an axis.
#[inline(always)]
pub const fn dot_unit(a: [i32; 3], unit: [i32; 3]) -> i32 {
    #[cfg(narrow_mul)]
    return narrow::dot_unit(a, unit);
    #[cfg(not(narrow_mul))]
    return dot_q24(a, unit);
}

/// [`dot_q24`], quicker on narrow cores where components of `unit` are 0.
#[inline(always)]
pub const fn dot_sparse(a: [i32; 3], unit: [i32; 3]) -> i32 {
    #[cfg(narrow_mul)]
    return narrow::dot_sparse(a, unit);
    #[cfg(not(narrow_mul))]
    return dot_q24(a, unit);
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

    /// See [`super::mul_share`]. Two products, each under 2^24.
    #[inline(always)]
    pub const fn mul_share(a: i32, share: i32) -> i32 {
        a * (share >> 8) + ((a * (share & 255)) >> 8)
    }

    /// See [`super::mul_unit`].
    #[inline(always)]
    pub const fn mul_unit(a: i32, unit: i32) -> i32 {
        if unit & 0xffff == 0 {
            a.wrapping_mul(unit >> 16)
        } else {
            mul_q16(a, unit)
        }
    }

    /// See [`super::dot_unit`]. The products of an axis have no bits to be cut off.
    #[inline(always)]
    pub const fn dot_unit(a: [i32; 3], unit: [i32; 3]) -> i32 {
        if (unit[0] | unit[1] | unit[2]) & 0xffff == 0 {
            (a[0] * (unit[0] >> 16) + a[1] * (unit[1] >> 16) + a[2] * (unit[2] >> 16)) << 8
        } else {
            super::dot_q24(a, unit)
        }
    }

    /// See [`super::dot_sparse`].
    #[inline(always)]
    pub const fn dot_sparse(a: [i32; 3], unit: [i32; 3]) -> i32 {
        let (mut high, mut low) = (0, 0);
        let mut i = 0;
        while i < 3 {
            if unit[i] != 0 {
                high += (a[i] >> 8) * unit[i];
                low += (a[i] & 255) * unit[i];
            }
            i += 1;
        }
        high + (low >> 8)
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

    /// See [`super::mul_shift_brief`]. Three products, each rounded down once the next is added: |a| times 11 bits, and as much
    /// again carried, stays under 2^31.
    #[inline(always)]
    pub const fn mul_shift_brief(a: i32, b: i32, shift: u32) -> i32 {
        let (high, middle, low) = (b >> 22, (b >> 11) & 0x7ff, b & 0x7ff);
        let sum = a * middle + ((a * low) >> 11);
        (a * high + (sum >> 11)) >> (shift.wrapping_sub(22) & 31)
    }

    /// See [`super::mul_shift_medium`]. Four products: ah of 14 bits and a sign, al of 12; bh of 16, bl of 15.
    #[inline(always)]
    pub const fn mul_shift_medium(a: i32, b: i32, shift: u32) -> i32 {
        let (ah, al) = (a >> 12, a & 0xfff);
        let (bh, bl) = (b >> 15, b & 0x7fff);
        // (ah·2^12 + al)(bh·2^15 + bl), by turns rounded down to 2^12, 2^15 and 2^27.
        let sum = ah * bl + ((al * bl) >> 12);
        let sum = al * bh + (sum >> 3);
        (ah * bh + (sum >> 12)) >> (shift.wrapping_sub(27) & 31)
    }

    /// See [`super::mul_shift_short`].
    #[inline(always)]
    pub const fn mul_shift_short(a: u32, b: u32, shift: u32) -> u32 {
        let (low, high) = wide(a, b);
        low >> (shift & 31) | high << (32u32.wrapping_sub(shift) & 31)
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
