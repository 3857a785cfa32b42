use super::{DisplayColor, Dither, Tone, ToneMap};
use crate::color::Radiance;

/// Exposure in stops (EV), steps of 1/256, −128 up to 128: each whole one doubles the light.
pub type Stops = fixed::types::I8F8;

/// How light is shown. The default is what a viewer of PNGs expects: no change of exposure, clamped, no dither.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Display {
    pub exposure: Stops,
    pub tone_map: ToneMap,
    pub dither: Dither,
}

impl Display {
    /// The tone map at the exposure; made once a tile, since the exposure costs a few products.
    pub fn tone(&self) -> Tone {
        self.tone_map.at(self.exposure)
    }

    /// One pixel's colour at (x, y) of the picture.
    #[inline]
    pub fn color<C: DisplayColor>(&self, tone: &Tone, light: Radiance, x: i32, y: i32) -> C {
        // Black is black at every threshold.
        if light.is_black() {
            return C::quantize([0; 3], 0);
        }
        let signal = if C::GRAY {
            [tone.luminance(light); 3]
        } else {
            tone.rgb(light)
        };
        C::quantize(signal, self.dither.threshold(x, y))
    }
}
