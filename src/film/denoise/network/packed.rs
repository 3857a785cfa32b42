use super::input::OWN;
use super::layer::{Weights, word};
use super::{CHANNELS, HEAD, INPUTS, LIGHTS};

/// Bytes of what the first layer takes of a pixel.
pub const SEEN: usize = INPUTS;

/// A row of what is seen, to be filled: light of all pixels, then what else there is of each.
#[derive(Debug)]
pub struct Row<'r> {
    lights: &'r mut [[u8; LIGHTS]],
    own: &'r mut [[u8; OWN]],
}

impl Row<'_> {
    /// Of the words that an [`Input`](super::Input) is made of, by number of pixel: the first, and the others where they differ
    /// from those of the pixel before.
    #[inline(always)]
    pub fn fill(self, mut look: impl FnMut(usize) -> (u32, Option<[u32; 2]>)) {
        let mut own = [0; 2];
        for (x, (light, place)) in self.lights.iter_mut().zip(self.own).enumerate() {
            let (bright, still) = look(x);
            own = still.unwrap_or(own);
            let [i0, i1, i2, depth] = bright.to_le_bytes();
            let [[a0, a1, a2, n0], [n1, n2, s, _]] = own.map(u32::to_le_bytes);
            *light = [i0, i1, i2];
            *place = [a0, a1, a2, n0, n1, n2, depth, s];
        }
    }
}

impl Weights<'_> {
    /// Layer `number`, its weights packed into the front of `words`; and the rest of those.
    pub(super) fn pack<'w>(&self, number: usize, words: &'w mut [u32]) -> (Packed<'w>, &'w mut [u32])
    where
        Self: 'w,
    {
        let (layer, weights, biases) = self.layer(number);
        let (front, rest) = words.split_at_mut(weights.len() / 2);
        let (weights, _) = weights.as_chunks::<2>();
        let by = pairs(layer.outputs);
        let products = layer.weights() / layer.outputs;
        for (pass, words) in front.chunks_exact_mut(products * by).enumerate() {
            let words = words.chunks_exact_mut(by);
            for (words, pairs) in words.zip(weights.chunks_exact(layer.outputs / 2)) {
                for (place, pair) in words.iter_mut().zip(&pairs[pass * by..]) {
                    *place = word(*pair);
                }
            }
        }
        let packed = Packed {
            words: front,
            biases,
            products,
            inputs: layer.each(),
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
    /// Of an output.
    products: usize,
    inputs: usize,
}

impl Packed<'_> {
    /// A row of what is seen.
    pub fn row<'r>(&self, row: &'r mut [u8]) -> Row<'r> {
        let (lights, own) = row.split_at_mut(row.len() / SEEN * LIGHTS);
        Row {
            lights: lights.as_chunks_mut().0,
            own: own.as_chunks_mut().0,
        }
    }

    /// 3 × 3 over the rows above, at and below, activations out; the picture's edge goes on outwards.
    pub fn convolve(&self, rows: [&[u8]; 3], width: usize, out: &mut [u8]) {
        if self.inputs == LIGHTS {
            return self.convolve_seen(rows, width, out);
        }
        match pairs(self.biases.len()) {
            2 => self.convolve_by::<2>(rows, width, out),
            3 => self.convolve_by::<3>(rows, width, out),
            _ => self.convolve_by::<4>(rows, width, out),
        }
    }

    fn convolve_by<const PAIRS: usize>(&self, rows: [&[u8]; 3], width: usize, out: &mut [u8]) {
        let (inputs, outputs) = (self.inputs, self.biases.len());
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

    /// 3 × 3 over light and 1 × 1 over what else is seen.
    fn convolve_seen(&self, rows: [&[u8]; 3], width: usize, out: &mut [u8]) {
        const PAIRS: usize = pairs(CHANNELS[0]);
        let (_, own) = rows[1].split_at(LIGHTS * width);
        let rows = rows.map(|row| &row[..LIGHTS * width]);
        let mut edge = |x: usize| {
            let columns = [x.saturating_sub(1), x, (x + 1).min(width - 1)];
            let run = |i: usize| match rows.get(i / 3) {
                Some(row) => (&row[columns[i % 3] * LIGHTS..][..LIGHTS], LIGHTS, 0),
                None => (&own[x * OWN..][..OWN], OWN, 0),
            };
            let out = &mut out[x * CHANNELS[0]..][..CHANNELS[0]];
            self.pixels::<PAIRS, 10>(core::array::from_fn(run), out);
        };
        edge(0);
        edge(width - 1);
        if width > 2 {
            let [above, at, below] = rows.map(|row| (row, 3 * LIGHTS, LIGHTS));
            let runs = [above, at, below, (&own[OWN..], OWN, OWN)];
            self.pixels::<PAIRS, 4>(runs, &mut out[CHANNELS[0]..(width - 1) * CHANNELS[0]]);
        }
    }

    /// 1 × 1 over each pixel of a row, and the pixel of the coarser size above it; activations out.
    pub fn merge(&self, coarse: &[u8], coarse_inputs: usize, fine: &[u8], _: usize, out: &mut [u8]) {
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
        let passes = words.chunks_exact(self.products);
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

    /// The same in the activations' place, from the start on: none is narrower than a head.
    pub fn squeeze(&self, activations: &mut [u8]) {
        for at in 0..activations.len() / self.inputs {
            let mut head = [[0; HEAD]];
            self.heads(&activations[at * self.inputs..][..self.inputs], &mut head);
            activations[at * HEAD..][..HEAD].copy_from_slice(&head[0]);
        }
    }
}

/// A run of activations of each of several pixels: the bytes, how many of them each pixel has, and how many further the next
/// one's begin.
pub(super) type Run<'a> = (&'a [u8], usize, usize);

#[cfg(not(layers))]
use super::plain::{activations, heads};
#[cfg(layers)]
use microlux_asm::{activations, heads};
