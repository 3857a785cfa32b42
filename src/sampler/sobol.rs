//! Padded two-dimensional Sobol' points, Owen-scrambled by hashes.

use super::{Sampler, hash, hash::Keys};
use fixed::types::U0F32;

/// Owen-scrambled (0,2)-sequences, one for each pair of dimensions.
///
/// Of samples k·2ᵐ to (k+1)·2ᵐ − 1 of a pixel, each `next_2d` puts exactly one in every elementary interval:
/// every box of 2ᵃ × 2ᵐ⁻ᵃ equal boxes that fill the square; each `next_1d` puts one in each of 2ᵐ equal
/// parts. For smooth integrands error falls nearly as spp^(−3/2) at powers of two, and no faster than other
/// stratification where an edge runs through. Between powers of two some of that is lost; nothing has to be
/// known in advance.
///
/// Each pair uses the first two dimensions of Sobol', with its own scrambling and its own order of samples,
/// so that no pair of dimensions can be bad: Burley, "Practical hash-based Owen scrambling" (JCGT 9(4),
/// 2020).
#[derive(Clone, Debug)]
pub struct Sobol {
    seed: u32,
    point: Padded,
}

impl Sobol {
    /// A sampler whose pictures differ by `seed`, at the first sample of pixel (0, 0).
    #[must_use]
    pub fn new(seed: u32) -> Self {
        Self {
            seed,
            point: Padded::new(0, hash(seed, 0, 0, 0)),
        }
    }
}

impl Sampler for Sobol {
    fn start(&mut self, x: u16, y: u16, index: u32) {
        self.point = Padded::new(index, hash(self.seed, x, y, 0));
    }

    fn next_1d(&mut self) -> U0F32 {
        self.point.next_1d()
    }

    fn next_2d(&mut self) -> [U0F32; 2] {
        self.point.next_2d()
    }
}

/// One point of a padded sequence: the index stays, each draw has a shuffling and a scrambling of its own.
#[derive(Clone, Debug)]
pub(super) struct Padded {
    /// The point's index, first bit last: the form in which the hash can scramble it.
    reversed_index: u32,
    keys: Keys,
}

impl Padded {
    /// Point number `index` of the sequence that `key` chooses.
    pub(super) const fn new(index: u32, key: u32) -> Self {
        Self {
            reversed_index: index.reverse_bits(),
            keys: Keys::new(key),
        }
    }

    /// This sample's place in a new dimension's own order, in which aligned blocks of 2ᵐ stay aligned blocks.
    fn shuffled_index(&mut self) -> u32 {
        scramble_reversed(self.reversed_index, self.keys.draw()).reverse_bits()
    }

    /// Scrambles a coordinate given first bit last.
    fn scrambled(&mut self, reversed: u32) -> U0F32 {
        U0F32::from_bits(scramble_reversed(reversed, self.keys.draw()).reverse_bits())
    }

    pub(super) fn next_1d(&mut self) -> U0F32 {
        let index = self.shuffled_index();
        self.scrambled(index)
    }

    pub(super) fn next_2d(&mut self) -> [U0F32; 2] {
        // The first dimension of Sobol' is the index with its bits reversed, so that reversed it is the
        // index.
        let index = self.shuffled_index();
        [self.scrambled(index), self.scrambled(pascal(index))]
    }
}

/// Sobol's second dimension, bits reversed: the index times Pascal's triangle modulo 2.
///
/// Column j of that matrix holds the coefficients of (x+1)ʲ, so with the index's bits as the coefficients of
/// p(x) the product is p(x+1) over GF(2). For p = h·x^(2ᵏ) + l that is h(x+1)·(x^(2ᵏ) + 1) + l(x+1): five
/// steps of halves added to halves, in place of up to 32 direction numbers. Matrix: Sobol' (1967), polynomial
/// x + 1.
const fn pascal(index: u32) -> u32 {
    let p = index ^ (index >> 16);
    let p = p ^ (p >> 8 & 0x00ff_00ff);
    let p = p ^ (p >> 4 & 0x0f0f_0f0f);
    let p = p ^ (p >> 2 & 0x3333_3333);
    p ^ (p >> 1 & 0x5555_5555)
}

