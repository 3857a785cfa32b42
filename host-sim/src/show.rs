//! What a display would show: the simulator's display of any colour type as a picture, and, optionally, in a window.

use embedded_graphics::pixelcolor::{PixelColor, Rgb888};
use embedded_graphics::prelude::*;
use embedded_graphics_simulator::{OutputSettings, SimulatorDisplay};

/// The kinds of display the film can draw on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DisplayKind {
    Rgb565,
    Rgb666,
    Rgb888,
    Gray8,
    /// One bit a pixel.
    Mono,
}

/// Draws a picture of `width` by `height` pixels on a display of colour `C` and reads back what can be seen on it.
///
/// `paint` receives the display, black at first, as an ordinary `DrawTarget`. Returns rows from the top, 8-bit sRGB.
pub fn shown<C, E>(
    width: u32,
    height: u32,
    paint: impl FnOnce(&mut SimulatorDisplay<C>) -> Result<(), E>,
) -> Result<Vec<[u8; 3]>, E>
where
    C: PixelColor + From<Rgb888> + Into<Rgb888>,
{
    let mut display = SimulatorDisplay::with_default_color(Size::new(width, height), C::from(Rgb888::BLACK));
    paint(&mut display)?;
    Ok(pixels(&display))
}

/// Everything on a display, rows from the top, 8-bit sRGB.
pub fn pixels<C>(display: &SimulatorDisplay<C>) -> Vec<[u8; 3]>
where
    C: PixelColor + Into<Rgb888>,
{
    let output = display.to_rgb_output_image(&OutputSettings::default());
    output.as_image_buffer().pixels().map(|pixel| pixel.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_graphics::pixelcolor::{BinaryColor, Gray8, Rgb565, Rgb666};
    use embedded_graphics::primitives::Rectangle;

    fn middle<C: PixelColor + From<Rgb888> + Into<Rgb888>>(color: C) -> Vec<[u8; 3]> {
        let place = Rectangle::new(Point::new(1, 0), Size::new(1, 1));
        let Ok(pixels) = shown(3, 1, |display| display.fill_contiguous(&place, [color]));
        pixels
    }

    #[test]
    fn each_kind_of_display_shows_its_own_steps() {
        assert_eq!(middle(Rgb565::new(31, 63, 0)), [[0; 3], [255, 255, 0], [0; 3]]);
        assert_eq!(middle(Rgb565::new(16, 32, 1))[1], [132, 130, 8]);
        assert_eq!(middle(Rgb666::new(1, 2, 63))[1], [4, 8, 255]);
        assert_eq!(middle(Rgb888::new(1, 2, 3))[1], [1, 2, 3]);
        assert_eq!(middle(Gray8::new(77))[1], [77; 3]);
        assert_eq!(middle(BinaryColor::On)[1], [255; 3]);
    }
}
