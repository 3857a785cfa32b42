//! How much one pixel may say of another: half-lives add up, one table makes a weight of them.

use super::super::Feature;
use crate::color::{Albedo, Radiance, Rgb9e5};
use crate::num::{leading_zeros, recip};
use zerocopy::transmute_ref;

/// 64 · 2^(−i/8), to nearest, from 64 (i = 0) to 1 (48); nothing from 56 on.
pub(super) static FALL: [u8; 64] = [
    64, 59, 54, 49, 45, 41, 38, 35, 32, 29, 27, 25, 23, 21, 19, 17, 16, 15, 13, 12, 11, 10, 10, 9, 8, 7, 7,
    6, 6, 5, 5, 4, 4, 4, 3, 3, 3, 3, 2, 2, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0,
    0, 0,
];

/// [`FALL`] of what is too far.
pub(super) const FAR: u32 = 63;

/// A unit vector in 127ths.
#[inline]
pub(super) fn short_normal(pixel: &Feature) -> [i8; 3] {
    pixel
        .normal
        .decode()
        .0
        .map(|c| ((c * 127 + (1 << 15)) >> 16) as i8)
}

/// One less the cosine between two of these, 0 ..= 127: a right angle and more is 127.
#[inline]
pub(super) fn turn(a: [i8; 3], b: [i8; 3]) -> u32 {
    let dot: i32 = (0..3).map(|i| a[i] as i32 * b[i] as i32).sum();
    ((127 * 127 - dot).max(0) >> 7).min(127) as u32
}

/// [`turn`] between two pixels' normals. Most look the same way to the last bit: nothing is asked for then.
#[inline]
pub(super) fn turn_of(a: &Feature, b: &Feature) -> u32 {
    if a.normal == b.normal {
        0
    } else {
        turn_between(a, b)
    }
}

/// [`turn_of`] two normals, remembered: along an outline the same ones meet again and again.
#[derive(Default)]
pub(super) struct Turns {
    /// The bits of one below those of the other, and their turn, by what [`Self::place`] says of them.
    known: [[u32; 2]; 4],
}

impl Turns {
    #[inline]
    pub(super) fn of(&mut self, a: &Feature, b: &Feature) -> u32 {
        if a.normal == b.normal {
            return 0;
        }
        let [low, high] = [a, b].map(|pixel| u16::from_le_bytes(pixel.normal.0.map(|c| c as u8)));
        let normals = u32::from(low) | u32::from(high) << 16;
        let known = &mut self.known[Turns::place(normals)];
        if known[0] != normals {
            *known = [normals, turn_between(a, b)];
        }
        known[1]
    }

    fn place(normals: u32) -> usize {
        (normals.wrapping_mul(0x9e37_79b1) >> 30) as usize
    }

    /// All that is remembered.
    #[cfg(upsamples)]
    pub(super) fn known(&self) -> &[[u32; 2]; 4] {
        &self.known
    }
}

#[inline(never)]
fn turn_between(a: &Feature, b: &Feature) -> u32 {
    turn(short_normal(a), short_normal(b))
}

/// Whether a pixel is nothing but a lamp (or as white as can be): from its word of albedo and distance as it lies in memory.
#[inline(always)]
pub(super) fn shines(word: u32) -> bool {
    // White, and not infinitely far away, which has a distance of 255.
    let next = u32::from_le(word).wrapping_add(1);
    next != 0 && next << 8 == 0
}

/// The logarithm of luminance, eighths of an octave from 2^-15 (1) on; 0 for black.
///
/// Between whole eighths by the mantissa itself: off by 0.09 octave at most.
#[inline]
pub(super) fn luma_code(light: Rgb9e5) -> u8 {
    let ([r, g, b], exponent) = light.to_parts();
    // raw: under 2^17
    let y = 54 * r + 183 * g + 19 * b;
    if y == 0 {
        return 0;
    }
    let zeros = leading_zeros(y);
    let eighth = ((y << zeros) >> 28) & 7;
    let octave = 31 - zeros as i32 + exponent - 8 + 15;
    // raw: octaves are under 31.
    (1 + 8 * octave + eighth as i32).max(1) as u8
}

/// Words of albedo and distance, and of normal and number, as they lie in memory.
#[inline(always)]
pub(super) fn words(pixel: &Feature) -> [u32; 2] {
    let &[_, seen, looks]: &[u32; 3] = transmute_ref!(pixel);
    [seen, looks]
}

