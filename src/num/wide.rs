use super::recip::ratio_q16;
use super::{leading_zeros, rsqrt};

/// A number ≥ 0 with 16 bits of precision and an exponent of 16 bits: densities, solid angles, 1/d², weights.
///
/// Value: `mantissa / 2^15 · 2^exponent`, mantissa in 2^15 ..= 2^16 − 1, or 0. Results are rounded to nearest:
/// error ½ ulp, 2^-16 of the value, at most (quotients and roots 0.501 ulp), RMS 0.3 ulp, no bias (mean within
/// 0.035 ulp; `tests/num_error`). Above 2^32767 they stay at the largest, below 2^-32768 they become 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Wide {
    mantissa: u16,
    exponent: i16,
}

impl Wide {
    pub const ZERO: Wide = Wide {
        mantissa: 0,
        exponent: 0,
    };
    pub const ONE: Wide = Wide {
        mantissa: 1 << 15,
        exponent: 0,
    };
    /// π.
    pub const PI: Wide = Wide {
        mantissa: 51472,
        exponent: 1,
    };
    /// 1/π.
    pub const INV_PI: Wide = Wide {
        mantissa: 41722,
        exponent: -2,
    };
    const MAX: Wide = Wide {
        mantissa: u16::MAX,
        exponent: i16::MAX,
    };

    /// `x · 2^exponent`, rounded to nearest.
    #[inline]
    pub const fn new(x: u32, exponent: i32) -> Wide {
        if x == 0 {
            return Wide::ZERO;
        }
        let zeros = leading_zeros(x);
        let n = x << zeros;
        // The top 16 bits, rounded by the bit below; 0xffff_8000 and up carry into the next octave.
        if n >= 0xffff_8000 {
            Wide::pack(1 << 15, exponent + 32 - zeros as i32)
        } else {
            Wide::pack((n + 0x8000) >> 16, exponent + 31 - zeros as i32)
        }
    }

    /// A Q16 number; negative ones count as 0.
    #[inline]
    pub const fn from_q16(x: i32) -> Wide {
        Wide::new(if x < 0 { 0 } else { x as u32 }, -16)
    }

    /// The mantissa, 2^15 ..= 2^16 − 1, or 0.
    #[inline(always)]
    pub const fn mantissa(self) -> u16 {
        self.mantissa
    }

    /// The exponent of the value's leading bit.
    #[inline(always)]
    pub const fn exponent(self) -> i16 {
        self.exponent
    }

    #[inline(always)]
    pub const fn is_zero(self) -> bool {
        self.mantissa == 0
    }

    #[inline(always)]
    const fn pack(mantissa: u32, exponent: i32) -> Wide {
        if exponent != exponent as i16 as i32 {
            return Wide::at_the_end(exponent);
        }
        Wide {
            mantissa: mantissa as u16,
            exponent: exponent as i16,
        }
    }

    /// What an exponent beyond the range leaves: nothing, or the largest there is.
    #[cold]
    const fn at_the_end(exponent: i32) -> Wide {
        if exponent < 0 { Wide::ZERO } else { Wide::MAX }
    }

