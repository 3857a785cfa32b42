//! Inner loops of microlux in assembly, where registers handed out by hand spare what a compiler spills.
//!
//! `Walk` goes through a tree along a ray, `Facets` looks at triangles; the core has the portable twin of both, and
//! says why they decide so (`bvh::traverse`, `shape::triangle`). The firmware's job `meshes` compares the two. [`sums`],
//! `activations`, `heads`, `gather` and `Spread` are the network's, held against its portable layers and filter by the job
//! `network`; `normalize` is `geom::Offset`'s and `rectangle` meets one (`shape::planar`), held by the jobs `normalize` and
//! `rectangles`.
//!
//! Cores of ARMv6-M, ARMv7-M and RV32IM have `Walk` and `Facets`, the first [`sums`], `normalize` and `rectangle` besides,
//! those of ARMv7-M `activations` and `heads`, and those of ARMv7E-M `gather` and `Spread`; elsewhere [`sums`] is [`plain`],
//! and the rest is not there.

#![no_std]

/// Activations in runs, one after the other, each times its `PAIRS` words, added up modulo 2^32.
///
/// There are as many words as activations; where either is short, the rest counts for nothing.
#[inline]
pub fn sums<const PAIRS: usize, const RUNS: usize>(
    runs: [&[u8]; RUNS],
    words: &[[u32; PAIRS]],
) -> [u32; PAIRS] {
    #[cfg(armv6m)]
    if matches!(PAIRS, 2..=4) && runs.iter().map(|run| run.len()).sum::<usize>() <= words.len() {
        return armv6m::sums::sums(runs, words);
    }
    plain(runs, words)
}

/// What [`sums`] is held against.
pub fn plain<const PAIRS: usize, const RUNS: usize>(
    runs: [&[u8]; RUNS],
    words: &[[u32; PAIRS]],
) -> [u32; PAIRS] {
    let mut sums = [0u32; PAIRS];
    for (input, words) in runs.into_iter().flatten().zip(words) {
        for (sum, word) in sums.iter_mut().zip(words) {
            *sum = sum.wrapping_add(word.wrapping_mul(u32::from(*input)));
        }
    }
    sums
}

#[cfg(armv6m)]
mod armv6m;
#[cfg(armv7em)]
mod armv7em;
#[cfg(armv7m)]
mod armv7m;
#[cfg(any(armv6m, armv7m))]
mod facets;
#[cfg(armv7m)]
mod layer;
#[cfg(any(armv6m, armv7m, target_arch = "riscv32"))]
mod ray;
#[cfg(target_arch = "riscv32")]
mod rv32;
#[cfg(armv6m)]
pub use armv6m::{
    normalize::{Normal, normalize},
    rectangle::rectangle,
    walk::Walk,
};
#[cfg(armv7em)]
pub use armv7em::{Spread, gather};
#[cfg(armv7m)]
pub use armv7m::walk::Walk;
#[cfg(any(armv6m, armv7m))]
pub use facets::Facets;
#[cfg(armv7m)]
pub use layer::{activations, heads};
#[cfg(any(armv6m, armv7m, target_arch = "riscv32"))]
pub use ray::{Corner, DEPTH_BITS, Leaves, Met, Order, Ray, STACK};
#[cfg(target_arch = "riscv32")]
pub use rv32::{facets::Facets, walk::Walk};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_table_ends_the_sum() {
        let words = [[1, 1 << 16, 3], [10, 20, u32::MAX]];
        assert_eq!(sums([&[2], &[3]], &words), [32, 60 + (2 << 16), 3]);
        assert_eq!(sums([&[2, 3, 4]], &words), [32, 60 + (2 << 16), 3]);
        assert_eq!(sums([&[], &[2]], &words[1..]), [20, 40, u32::MAX - 1]);
    }
}
