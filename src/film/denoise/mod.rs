//! From noisy [`Feature`]s to a clean picture, in integers, in memory that the caller lends.
//!
//! ```text
//! Renderer::feature_tile -> firefly clamp, history (accumulate) -> Filter (a-trous) -> times albedo
//!                                  ^ where a pixel was: Reproject      `-> twice or three times the size: upsample, times its albedo
//! either, outlines without steps (outline), row by row -> what is shown
//!                        half of it and half of what was shown before (taa), where there is room for two pictures
//! ```
//!
//! All of it works on light before the albedo, so that no edge of a texture is blurred. Each pass writes rows that no
//! other row of the same pass reads: bands of rows may be made in any order, by several cores ([`Pair`]), and the bits are
//! the same.
//!
//! RAM: 26 bytes a pixel ([`Memory`]) and three rows of light. The filter by the network takes 1.9 more
//! ([`network::Neural::needs`]).

mod accumulate;
mod atrous;
mod near;
pub mod network;
mod outline;
mod pair;
mod remember;
mod taa;
mod upsample;
mod weight;

pub use accumulate::{Band, Before, Past, Reproject, accumulate};
pub use atrous::{Atrous, Whole, beside};
pub use near::FIREFLY;
pub use outline::{Row, Seen};
pub use pair::{Alone, Pair};
pub use taa::Shown;
pub use upsample::{upsample, upsample_3x};

use core::ops::Range;

use self::outline::{MIDDLE, go_down, worth};
use self::upsample::Coarse;
use self::weight::Turns;
use super::Feature;
use crate::color::{Radiance, Rgb9e5};
use zerocopy::{FromBytes, IntoBytes};

/// Width and height, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    pub width: u16,
    pub height: u16,
}

impl Size {
    pub const fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }

    /// So many times as wide and high.
    pub const fn times(self, scale: u16) -> Size {
        Size {
            width: self.width.saturating_mul(scale),
            height: self.height.saturating_mul(scale),
        }
    }

    /// Pixels of the upper half of the rows, which is the first worker's.
    const fn upper(self) -> usize {
        self.width as usize * (self.height as usize).div_ceil(2)
    }
}

/// What a [`Denoiser`] works in; each slice at least as long as its line says.
#[derive(Debug)]
pub struct Memory<'m> {
    /// A pixel each.
    pub frames: [&'m mut [Feature]; 2],
    /// A pixel each.
    pub lengths: [&'m mut [u8]; 2],
    /// Three rows: [`ROWS`].
    pub rows: &'m mut [Rgb9e5],
}

/// Rows of light that a [`Denoiser`] works in: one for each worker, and one that the upper half sees below it.
pub const ROWS: usize = 3;

/// Memory that does not suffice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooShort {
    /// Which slice of [`Memory`].
    pub slice: &'static str,
    /// How long it has to be.
    pub needed: usize,
}

impl core::fmt::Display for TooShort {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "`{}` is too short: {} are needed", self.slice, self.needed)
    }
}

impl core::error::Error for TooShort {}

/// What makes smooth light of noisy light: within one frame, led by its features.
pub trait Filter {
    /// Filters `frame`'s irradiance; the answer is in `scratch.light`.
    ///
    /// `lengths` has how many frames each pixel's light is of, 1 ..= 8.
    fn filter(&mut self, pair: &impl Pair, size: Size, frame: &[Feature], lengths: &[u8], scratch: Scratch);
}

/// Lets light through as it is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Off;

impl Filter for Off {
    fn filter(&mut self, _: &impl Pair, _: Size, frame: &[Feature], _: &[u8], scratch: Scratch) {
        for (light, pixel) in scratch.light.iter_mut().zip(frame) {
            *light = pixel.irradiance;
        }
    }
}

/// Room for a filter, twelve bytes a pixel.
#[derive(Debug)]
pub struct Scratch<'a> {
    /// A pixel each.
    pub light: &'a mut [Rgb9e5],
    /// Eight bytes a pixel, as well aligned as `light`.
    pub rest: &'a mut [u8],
}

impl<'a> Scratch<'a> {
    /// In the place of pixels that are not needed meanwhile.
    pub fn over(pixels: &'a mut [Feature]) -> Scratch<'a> {
        let count = pixels.len();
        let (light, rest) = pixels.as_mut_bytes().split_at_mut(4 * count);
        // Four bytes each and as well aligned as a pixel: the cast cannot fail.
        let light = <[Rgb9e5]>::mut_from_bytes(light).unwrap_or(&mut []);
        Scratch { light, rest }
    }
}

/// One frame after another: holds what is remembered of the last.
///
/// Render into [`Self::frame`], then [`Self::denoise`], then show [`Clean::rows`].
#[derive(Debug)]
pub struct Denoiser<'m> {
    size: Size,
    /// Samples a pixel of each frame.
    spp: u32,
    now: &'m mut [Feature],
    before: &'m mut [Feature],
    lengths: &'m mut [u8],
    lengths_before: &'m mut [u8],
    rows: &'m mut [Rgb9e5],
    /// Frames so far, wrapping; those before this one are in `before` unless it is the first.
    count: u32,
    has_history: bool,
    /// Frames, this one in it, of which pixels are remembered as a whole: see [`Reproject::is_whole`].
    whole: u8,
}

