//! The generator: PCG with 32 bits of state.

use core::convert::Infallible;
use rand_core::{SeedableRng, TryRng, utils};

/// PCG RXS-M-XS 32/32, one sequence: 4 bytes of state, period 2³², every value once in a period.
///
/// Since no value comes twice in a period, a run of much more than 2¹⁶ draws is too even; a sample of a pixel
/// draws tens. Not for secrets: the state can be read off one output.
///
/// `from_seed` reads the seed as little-endian and starts as the reference's `pcg32si_srandom_r` does.
/// Source: O'Neill, "PCG: A family of simple fast space-efficient statistically good algorithms for random
/// number generation" (2014), section 6.3.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PcgRxsMXs32 {
    state: u32,
}

impl PcgRxsMXs32 {
    const MULTIPLIER: u32 = 747_796_405;
    const INCREMENT: u32 = 2_891_336_453;

    const fn advance(state: u32) -> u32 {
        state.wrapping_mul(Self::MULTIPLIER).wrapping_add(Self::INCREMENT)
    }

    /// Draws the next word and steps the state.
    const fn draw(&mut self) -> u32 {
        let state = self.state;
        self.state = Self::advance(state);
        // Random xorshift by 4 to 19, multiply, xorshift.
        let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
        (word >> 22) ^ word
    }
}

impl SeedableRng for PcgRxsMXs32 {
    type Seed = [u8; 4];

    fn from_seed(seed: [u8; 4]) -> Self {
        let seed = u32::from_le_bytes(seed);
        Self {
            state: Self::advance(Self::advance(0).wrapping_add(seed)),
        }
    }
}

impl TryRng for PcgRxsMXs32 {
    type Error = Infallible;

    #[inline]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(self.draw())
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        utils::next_u64_via_u32(self)
    }

    fn try_fill_bytes(&mut self, dst: &mut [u8]) -> Result<(), Infallible> {
        utils::fill_bytes_via_next_word(dst, || self.try_next_u32())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_core::Rng;

    #[test]
    fn agrees_with_the_published_sequence() {
        // pcg-c, test-high/expected/check-pcg32si.out, seed 42, rounds 1 (first six words).
        let mut rng = PcgRxsMXs32::from_seed(42_u32.to_le_bytes());
        let words = [(); 6].map(|()| rng.next_u32());
        assert_eq!(
            words,
            [
                0x256b_5357,
                0xa5ef_ad32,
                0x170b_7830,
                0x334a_5b22,
                0x3de5_c680,
                0x9b47_b7b3
            ]
        );
    }

    #[test]
    fn wider_draws_are_words_in_order_little_endian() {
        let start = PcgRxsMXs32::from_seed([1, 2, 3, 4]);
        let mut words = start.clone();
        let [a, b] = [words.next_u32(), words.next_u32()];

        assert_eq!(start.clone().next_u64(), u64::from(b) << 32 | u64::from(a));

        let mut bytes = [0; 7];
        let mut filled = start.clone();
        filled.fill_bytes(&mut bytes);
        assert_eq!(bytes[..4], a.to_le_bytes());
        assert_eq!(bytes[4..], b.to_le_bytes()[..3]);
        // A word that was used in part is spent.
        assert_eq!(filled, words);
    }

    #[test]
    fn the_seed_is_read_little_endian() {
        assert_eq!(
            PcgRxsMXs32::from_seed([0x78, 0x56, 0x34, 0x12]),
            PcgRxsMXs32::from_seed(0x1234_5678_u32.to_le_bytes())
        );
        assert_ne!(
            PcgRxsMXs32::from_seed([1, 0, 0, 0]),
            PcgRxsMXs32::from_seed([0, 0, 0, 1])
        );
    }
}
