use super::{Albedo, Radiance};
use crate::num::leading_zeros;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// Light in four bytes, three mantissas of nine bits under one exponent: `mantissa · 2^(exponent − 24)`.
///
/// Red in the lowest bits, the exponent in the highest five (GL_EXT_texture_shared_exponent). The mantissas of one
/// light need not fill their bits; [`Self::encode`] makes those that do.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct Rgb9e5(pub u32);

impl Rgb9e5 {
    pub const BLACK: Rgb9e5 = Rgb9e5(0);

    /// Rounded to nearest; channels over 65408 count as that.
    ///
    /// Error: half a step of the largest channel's, which is 2^-9 of it at most, above 2^-16; 2^-25 below.
    #[inline]
    pub fn encode(light: Radiance) -> Rgb9e5 {
        // Mantissas of 16 bits, the largest full: seven too many.
        let (m, exponent) = light.to_parts();
        let [r, g, b] = m.map(u32::from);
        let e = exponent as i32 - 15 + 7 + 24;
        if (0..31).contains(&e) && (r | g | b) >> 15 == 1 {
            // Nothing ends here: what `from_bits` does, one bit more where rounding carries.
            let round = |shift: u32| [r, g, b].map(|c| ((c >> (shift - 1)) + 1) >> 1);
            let (mut m, mut e) = (round(7), e as u32);
            if (m[0] | m[1] | m[2]) > 511 {
                (m, e) = (round(8), e + 1);
            }
            return Rgb9e5(m[0] | m[1] << 9 | m[2] << 18 | e << 27);
        }
        Self::at_an_end([r, g, b], exponent as i32 - 15)
    }

    /// Three channels under 2^16, times 2^`exponent`, times shares: `encode(Radiance::from_bits(..).mul_albedo(by))`, the
    /// same bits.
    #[inline]
    pub(crate) fn encode_product(channels: [u32; 3], exponent: i32, by: Albedo) -> Rgb9e5 {
        let bits = [0, 1, 2].map(|i| channels[i] * u32::from(by.0[i].to_bits()));
        Rgb9e5::encode_bits(bits, exponent - 15)
    }

    /// `encode(Radiance::from_bits(bits, exponent))`, the same bits.
    #[inline(always)]
    fn encode_bits(bits: [u32; 3], exponent: i32) -> Rgb9e5 {
        // Halves up to 16 bits and then to nine: both at once where neither carries. In units of 2, to stay under 2^32.
        const HALVES: u32 = (1 << 14) + (1 << 21);
        let all = bits[0] | bits[1] | bits[2];
        if all == 0 {
            return Rgb9e5::BLACK;
        }
        let zeros = leading_zeros(all);
        let [r, g, b] = bits.map(|bits| (((bits << zeros) >> 1) + HALVES) >> 22);
        let e = exponent + 47 - zeros as i32;
        if r | g | b < 512 && (1..31).contains(&e) {
            return Rgb9e5(r | g << 9 | b << 18 | (e as u32) << 27);
        }
        Rgb9e5::encode_at_the_end(bits, exponent)
    }

    #[cold]
    fn encode_at_the_end(bits: [u32; 3], exponent: i32) -> Rgb9e5 {
        Rgb9e5::encode(Radiance::from_bits(bits, exponent))
    }

    /// Of three channels `bits · 2^exponent`, rounded as [`Self::encode`] does; `bits` under 2^31.
    #[inline]
    pub fn from_bits(bits: [u32; 3], exponent: i32) -> Rgb9e5 {
        let all = bits[0] | bits[1] | bits[2];
        if all == 0 {
            return Rgb9e5::BLACK;
        }
        let zeros = leading_zeros(all);
        let round = |shift: u32| bits.map(|b| (((b << zeros) >> (shift - 1)) + 1) >> 1);
        let e = exponent.saturating_add(47 - zeros as i32);
        if (0..31).contains(&e) {
            // Nothing ends here; one bit more where rounding carries.
            let (mut m, mut e) = (round(23), e as u32);
            if (m[0] | m[1] | m[2]) > 511 {
                (m, e) = (round(24), e + 1);
            }
            return Rgb9e5(m[0] | m[1] << 9 | m[2] << 18 | e << 27);
        }
        Rgb9e5::at_an_end(bits, exponent)
    }

