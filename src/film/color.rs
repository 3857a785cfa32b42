use super::tonemap::luminance;
use embedded_graphics::pixelcolor::*;

/// A display's colour: how a signal of 16 bits a channel becomes one of its levels.
pub trait DisplayColor: PixelColor {
    /// Whether it shows luminance alone; then that is tone mapped, and the three channels given are equal.
    const GRAY: bool = false;

    /// The colour of an sRGB-encoded signal, 0 ..= 65535 a channel, at a threshold of [`super::Dither::threshold`].
    ///
    /// With n + 1 levels a channel v becomes ⌊(v·n + threshold)/65535⌋, so that thresholds spread evenly give
    /// v·n/65535 in the mean. 0 and 65535 are exact at each threshold under 65535; 65535 counts as 65534.
    fn quantize(rgb: [u16; 3], threshold: u16) -> Self;
}

/// The level, 0 ..= `max`, of a channel; `max` ≤ 255.
#[inline(always)]
fn level(v: u16, threshold: u16, max: u8) -> u8 {
    // raw: x < 2^24, so ⌊x/65535⌋ is ⌊(x + ⌊x/2^16⌋ + 1)/2^16⌋.
    let x = v as u32 * max as u32 + threshold.min(65534) as u32;
    ((x + (x >> 16) + 1) >> 16) as u8
}

macro_rules! rgb {
    ($($color:ty)*) => {$(
        impl DisplayColor for $color {
            #[inline]
            fn quantize([r, g, b]: [u16; 3], threshold: u16) -> Self {
                let max = (Self::MAX_R, Self::MAX_G, Self::MAX_B);
                Self::new(level(r, threshold, max.0), level(g, threshold, max.1), level(b, threshold, max.2))
            }
        }
    )*};
}

rgb!(Rgb555 Bgr555 Rgb565 Bgr565 Rgb666 Bgr666 Rgb888 Bgr888);

macro_rules! gray {
    ($($color:ident $max:literal)*) => {$(
        /// Levels of the luma, 0.2126 R + 0.7152 G + 0.0722 B of the encoded channels.
        impl DisplayColor for $color {
            const GRAY: bool = true;

            #[inline]
            fn quantize(rgb: [u16; 3], threshold: u16) -> Self {
                $color::new(level(luminance(rgb), threshold, $max))
            }
        }
    )*};
}

gray!(Gray2 3 Gray4 15 Gray8 255);

/// On where the light of the signal, its luma decoded, passes the threshold: dots that are on or off add up as light.
impl DisplayColor for BinaryColor {
    const GRAY: bool = true;

    #[inline]
    fn quantize(rgb: [u16; 3], threshold: u16) -> Self {
        BinaryColor::from(level(light(luminance(rgb)), threshold, 1) == 1)
    }
}

/// sRGB decoded, 0 ..= 65535, both ends exact: the cubic 0.3053 v³ + 0.6822 v² + 0.0125 v, error 0.0017 at most,
/// mean −0.0003 (`tests/film.rs`, with 1/512 of the mask's).
#[inline]
fn light(v: u16) -> u16 {
    // Q15 with both ends. raw: 64715 · 2^15 < 2^31, and 2^16 · 2^15 = 2^31.
    let v = (v as u32 + 1) >> 1;
    let slope = ((20_008 * v) >> 15) + 44_707;
    let slope = ((slope * v) >> 15) + 821;
    ((slope * v) >> 15).min(65535) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_the_quotient() {
        for max in [1, 3, 15, 31, 63, 255] {
            for v in (0..=65535).step_by(251) {
                for t in (0..65535).step_by(4369).chain([1, 32767, 65534]) {
                    assert_eq!(
                        level(v, t, max) as u32,
                        (v as u32 * max as u32 + t as u32) / 65535
                    );
                }
            }
        }
    }

    #[test]
    fn black_and_white_stay_at_each_threshold() {
        for t in [0, 1, 32767, 65534, 65535] {
            assert_eq!(Rgb565::quantize([0; 3], t), Rgb565::BLACK);
            assert_eq!(Rgb565::quantize([65535; 3], t), Rgb565::WHITE);
            assert_eq!(BinaryColor::quantize([0; 3], t), BinaryColor::Off);
            assert_eq!(BinaryColor::quantize([65535; 3], t), BinaryColor::On);
        }
    }

    #[test]
    fn channels_go_where_they_belong() {
        let signal = [65535, 32768, 0];
        assert_eq!(Rgb888::quantize(signal, 32767), Rgb888::new(255, 128, 0));
        assert_eq!(Bgr888::quantize(signal, 32767), Bgr888::new(255, 128, 0));
        assert_eq!(Rgb666::quantize(signal, 32767), Rgb666::new(63, 32, 0));
        assert_eq!(Bgr565::quantize(signal, 32767), Bgr565::new(31, 32, 0));
        assert_eq!(Gray8::quantize(signal, 32767), Gray8::new(145)); // 255 (0.2126 + 0.7152/2)
        assert_eq!(Gray4::quantize(signal, 32767), Gray4::new(9));
    }
}
