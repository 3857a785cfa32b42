#[cfg(armv6m)]
use crate::armv6m::sums::{four, three, two};
#[cfg(armv7m)]
use crate::armv7m::sums::{four, three, two};

/// A run's first activation, and what lies behind its last.
#[repr(C)]
pub(crate) struct Run {
    first: *const u8,
    end: *const u8,
}

/// `PAIRS` is 2, 3 or 4, and there are no fewer words than activations.
#[inline]
pub fn sums<const PAIRS: usize, const RUNS: usize>(
    runs: [&[u8]; RUNS],
    words: &[[u32; PAIRS]],
) -> [u32; PAIRS] {
    let runs = runs.map(|run| {
        let range = run.as_ptr_range();
        Run {
            first: range.start,
            end: range.end,
        }
    });
    let range = runs.as_ptr_range();
    let mut sums = [0; PAIRS];
    let add = match PAIRS {
        2 => two,
        3 => three,
        _ => four,
    };
    // SAFETY: `runs` are slices one after the other, `words` has `PAIRS` words for each of their bytes (the caller's
    // promise), and `sums` has room for as many.
    unsafe { add(sums.as_mut_ptr(), range.start, range.end, words.as_ptr().cast()) }
    sums
}
