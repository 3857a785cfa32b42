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
//! [`Weights::new`]. Nothing panics after [`Network::new`]. By two workers ([`Pair`]) the bits are the same.

mod extract;
mod filter;
mod input;
mod layer;
mod neural;
mod weights;

pub use filter::EXP;
pub use input::{INPUTS, Input, exposure, irradiance};
pub use layer::{BIASES, LAYERS, Layer, WEIGHTS, Weights, WeightsError, layers};
pub use neural::Neural;
pub use weights::{CHECKSUM, TRAINED};

use super::Pair;

/// Sizes at which the network sees the picture: each half the one before, rounded up.
pub const LEVELS: usize = 4;
/// Bytes of a pixel's head: six features (signed, eighths), confidence, blend.
pub const HEAD: usize = 8;
/// Channels of activations at each size.
pub const CHANNELS: [usize; LEVELS] = [8, 12, 16, 16];
/// Words of packed weights that the widest step keeps: merge and convolution at a quarter of the size.
const WORDS: usize = (16 + 16) * 8 + 9 * 16 * 8;

type Light = [u16; 3];
type Head = [u8; HEAD];

/// How long the slices of a [`Scratch`] have to be for pictures of some size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Pixels.
    pub fine: usize,
    /// Words.
    pub coarse: usize,
    /// Words.
    pub work: usize,
}

impl Needs {
    /// For pictures of up to [`MAX_SIDE`] pixels a side; larger ones are refused by [`Network::new`].
    pub const fn of(width: usize, height: usize) -> Needs {
        let (mut activations, mut heads, mut light) = (0, 0, 0);
        let mut level = 1;
        while level < LEVELS {
            let pixels = Shape::of(width, height, level).pixels();
            activations += CHANNELS[level] * pixels;
            heads += size_of::<Head>() * pixels;
            light += 2 * size_of::<Light>() * pixels;
            level += 1;
        }
        let half = Shape::of(width, height, 1).pixels();
        let done = size_of::<Light>() * half;
        let last = size_of::<Head>() * half + 2 * Shape::lights(width) + done;
        Needs {
            fine: width * height,
            coarse: max(activations, max(heads + done, last)).div_ceil(4),
            work: max(4 * WORDS + 2 * Shape::ring(width), light - done).div_ceil(4),
        }
    }
}

const fn max(a: usize, b: usize) -> usize {
    if a > b { a } else { b }
}

/// Memory lent to a [`Network`]; what is in it before does not matter.
#[derive(Debug)]
pub struct Scratch<'a> {
    /// The finest size's activations, in whose place come its heads.
    pub fine: &'a mut [[u8; HEAD]],
    /// The coarser sizes' activations; then their heads from the start on, and at the end what the finest light is
    /// raised from.
    pub coarse: &'a mut [u32],
    /// Weights, unpacked for the step under way, and rows for each worker; then light of the coarser sizes. Of no use to
    /// the filter's last pass, which makes the finest light.
    pub work: &'a mut [u32],
}

/// Why a picture is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NetworkError {
    /// Width and height are 1 ..= [`MAX_SIDE`].
    Size { width: usize, height: usize },
    /// [`Scratch::fine`] is too short.
    Fine { needed: usize },
    /// [`Scratch::coarse`] is too short.
    Coarse { needed: usize },
    /// [`Scratch::work`] is too short.
    Work { needed: usize },
    /// The memory of a [`Neural`] is too short.
    Memory { needed: usize },
    /// The answer has not one place for each pixel.
    Out { needed: usize },
}

impl core::fmt::Display for NetworkError {
    fn fmt(&self, f: &mut core::fmt::Formatter) -> core::fmt::Result {
        match self {
            Self::Size { width, height } => {
                write!(f, "{width} x {height} pixels: each side must be 1 to {MAX_SIDE}")
            }
            Self::Fine { needed } => write!(f, "scratch.fine is short: {needed} pixels are needed"),
            Self::Coarse { needed } => write!(f, "scratch.coarse is short: {needed} words are needed"),
            Self::Work { needed } => write!(f, "scratch.work is short: {needed} words are needed"),
            Self::Memory { needed } => write!(f, "memory is short: {needed} words are needed"),
            Self::Out { needed } => write!(f, "out must have {needed} pixels"),
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

    /// The same at all sizes.
    fn all(width: usize, height: usize) -> Result<[Shape; LEVELS], NetworkError> {
        if !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
            return Err(NetworkError::Size { width, height });
        }
        Ok(core::array::from_fn(|level| Shape::of(width, height, level)))
    }

    /// Bytes of four rows that a worker's convolution looks at and one that it writes, whichever is the most of all sizes.
    const fn ring(width: usize) -> usize {
        let mut most = (4 * INPUTS + CHANNELS[0]) * width;
        let mut level = 1;
        while level < LEVELS {
            most = max(most, 5 * CHANNELS[level] * Shape::of(width, 1, level).width);
            level += 1;
        }
        most
    }

    /// Bytes of three rows of light.
    const fn lights(width: usize) -> usize {
        3 * size_of::<Light>() * width
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
    /// The border: sizes and memory are checked here, and nothing fails afterwards but for an answer of another size.
    pub fn new(
        weights: Weights<'a>,
        width: usize,
        height: usize,
        scratch: Scratch<'a>,
    ) -> Result<Self, NetworkError> {
        let shape = Shape::all(width, height)?;
        let Needs { fine, coarse, work } = Needs::of(width, height);
        let scratch = Scratch {
            fine: scratch
                .fine
                .get_mut(..fine)
                .ok_or(NetworkError::Fine { needed: fine })?,
            coarse: scratch
                .coarse
                .get_mut(..coarse)
                .ok_or(NetworkError::Coarse { needed: coarse })?,
            work: scratch
                .work
                .get_mut(..work)
                .ok_or(NetworkError::Work { needed: work })?,
        };
        Ok(Network {
            weights,
            shape,
            scratch,
        })
    }
}

/// Both halves of a plane's rows at once; `work` is told the first row's number.
fn halves<T: Send>(pair: &impl Pair, plane: &mut [T], width: usize, work: impl Fn(usize, &mut [T]) + Sync) {
    let half = (plane.len() / width).div_ceil(2);
    let (upper, lower) = plane.split_at_mut(half * width);
    pair.both(|| work(0, upper), || work(half, lower));
}
