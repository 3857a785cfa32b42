//! A small neural network that says how far each pixel may be mixed with its neighbours, and the filter that does so.
//!
//! The network (a U-Net at 1, 1/2, 1/4 and 1/8 of the size) never makes light: it gives each pixel of each size six
//! *features*, a *confidence* and a *blend*. The filter then mixes irradiance, from coarse to fine:
//!
//! ```text
//! weight(i, j) = exp(−|feature i − feature j|²) · confidence j
//! light[l+1] = mean of light[l] by weight(coarse, fine)                           (2 × 2)
//! filtered[l] = mean of light[l] by weight                                        (3 × 3; 5 × 5 at the coarser sizes)
//! raised = mean of out[l+1] by exp(−|feature i − coarse feature j|²) · bilinear   (2 × 2)
//! out[l] = raised + blend · (filtered[l] − raised)
//! ```
//!
//! A finest head is made of what the network tells and of what its pixel is, unless that one's light is of one sample.
//!
//! At an outline the finest size's mean has a quarter of another thing's light, and half of the blend; light of one frame is
//! smoothed once more, within one thing (`last`).
//!
//! After Işık et al., "Interactive Monte Carlo Denoising using Affinity of Neural Features", 2021 (pairwise affinity), and
//! Thomas et al., "Temporally Stable Real-Time Joint Neural Denoising and Supersampling", 2022 (an extractor of low
//! precision, shared by the filters of several sizes).
//!
//! Every mean is its own centre plus a weighted difference, so where irradiance is the same all over it stays, bit for
//! bit. Weights are 8 bits, activations 6 bits (0 ..= 63 stand for 0 ..= 3.94), sums 16 bits, two to a word: see
//! [`Weights::new`]. Nothing panics after [`Network::new`]. By two workers ([`Pair`]) the bits are the same.

#[cfg(columns)]
mod columns;
mod extract;
mod filter;
mod finest;
mod input;
mod last;
mod layer;
mod mean;
mod neural;
#[cfg(not(columns))]
mod packed;
#[cfg(not(any(layers, columns)))]
mod plain;
mod weights;

use input::OWN;
pub use input::{INPUTS, Input, LIGHTS, exposure, irradiance};
pub use layer::{BIASES, LAYERS, Layer, WEIGHTS, Weights, WeightsError, layers};
pub use mean::EXP;
pub use neural::Neural;
pub use weights::{CHECKSUM, TRAINED};

#[cfg(columns)]
use columns::{Packed, Row, SEEN};
#[cfg(not(columns))]
use packed::{Packed, Row, SEEN};

use super::Pair;

/// Sizes at which the network sees the picture: each half the one before, rounded up.
pub const LEVELS: usize = 4;
/// Features of a pixel.
pub const FEATURES: usize = 6;
/// Bytes of a pixel's head: features (signed, eighths), confidence, blend.
pub const HEAD: usize = FEATURES + 2;
/// Channels of activations at each size.
pub const CHANNELS: [usize; LEVELS] = [4, 8, 12, 12];
/// Words of packed weights that the widest step keeps: merge and convolution at a quarter of the size.
const WORDS: usize = (CHANNELS[3] + CHANNELS[2]) * CHANNELS[2] / 2 + 9 * CHANNELS[2] * CHANNELS[2] / 2;

// Activations stand in the place of their pixel's head, and heads of coarser sizes in that of their activations, which are
// whole words of bytes.
const _: () = assert!(CHANNELS[0] <= HEAD && HEAD <= CHANNELS[1] && HEAD <= CHANNELS[3]);
const _: () = assert!(CHANNELS[2].is_multiple_of(4) && CHANNELS[3].is_multiple_of(4));

type Light = [u16; 3];
type Head = [u8; HEAD];

/// How long the slices of a [`Scratch`] have to be for pictures of some size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Pixels.
    pub fine: usize,
    /// Words.
    pub near: usize,
    /// Words.
    pub far: usize,
}

impl Needs {
    /// For pictures of up to [`MAX_SIDE`] pixels a side; larger ones are refused by [`Network::new`].
    pub const fn of(width: usize, height: usize) -> Needs {
        let [half, quarter, eighth] = [
            Shape::of(width, height, 1).pixels(),
            Shape::of(width, height, 2).pixels(),
            Shape::of(width, height, 3).pixels(),
        ];
        let (head, light) = (size_of::<Head>(), size_of::<Light>());
        let extraction = CHANNELS[1] * half + 2 * Shape::ring(width);
        let coarser = head * (half + quarter) + light * half;
        let finest = head * half + 2 * finest::Ring::bytes(width);
        let far = CHANNELS[3] * eighth + CHANNELS[2] * quarter + 4 * WORDS;
        let lights = filter::overlaid(half, quarter, eighth) + light * quarter;
        Needs {
            fine: width * height,
            near: max(extraction, max(coarser, finest)).div_ceil(4),
            far: max(far, lights).div_ceil(4),
        }
    }
}

const fn max(a: usize, b: usize) -> usize {
    if a > b { a } else { b }
}

/// Memory lent to a [`Network`]; what is in it before does not matter.
#[derive(Debug)]
pub struct Scratch<'a> {
    /// The finest size's activations, in whose place come its heads, in whose place comes the finest light.
    pub fine: &'a mut [[u8; HEAD]],
    /// What is of half the size, and rows for each worker.
    pub near: &'a mut [u32],
    /// What is of the sizes below, and weights, unpacked for the step under way; then the light of half the size that the
    /// finest is raised from.
    pub far: &'a mut [u32],
}

/// Why a picture is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NetworkError {
    /// Width and height are 1 ..= [`MAX_SIDE`].
    Size { width: usize, height: usize },
    /// [`Scratch::fine`] is too short.
    Fine { needed: usize },
    /// [`Scratch::near`] is too short.
    Near { needed: usize },
    /// [`Scratch::far`] is too short.
    Far { needed: usize },
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
            Self::Near { needed } => write!(f, "scratch.near is short: {needed} words are needed"),
            Self::Far { needed } => write!(f, "scratch.far is short: {needed} words are needed"),
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
        let mut most = (4 * SEEN + CHANNELS[0]) * width;
        let mut level = 1;
        while level < LEVELS {
            most = max(most, 5 * CHANNELS[level] * Shape::of(width, 1, level).width);
            level += 1;
        }
        // Enough for the finest heads: five rows, and one of what they are made of.
        assert!(4 * SEEN >= 4 * CHANNELS[0] + CHANNELS[0] + OWN);
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
    /// The border: sizes and memory are checked here, and nothing fails afterwards but for an answer of another size.
    pub fn new(
        weights: Weights<'a>,
        width: usize,
        height: usize,
        scratch: Scratch<'a>,
    ) -> Result<Self, NetworkError> {
        let shape = Shape::all(width, height)?;
        let Needs { fine, near, far } = Needs::of(width, height);
        let scratch = Scratch {
            fine: scratch
                .fine
                .get_mut(..fine)
                .ok_or(NetworkError::Fine { needed: fine })?,
            near: scratch
                .near
                .get_mut(..near)
                .ok_or(NetworkError::Near { needed: near })?,
            far: scratch
                .far
                .get_mut(..far)
                .ok_or(NetworkError::Far { needed: far })?,
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