    #[inline]
    #[allow(
        clippy::should_implement_trait,
        reason = "const, and the operators below call it"
    )]
    pub const fn mul(self, other: Wide) -> Wide {
        if self.mantissa == 0 || other.mantissa == 0 {
            return Wide::ZERO;
        }
        // 2^30 ≤ product < 2^32
        let product = self.mantissa as u32 * other.mantissa as u32;
        let exponent = self.exponent as i32 + other.exponent as i32;
        if product >= 0x7fff_c000 {
            Wide::pack(
                (product + if product < 0x8000_0000 { 0x4000 } else { 0x8000 }) >> 16,
                exponent + 1,
            )
        } else {
            Wide::pack((product + 0x4000) >> 15, exponent)
        }
    }

    #[inline]
    #[allow(
        clippy::should_implement_trait,
        reason = "const, and the operators below call it"
    )]
    pub const fn add(self, other: Wide) -> Wide {
        let (big, small) = if self.is_at_least(other) {
            (self, other)
        } else {
            (other, self)
        };
        let gap = big.exponent as i32 - small.exponent as i32;
        if small.mantissa == 0 || gap > 16 {
            return big;
        }
        // Both with 15 bits below the mantissa's last.
        let sum = ((big.mantissa as u32) << 15) + (((small.mantissa as u32) << 15) >> gap);
        if sum >= 0x7fff_c000 {
            Wide::pack((sum + 0x8000) >> 16, big.exponent as i32 + 1)
        } else {
            Wide::pack((sum + 0x4000) >> 15, big.exponent as i32)
        }
    }

    /// `self − other`, or 0 where `other` is the larger.
    #[inline]
    pub const fn saturating_sub(self, other: Wide) -> Wide {
        if !self.is_at_least(other) {
            return Wide::ZERO;
        }
        let gap = self.exponent as i32 - other.exponent as i32;
        // Just above a power of two the difference has finer steps than `self`: 17 still counts.
        if other.mantissa == 0 || gap > 17 {
            return self;
        }
        let difference = ((self.mantissa as u32) << 15) - (((other.mantissa as u32) << 15) >> gap);
        Wide::new(difference, self.exponent as i32 - 30)
    }

    /// 1/x; the largest number for 0.
    #[inline]
    pub fn recip(self) -> Wide {
        if self.mantissa == 0 {
            return Wide::MAX;
        }
        Wide::ONE.div(self)
    }

    #[inline]
    #[allow(clippy::should_implement_trait, reason = "the operator below calls it")]
    pub fn div(self, other: Wide) -> Wide {
        if self.mantissa == 0 {
            return Wide::ZERO;
        }
        if other.mantissa == 0 {
            return Wide::MAX;
        }
        let exponent = self.exponent as i32 - other.exponent as i32;
        let (a, b) = (self.mantissa as u32, other.mantissa as u32);
        let ratio = ratio_q16(a, b);
        // Rounded by the bit below the last one, or by the remainder where there is none; neither carries.
        if a >= b {
            Wide::pack((ratio + 1) >> 1, exponent)
        } else {
            let rest = (a << 16) - ratio * b;
            Wide::pack(ratio + (2 * rest >= b) as u32, exponent - 1)
        }
    }

    #[inline]
    pub fn sqrt(self) -> Wide {
        if self.mantissa == 0 {
            return Wide::ZERO;
        }
        // x/√x with the exponent made even: m · 2^(e - 15) = (m << odd) · 2^(even)
        let odd = ((self.exponent as i32 - 15) & 1) as u32;
        let m = (self.mantissa as u32) << odd;
        let even = self.exponent as i32 - 15 - odd as i32;
        let (mantissa, half) = rsqrt(m);
        let root = super::mul_hi(mantissa, m << 15);
        Wide::new(root, half as i32 + even / 2 - 30)
    }

    #[inline]
    pub const fn is_at_least(self, other: Wide) -> bool {
        if self.mantissa == 0 || other.mantissa == 0 {
            return other.mantissa == 0;
        }
        self.exponent > other.exponent || (self.exponent == other.exponent && self.mantissa >= other.mantissa)
    }

    /// `self · 2^n`, exactly.
    #[inline]
    pub const fn shl(self, n: i32) -> Wide {
        if self.mantissa == 0 {
            self
        } else {
            Wide::pack(self.mantissa as u32, self.exponent as i32 + n)
        }
    }

    /// The value with `fraction` bits below the point, rounded to nearest, at most `u32::MAX`.
    #[inline]
    pub const fn to_fixed(self, fraction: i32) -> u32 {
        let shift = self.exponent as i32 - 15 + fraction;
        if self.mantissa == 0 || shift < -16 {
            0
        } else if shift < 0 {
            ((self.mantissa as u32) + (1 << (-shift - 1))) >> -shift
        } else if shift <= 16 {
            (self.mantissa as u32) << shift
        } else {
            u32::MAX
        }
    }
}

impl core::ops::Mul for Wide {
    type Output = Wide;
    #[inline]
    fn mul(self, other: Wide) -> Wide {
        Wide::mul(self, other)
    }
}

impl core::ops::Add for Wide {
    type Output = Wide;
    #[inline]
    fn add(self, other: Wide) -> Wide {
        Wide::add(self, other)
    }
}

impl core::ops::Div for Wide {
    type Output = Wide;
    #[inline]
    fn div(self, other: Wide) -> Wide {
        Wide::div(self, other)
    }
}

impl PartialOrd for Wide {
    #[inline]
    fn partial_cmp(&self, other: &Wide) -> Option<core::cmp::Ordering> {
        Some(if self == other {
            core::cmp::Ordering::Equal
        } else if self.is_at_least(*other) {
            core::cmp::Ordering::Greater
        } else {
            core::cmp::Ordering::Less
        })
    }
}
