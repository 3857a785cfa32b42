use super::{leading_zeros, mul_hi, mul_shift, mul_shift_brief};

/// 1/x as `mantissa · 2^(−shift)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Recip {
    /// In 2^31 ..= 2^32 − 1.
    pub mantissa: u32,
    /// In 32 ..= 63.
    pub shift: u32,
}

impl Recip {
    /// a/x times 2^`extra`, for answers under 2^31 − 8 in magnitude; `extra` < `shift`.
    ///
    /// The reciprocal's error, then rounded down: for answers under 2^16 error in (−1.001, 0.001) ulp, RMS 0.65, mean
    /// −0.5, so that an exact quotient may come out one less; for any, max 7 ulp, RMS 1.25, mean −0.42
    /// (`tests/num_error`).
    #[inline(always)]
    pub const fn times(self, a: i32, extra: u32) -> i32 {
        // The mantissa has 32 bits: halve it so that it fits the signed product.
        mul_shift(a, (self.mantissa >> 1) as i32, self.shift - 1 - extra)
    }

    /// [`Self::times`], the same bits, quicker on narrow cores where |a| is 2^20 at most and x is not small.
    #[inline(always)]
    pub const fn times_short(self, a: i32, extra: u32) -> i32 {
        let shift = self.shift - 1 - extra;
        if cfg!(narrow_mul) && shift >= 22 && a.unsigned_abs() <= 1 << 20 {
            mul_shift_brief(a, (self.mantissa >> 1) as i32, shift)
        } else {
            self.times(a, extra)
        }
    }
}

/// First guesses 2^47/n for n in [2^31, 2^32) by its seven bits below the top one, at each interval's middle.
pub(crate) static RECIPS: [u16; 128] = {
    let mut table = [0; 128];
    let mut i = 0;
    while i < 128 {
        let middle = (2 * (128 + i as u64) + 1) << 23;
        table[i] = (((1u64 << 47) + middle / 2) / middle) as u16;
        i += 1;
    }
    table
};

/// Reciprocal of `x` ≥ 1 (0 answers as 1 would).
///
/// Relative error: max 3.0e-9 (2^-28.3; 2^31 ..= 2^32 − 1 tried one by one), RMS 7.3e-10, mean −4.4e-10
/// (`tests/num_error`). Table of 128, one Newton step in 16 bits, one in 32.
#[inline]
pub fn recip(x: u32) -> Recip {
    let zeros = leading_zeros(x | 1).min(31);
    Recip {
        mantissa: recip_of_large((x | (x == 0) as u32) << zeros),
        shift: 63 - zeros,
    }
}

/// The mantissa of [`recip`] of 2^31 and more: 2^63/n.
#[inline(always)]
pub(crate) fn recip_of_large(n: u32) -> u32 {
    // r ≈ 2^47/n, 16 bits. |e| ≤ 2^31 · 2^-8, so the product stays under 2^16 · 2^14.
    let r = RECIPS[((n >> 24) & 127) as usize] as i32;
    let e = (1i32 << 31).wrapping_sub(((n >> 16).wrapping_mul(r as u32)) as i32);
    let r = r + ((r * (e >> 9)) >> 22);
    // R = 2^62/n to 2^-15; n·R/2^32 = 2^30 (1 + error), which the second step takes back.
    let big = (r as u32) << 15;
    // That product's high word, exactly: r has 16 bits, so two products do where they are narrow.
    #[cfg(narrow_mul)]
    let high = ((n >> 16) * r as u32 + (((n & 0xffff) * r as u32) >> 16)) >> 1;
    #[cfg(not(narrow_mul))]
    let high = mul_hi(n, big);
    let e = (1i32 << 30) - high as i32;
    let big = big.wrapping_add((((r >> 1) * e) >> 14) as u32);
    if big >= 1 << 31 { u32::MAX } else { big << 1 }
}

/// a/b in 2^-32, for `a` ≤ `b`; the largest number below 1 where they are equal, 0 for 0/0.
///
/// Error: 14 steps of 2^-32 at most, RMS 1.5, mean −1.2 (`tests/num_error`).
#[inline]
pub fn ratio(a: u32, b: u32) -> u32 {
    let r = recip(b);
    // a·2^zeros · mantissa / 2^63: one bit fewer than wanted, so that nothing overflows.
    let half = mul_hi(a << (63 - r.shift), r.mantissa);
    half.min((1 << 31) - 1) << 1
}

/// ⌊2^16 · a/b⌋, exactly, for a and b in 2^15 ..= 2^16 − 1: 2^15 < answer < 2^17.
///
/// One function, so that a core without a divider can have its own form of the same answer; the twins were held equal for
/// every a and b.
#[inline(always)]
pub(crate) const fn ratio_q16(a: u32, b: u32) -> u32 {
    #[cfg(narrow_mul)]
    return narrow_ratio_q16(a, b);
    #[cfg(not(narrow_mul))]
    return match (a << 16).checked_div(b) {
        Some(ratio) => ratio,
        None => u32::MAX,
    };
}

/// 2^31/b, in 2^15 ..= 2^16, for b in 2^15 ..= 2^16 − 1; for others any number.
///
/// Relative error: max 3.4e-5, RMS 1.6e-5, mean −1.42e-5 (`tests/num_error`). Table of 128, one Newton step: two products.
#[inline(always)]
pub const fn short_recip(b: u32) -> i32 {
    let r = RECIPS[((b >> 8) & 127) as usize] as i32;
    let e = (1i32 << 31).wrapping_sub(b.wrapping_mul(r as u32) as i32);
    r + (r.wrapping_mul(e >> 9) >> 22)
}

/// [`ratio_q16`] where dividing takes long: by [`short_recip`], once more by the remainder, one off put right.
#[cfg(any(narrow_mul, test))]
#[inline]
const fn narrow_ratio_q16(a: u32, b: u32) -> u32 {
    let r = short_recip(b);
    let ratio = (a * r as u32) >> 15;
    // Within 8 of the answer: the rest is under 2^19.
    let rest = (a << 16).wrapping_sub(ratio.wrapping_mul(b)) as i32;
    let ratio = ratio.wrapping_add_signed(((rest >> 4) * (r >> 1)) >> 26);
    let rest = (a << 16).wrapping_sub(ratio.wrapping_mul(b)) as i32;
    ratio + (rest >= b as i32) as u32 - (rest < 0) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_divide_alike() {
        // Every divisor, and so many dividends that each is met by some.
        for b in 1 << 15..1 << 16 {
            for a in ((1 << 15) | (b % 251)..1 << 16)
                .step_by(251)
                .chain([1 << 15, b - 1, b, 65535])
            {
                let a = a.clamp(1 << 15, 65535);
                assert_eq!(ratio_q16(a, b), (a << 16) / b, "{a} {b}");
                assert_eq!(narrow_ratio_q16(a, b), (a << 16) / b, "{a} {b}");
            }
        }
    }
}
