//! Layers as a core takes them whose routines go column by column (`microlux_asm::convolve`).

use super::layer::{Layer, Weights, word};
use super::{CHANNELS, HEAD, INPUTS, LEVELS};
use microlux_asm::{convolve, convolve_seen, heads, merge, squeeze};

/// What the first layer takes of a pixel.
pub type Seen = [u32; 3];

/// The order in which its bytes are seen: light and depth, then what pixels side by side often have alike. The last is no input.
const ORDER: [usize; size_of::<Seen>()] = [0, 1, 2, 9, 3, 4, 5, 6, 7, 8, 10, INPUTS];
/// Of these, those that pixels seldom have alike.
const OWN: usize = 4;
/// Any other order.
const PLAIN: [usize; CHANNELS[LEVELS - 1]] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11];

/// Of the words that an [`Input`](super::Input) is made of, where it differs from the pixel before it in its row in the last two.
#[inline(always)]
pub fn seen(bright: u32, still: [u32; 2], differs: bool) -> Seen {
    [bright, still[0], still[1] | u32::from(differs) << 24]
}

impl Weights<'_> {
    /// Layer `number`, its weights packed into the front of `words`; and the rest of those.
    pub(super) fn pack<'w>(&self, number: usize, words: &'w mut [u32]) -> (Packed<'w>, &'w mut [u32])
    where
        Self: 'w,
    {
        let (layer, weights, biases) = self.layer(number);
        let is_first = number == 0;
        let inputs = if is_first { ORDER.len() } else { layer.inputs };
        let (front, rest) = words.split_at_mut(layer.taps * inputs * layer.outputs / 2);
        let (pairs, _) = front.as_chunks_mut();
        if layer.taps == 1 {
            // A head's in one pass.
            let pass = if number < FIRST_HEAD { OUTPUTS } else { HEAD };
            pack_pixels(layer, weights, pass, pairs);
        } else if is_first {
            let (own, often) = ORDER.split_at(OWN);
            pack_columns(layer, weights, &[own, often], pairs);
        } else {
            pack_columns(layer, weights, &[&PLAIN[..inputs]], pairs);
        }
        let packed = Packed {
            words: front,
            biases,
            inputs,
            is_first,
        };
        (packed, rest)
    }
}

/// Of the layers, the first that makes heads.
const FIRST_HEAD: usize = 11;
/// Outputs of a pass, but for heads.
const OUTPUTS: usize = 4;

/// Of a 3 × 3 layer: pass by pass, of `parts` one after the other, row by row, input by input, from the right tap to the left.
fn pack_columns(layer: Layer, weights: &[i8], parts: &[&[usize]], to: &mut [[u32; OUTPUTS / 2]]) {
    let mut to = to.iter_mut();
    for pass in 0..layer.outputs / OUTPUTS {
        for part in parts {
            for row in 0..3 {
                for &input in *part {
                    for tap in [2, 1, 0] {
                        let Some(words) = to.next() else { return };
                        *words = [0; 2];
                        if input < layer.inputs {
                            let at =
                                ((3 * row + tap) * layer.inputs + input) * layer.outputs + pass * OUTPUTS;
                            if let Some(&[a, b, c, d]) = weights[at..].first_chunk() {
                                *words = [word([a, b]), word([c, d])];
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Of a 1 × 1 layer: pass by pass of as many outputs, input by input.
fn pack_pixels(layer: Layer, weights: &[i8], pass: usize, to: &mut [[u32; OUTPUTS / 2]]) {
    let mut to = to.iter_mut();
    for first in (0..layer.outputs).step_by(pass) {
        for weights in weights.chunks_exact(layer.outputs) {
            for four in weights[first..][..pass].as_chunks::<OUTPUTS>().0 {
                let Some(words) = to.next() else { return };
                *words = [word([four[0], four[1]]), word([four[2], four[3]])];
            }
        }
    }
}

/// A layer ready to run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Packed<'a> {
    words: &'a [u32],
    biases: &'a [i16],
    inputs: usize,
    /// Whether it takes what is seen.
    is_first: bool,
}

impl Packed<'_> {
    /// 3 × 3 over the rows above, at and below, activations out; the picture's edge goes on outwards.
    pub fn convolve(&self, rows: [&[u8]; 3], width: usize, out: &mut [u8]) {
        let (words, _) = self.words.as_chunks();
        if self.is_first {
            convolve_seen(rows, width, words, self.biases, out);
        } else {
            convolve(rows, [width, self.inputs], words, self.biases, out);
        }
    }

    /// 1 × 1 over each pixel of a row, and the pixel of the coarser size above it; activations out.
    pub fn merge(&self, coarse: &[u8], coarse_inputs: usize, fine: &[u8], width: usize, out: &mut [u8]) {
        let inputs = [coarse_inputs, self.inputs - coarse_inputs];
        merge(
            [coarse, fine],
            inputs,
            width,
            self.words.as_chunks().0,
            self.biases,
            out,
        );
    }

    /// The heads of pixels side by side: features in eighths, confidence and blend in 256ths about ½.
    pub fn heads(&self, pixels: &[u8], out: &mut [[u8; HEAD]]) {
        heads(pixels, self.inputs, self.words.as_chunks().0, self.biases, out);
    }

    /// The same in the activations' place, from the start on: none is narrower than a head.
    pub fn squeeze(&self, activations: &mut [u8]) {
        squeeze(activations, self.inputs, self.words.as_chunks().0, self.biases);
    }
}