    /// [`Self::from_bits`], also where the range ends.
    #[cold]
    pub(crate) fn at_an_end(bits: [u32; 3], exponent: i32) -> Rgb9e5 {
        let all = bits[0] | bits[1] | bits[2];
        if all == 0 {
            return Rgb9e5::BLACK;
        }
        let filled = 32 - leading_zeros(all) as i32;
        // Where the largest has nine bits, or where steps end.
        let mut shift = (filled - 9).max(-24 - exponent);
        let rounded = |shift: i32| bits.map(|b| shift_round(b, shift));
        let mut m = rounded(shift);
        if (m[0] | m[1] | m[2]) > 511 {
            shift += 1;
            m = rounded(shift);
        }
        let e = exponent.saturating_add(shift).saturating_add(24);
        if e > 31 {
            // Steps of 2^7, as far as there are any.
            m = bits.map(|b| shift_round(b, 7i32.saturating_sub(exponent)).min(511));
        }
        let e = e.clamp(0, 31) as u32;
        Rgb9e5(m[0] | m[1] << 9 | m[2] << 18 | e << 27)
    }

    /// The mantissas, and the exponent of their unit: light is `mantissa · 2^exponent`.
    #[inline(always)]
    pub const fn to_parts(self) -> ([u32; 3], i32) {
        let b = self.0;
        ([b & 511, (b >> 9) & 511, (b >> 18) & 511], (b >> 27) as i32 - 24)
    }

    /// Exactly.
    #[inline]
    pub const fn decode(self) -> Radiance {
        let (m, exponent) = self.to_parts();
        let all = m[0] | m[1] | m[2];
        if all == 0 {
            return Radiance::BLACK;
        }
        // What `from_bits` does, where nothing is rounded off.
        let zeros = leading_zeros(all);
        Radiance {
            mantissa: [
                (m[0] << (zeros - 16)) as u16,
                (m[1] << (zeros - 16)) as u16,
                (m[2] << (zeros - 16)) as u16,
            ],
            exponent: (exponent + 31 - zeros as i32) as i16,
        }
    }

    /// Its light times shares: `decode().mul_albedo(by)`, the same bits.
    #[inline]
    pub const fn times(self, by: Albedo) -> Radiance {
        let (bits, exponent) = self.product(by);
        Radiance::from_bits(bits, exponent)
    }

    /// `encode(self.times(by))`, the same bits.
    #[inline]
    pub fn shaded(self, by: Albedo) -> Rgb9e5 {
        let (bits, exponent) = self.product(by);
        Rgb9e5::encode_bits(bits, exponent)
    }

    #[inline(always)]
    const fn product(self, by: Albedo) -> ([u32; 3], i32) {
        let (m, exponent) = self.to_parts();
        // raw: under 2^9 · 2^16
        let bits = [
            m[0] * by.0[0].to_bits() as u32,
            m[1] * by.0[1].to_bits() as u32,
            m[2] * by.0[2].to_bits() as u32,
        ];
        (bits, exponent - 15)
    }

    /// Its value times 2^`exponent`.
    #[inline]
    pub const fn scaled(self, exponent: i32) -> Radiance {
        let (m, own) = self.to_parts();
        Radiance::from_bits(m, own + exponent)
    }
}

