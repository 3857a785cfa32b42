//! Layers as every core can run them.

use super::packed::Run;
use super::{FEATURES, HEAD};

/// Activations of pixels side by side, `outputs` bytes from one to the next: from [`sums`], with their biases.
#[inline(always)]
pub fn activations<const PAIRS: usize, const RUNS: usize>(
    runs: [Run; RUNS],
    words: &[[u32; PAIRS]],
    biases: &[i16],
    out: &mut [u8],
    outputs: usize,
) {
    for (x, out) in out.chunks_mut(outputs).enumerate() {
        let runs = runs.map(|(bytes, length, step)| &bytes[x * step..][..length]);
        for (out, sum) in out.iter_mut().zip(both(&sums(runs, words), biases)) {
            *out = ((sum + 32) >> 6).clamp(0, 63) as u8;
        }
    }
}

/// Heads of pixels side by side, of `inputs` activations each.
pub fn heads(
    pixels: &[u8],
    inputs: usize,
    words: &[[u32; HEAD / 2]],
    biases: &[i16],
    out: &mut [[u8; HEAD]],
) {
    for (pixel, head) in pixels.chunks_exact(inputs).zip(out) {
        let sums = sums([pixel], words);
        for (i, (out, sum)) in head.iter_mut().zip(both(&sums, biases)).enumerate() {
            *out = if i < FEATURES {
                ((sum + 64) >> 7).clamp(-128, 127) as i8 as u8
            } else {
                (128 + ((sum + 8) >> 4)).clamp(0, 255) as u8
            };
        }
    }
}

/// Both sums of each word, with their biases.
#[inline(always)]
fn both<const PAIRS: usize>(sums: &[u32; PAIRS], biases: &[i16]) -> impl Iterator<Item = i32> {
    let both = sums.iter().flat_map(|&word| {
        let low = i32::from(word as i16);
        [low, (word as i32).wrapping_sub(low) >> 16]
    });
    both.zip(biases).map(|(sum, &bias)| sum + i32::from(bias))
}

/// Products of activations, run by run, with two weights a word, added up modulo 2^32.
#[inline(always)]
fn sums<const PAIRS: usize, const RUNS: usize>(
    runs: [&[u8]; RUNS],
    mut words: &[[u32; PAIRS]],
) -> [u32; PAIRS] {
    let mut sums = [0; PAIRS];
    for run in runs {
        let (fours, others) = run.as_chunks::<4>();
        for four in fours {
            let Some((front, rest)) = words.split_first_chunk::<4>() else {
                return sums;
            };
            words = rest;
            for (input, words) in four.iter().zip(front) {
                add(&mut sums, *input, words);
            }
        }
        for input in others {
            let Some((front, rest)) = words.split_first() else {
                return sums;
            };
            words = rest;
            add(&mut sums, *input, front);
        }
    }
    sums
}

/// A third to two thirds of activations are 0.
#[inline(always)]
fn add<const PAIRS: usize>(sums: &mut [u32; PAIRS], input: u8, words: &[u32; PAIRS]) {
    if input != 0 {
        for (sum, &word) in sums.iter_mut().zip(words) {
            *sum = sum.wrapping_add(word.wrapping_mul(input.into()));
        }
    }
}
