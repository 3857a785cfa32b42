//! Inner loops of microlux, where the compiler knows only seven registers of a Cortex-M0+: what stays the same, and sums,
//! stand in the upper eight.
//!
//! `Walk` goes through a tree along a ray, `Facets` looks at triangles; the core has the portable twin of both, and
//! says why they decide so (`bvh::traverse`, `shape::triangle`). The firmware's job `meshes` compares the two. [`sums`] is
//! the network's.
//!
//! A word of weights holds two, of which one multiplication makes two products (`Weights::new` says why their sums stay
//! apart). Cycles of an activation: 18 by four words, 15 by three, 12 by two; 9 where it is 0. Compiled code takes 25 to 45.
//!
//! Only ARM has the assembly; elsewhere [`sums`] is [`plain`], and the rest is not there.

#![no_std]

/// Activations in runs, one after the other, each times its `PAIRS` words, added up modulo 2^32.
///
/// There are as many words as activations; where either is short, the rest counts for nothing.
#[inline]
pub fn sums<const PAIRS: usize, const RUNS: usize>(
    runs: [&[u8]; RUNS],
    words: &[[u32; PAIRS]],
) -> [u32; PAIRS] {
    #[cfg(target_arch = "arm")]
    if matches!(PAIRS, 2..=4) && runs.iter().map(|run| run.len()).sum::<usize>() <= words.len() {
        return arm::sums(runs, words);
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

/// The upper registers that a caller wants back, onto the stack; r4 to r7 are free.
#[cfg(target_arch = "arm")]
macro_rules! save_upper {
    () => {
        "mov r4, r8; mov r5, r9; mov r6, r10; mov r7, r11; push {{r4, r5, r6, r7}}"
    };
}

/// And back.
#[cfg(target_arch = "arm")]
macro_rules! restore_upper {
    () => {
        "pop {{r4, r5, r6, r7}}; mov r8, r4; mov r9, r5; mov r10, r6; mov r11, r7"
    };
}

#[cfg(target_arch = "arm")]
mod arm;
#[cfg(target_arch = "arm")]
mod facets;
#[cfg(target_arch = "arm")]
mod walk;
#[cfg(target_arch = "arm")]
pub use facets::{Corner, Facets, Met};
#[cfg(target_arch = "arm")]
pub use walk::{DEPTH_BITS, Leaves, Order, Ray, STACK, Walk};

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