/// `x / 2^shift`, halves up; at most 2^31.
#[inline(always)]
fn shift_round(x: u32, shift: i32) -> u32 {
    if shift <= 0 {
        // A left shift: only where the highest bits are free, or the answer too large anyway.
        let left = shift.unsigned_abs().min(31);
        if x == 0 || leading_zeros(x) > left {
            x << left
        } else {
            1 << 31
        }
    } else if shift > 31 {
        0
    } else {
        ((x >> (shift - 1)) + 1) >> 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(light: Radiance) -> [f64; 3] {
        let (m, e) = light.to_parts();
        m.map(|m| f64::from(m) * f64::from(i32::from(e) - 15).exp2())
    }

    fn random(state: &mut u32) -> u32 {
        *state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        *state ^ (*state >> 15)
    }

    #[test]
    fn light_is_the_nearest_there_is() {
        let mut state = 1;
        let (mut mean, mut count) = (0f64, 0.0);
        for i in 0..200_000 {
            let bits = [0; 3].map(|_| random(&mut state) >> (random(&mut state) % 12 + 1));
            let light = Radiance::from_bits(bits, (i % 48) - 58);
            let (exact, got) = (value(light), value(Rgb9e5::encode(light).decode()));
            let largest = exact.iter().fold(0f64, |m, c| m.max(*c));
            let step = (largest * (1.0 + 1.0 / 1000.0)).log2().floor().exp2() / 256.0;
            for c in 0..3 {
                if largest < 65408.0 {
                    let bound = 0.5 * step.max(f64::from(-24).exp2());
                    assert!((got[c] - exact[c]).abs() <= bound * 1.0001, "{exact:?} {got:?}");
                    if exact[c] == largest && largest > 2e-5 {
                        mean += (got[c] - exact[c]) / step;
                        count += 1.0;
                    }
                } else {
                    assert!(
                        (got[c] - exact[c].min(65408.0)).abs() <= 64.0,
                        "{exact:?} {got:?}"
                    );
                }
            }
        }
        assert!((mean / count).abs() < 1e-2, "{mean}");
        for bits in [0, 1, 511, 511 << 9 | 31 << 27, 0xffff_ffff, 256 << 18 | 3 << 27] {
            let code = Rgb9e5(bits);
            assert_eq!(Rgb9e5::encode(code.decode()).decode(), code.decode(), "{bits:#x}");
        }
        assert_eq!(Rgb9e5::encode(Radiance::WHITE).decode(), Radiance::WHITE);
        assert_eq!(
            Rgb9e5::encode(Radiance::from_bits([u32::MAX; 3], 40_000)).0,
            u32::MAX
        );
        assert_eq!(Rgb9e5::encode(Radiance::from_bits([u32::MAX; 3], -40_000)).0, 0);
    }

    #[test]
    fn products_are_encoded_alike() {
        let mut state = 1;
        for i in 0..200_000 {
            let by = [0; 3].map(|_| (random(&mut state) % 32_769) as u16);
            let by = Albedo::from_bits(if i % 3 == 0 { [by[0]; 3] } else { by });
            let code = Rgb9e5(random(&mut state));
            assert_eq!(code.shaded(by), Rgb9e5::encode(code.times(by)), "{code:?} {by:?}");
            let bits = [0; 3].map(|_| random(&mut state) >> (random(&mut state) % 32));
            let e = (i % 96) - 64;
            assert_eq!(
                Rgb9e5::from_bits(bits, e),
                Rgb9e5::at_an_end(bits, e),
                "{bits:?} {e}"
            );
            let brief = bits.map(|bits| bits & 0xffff);
            assert_eq!(
                Rgb9e5::encode_product(brief, e, by),
                Rgb9e5::encode(Radiance::from_bits(brief, e).mul_albedo(by)),
                "{brief:?} {e} {by:?}"
            );
        }
        for exponent in [40_000, -40_000] {
            assert_eq!(
                Rgb9e5::encode_product([0xffff; 3], exponent, Albedo::WHITE),
                Rgb9e5::encode(Radiance::from_bits([0xffff; 3], exponent))
            );
        }
    }
}
