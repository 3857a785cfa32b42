use super::{CHANNELS, HEAD, INPUTS, LEVELS};

/// Weights of all layers together.
pub const WEIGHTS: usize = {
    let mut sum = 0;
    let mut i = 0;
    while i < LAYERS.len() {
        sum += LAYERS[i].taps * LAYERS[i].inputs * LAYERS[i].outputs;
        i += 1;
    }
    sum
};

/// Biases of all layers together.
pub const BIASES: usize = {
    let mut sum = 0;
    let mut i = 0;
    while i < LAYERS.len() {
        sum += LAYERS[i].outputs;
        i += 1;
    }
    sum
};

/// One layer's place in the table of weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layer {
    /// 9 (3 × 3) or 1.
    pub taps: usize,
    pub inputs: usize,
    /// Even.
    pub outputs: usize,
}

const fn layer(taps: usize, inputs: usize, outputs: usize) -> Layer {
    Layer {
        taps,
        inputs,
        outputs,
    }
}

/// Down through the sizes (0 ..= 3), once more at the coarsest (4); up again by a merge and a convolution each (5 ..= 10);
/// heads from the finest on (11 ..= 14).
pub const LAYERS: [Layer; 15] = layers(CHANNELS);

/// The layers of a network of `c` channels at each size.
pub const fn layers(c: [usize; LEVELS]) -> [Layer; 15] {
    [
        layer(9, INPUTS, c[0]),
        layer(9, c[0], c[1]),
        layer(9, c[1], c[2]),
        layer(9, c[2], c[3]),
        layer(9, c[3], c[3]),
        layer(1, c[3] + c[2], c[2]),
        layer(9, c[2], c[2]),
        layer(1, c[2] + c[1], c[1]),
        layer(9, c[1], c[1]),
        layer(1, c[1] + c[0], c[0]),
        layer(9, c[0], c[0]),
        layer(1, c[0], HEAD),
        layer(1, c[1], HEAD),
        layer(1, c[2], HEAD),
        layer(1, c[3], HEAD),
    ]
}

/// What the network learned, checked.
///
/// Weights are 64ths, layer by layer; in a layer tap by tap (rows from the top, each from the left), in a tap input by
/// input (of a merge: the coarse ones first), in an input output by output. Biases are 1024ths, layer by layer.
#[derive(Clone, Copy, Debug)]
pub struct Weights<'a> {
    weights: &'a [i8; WEIGHTS],
    biases: &'a [i16; BIASES],
}

/// Weights of which two sums do not fit one word: those of the output `output` of layer `layer` (both from 0).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WeightsError {
    pub layer: usize,
    pub output: usize,
}

/// The most that the weights above 0, and those below 0, of one output may add up to: 63 · 520 ≤ 2^15 − 1.
const MOST: i32 = 520;

impl<'a> Weights<'a> {
    /// The border of weights, also at compile time: what an output's weights above 0 add up to, and those below, is at most
    /// 520 each.
    ///
    /// Then each sum of products with 6 bits stays within 16 bits, wherever a picture leads, and one 32-bit
    /// multiplication does two: (w₀ + 2^16 w₁) a, added up modulo 2^32, holds both sums (the bound on sums is that of
    /// Colbert et al., "A2Q: Accumulator-Aware Quantization with Guaranteed Overflow Avoidance", 2023).
    pub const fn new(
        weights: &'a [i8; WEIGHTS],
        biases: &'a [i16; BIASES],
    ) -> Result<Weights<'a>, WeightsError> {
        let mut from = 0;
        let mut number = 0;
        while number < LAYERS.len() {
            let Layer {
                taps,
                inputs,
                outputs,
            } = LAYERS[number];
            let mut output = 0;
            while output < outputs {
                let (mut above, mut below) = (0, 0);
                let mut i = 0;
                while i < taps * inputs {
                    let w = weights[from + i * outputs + output] as i32;
                    if w > 0 {
                        above += w;
                    } else {
                        below -= w;
                    }
                    i += 1;
                }
                if above > MOST || below > MOST {
                    return Err(WeightsError {
                        layer: number,
                        output,
                    });
                }
                output += 1;
            }
            from += taps * inputs * outputs;
            number += 1;
        }
        Ok(Weights { weights, biases })
    }

    /// Weights and biases, in the order above.
    pub const fn tables(&self) -> (&'a [i8; WEIGHTS], &'a [i16; BIASES]) {
        (self.weights, self.biases)
    }

    /// Layer `number`, its weights packed into the front of `words`; and the rest of those.
    pub(super) fn pack<'w>(&self, number: usize, words: &'w mut [u32]) -> (Packed<'w>, &'w mut [u32])
    where
        'a: 'w,
    {
        let Layer {
            taps,
            inputs,
            outputs,
        } = LAYERS[number];
        let before = LAYERS.iter().take(number);
        let from: usize = before.clone().map(|l| l.taps * l.inputs * l.outputs).sum();
        let biases: usize = before.map(|l| l.outputs).sum();
        let (front, rest) = words.split_at_mut(taps * inputs * outputs / 2);
        let (weights, _) = self.weights[from..][..taps * inputs * outputs].as_chunks::<2>();
        let by = pairs(outputs);
        for (pass, words) in front.chunks_exact_mut(taps * inputs * by).enumerate() {
            let words = words.chunks_exact_mut(by);
            for (words, pairs) in words.zip(weights.chunks_exact(outputs / 2)) {
                for (word, [low, high]) in words.iter_mut().zip(&pairs[pass * by..]) {
                    *word = (i32::from(*low) as u32).wrapping_add((i32::from(*high) as u32) << 16);
                }
            }
        }
        let packed = Packed {
            words: front,
            biases: &self.biases[biases..][..outputs],
            taps,
            inputs,
        };
        (packed, rest)
    }
}

