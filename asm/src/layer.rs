use crate::armv7m::layer::{layer_four, layer_heads, layer_three, layer_two};

/// A run of each of several pixels: where it begins, how long it is, and how far it is to the next pixel's.
#[repr(C)]
pub(crate) struct Steps {
    first: *const u8,
    length: usize,
    step: usize,
}

/// The rest of what is to be done.
#[repr(C)]
pub(crate) struct Task {
    pub(crate) words: *const u32,
    pub(crate) biases: *const i16,
    pub(crate) out: *mut u8,
    /// Bytes between one pixel's activations and the next one's.
    pub(crate) gap: usize,
    /// 1 at least.
    pub(crate) pixels: usize,
}

/// Activations of pixels side by side, `outputs` bytes from one to the next: sums as [`crate::sums`] has them, each word's lower
/// one first, plus their biases, a 64th of that, rounded, cut to 0 ..= 63.
///
/// A run is its bytes, how many of them each pixel has, and how many further the next one's begin. Nothing is made where
/// anything is short.
#[inline]
pub fn activations<const PAIRS: usize, const RUNS: usize>(
    runs: [(&[u8], usize, usize); RUNS],
    words: &[[u32; PAIRS]],
    biases: &[i16],
    out: &mut [u8],
    outputs: usize,
) {
    let make = match PAIRS {
        2 => layer_two,
        3 => layer_three,
        4 => layer_four,
        _ => return,
    };
    by(make, runs, words, biases, out, outputs);
}

/// Heads of pixels side by side, of `inputs` activations each: six signed bytes, 128ths of the sums with their biases, then two
/// about 128, 16ths of theirs. Nothing is made where anything is short.
#[inline]
pub fn heads(pixels: &[u8], inputs: usize, words: &[[u32; 4]], biases: &[i16], out: &mut [[u8; 8]]) {
    let runs = [(pixels, inputs, inputs)];
    by(layer_heads, runs, words, biases, out.as_flattened_mut(), 8);
}

type Make = unsafe extern "C" fn(*mut Task, *mut Steps, *const Steps);

#[inline(always)]
fn by<const PAIRS: usize, const RUNS: usize>(
    make: Make,
    runs: [(&[u8], usize, usize); RUNS],
    words: &[[u32; PAIRS]],
    biases: &[i16],
    out: &mut [u8],
    outputs: usize,
) {
    let made = 2 * PAIRS;
    if outputs < made || out.len() < made || biases.len() < made {
        return;
    }
    let pixels = (out.len() - made) / outputs + 1;
    let mut inputs = 0;
    for (bytes, length, step) in runs {
        if bytes.len() < (pixels - 1).saturating_mul(step).saturating_add(length) {
            return;
        }
        inputs += length;
    }
    if inputs > words.len() {
        return;
    }
    let mut task = Task {
        words: words.as_ptr().cast(),
        biases: biases.as_ptr(),
        out: out.as_mut_ptr(),
        gap: outputs - made,
        pixels,
    };
    let mut runs = runs.map(|(bytes, length, step)| Steps {
        first: bytes.as_ptr(),
        length,
        step,
    });
    let range = runs.as_mut_ptr_range();
    // SAFETY: `make` takes `PAIRS`; each run has its bytes for all pixels, `words` has `PAIRS` for each byte of a pixel, there
    // are two biases a word, and room for as many activations of each pixel.
    unsafe { make(&mut task, range.start, range.end) }
}
