//! Colours, linear sRGB: [`Albedo`] (a share a surface gives back) and [`Radiance`] (light, any magnitude), never mixed.

mod rgb9e5;

use crate::num::{Metres, Share, Wide, leading_zeros, mul_hi, recip};

pub use rgb9e5::Rgb9e5;

/// A share per channel, 0 ..= 1, steps of 2^-15, both ends exact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Albedo(pub [Share; 3]);

impl Albedo {
    pub const BLACK: Albedo = Albedo([Share::ZERO; 3]);
    pub const WHITE: Albedo = Albedo([Share::ONE; 3]);

    /// Of shares in 2^-15.
    pub const fn from_bits([r, g, b]: [u16; 3]) -> Albedo {
        Albedo([Share::from_bits(r), Share::from_bits(g), Share::from_bits(b)])
    }

    /// Of an sRGB signal (IEC 61966-2-1), each channel to the nearest share.
    #[inline]
    pub fn from_srgb(signal: [u8; 3]) -> Albedo {
        Albedo::from_bits(signal.map(|byte| SRGB[usize::from(byte)]))
    }

    /// Shares of shares, each rounded to nearest.
    #[inline]
    pub fn times(self, other: Albedo) -> Albedo {
        let product = |i: usize| {
            let bits = u32::from(self.0[i].to_bits()) * u32::from(other.0[i].to_bits());
            ((bits + (1 << 14)) >> 15) as u16
        };
        Albedo::from_bits([product(0), product(1), product(2)])
    }

    /// Whether every channel is at most 1.
    pub fn is_valid(&self) -> bool {
        self.0.iter().all(|c| *c <= Share::ONE)
    }

    /// The largest channel.
    #[inline]
    pub fn max(self) -> Share {
        self.0[0].max(self.0[1]).max(self.0[2])
    }
}

/// The light that each sRGB signal stands for, in 2^-15.
#[rustfmt::skip]
static SRGB: [u16; 256] = [
    0, 10, 20, 30, 40, 50, 60, 70, 80, 90, 99, 110,
    120, 132, 144, 157, 170, 184, 198, 213, 229, 246, 263, 281,
    299, 319, 338, 359, 381, 403, 425, 449, 473, 498, 524, 551,
    578, 606, 635, 665, 695, 727, 759, 792, 825, 860, 895, 931,
    969, 1006, 1045, 1085, 1125, 1167, 1209, 1252, 1296, 1341, 1386, 1433,
    1481, 1529, 1578, 1629, 1680, 1732, 1785, 1839, 1894, 1950, 2007, 2065,
    2123, 2183, 2244, 2306, 2368, 2432, 2496, 2562, 2629, 2696, 2765, 2834,
    2905, 2977, 3049, 3123, 3198, 3273, 3350, 3428, 3507, 3587, 3668, 3750,
    3833, 3917, 4002, 4089, 4176, 4264, 4354, 4444, 4536, 4629, 4723, 4818,
    4914, 5011, 5109, 5209, 5309, 5411, 5514, 5618, 5723, 5829, 5936, 6045,
    6155, 6265, 6377, 6490, 6605, 6720, 6837, 6954, 7073, 7193, 7315, 7437,
    7561, 7686, 7812, 7939, 8068, 8197, 8328, 8460, 8593, 8728, 8864, 9001,
    9139, 9278, 9419, 9561, 9704, 9848, 9994, 10_141, 10_289, 10_438, 10_589, 10_741,
    10_894, 11_048, 11_204, 11_361, 11_519, 11_679, 11_839, 12_001, 12_165, 12_329, 12_495, 12_663,
    12_831, 13_001, 13_172, 13_344, 13_518, 13_693, 13_870, 14_047, 14_226, 14_407, 14_588, 14_771,
    14_956, 15_141, 15_328, 15_517, 15_706, 15_897, 16_090, 16_284, 16_479, 16_675, 16_873, 17_072,
    17_273, 17_474, 17_678, 17_882, 18_088, 18_296, 18_504, 18_715, 18_926, 19_139, 19_353, 19_569,
    19_786, 20_005, 20_225, 20_446, 20_669, 20_893, 21_118, 21_345, 21_574, 21_803, 22_035, 22_267,
    22_501, 22_737, 22_974, 23_212, 23_452, 23_693, 23_936, 24_180, 24_425, 24_672, 24_921, 25_171,
    25_422, 25_675, 25_929, 26_185, 26_442, 26_701, 26_961, 27_223, 27_486, 27_750, 28_016, 28_284,
    28_553, 28_823, 29_095, 29_369, 29_644, 29_920, 30_198, 30_478, 30_759, 31_041, 31_325, 31_611,
    31_898, 32_186, 32_476, 32_768,
];

/// A colour of shares: `rgb(q!(0.61, Share), q!(0.06, Share), q!(0.06, Share))`.
pub const fn albedo(r: Share, g: Share, b: Share) -> Albedo {
    Albedo([r, g, b])
}

