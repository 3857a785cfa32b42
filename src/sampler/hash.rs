//! Hashes that turn (seed, pixel, sample, dimension) into seeds.

/// 2³² over the golden ratio, odd: the step whose multiples spread most evenly (Knuth, TAOCP 3, 6.4).
const GOLDEN: u32 = 0x9e37_79b9;

/// Mixes 32 bits: a bijection in which each input bit flips each output bit in half of all cases.
///
/// `mix(0) == 0`. Bias 0.107 by its source's measure, where 0 is ideal: Wellons, "Prospecting for
/// hash functions" (2018), the xorshift-multiply family, with the constants found later in the same search
/// (hash-prospector, issue 19). Avalanche tested below.
#[must_use]
pub const fn mix(x: u32) -> u32 {
    let x = (x ^ (x >> 16)).wrapping_mul(0x21f0_aaad);
    let x = (x ^ (x >> 15)).wrapping_mul(0xd35a_2d97);
    x ^ (x >> 15)
}

/// Hashes a seed, a pixel and a number (a sample's index, or a pass) to 32 bits.
///
/// For a fixed seed and `n` it is a bijection of pixels, and for a fixed seed and pixel one of `n`. The seed
/// enters twice, so that two seeds do not share one set of values in another order.
#[must_use]
pub fn hash(seed: u32, x: u16, y: u16, n: u32) -> u32 {
    let pixel = u32::from(x) | u32::from(y) << 16;
    let seed = mix(seed ^ GOLDEN);
    mix(mix(seed ^ pixel).wrapping_add(seed) ^ n)
}

/// A sequence of keys, one per use, with period 2³²: a counter in steps of [`GOLDEN`], mixed.
///
/// Source: Steele, Lea, Flood, "Fast splittable pseudorandom number generators" (2014), in 32 bits.
#[derive(Clone, Debug)]
pub(super) struct Keys(u32);

impl Keys {
    pub(super) const fn new(seed: u32) -> Self {
        Self(seed)
    }

    pub(super) const fn draw(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(GOLDEN);
        mix(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Asserts that, over `cases`, no output bit flips in much more or fewer than half when `bit` of the
    /// input does.
    fn assert_avalanche(cases: u32, bits: u32, f: impl Fn(u32, u32) -> u32) {
        // Six standard deviations of a fair coin: sqrt(cases)/2 each.
        let bound = 3 * cases.isqrt();
        for bit in 0..bits {
            let mut flips = [0_u32; 32];
            for case in 0..cases {
                let changed = f(case, bit);
                for (out, count) in flips.iter_mut().enumerate() {
                    *count += changed >> out & 1;
                }
            }
            for (out, count) in flips.iter().enumerate() {
                assert!(
                    count.abs_diff(cases / 2) < bound,
                    "input bit {bit} flips output bit {out} in {count} of {cases}"
                );
            }
        }
    }

    #[test]
    fn mix_avalanches_on_small_numbers_and_large() {
        assert_avalanche(20_000, 32, |case, bit| mix(case) ^ mix(case ^ 1 << bit));
        assert_avalanche(20_000, 32, |case, bit| {
            let x = case.wrapping_mul(0x0123_4567);
            mix(x) ^ mix(x ^ 1 << bit)
        });
    }

    #[test]
    fn hash_avalanches_in_each_argument() {
        let pixel = |case: u32| ((case % 240) as u16, (case / 240) as u16);
        let base = |case: u32| {
            let (x, y) = pixel(case);
            hash(case >> 8, x, y, case & 255)
        };
        assert_avalanche(20_000, 32, |case, bit| {
            let (x, y) = pixel(case);
            base(case) ^ hash(case >> 8 ^ 1 << bit, x, y, case & 255)
        });
        assert_avalanche(20_000, 16, |case, bit| {
            let (x, y) = pixel(case);
            base(case) ^ hash(case >> 8, x ^ 1 << bit, y, case & 255)
        });
        assert_avalanche(20_000, 16, |case, bit| {
            let (x, y) = pixel(case);
            base(case) ^ hash(case >> 8, x, y ^ 1 << bit, case & 255)
        });
        assert_avalanche(20_000, 32, |case, bit| {
            let (x, y) = pixel(case);
            base(case) ^ hash(case >> 8, x, y, case & 255 ^ 1 << bit)
        });
    }

    #[test]
    fn keys_avalanche_between_neighbouring_seeds() {
        assert_avalanche(20_000, 32, |case, bit| {
            let (mut a, mut b) = (Keys::new(case), Keys::new(case ^ 1 << bit));
            a.draw();
            b.draw();
            a.draw() ^ b.draw()
        });
    }

    #[test]
    fn known_answers() {
        assert_eq!([mix(0), mix(1), mix(u32::MAX)], [0, 0x06d3_fa73, 0xd9b5_6683]);
        assert_eq!(hash(0, 0, 0, 0), 0x64dc_ab1f);
        assert_eq!(hash(1, 2, 3, 4), 0x6dcc_3b63);
    }
}
