//! What a display would show: the simulator's display of any colour type as a picture, and, optionally, in a window.

use embedded_graphics::pixelcolor::{BinaryColor, Gray8, PixelColor, Rgb565, Rgb666, Rgb888};
use embedded_graphics::prelude::*;
use embedded_graphics_simulator::{OutputSettings, SimulatorDisplay};
use microlux::film::{Display, DisplayColor, Dither, Stops, Tile, ToneMap};

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

/// What a display of this kind shows of finished tiles, rows from the top, 8-bit sRGB; plain sRGB where there is none.
///
/// `width` pixels across, as high as the tiles reach below the first one's top. Displays of fewer than 8 bits a channel
/// are dithered by blue noise.
pub fn tiles<'a>(
    width: u32,
    tiles: impl IntoIterator<Item = Tile<'a>>,
    kind: Option<DisplayKind>,
    look: Look,
) -> Vec<[u8; 3]> {
    let tiles: Vec<_> = tiles.into_iter().collect();
    let top = tiles.iter().map(|tile| tile.area.top_left.y).min().unwrap_or(0);
    let bottom = tiles
        .iter()
        .map(|tile| tile.area.top_left.y + tile.area.size.height as i32)
        .max()
        .unwrap_or(0);
    let size = Size::new(width, (bottom - top).max(0) as u32);
    match kind {
        Some(DisplayKind::Rgb565) => paint::<Rgb565>(size, top, &tiles, look.on(Dither::BlueNoise)),
        Some(DisplayKind::Rgb666) => paint::<Rgb666>(size, top, &tiles, look.on(Dither::BlueNoise)),
        Some(DisplayKind::Mono) => paint::<BinaryColor>(size, top, &tiles, look.on(Dither::BlueNoise)),
        Some(DisplayKind::Gray8) => paint::<Gray8>(size, top, &tiles, look.on(Dither::None)),
        Some(DisplayKind::Rgb888) | None => paint::<Rgb888>(size, top, &tiles, look.on(Dither::None)),
    }
}

/// Exposure and tone map, whatever the display.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Stops of exposure: light is multiplied by 2^exposure.
    pub exposure: f64,
    pub tone_map: ToneMap,
}

impl Default for Look {
    fn default() -> Look {
        Look {
            exposure: 0.0,
            tone_map: ToneMap::Clamp,
        }
    }
}

impl Look {
    fn on(self, dither: Dither) -> Display {
        Display {
            exposure: Stops::saturating_from_num(self.exposure),
            tone_map: self.tone_map,
            dither,
        }
    }
}

fn paint<C>(size: Size, top: i32, tiles: &[Tile], display: Display) -> Vec<[u8; 3]>
where
    C: DisplayColor + From<Rgb888> + Into<Rgb888>,
{
    let Ok(pixels) = shown::<C, _>(size.width, size.height, |screen| {
        // Dither depends on the place in the whole picture, so the screen moves, not the tile.
        tiles
            .iter()
            .try_for_each(|tile| tile.draw(&mut screen.translated(Point::new(0, -top)), &display))
    });
    pixels
}

#[cfg(test)]
mod tests {
    use super::*;
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