/// A weighted mean of lights, its sum in 32 bits.
///
/// Weights add up to 2^14 at most. Lights are first shown, [`Self::see`], then added: those under the largest shown
/// lose what is less than 2^-18 of it.
#[derive(Clone, Copy)]
pub(super) struct Mean {
    sum: [u32; 3],
    weight: u32,
    /// As [`Rgb9e5`] has it in its highest bits.
    exponent: u32,
}

impl Mean {
    pub(super) const fn new() -> Mean {
        Mean {
            sum: [0; 3],
            weight: 0,
            exponent: 0,
        }
    }

    /// One that has seen as much.
    #[inline(always)]
    pub(super) fn anew(&self) -> Mean {
        Mean {
            exponent: self.exponent,
            ..Mean::new()
        }
    }

    #[inline]
    pub(super) fn see(&mut self, light: Rgb9e5) {
        self.exponent = self.exponent.max(light.0 >> 27);
    }

    #[inline]
    pub(super) fn add(&mut self, light: Rgb9e5, weight: u32) {
        self.add_parts(self.parts(light), weight);
    }

    /// A light's channels as they are added up.
    #[inline]
    pub(super) fn parts(&self, light: Rgb9e5) -> [u32; 3] {
        const BITS: u32 = 511 << 9;
        let gap = self.exponent.wrapping_sub(light.0 >> 27) & 31;
        // The mantissas times 2^9, from where they stand.
        [light.0 << 9, light.0, light.0 >> 9].map(|part| (part & BITS) >> gap)
    }

    #[inline]
    pub(super) fn add_parts(&mut self, parts: [u32; 3], weight: u32) {
        for (sum, part) in self.sum.iter_mut().zip(parts) {
            // raw: (511 · 2^9) · 2^14 < 2^32
            *sum = sum.wrapping_add(part.wrapping_mul(weight));
        }
        self.weight += weight;
    }

    pub(super) fn weight(&self) -> u32 {
        self.weight
    }

    /// Sum over weight as channels and their exponent; equal lights give themselves when rounded to nine bits.
    #[inline]
    pub(super) fn divided(&self) -> ([u32; 3], i32) {
        let r = recip(self.weight);
        // All the bits there are: what the product's low word would have had is 2^-31 of the largest.
        let zeros = leading_zeros(self.sum[0] | self.sum[1] | self.sum[2] | 1);
        let bits = self.sum.map(|sum| crate::num::mul_hi(sum << zeros, r.mantissa));
        (
            bits,
            self.exponent as i32 - 24 - 9 + 32 - r.shift as i32 - zeros as i32,
        )
    }

    /// Sum over weight as a [`Radiance`] has it.
    #[inline]
    pub(super) fn channels(&self) -> Channels {
        let (bits, exponent) = self.divided();
        // The largest has 31 bits or 32, if there is any.
        let shift = 15 + ((bits[0] | bits[1] | bits[2]) >> 31);
        let rounded = bits.map(|bits| ((bits >> (shift - 1)) + 1) >> 1);
        if (rounded[0] | rounded[1] | rounded[2]) >> 16 != 0 {
            return Channels::carried(bits, exponent);
        }
        Channels {
            bits: rounded,
            exponent: exponent + shift as i32,
        }
    }

    /// [`Self::channels`] of such sums whose weights are 16 in all, where no bit of them is below the 16 that a
    /// [`Radiance`] has.
    #[inline(always)]
    pub(super) fn sixteenths(&self, sums: [u32; 3]) -> Option<Channels> {
        // raw: under 2^22
        let is_exact = (sums[0] | sums[1] | sums[2]) & 63 == 0;
        is_exact.then(|| Channels {
            bits: sums.map(|sum| sum >> 6),
            exponent: self.exponent as i32 - 24 - 9 + 6 - 4,
        })
    }

    #[inline]
    pub(super) fn light(&self) -> Rgb9e5 {
        Mean::encoded(self.divided())
    }

    /// [`Self::light`] of weights that are 256 in all.
    #[inline]
    pub(super) fn light_of_256(&self) -> Rgb9e5 {
        let zeros = leading_zeros(self.sum[0] | self.sum[1] | self.sum[2] | 1);
        let top = self.sum.map(|sum| sum << zeros);
        // To nine bits, halves down: the reciprocal's mantissa is 2^32 − 2. raw: sums are under 2^26
        let [r, g, b] = top.map(|top| ((top >> 1) + (1 << 21) - 1) >> 22);
        let e = self.exponent as i32 + 6 - zeros as i32;
        if (256..512).contains(&(r | g | b)) && (0..32).contains(&e) {
            return Rgb9e5(r | g << 9 | b << 18 | (e as u32) << 27);
        }
        // The high word of a product with that.
        let less = |x: u32| x - (x >> 31) - u32::from(x << 1 != 0);
        Rgb9e5::at_an_end(top.map(less), e - 47)
    }