/// Words of sums that one pass over a pixel's inputs makes: no more than a small core has registers for.
const fn pairs(outputs: usize) -> usize {
    match outputs {
        4 => 2,
        12 => 3,
        _ => 4,
    }
}

/// A layer ready to run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Packed<'a> {
    /// Pass by pass; in a pass as the weights lie in their table.
    words: &'a [u32],
    biases: &'a [i16],
    taps: usize,
    pub inputs: usize,
}

impl Packed<'_> {
    /// 3 × 3 over the rows above, at and below, activations out; the picture's edge goes on outwards.
    pub fn convolve(&self, rows: [&[u8]; 3], out: &mut [u8]) {
        match pairs(self.biases.len()) {
            2 => self.convolve_by::<2>(rows, out),
            3 => self.convolve_by::<3>(rows, out),
            _ => self.convolve_by::<4>(rows, out),
        }
    }

    fn convolve_by<const PAIRS: usize>(&self, rows: [&[u8]; 3], out: &mut [u8]) {
        let (inputs, outputs) = (self.inputs, self.biases.len());
        let width = rows[0].len() / inputs;
        let mut edge = |x: usize| {
            let columns = [x.saturating_sub(1), x, (x + 1).min(width - 1)];
            let run = |i: usize| (&rows[i / 3][columns[i % 3] * inputs..][..inputs], inputs, 0);
            self.pixels::<PAIRS, 9>(core::array::from_fn(run), &mut out[x * outputs..][..outputs]);
        };
        edge(0);
        edge(width - 1);
        if width > 2 {
            let runs = rows.map(|row| (row, 3 * inputs, inputs));
            self.pixels::<PAIRS, 3>(runs, &mut out[outputs..(width - 1) * outputs]);
        }
    }

    /// 1 × 1 over each pixel of a row, and the pixel of the coarser size above it; activations out.
    pub fn merge(&self, coarse: &[u8], coarse_inputs: usize, fine: &[u8], out: &mut [u8]) {
        match pairs(self.biases.len()) {
            2 => self.merge_by::<2>(coarse, coarse_inputs, fine, out),
            3 => self.merge_by::<3>(coarse, coarse_inputs, fine, out),
            _ => self.merge_by::<4>(coarse, coarse_inputs, fine, out),
        }
    }

    fn merge_by<const PAIRS: usize>(&self, coarse: &[u8], coarse_inputs: usize, fine: &[u8], out: &mut [u8]) {
        let fine_inputs = self.inputs - coarse_inputs;
        let coarse = coarse.chunks_exact(coarse_inputs);
        let fine = fine.chunks(2 * fine_inputs);
        // Two pixels have the same coarser one.
        let outs = out.chunks_mut(2 * self.biases.len());
        for ((coarse, fine), out) in coarse.zip(fine).zip(outs) {
            let runs = [(coarse, coarse_inputs, 0), (fine, fine_inputs, fine_inputs)];
            self.pixels::<PAIRS, 2>(runs, out);
        }
    }

    /// Activations of pixels side by side, pass by pass: see [`activations`].
    #[inline(always)]
    fn pixels<const PAIRS: usize, const RUNS: usize>(&self, runs: [Run; RUNS], out: &mut [u8]) {
        let (words, _) = self.words.as_chunks::<PAIRS>();
        let biases = self.biases.chunks_exact(2 * PAIRS);
        let passes = words.chunks_exact(self.taps * self.inputs);
        for (pass, (biases, words)) in biases.zip(passes).enumerate() {
            let out = out.get_mut(pass * 2 * PAIRS..).unwrap_or(&mut []);
            activations(runs, words, biases, out, self.biases.len());
        }
    }

    /// The heads of pixels side by side: features in eighths, confidence and blend in 256ths about ½.
    pub fn heads(&self, pixels: &[u8], out: &mut [[u8; HEAD]]) {
        let (words, _) = self.words.as_chunks::<{ HEAD / 2 }>();
        heads(pixels, self.inputs, words, self.biases, out);
    }

    /// The head of one.
    pub fn head(&self, pixel: &[u8]) -> [u8; HEAD] {
        let mut head = [[0; HEAD]];
        self.heads(pixel, &mut head);
        head[0]
    }
}

/// A run of activations of each of several pixels: the bytes, how many of them each pixel has, and how many further the next
/// one's begin.
pub(super) type Run<'a> = (&'a [u8], usize, usize);

#[cfg(not(layers))]
use super::plain::{activations, heads};
#[cfg(layers)]
use microlux_asm::{activations, heads};
