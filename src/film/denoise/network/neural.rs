use super::finest::kept;
use super::last;
use super::{Needs, Network, NetworkError, Scratch, Shape, Weights, halves, irradiance};
use crate::color::Rgb9e5;
use crate::film::Feature;
use crate::film::denoise::{self, Filter, Pair, Size};
use crate::film::feature::{DEPTH_NOTHING, ID_NOTHING};
use zerocopy::{FromBytes, IntoBytes};

/// The network as a denoiser's filter. Pixels that see nothing, and not by way of a mirror or glass, keep their light.
///
/// It works in the filter's [`denoise::Scratch`] and in memory of its own. The finest heads, and then the finest light, stand
/// beside the answer's place, and [`Scratch::near`] in that place until the answer comes, if it is large enough.
#[derive(Debug)]
pub struct Neural<'a> {
    weights: Weights<'a>,
    size: Size,
    samples: u32,
    memory: &'a mut [u32],
}

impl<'a> Neural<'a> {
    /// Words of memory for frames of `size`, of up to [`super::MAX_SIDE`] pixels a side.
    pub const fn needs(size: Size) -> usize {
        let Needs { fine, near, far } = Needs::of(size.width as usize, size.height as usize);
        if near <= fine { far } else { far + near }
    }

    /// For frames of `size` and of `samples` a pixel each; `memory` has as many words as it [`Self::needs`].
    pub fn new(
        weights: Weights<'a>,
        size: Size,
        samples: u32,
        memory: &'a mut [u32],
    ) -> Result<Neural<'a>, NetworkError> {
        Shape::all(size.width.into(), size.height.into())?;
        let needed = Neural::needs(size);
        let memory = memory.get_mut(..needed).ok_or(NetworkError::Memory { needed })?;
        Ok(Neural {
            weights,
            size,
            samples,
            memory,
        })
    }

    /// Its memory: [`Self::needs`] words, of no use to it between two frames.
    pub fn memory(&mut self) -> &mut [u32] {
        self.memory
    }

    /// [`Filter::filter`], or what it is refused for.
    fn run(
        &mut self,
        pair: &impl Pair,
        frame: &[Feature],
        lengths: &[u8],
        out: &mut [Rgb9e5],
        rest: &mut [u8],
    ) -> Result<(), NetworkError> {
        let needed = self.size.pixels();
        if frame.len() != needed || out.len() != needed {
            return Err(NetworkError::Out { needed });
        }
        let (width, height) = (self.size.width.into(), self.size.height.into());
        let (far, own) = self.memory.split_at_mut(Needs::of(width, height).far);
        let near = if own.is_empty() {
            // Words, too: the cast cannot fail.
            <[u32]>::mut_from_bytes(out.as_mut_bytes()).unwrap_or(&mut [])
        } else {
            own
        };
        let (fine, _) = rest.as_chunks_mut();
        let scratch = Scratch {
            fine: &mut *fine,
            near,
            far,
        };
        let mut network = Network::new(self.weights, width, height, scratch)?;

        // More are as many to it.
        let samples = self.samples.min(1 << 16);
        network.extract_frame(pair, frame, |at| {
            samples * lengths.get(at).map_or(1, |&length| u32::from(length))
        });
        let light = |at: usize| frame.get(at).map_or([0; 3], irradiance);
        let keeps = |at: usize| frame.get(at).is_some_and(keeps);
        let thing = |at: usize| frame.get(at).map_or(ID_NOTHING, |pixel| pixel.id);
        network.filter_in_place(pair, light, thing, keeps);
        let fine = &*fine;
        halves(pair, out, width, |first, rows| {
            for (place, out) in fine[first * width..].iter().zip(rows) {
                *out = Rgb9e5::from_bits(kept(place).map(u32::from), -12);
            }
        });
        Ok(())
    }

    /// Smooths the `light` that is of one frame alone; `rest` is not needed any more.
    fn smooth(
        &self,
        pair: &impl Pair,
        frame: &[Feature],
        lengths: &[u8],
        light: &mut [Rgb9e5],
        rest: &mut [u8],
    ) {
        let width = self.size.width.into();
        // Four bytes each, and as well aligned as light: the cast cannot fail.
        let made = <[Rgb9e5]>::mut_from_bytes(rest).unwrap_or(&mut []);
        let Some(made) = made.get_mut(..light.len()) else {
            return;
        };
        let is_one =
            |at: usize| lengths.get(at) == Some(&1) && frame.get(at).is_some_and(|pixel| !keeps(pixel));
        let before = &*light;
        let luma = last::luma(self.samples);
        halves(pair, made, width, |first, rows| {
            for (at, made) in (first * width..).zip(rows) {
                if is_one(at) {
                    *made = last::smooth(frame, before, width, at, luma);
                }
            }
        });
        let made = &*made;
        halves(pair, light, width, |first, rows| {
            for (at, (light, made)) in (first * width..).zip(rows.iter_mut().zip(&made[first * width..])) {
                if is_one(at) {
                    *light = *made;
                }
            }
        });
    }
}

/// Whether it is what the sky says, without noise; not so by way of a mirror or glass, which has another number.
fn keeps(pixel: &Feature) -> bool {
    pixel.depth == DEPTH_NOTHING && pixel.id == ID_NOTHING
}

impl Filter for Neural<'_> {
    /// Frames of another size than this filter's become black.
    fn filter(
        &mut self,
        pair: &impl Pair,
        _: Size,
        frame: &[Feature],
        lengths: &[u8],
        scratch: denoise::Scratch,
    ) {
        let denoise::Scratch { light, rest } = scratch;
        if self.run(pair, frame, lengths, light, rest).is_err() {
            light.fill(Rgb9e5::BLACK);
        } else {
            self.smooth(pair, frame, lengths, light, rest);
        }
    }
}