/// Light per channel: three 16-bit mantissas under one exponent.
///
/// Value of a channel: `mantissa / 2^15 · 2^exponent`. Normalised: the largest mantissa is 2^15 or more, or all are 0.
/// Results are rounded to nearest: a step's error, as a share of the largest channel, is 2^-16 at most, RMS 5.7e-6,
/// without bias (mean within 4e-7; `tests/num_error`). Units by use: W·sr⁻¹·m⁻²
/// for radiance; also intensity, irradiance, and a path's throughput.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Radiance {
    mantissa: [u16; 3],
    exponent: i16,
}

impl Radiance {
    pub const BLACK: Radiance = Radiance {
        mantissa: [0; 3],
        exponent: 0,
    };
    /// 1 in each channel: the throughput of a path's first vertex.
    pub const WHITE: Radiance = Radiance {
        mantissa: [1 << 15; 3],
        exponent: 0,
    };

    /// From three channels `bits · 2^exponent`.
    #[cfg_attr(not(narrow_mul), inline(always))]
    pub const fn from_bits(bits: [u32; 3], exponent: i32) -> Radiance {
        let all = bits[0] | bits[1] | bits[2];
        if all == 0 {
            return Radiance::BLACK;
        }
        // Keep 16 bits of the largest; if rounding carries past them, one bit fewer.
        // Of products by numbers that are normalised themselves, mostly 0 or 1.
        let zeros = match all >> 30 {
            0 => leading_zeros(all),
            1 => 1,
            _ => 0,
        };
        let top = [bits[0] << zeros, bits[1] << zeros, bits[2] << zeros];
        let mut m = round(top, 16);
        let mut e = exponent + 31 - zeros as i32;
        if (m[0] | m[1] | m[2]) > 0xffff {
            m = round(top, 17);
            e += 1;
        }
        if e != e as i16 as i32 {
            return Radiance::at_the_end(e);
        }
        Radiance {
            mantissa: [m[0] as u16, m[1] as u16, m[2] as u16],
            exponent: e as i16,
        }
    }

    /// What an exponent beyond the range leaves: nothing, or the largest there is.
    #[cold]
    const fn at_the_end(exponent: i32) -> Radiance {
        if exponent < 0 {
            return Radiance::BLACK;
        }
        Radiance {
            mantissa: [u16::MAX; 3],
            exponent: i16::MAX,
        }
    }

    /// From three lengths' worth of numbers (Q16); negative ones count as 0.
    pub const fn new(r: Metres, g: Metres, b: Metres) -> Radiance {
        const fn bits(x: Metres) -> u32 {
            if x.to_bits() < 0 { 0 } else { x.to_bits() as u32 }
        }
        Radiance::from_bits([bits(r), bits(g), bits(b)], -16)
    }

    /// The mantissas and the exponent, as the type's doc says.
    #[inline(always)]
    pub const fn to_parts(self) -> ([u16; 3], i16) {
        (self.mantissa, self.exponent)
    }

    #[inline(always)]
    pub const fn is_black(self) -> bool {
        self.mantissa[0] | self.mantissa[1] | self.mantissa[2] == 0
    }

    /// Shares of a number: `WHITE.mul_albedo(albedo).scale(by)`, the same bits.
    #[inline]
    pub const fn from_albedo(albedo: Albedo, by: Wide) -> Radiance {
        let m = by.mantissa() as u32;
        let a = [
            albedo.0[0].to_bits() as u32 * m,
            albedo.0[1].to_bits() as u32 * m,
            albedo.0[2].to_bits() as u32 * m,
        ];
        Radiance::from_bits(a, by.exponent() as i32 - 30)
    }

    /// Channel by channel, by shares.
    #[inline]
    pub const fn mul_albedo(self, by: Albedo) -> Radiance {
        let a = [
            by.0[0].to_bits() as u32,
            by.0[1].to_bits() as u32,
            by.0[2].to_bits() as u32,
        ];
        self.mul_channels(a, 0)
    }

    /// Channel by channel.
    #[inline]
    #[allow(clippy::should_implement_trait, reason = "const")]
    pub const fn mul(self, by: Radiance) -> Radiance {
        let a = [
            by.mantissa[0] as u32,
            by.mantissa[1] as u32,
            by.mantissa[2] as u32,
        ];
        self.mul_channels(a, by.exponent as i32)
    }

    #[inline]
    const fn mul_channels(self, a: [u32; 3], exponent: i32) -> Radiance {
        // 16 × 16 bits a channel; the value of a product is bits · 2^(-30 + exponents)
        let m = self.mantissa;
        let bits = [m[0] as u32 * a[0], m[1] as u32 * a[1], m[2] as u32 * a[2]];
        Radiance::from_bits(bits, self.exponent as i32 + exponent - 30)
    }

    /// All channels by one number.
    #[inline]
    pub const fn scale(self, by: Wide) -> Radiance {
        self.mul_channels([by.mantissa() as u32; 3], by.exponent() as i32)
    }