    #[inline(always)]
    fn encoded((bits, exponent): ([u32; 3], i32)) -> Rgb9e5 {
        // The largest has 31 bits or 32: what `from_bits` does, where it has no end of the range to mind.
        let shift = 22 + ((bits[0] | bits[1] | bits[2]) >> 31);
        let rounded = |bits: u32| ((bits >> (shift - 1)) + 1) >> 1;
        let [r, g, b] = [rounded(bits[0]), rounded(bits[1]), rounded(bits[2])];
        let e = exponent + shift as i32 + 24;
        if (256..512).contains(&(r | g | b)) && (0..32).contains(&e) {
            return Rgb9e5(r | g << 9 | b << 18 | (e as u32) << 27);
        }
        Rgb9e5::at_an_end(bits, exponent)
    }
}

/// Light in three channels of 16 bits at most, times 2^`exponent`.
#[derive(Clone, Copy)]
pub(super) struct Channels {
    bits: [u32; 3],
    exponent: i32,
}

impl Channels {
    /// Where rounding carries past 16 bits.
    #[cold]
    fn carried(bits: [u32; 3], exponent: i32) -> Channels {
        Channels::of(Radiance::from_bits(bits, exponent))
    }

    pub(super) fn of(light: Radiance) -> Channels {
        let (mantissas, exponent) = light.to_parts();
        Channels {
            bits: mantissas.map(u32::from),
            exponent: i32::from(exponent) - 15,
        }
    }

    pub(super) fn radiance(self) -> Radiance {
        Radiance::from_bits(self.bits, self.exponent)
    }

    /// Times shares.
    #[inline(always)]
    pub(super) fn shaded(self, by: Albedo) -> Rgb9e5 {
        Rgb9e5::encode_product(self.bits, self.exponent, by)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_weights_are_divided_by_alike() {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            state ^ (state >> 15)
        };
        let mut exact = 0;
        for i in 0..200_000 {
            // Of exponents that are up to eight apart, some of them black.
            let lights = [0; 2].map(|_| Rgb9e5((random() & random() << (i % 7)) & !(24 << 27)));
            let mut mean = Mean::new();
            lights.iter().for_each(|light| mean.see(*light));
            let parts = lights.map(|light| mean.parts(light));
            let sums = [0, 1, 2].map(|i| 7 * parts[0][i] + 9 * parts[1][i]);
            for scale in [64, 16, 23] {
                let mut mean = mean.anew();
                mean.add(lights[0], 7 * scale);
                mean.add(lights[1], 9 * scale);
                let (bits, exponent) = mean.divided();
                let whole = Radiance::from_bits(bits, exponent);
                assert_eq!(mean.channels().radiance(), whole, "{lights:?}");
                if let Some(sixteenths) = mean.sixteenths(sums) {
                    exact += 1;
                    assert_eq!(sixteenths.radiance(), whole, "{lights:?}");
                }
                if scale == 16 {
                    assert_eq!(mean.light_of_256(), mean.light(), "{lights:?}");
                }
            }
        }
        assert!(exact > 100_000, "{exact}");
    }

    #[test]
    fn means_of_256_are_what_the_reciprocal_says() {
        let mut state = 7u32;
        let mut random = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            state ^ (state >> 15)
        };
        for round in 0..200_000 {
            let weight = [random() & 255, 128, 64, 16 * (random() & 15)][round & 3];
            let [mut a, mut b] = [0; 2].map(|_| {
                let mantissas = random() & [!0, random(), 0x0402_0100][round / 4 % 3];
                mantissas & 0x07ff_ffff | (random() % [1, 3, 32][round / 12 % 3] + random() % 32 / 2) << 27
            });
            if round / 36 % 4 == 0 {
                (a, b) = (a & 0x07ff_ffff, b & 0x07ff_ffff);
            }
            let mut mean = Mean::new();
            mean.see(Rgb9e5(a));
            mean.see(Rgb9e5(b));
            mean.add(Rgb9e5(a), 256 - weight);
            mean.add(Rgb9e5(b), weight);
            assert_eq!(mean.light_of_256(), mean.light(), "{a:x} {b:x} {weight}");
        }
    }
}
