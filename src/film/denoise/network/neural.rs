use super::{Input, Network, NetworkError, Scratch, Weights, exposure, irradiance};
use crate::color::Rgb9e5;
use crate::film::Feature;
use crate::film::denoise::{self, Filter, Pair, Size};

/// The network as a denoiser's filter.
#[derive(Debug)]
pub struct Neural<'a> {
    network: Network<'a>,
    light: &'a mut [[u16; 3]],
    samples: u32,
}

impl<'a> Neural<'a> {
    /// For frames of `size` and of `samples` a pixel each; `light` has a pixel for each of the frame's.
    pub fn new(
        weights: Weights<'a>,
        size: Size,
        samples: u32,
        light: &'a mut [[u16; 3]],
        scratch: Scratch<'a>,
    ) -> Result<Neural<'a>, NetworkError> {
        let network = Network::new(weights, size.width.into(), size.height.into(), scratch)?;
        let needed = size.pixels();
        let light = light
            .get_mut(..needed)
            .ok_or(NetworkError::Irradiance { needed })?;
        Ok(Neural {
            network,
            light,
            samples,
        })
    }
}

impl Filter for Neural<'_> {
    /// Frames of another size than this filter's stay black.
    fn filter(
        &mut self,
        _: &impl Pair,
        _: Size,
        frame: &[Feature],
        lengths: &[u8],
        scratch: denoise::Scratch,
    ) {
        for (light, pixel) in self.light.iter_mut().zip(frame) {
            *light = irradiance(pixel);
        }
        let samples = self.samples;
        let exposure = exposure(frame);
        let input = |at: usize| match (frame.get(at), lengths.get(at)) {
            (Some(pixel), Some(&length)) => {
                Input::new(pixel, samples.saturating_mul(length.into()), exposure)
            }
            _ => Input::new(&Feature::default(), samples, exposure),
        };
        scratch.light.fill(Rgb9e5::BLACK);
        let mut rest = scratch.light.iter_mut();
        let keep = |_: usize, row: &[[u16; 3]]| {
            for (light, out) in row.iter().zip(&mut rest) {
                *out = Rgb9e5::from_bits(light.map(u32::from), -12);
            }
        };
        if frame.len() == self.light.len() {
            // As many pixels as it was made for: nothing to refuse.
            let _ = self.network.run(self.light, input, keep);
        }
    }
}