/// Owen scrambling of a number given with its bits reversed: flips each bit by a hash of the key and of the
/// bits below it (above it, in the number itself), hence a bijection of every aligned block onto an aligned
/// block.
///
/// Laine and Karras, "Stratified sampling for stochastic transparency" (EGSR 2011); the steps
/// and constants are Vegdahl's, "Building a better LK hash" (psychopath.io, 2021-01-30, as revised
/// 2021-05-08). The key must be well mixed.
const fn scramble_reversed(x: u32, key: u32) -> u32 {
    let x = x ^ x.wrapping_mul(0x3d20_adea);
    let x = x.wrapping_add(key).wrapping_mul((key >> 16) | 1);
    let x = x ^ x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pascal_is_the_matrix_of_direction_numbers() {
        // Joe and Kuo, "Remark on Algorithm 659" (2003): dimension 2 has m₁ = 1 and mⱼ = 2 mⱼ₋₁ xor mⱼ₋₁, and
        // its direction numbers are mⱼ 2^(32−j).
        let mut m = 1_u32;
        for j in 0..32 {
            let direction = m << (31 - j);
            assert_eq!(pascal(1 << j), direction.reverse_bits(), "column {j}");
            m ^= m << 1;
        }
        for index in [0, 3, 0x1234_5678, u32::MAX] {
            let sum = (0..32)
                .filter(|j| index >> j & 1 == 1)
                .fold(0, |sum, j| sum ^ pascal(1 << j));
            assert_eq!(pascal(index), sum);
        }
    }

    #[test]
    fn unscrambled_points_begin_as_published() {
        // In 1/16ths: (0,0) (1/2,1/2) (1/4,3/4) (3/4,1/4) (1/8,5/8) (5/8,1/8) (3/8,3/8) (7/8,7/8).
        let points: [[u32; 2]; 8] = core::array::from_fn(|i| {
            let i = i as u32;
            [i.reverse_bits() >> 28, pascal(i).reverse_bits() >> 28]
        });
        assert_eq!(
            points,
            [
                [0, 0],
                [8, 8],
                [4, 12],
                [12, 4],
                [2, 10],
                [10, 2],
                [6, 6],
                [14, 14]
            ]
        );
    }

    #[test]
    fn scrambling_is_nested() {
        // Two numbers that agree in their first k bits and differ in the next still do, once scrambled.
        for case in 0..1000_u32 {
            let [a, key] = [hash(1, 0, 0, case), hash(2, 0, 0, case)];
            for k in 0..32 {
                let b = a ^ (1 << k) ^ (hash(3, 0, 0, case) << k << 1);
                let apart = scramble_reversed(a, key) ^ scramble_reversed(b, key);
                assert_eq!(apart.trailing_zeros(), k);
            }
        }
    }

    #[test]
    fn scrambling_flips_each_bit_for_half_of_all_keys() {
        // One random bit for each node of the tree of the first four bits, by node and by pair of nodes.
        let cases = 40_000_u32;
        let mut flips = [[0_u32; 15]; 15];
        for case in 0..cases {
            let key = hash(7, 0, 0, case);
            let flipped: [u32; 15] = core::array::from_fn(|node| {
                let depth = (node as u32 + 1).ilog2();
                let prefix = node as u32 + 1 - (1 << depth);
                (scramble_reversed(prefix, key) ^ prefix) >> depth & 1
            });
            for (i, row) in flips.iter_mut().enumerate() {
                for (j, count) in row.iter_mut().enumerate() {
                    // Alone on the diagonal, against each other beside it.
                    *count += if i == j {
                        flipped[i]
                    } else {
                        flipped[i] ^ flipped[j]
                    };
                }
            }
        }
        // Four standard deviations; 100 apart would be flipping as one.
        let bound = 2 * cases.isqrt();
        for (i, row) in flips.iter().enumerate() {
            for (j, count) in row.iter().enumerate() {
                let off = count.abs_diff(cases / 2);
                assert!(off < bound, "nodes {i} and {j}: {off} of {bound}");
            }
        }
    }
}
