//! Layers as a core takes them whose routines go column by column (`microlux_asm::convolve`).

use super::input::OWN;
use super::layer::{Layer, Weights, word};
use super::{HEAD, LIGHTS};
use microlux_asm::{convolve, convolve_seen, heads, merge, squeeze};
use zerocopy::FromBytes;

/// Light, then the sums of what else there is, two to a word.
type Seen = [u32; 1 + OUTPUTS / 2];
/// Bytes of what the first layer takes of a pixel.
pub const SEEN: usize = size_of::<Seen>();

/// A row of what is seen, to be filled.
#[derive(Debug)]
pub struct Row<'r> {
    places: &'r mut [Seen],
    words: &'r [[u32; OUTPUTS / 2]; OWN],
}

impl Row<'_> {
    /// Of the words that an [`Input`](super::Input) is made of, by number of pixel: the first, and the others where they differ
    /// from those of the pixel before.
    #[inline(always)]
    pub fn fill(self, mut look: impl FnMut(usize) -> (u32, Option<[u32; 2]>)) {
        let mut alike = [0; OUTPUTS / 2];
        for (x, place) in self.places.iter_mut().enumerate() {
            let (bright, still) = look(x);
            if let Some(still) = still {
                alike = sums(self.words, still);
            }
            let ([first, second], [a, b]) = (alike, self.words[DEPTH]);
            let depth = bright >> 24;
            *place = [
                bright & 0xff_ffff,
                first.wrapping_add(a.wrapping_mul(depth)),
                second.wrapping_add(b.wrapping_mul(depth)),
            ];
        }
    }
}

/// Of a pixel's own inputs, its depth.
const DEPTH: usize = OWN - 2;

/// Of all of them but for depth.
#[inline(never)]
fn sums(words: &[[u32; OUTPUTS / 2]; OWN], [mut first, mut second]: [u32; 2]) -> [u32; OUTPUTS / 2] {
    let [others @ .., samples] = words;
    let mut sums = samples.map(|word| word.wrapping_mul(second >> 16));
    for words in &others[..DEPTH] {
        for (sum, word) in sums.iter_mut().zip(words) {
            *sum = sum.wrapping_add(word.wrapping_mul(first & 0xff));
        }
        first = first >> 8 | second << 24;
        second >>= 8;
    }
    sums
}

impl Weights<'_> {
    /// Layer `number`, its weights packed into the front of `words`; and the rest of those.
    pub(super) fn pack<'w>(&self, number: usize, words: &'w mut [u32]) -> (Packed<'w>, &'w mut [u32])
    where
        Self: 'w,
    {
        let (layer, weights, biases) = self.layer(number);
        let (front, rest) = words.split_at_mut(weights.len() / 2);
        let (pairs, _) = front.as_chunks_mut();
        if layer.taps == 1 {
            // A head's in one pass.
            let pass = if number < FIRST_HEAD { OUTPUTS } else { HEAD };
            pack_pixels(layer, weights, pass, pairs);
        } else {
            let (near, own) = weights.split_at(weights.len() - layer.own * layer.outputs);
            let (columns, pixels) = pairs.split_at_mut(near.len() / OUTPUTS);
            pack_columns(layer, near, columns);
            pack_pixels(layer, own, OUTPUTS, pixels);
        }
        let packed = Packed {
            words: front,
            biases,
            inputs: layer.each(),
        };
        (packed, rest)
    }
}

/// Of the layers, the first that makes heads.
const FIRST_HEAD: usize = 11;
/// Outputs of a pass, but for heads.
const OUTPUTS: usize = 4;

/// Of a 3 × 3 layer: pass by pass, row by row, input by input, from the right tap to the left.
fn pack_columns(layer: Layer, weights: &[i8], to: &mut [[u32; OUTPUTS / 2]]) {
    let mut to = to.iter_mut();
    for pass in 0..layer.outputs / OUTPUTS {
        for row in 0..3 {
            for input in 0..layer.inputs {
                for tap in [2, 1, 0] {
                    let at = ((3 * row + tap) * layer.inputs + input) * layer.outputs + pass * OUTPUTS;
                    if let (Some(&[a, b, c, d]), Some(words)) = (weights[at..].first_chunk(), to.next()) {
                        *words = [word([a, b]), word([c, d])];
                    }
                }
            }
        }
    }
}

/// Of inputs of a pixel itself: pass by pass of as many outputs, input by input.
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
}

/// Words of a 3 × 3 layer's weights over light.
const NEAR: usize = 9 * LIGHTS * OUTPUTS / 2;

impl<'a> Packed<'a> {
    /// A row of what is seen, of the first layer.
    pub fn row<'r>(&self, row: &'r mut [u8]) -> Row<'r>
    where
        'a: 'r,
    {
        let words = self.words.split_at_checked(NEAR);
        let words = words.and_then(|(_, own)| own.as_chunks().0.first_chunk());
        Row {
            // Whole ones, and words where they are: the cast cannot fail.
            places: <[Seen]>::mut_from_bytes(row).unwrap_or(&mut []),
            words: words.unwrap_or(&[[0; OUTPUTS / 2]; OWN]),
        }
    }

    /// 3 × 3 over the rows above, at and below, activations out; the picture's edge goes on outwards.
    pub fn convolve(&self, rows: [&[u8]; 3], width: usize, out: &mut [u8]) {
        let (words, _) = self.words.as_chunks();
        if self.inputs == LIGHTS {
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