    /// All channels by a Q16 number; negative ones count as 0.
    #[inline]
    pub const fn scale_q16(self, by: i32) -> Radiance {
        self.scale(Wide::from_q16(by))
    }

    #[inline]
    #[allow(clippy::should_implement_trait, reason = "const")]
    pub const fn add(self, other: Radiance) -> Radiance {
        if self.is_black() {
            return other;
        }
        if other.is_black() {
            return self;
        }
        let (big, small) = if self.exponent >= other.exponent {
            (self, other)
        } else {
            (other, self)
        };
        let gap = (big.exponent as i32 - small.exponent as i32) as u32;
        if gap > 17 {
            return big;
        }
        // 14 more bits below keep the smaller one's; sums stay under 2^31.
        let mut bits = [0; 3];
        let mut i = 0;
        while i < 3 {
            bits[i] = ((big.mantissa[i] as u32) << 14) + (((small.mantissa[i] as u32) << 14) >> gap);
            i += 1;
        }
        Radiance::from_bits(bits, big.exponent as i32 - 29)
    }

    /// The largest channel.
    #[inline]
    pub const fn max_channel(self) -> Wide {
        let m = self.mantissa;
        let (a, b) = (if m[0] > m[1] { m[0] } else { m[1] }, m[2]);
        Wide::new(if a > b { a as u32 } else { b as u32 }, self.exponent as i32 - 15)
    }

    /// Luminance in whole 256ths, 54 : 183 : 19 (Rec. 709: 54.4, 183.1, 18.5): what to draw more of, not what is seen.
    ///
    /// More than 0 wherever a channel is.
    #[inline]
    pub const fn luminance(self) -> Wide {
        let m = self.mantissa;
        let sum = 54 * m[0] as u32 + 183 * m[1] as u32 + 19 * m[2] as u32;
        Wide::new(sum, self.exponent as i32 - 23)
    }

    /// Channels with 32 bits below the point, rounded to nearest, at most 2^16 (`(1 << 48) − 1`): what a film adds up.
    #[inline]
    pub const fn to_q32(self) -> [u64; 3] {
        let mut q = [0; 3];
        let shift = self.exponent as i32 + 17;
        let mut i = 0;
        while i < 3 {
            let m = self.mantissa[i] as u64;
            q[i] = if m == 0 || shift < -16 {
                0
            } else if shift < 0 {
                (m + (1 << (-shift - 1))) >> -shift
            } else if shift < 33 {
                m << shift
            } else {
                (1 << 48) - 1
            };
            i += 1;
        }
        q
    }

    /// Whether [`mean_q32`] of this sample alone gives it back, bit for bit: where no bit lies below the sums' last, and none
    /// is cut off.
    #[inline]
    pub const fn is_its_mean(self) -> bool {
        self.exponent >= -17 && self.exponent <= 15
    }
}

/// The mean of `count` ≥ 1 samples whose [`Radiance::to_q32`] were added up; sums under 2^64.
///
/// Error, as a share of the largest channel: 2^-16 at most, RMS 6.3e-6, no bias (mean within 1e-7;
/// `tests/num_error`).
pub fn mean_q32(sum: [u64; 3], count: u32) -> Radiance {
    let all = sum[0] | sum[1] | sum[2];
    if all == 0 {
        return Radiance::BLACK;
    }
    // The largest sum fills 32 bits, the others keep in step; then one product and one rounding.
    let zeros = if all >> 32 == 0 {
        32 + leading_zeros(all as u32)
    } else {
        leading_zeros((all >> 32) as u32)
    };
    let r = recip(count);
    let bits = sum.map(|s| mul_hi(((s << zeros) >> 32) as u32, r.mantissa));
    Radiance::from_bits(bits, 32 - zeros as i32 - r.shift as i32)
}

/// `bits / 2^shift`, halves up; `shift` ≥ 1.
#[inline(always)]
const fn round(bits: [u32; 3], shift: u32) -> [u32; 3] {
    // ((x >> (shift - 1)) + 1) >> 1 cannot overflow where ⌊(x + half) >> shift⌋ would.
    let s = shift - 1;
    [
        ((bits[0] >> s) + 1) >> 1,
        ((bits[1] >> s) + 1) >> 1,
        ((bits[2] >> s) + 1) >> 1,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sample_is_its_mean() {
        let mut s = 9u32;
        let mut r = || {
            s = s.wrapping_mul(747796405).wrapping_add(2891336453);
            (s ^ (s >> 15)) >> (s & 31)
        };
        let mut plain = 0;
        for _ in 0..200_000 {
            let light = Radiance::from_bits([r(), r(), r()], (r() % 40) as i32 - 50);
            if light.is_its_mean() {
                plain += 1;
                assert_eq!(mean_q32(light.to_q32(), 1), light, "{light:?}");
            }
        }
        assert!(plain > 50_000, "{plain}");
        for exponent in [-18, 16] {
            let light = Radiance::from_bits([0xffff_0000, 0x8001_0000, 0], exponent - 31);
            assert_ne!(mean_q32(light.to_q32(), 1), light);
        }
    }
}
