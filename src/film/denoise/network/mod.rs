//! A small neural network that says how far each pixel may be mixed with its neighbours, and the filter that does so.
//!
//! The network (a U-Net at 1, 1/2, 1/4 and 1/8 of the size) never makes light: it gives each pixel of each size six
//! *features*, a *confidence* and a *blend*. The filter then mixes irradiance, from coarse to fine:
//!
//! ```text
//! light[l+1] = mean of light[l] by confidence                                     (2 × 2)
//! weight(i, j) = exp(−|feature i − feature j|²) · confidence j
//! filtered[l] = mean of light[l] by weight                                        (3 × 3; 5 × 5 at the coarser sizes)
//! raised = mean of out[l+1] by exp(−|feature i − coarse feature j|²) · bilinear   (2 × 2)
//! out[l] = raised + blend · (filtered[l] − raised)
//! ```
//!
//! After Işık et al., "Interactive Monte Carlo Denoising using Affinity of Neural Features", 2021 (pairwise affinity), and
//! Thomas et al., "Temporally Stable Real-Time Joint Neural Denoising and Supersampling", 2022 (an extractor of low
//! precision, shared by the filters of several sizes).
//!
//! Every mean is its own centre plus a weighted difference, so where irradiance is the same all over it stays, bit for
//! bit. Weights are 8 bits, activations 6 bits (0 ..= 63 stand for 0 ..= 3.94), sums 16 bits, two to a word: see
//! [`Weights::new`]. Nothing panics after [`Network::new`].

mod extract;
mod filter;
mod input;
mod layer;
mod neural;
mod weights;

pub use filter::EXP;
pub use input::{INPUTS, Input, exposure, irradiance};
pub use layer::{BIASES, LAYERS, Layer, WEIGHTS, Weights, WeightsError};
pub use neural::Neural;
pub use weights::{CHECKSUM, TRAINED};

/// Sizes at which the network sees the picture: each half the one before, rounded up.
pub const LEVELS: usize = 4;
/// Bytes of a pixel's head: six features (signed, eighths), confidence, blend.
pub const HEAD: usize = 8;
/// Channels of activations at each size.
pub const CHANNELS: [usize; LEVELS] = [8, 12, 16, 16];
/// Words of packed weights that the widest step keeps: merge, convolution and head at a quarter of the size.
const WORDS: usize = (16 + 16) * 8 + 9 * 16 * 8 + 16 * 4;

/// What a picture of some size takes of the caller's memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Bytes: activations and heads.
    pub bytes: usize,
    /// Words: weights, unpacked for the step under way.
    pub words: usize,
    /// Pixels: irradiance at the coarser sizes, before and after, and a row.
    pub light: usize,
}

impl Needs {
    /// For pictures of up to [`MAX_SIDE`] pixels a side; larger ones are refused by [`Network::new`].
    pub const fn of(width: usize, height: usize) -> Needs {
        let mut bytes = Shape::ring(width);
        let mut light = width;
        let mut level = 0;
        while level < LEVELS {
            let pixels = Shape::of(width, height, level).pixels();
            // The finest heads take the place of that size's activations.
            bytes += CHANNELS[level] * pixels;
            if level > 0 {
                bytes += HEAD * pixels;
                light += 2 * pixels;
            }
            level += 1;
        }
        Needs {
            bytes,
            words: WORDS,
            light,
        }
    }
}

/// Memory lent to a [`Network`]; what is in it before does not matter.
#[derive(Debug)]
pub struct Scratch<'a> {
    pub bytes: &'a mut [u8],
    pub words: &'a mut [u32],
    pub light: &'a mut [[u16; 3]],
}

/// Why a picture is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NetworkError {
    /// Width and height are 1 ..= [`MAX_SIDE`].
    Size { width: usize, height: usize },
    /// [`Scratch::bytes`] is too short.
    Bytes { needed: usize },
    /// [`Scratch::words`] is too short.
    Words { needed: usize },
    /// [`Scratch::light`] is too short.
    Light { needed: usize },
    /// The irradiance is not one for each pixel.
    Irradiance { needed: usize },
}

impl core::fmt::Display for NetworkError {
    fn fmt(&self, f: &mut core::fmt::Formatter) -> core::fmt::Result {
        match self {
            Self::Size { width, height } => {
                write!(f, "{width} x {height} pixels: each side must be 1 to {MAX_SIDE}")
            }
            Self::Bytes { needed } => write!(f, "scratch.bytes is short: {needed} bytes are needed"),
            Self::Words { needed } => write!(f, "scratch.words is short: {needed} words are needed"),
            Self::Light { needed } => write!(f, "scratch.light is short: {needed} pixels are needed"),
            Self::Irradiance { needed } => write!(f, "irradiance must have {needed} pixels"),
        }
    }
}

impl core::error::Error for NetworkError {}

/// The longest side of a picture, pixels.
pub const MAX_SIDE: usize = 8192;

/// Width and height at one of the sizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shape {
    width: usize,
    height: usize,
}

impl Shape {
    const fn of(width: usize, height: usize, level: usize) -> Shape {
        Shape {
            width: width.div_ceil(1 << level),
            height: height.div_ceil(1 << level),
        }
    }

    const fn pixels(self) -> usize {
        self.width * self.height
    }

    /// Three rows that a convolution looks at and one that it writes, whichever is the longest of all sizes.
    const fn ring(width: usize) -> usize {
        let mut most = (3 * INPUTS + CHANNELS[0]) * width;
        let mut level = 1;
        while level < LEVELS {
            let bytes = 4 * CHANNELS[level] * Shape::of(width, 1, level).width;
            if bytes > most {
                most = bytes;
            }
            level += 1;
        }
        most
    }
}

/// The network over one picture's size, with the memory that it works in.
#[derive(Debug)]
pub struct Network<'a> {
    weights: Weights<'a>,
    shape: [Shape; LEVELS],
    scratch: Scratch<'a>,
}

impl<'a> Network<'a> {
    /// The border: sizes and memory are checked here, and nothing fails afterwards but for a picture of another size.
    pub fn new(
        weights: Weights<'a>,
        width: usize,
        height: usize,
        scratch: Scratch<'a>,
    ) -> Result<Self, NetworkError> {
        if !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
            return Err(NetworkError::Size { width, height });
        }
        let needs = Needs::of(width, height);
        if scratch.bytes.len() < needs.bytes {
            return Err(NetworkError::Bytes { needed: needs.bytes });
        }
        if scratch.words.len() < needs.words {
            return Err(NetworkError::Words { needed: needs.words });
        }
        if scratch.light.len() < needs.light {
            return Err(NetworkError::Light { needed: needs.light });
        }
        let shape = core::array::from_fn(|level| Shape::of(width, height, level));
        Ok(Network {
            weights,
            shape,
            scratch,
        })
    }

    /// Filters one picture: `input` answers what the network sees of pixel number i (row by row, each asked once), and
    /// `sink` gets each finished row of irradiance, from the top.
    pub fn run(
        &mut self,
        irradiance: &[[u16; 3]],
        input: impl FnMut(usize) -> Input,
        sink: impl FnMut(usize, &[[u16; 3]]),
    ) -> Result<(), NetworkError> {
        self.extract(input);
        self.filter(irradiance, sink)
    }
}