impl<'m> Denoiser<'m> {
    /// For frames of `size` and of `spp` samples a pixel. The border: past it nothing fails.
    pub fn new(size: Size, spp: u32, memory: Memory<'m>) -> Result<Denoiser<'m>, TooShort> {
        let needed = size.pixels();
        let [now, before] = memory.frames;
        let [lengths, lengths_before] = memory.lengths;
        let short = |slice, needed| TooShort { slice, needed };
        Ok(Denoiser {
            size,
            spp,
            now: now.get_mut(..needed).ok_or(short("frames[0]", needed))?,
            before: before.get_mut(..needed).ok_or(short("frames[1]", needed))?,
            lengths: lengths.get_mut(..needed).ok_or(short("lengths[0]", needed))?,
            lengths_before: lengths_before
                .get_mut(..needed)
                .ok_or(short("lengths[1]", needed))?,
            rows: memory
                .rows
                .get_mut(..ROWS * size.width as usize)
                .ok_or(short("rows", ROWS * size.width as usize))?,
            count: 0,
            has_history: false,
            whole: 0,
        })
    }

    pub fn size(&self) -> Size {
        self.size
    }

    /// Where the next frame is rendered to, row by row. What was shown of the last one is gone with the first write.
    pub fn frame(&mut self) -> &mut [Feature] {
        self.now
    }

    /// Forgets what was seen: a cut.
    pub fn forget(&mut self) {
        self.has_history = false;
    }

    /// Takes the frame together with the history, if `motion` says where its places were, and filters.
    ///
    /// Answers with the clean frame; the next one is rendered after that was shown.
    pub fn denoise<'d>(&'d mut self, motion: Option<&impl Reproject>, filter: &mut impl Filter) -> Clean<'d> {
        self.denoise_by(&Alone, motion, filter)
    }

    /// [`Self::denoise`] by two workers: the same bits.
    pub fn denoise_by<'d>(
        &'d mut self,
        pair: &impl Pair,
        motion: Option<&impl Reproject>,
        filter: &mut impl Filter,
    ) -> Clean<'d> {
        let motion = if self.has_history { motion } else { None };
        let past = motion.map(|motion| Past {
            frame: self.before,
            lengths: self.lengths_before,
            motion,
        });
        let [upper, lower] = halves(self.size, self.now, self.lengths, self.rows);
        let (past, count) = (past.as_ref(), self.count);
        pair.both(
            || accumulate(upper, past, count),
            || accumulate(lower, past, count),
        );
        self.count = self.count.wrapping_add(1);
        self.has_history = true;
        self.whole = match motion {
            Some(motion) if motion.is_whole() => self.whole.saturating_add(1),
            _ => 1,
        };
        // The last frame is not needed any more: its place is the filter's, and the next frame's after that.
        core::mem::swap(&mut self.now, &mut self.before);
        core::mem::swap(&mut self.lengths, &mut self.lengths_before);
        let scratch = Scratch::over(self.now);
        filter.filter(pair, self.size, self.before, self.lengths_before, scratch);
        Clean {
            size: self.size,
            frame: self.before,
            light: Scratch::over(self.now).light,
            lengths: self.lengths_before,
            spp: self.spp,
            whole: self.whole,
        }
    }
}

/// Both halves of a frame, each with the other's nearest row as it was rendered.
fn halves<'a>(
    size: Size,
    frame: &'a mut [Feature],
    lengths: &'a mut [u8],
    rows: &'a mut [Rgb9e5],
) -> [Band<'a>; 2] {
    let width = size.width as usize;
    let (upper, lower) = frame.split_at_mut(size.upper());
    let (upper_lengths, lower_lengths) = lengths.split_at_mut(upper.len());
    let (first, rest) = rows.split_at_mut(width);
    let (below, above) = rest.split_at_mut(width);
    for (light, pixel) in below.iter_mut().zip(&*lower) {
        *light = pixel.irradiance;
    }
    let last = upper.len().saturating_sub(width);
    for (light, pixel) in above.iter_mut().zip(&upper[last..]) {
        *light = pixel.irradiance;
    }
    let below: &[Rgb9e5] = if lower.is_empty() { &[] } else { below };
    let start = (size.height).div_ceil(2);
    [
        Band {
            size,
            first: 0,
            rows: upper,
            lengths: upper_lengths,
            above: first,
            below,
        },
        Band {
            size,
            first: start,
            rows: lower,
            lengths: lower_lengths,
            above,
            below: &[],
        },
    ]
}

