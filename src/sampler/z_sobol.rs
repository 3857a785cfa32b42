//! One Sobol' sequence for all pixels, dealt out so that neighbours make up for each other's errors.

use super::sobol::Padded;
use super::{Sampler, hash};
use fixed::types::U0F32;

/// Owen-scrambled Sobol' points of one sequence for the whole screen, by the pixels' Z-order: the error that is left
/// is blue noise.
///
/// Sample s of a pixel is point number z·2ᵏ + s, where z is the pixel's place along a Z-curve and 2ᵏ ≥ spp. An
/// aligned square of 2ᵃ × 2ᵃ pixels so draws an aligned block of the sequence, which is stratified as finely as
/// all its samples together: what one pixel is too bright, its neighbours are too dark, and an eye, or a filter,
/// sees less of it. Each draw shuffles the points' order anew, a square's quarters among each other, the quarters'
/// quarters and so on, so that the curve does not show. Each pixel alone has what [`Sobol`](super::Sobol) gives it.
///
/// Best at 1 to 4 samples a pixel: at one, the low-passed error (Gaussian, σ = 2 pixels) of a smooth integrand is
/// 0.28 of [`Sobol`](super::Sobol)'s, at the edge of a disk 0.55 (`tests/sampler.rs`). With more, the error within
/// the pixel is what counts, and is the same. Powers of two are best; sample 2ᵏ and after begin another sequence.
///
/// Ahmed and Wonka, "Screen-space blue-noise diffusion of Monte Carlo sampling error via hierarchical ordering of
/// pixels" (2020). They shuffle quarters by one of 24 orders; here halves are swapped by the same hash that
/// scrambles, which reaches 8 of them, is as good by measure, and costs one hash.
#[derive(Clone, Debug)]
pub struct ZSobol {
    seed: u32,
    /// k: bits of a sample's index within its pixel.
    index_bits: u32,
    point: Padded,
}

impl ZSobol {
    /// Samples a pixel at most; above, its samples are of more than one sequence.
    pub const MAX_SAMPLES: u32 = 1 << 16;

    /// A sampler for `spp` samples a pixel (at least 1), at the first sample of pixel (0, 0).
    #[must_use]
    pub fn new(seed: u32, spp: u32) -> Self {
        let index_bits = spp
            .clamp(1, Self::MAX_SAMPLES)
            .next_power_of_two()
            .trailing_zeros();
        let mut sampler = Self {
            seed,
            index_bits,
            point: Padded::new(0, 0),
        };
        sampler.start(0, 0, 0);
        sampler
    }
}

impl Sampler for ZSobol {
    fn start(&mut self, x: u16, y: u16, index: u32) {
        let k = self.index_bits;
        // As many of a coordinate's bits as fit beside the index; the others choose another sequence.
        let side = (32 - k) / 2;
        let [x, y] = [u32::from(x), u32::from(y)];
        let low = (1 << side) - 1;
        let z = spread(x & low) | spread(y & low) << 1;
        let key = hash(self.seed, (x >> side) as u16, (y >> side) as u16, index >> k);
        let first = if z == 0 { 0 } else { z << k };
        self.point = Padded::new(first | index & ((1 << k) - 1), key);
    }

    fn next_1d(&mut self) -> U0F32 {
        self.point.next_1d()
    }

    fn next_2d(&mut self) -> [U0F32; 2] {
        self.point.next_2d()
    }
}

/// The 16 bits of `x` with a zero after each (Morton, "A computer oriented geodetic data base", 1966).
const fn spread(x: u32) -> u32 {
    let x = (x | x << 8) & 0x00ff_00ff;
    let x = (x | x << 4) & 0x0f0f_0f0f;
    let x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_puts_a_zero_after_each_bit() {
        for x in 0..1 << 16 {
            let expected = (0..16).fold(0, |sum, bit| sum | (x >> bit & 1) << (2 * bit));
            assert_eq!(spread(x), expected);
        }
    }
}
