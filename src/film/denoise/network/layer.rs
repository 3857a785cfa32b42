use super::input::OWN;
use super::{CHANNELS, HEAD, LEVELS, LIGHTS};

/// Weights of all layers together.
pub const WEIGHTS: usize = {
    let mut sum = 0;
    let mut i = 0;
    while i < LAYERS.len() {
        sum += LAYERS[i].weights();
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
    /// At each tap.
    pub inputs: usize,
    /// Further inputs, of the pixel itself alone.
    pub own: usize,
    /// Even.
    pub outputs: usize,
}

impl Layer {
    /// Inputs that stand side by side at a tap: its own, too, where there is no other tap.
    pub(super) const fn each(&self) -> usize {
        if self.taps == 1 {
            self.inputs + self.own
        } else {
            self.inputs
        }
    }

    /// How many weights it has.
    pub const fn weights(&self) -> usize {
        (self.taps * self.inputs + self.own) * self.outputs
    }
}

const fn layer(taps: usize, inputs: usize, outputs: usize) -> Layer {
    Layer {
        taps,
        inputs,
        own: 0,
        outputs,
    }
}

/// Down through the sizes (0 ..= 3), once more at the coarsest (4); up again by a merge and a convolution each (5 ..= 10);
/// heads from the finest on (11 ..= 14).
pub const LAYERS: [Layer; 15] = layers(CHANNELS);

/// The layers of a network of `c` channels at each size.
pub const fn layers(c: [usize; LEVELS]) -> [Layer; 15] {
    [
        // But for light a pixel's neighbours differ from it only where things end, which the coarser sizes tell.
        Layer {
            own: OWN,
            ..layer(9, LIGHTS, c[0])
        },
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
        // What a pixel is tells it apart better than four activations do.
        Layer {
            own: OWN,
            ..layer(1, c[0], HEAD)
        },
        layer(1, c[1], HEAD),
        layer(1, c[2], HEAD),
        layer(1, c[3], HEAD),
    ]
}

/// What the network learned, checked.
///
/// Weights are 64ths, layer by layer; in a layer tap by tap (rows from the top, each from the left), in a tap input by
/// input (of a merge: the coarse ones first), in an input output by output; a pixel's own inputs follow. Biases are 1024ths, layer
/// by layer.
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
            let outputs = LAYERS[number].outputs;
            let count = LAYERS[number].weights();
            let mut output = 0;
            while output < outputs {
                let (mut above, mut below) = (0, 0);
                let mut i = 0;
                while i < count {
                    let w = weights[from + i + output] as i32;
                    if w > 0 {
                        above += w;
                    } else {
                        below -= w;
                    }
                    i += outputs;
                }
                if above > MOST || below > MOST {
                    return Err(WeightsError {
                        layer: number,
                        output,
                    });
                }
                output += 1;
            }
            from += count;
            number += 1;
        }
        Ok(Weights { weights, biases })
    }

    /// Weights and biases, in the order above.
    pub const fn tables(&self) -> (&'a [i8; WEIGHTS], &'a [i16; BIASES]) {
        (self.weights, self.biases)
    }

    /// Layer `number`, with its weights and biases.
    pub(super) fn layer(&self, number: usize) -> (Layer, &'a [i8], &'a [i16]) {
        let layer = LAYERS[number];
        let before = LAYERS.iter().take(number);
        let from: usize = before.clone().map(Layer::weights).sum();
        let biases: usize = before.map(|layer| layer.outputs).sum();
        (
            layer,
            &self.weights[from..][..layer.weights()],
            &self.biases[biases..][..layer.outputs],
        )
    }
}

/// Two weights in a word.
pub(super) fn word([low, high]: [i8; 2]) -> u32 {
    (i32::from(low) as u32).wrapping_add((i32::from(high) as u32) << 16)
}