/// A frame without its noise.
#[derive(Clone, Copy, Debug)]
pub struct Clean<'d> {
    pub size: Size,
    pub frame: &'d [Feature],
    pub light: &'d [Rgb9e5],
    /// How many frames each pixel's light is of, 1 ..= 8.
    pub lengths: &'d [u8],
    /// Samples a pixel of each.
    pub spp: u32,
    /// Of how many frames silhouettes and albedo are, at most: 1 where anything moved.
    pub whole: u8,
}

impl Clean<'_> {
    /// A pixel's light; black beside the picture.
    #[inline]
    pub fn pixel(&self, x: u16, y: u16) -> Radiance {
        let place = y as usize * self.size.width as usize + x as usize;
        match (self.light.get(place), self.frame.get(place)) {
            (Some(light), Some(pixel)) if x < self.size.width => light.times(pixel.albedo()),
            _ => Radiance::BLACK,
        }
    }

    /// A pixel of a picture twice as wide and high, whose own first hit is `guide`: see [`upsample`].
    #[inline]
    pub fn pixel_2x(&self, x: u16, y: u16, guide: &Feature) -> Radiance {
        upsample(self.size, self.frame, self.light, [x, y], guide).mul_albedo(guide.albedo())
    }

    /// A pixel of a picture three times as wide and high: see [`upsample_3x`].
    #[inline]
    pub fn pixel_3x(&self, x: u16, y: u16, guide: &Feature) -> Radiance {
        upsample_3x(self.size, self.frame, self.light, [x, y], guide).mul_albedo(guide.albedo())
    }

    /// Shows `rows` from the top, outlines without steps; `ring` is as long as three of them, or rows are cut off.
    pub fn rows(&self, rows: Range<u16>, ring: &mut [Seen], show: impl FnMut(u16, Row)) {
        let each = worth(self.spp);
        let make = |y: u16, row: &mut [Seen]| {
            for (x, seen) in (0..).zip(row) {
                let place = y as usize * self.size.width as usize + x as usize;
                let light = self.light.get(place).copied().unwrap_or_default();
                *seen = match (self.frame.get(place), self.lengths.get(place)) {
                    (Some(pixel), Some(&length)) => {
                        let frames = u32::from(length.min(self.whole).max(1));
                        Seen::new(
                            light.shaded(pixel.albedo()),
                            pixel,
                            (frames * each).min(MIDDLE - 1),
                        )
                    }
                    _ => Seen::default(),
                };
            }
        };
        go_down(rows, self.size, ring, make, show);
    }

    /// The same of a picture twice as wide and high; `guide` answers each pixel's own first hit.
    pub fn rows_2x(
        &self,
        rows: Range<u16>,
        ring: &mut [Seen],
        mut guide: impl FnMut(u16, u16) -> Feature,
        show: impl FnMut(u16, Row),
    ) {
        let coarse = self.coarse();
        let mut turns = Turns::default();
        let make = |y: u16, row: &mut [Seen]| {
            let lines = coarse.lines(y);
            let (first, others) = row.split_at_mut(row.len().min(1));
            let (pairs, last) = others.as_chunks_mut::<2>();
            let ends = [(0, first), (2 * pairs.len() as u16 + 1, last)];
            for (k, pair) in (1..).zip(pairs) {
                let guides = [guide(2 * k - 1, y), guide(2 * k, y)];
                lines.pair(coarse, [k, y], &guides, &mut turns, pair);
            }
            for (x, shown) in ends {
                for shown in shown {
                    *shown = lines.single(coarse, [x, y], &guide(x, y), &mut turns);
                }
            }
        };
        go_down(rows, self.size.times(2), ring, make, show);
    }

    fn coarse(&self) -> Coarse<'_> {
        Coarse {
            size: self.size,
            frame: self.frame,
            light: self.light,
        }
    }

    /// The same of a picture three times as wide and high.
    pub fn rows_3x(
        &self,
        rows: Range<u16>,
        ring: &mut [Seen],
        mut guide: impl FnMut(u16, u16) -> Feature,
        show: impl FnMut(u16, Row),
    ) {
        let coarse = self.coarse();
        let mut turns = Turns::default();
        let make = |y: u16, row: &mut [Seen]| {
            let lines = coarse.lines_3x(y);
            lines.thirds(coarse, y, |x| guide(x, y), &mut turns, row);
        };
        go_down(rows, self.size.times(3), ring, make, show);
    }
}
