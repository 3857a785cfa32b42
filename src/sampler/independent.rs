//! Independent random numbers, from any generator.

use super::{PcgRxsMXs32, Sampler, hash};
use core::convert::Infallible;
use fixed::types::U0F32;
use rand_core::{Rng, SeedableRng, TryRng};

/// Draws without a pattern: error falls as 1/√spp, whatever is integrated.
///
/// Each sample seeds a generator `R` by hash(seed, pixel, sample index), every word of `R::Seed` by a hash of
/// its own, and draws from it in order. Any generator of `rand_core` serves, if it never fails and starts
/// cheaply.
#[derive(Clone, Debug)]
pub struct Independent<R = PcgRxsMXs32> {
    seed: u32,
    rng: R,
}

impl<R: TryRng<Error = Infallible> + SeedableRng> Independent<R> {
    /// A sampler whose pictures differ by `seed`, at the first sample of pixel (0, 0).
    #[must_use]
    pub fn new(seed: u32) -> Self {
        Self {
            seed,
            rng: seeded(seed, 0, 0, 0),
        }
    }

    fn draw(&mut self) -> U0F32 {
        U0F32::from_bits(self.rng.next_u32())
    }
}

/// A generator for one sample.
fn seeded<R: SeedableRng>(seed: u32, x: u16, y: u16, index: u32) -> R {
    let mut bytes = R::Seed::default();
    for (chunk, word) in bytes.as_mut().chunks_mut(4).zip(0..) {
        let key = hash(seed.wrapping_add(word), x, y, index);
        for (byte, from) in chunk.iter_mut().zip(key.to_le_bytes()) {
            *byte = from;
        }
    }
    R::from_seed(bytes)
}

impl<R: TryRng<Error = Infallible> + SeedableRng> Sampler for Independent<R> {
    fn start(&mut self, x: u16, y: u16, index: u32) {
        self.rng = seeded(self.seed, x, y, index);
    }

    fn next_1d(&mut self) -> U0F32 {
        self.draw()
    }

    fn next_2d(&mut self) -> [U0F32; 2] {
        [self.draw(), self.draw()]
    }
}
