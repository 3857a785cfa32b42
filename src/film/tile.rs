use super::{Display, DisplayColor, Tone};
use crate::color::Radiance;
use core::marker::PhantomData;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::primitives::Rectangle;

/// A finished part of the picture: the mean light of each pixel, row by row.
///
/// Eight bytes a pixel. `pixels` should hold one for each place of `area`; where there are fewer, the last places are
/// left as they are, further ones are not drawn.
#[derive(Clone, Copy, Debug)]
pub struct Tile<'a> {
    /// Where it stands in the picture, which begins at (0, 0).
    pub area: Rectangle,
    pub pixels: &'a [Radiance],
}

const _: () = assert!(size_of::<Radiance>() == 8);

impl Tile<'_> {
    /// Shows it, by one [`DrawTarget::fill_contiguous`]; what lies outside the target, the target leaves out.
    ///
    /// Fails as the target does, and in no other way.
    pub fn draw<D, C>(&self, target: &mut D, display: &Display) -> Result<(), D::Error>
    where
        D: DrawTarget<Color = C>,
        C: DisplayColor,
    {
        target.fill_contiguous(&self.area, self.colors(display))
    }

    /// What [`Tile::draw`] sends: the colours, row by row.
    pub fn colors<C: DisplayColor>(&self, display: &Display) -> impl Iterator<Item = C> {
        let left = self.area.top_left.x;
        Colors {
            pixels: self.pixels.iter(),
            display: *display,
            tone: display.tone(),
            columns: (left, left.wrapping_add_unsigned(self.area.size.width)),
            place: (left, self.area.top_left.y),
            color: PhantomData,
        }
    }
}

struct Colors<'a, C> {
    pixels: core::slice::Iter<'a, Radiance>,
    display: Display,
    tone: Tone,
    /// The first, and the one after the last.
    columns: (i32, i32),
    place: (i32, i32),
    color: PhantomData<C>,
}

impl<C: DisplayColor> Iterator for Colors<'_, C> {
    type Item = C;

    #[inline]
    fn next(&mut self) -> Option<C> {
        let light = *self.pixels.next()?;
        let (x, y) = self.place;
        self.place.0 = x.wrapping_add(1);
        if self.place.0 == self.columns.1 {
            self.place = (self.columns.0, y.wrapping_add(1));
        }
        Some(self.display.color(&self.tone, light, x, y))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.pixels.size_hint()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Dither, ToneMap};
    use embedded_graphics::mock_display::MockDisplay;
    use embedded_graphics::pixelcolor::BinaryColor;
    use embedded_graphics::prelude::*;

    #[test]
    fn a_ramp_becomes_dots() {
        let mut pixels = [Radiance::BLACK; 16 * 4];
        for (i, pixel) in pixels.iter_mut().enumerate() {
            *pixel = Radiance::from_bits([(i as u32 % 16) * 4369; 3], -16);
        }
        let tile = Tile {
            area: Rectangle::new(Point::zero(), Size::new(16, 4)),
            pixels: &pixels,
        };
        let display = Display {
            tone_map: ToneMap::Clamp,
            dither: Dither::Ordered,
            ..Display::default()
        };
        let mut target = MockDisplay::<BinaryColor>::new();
        tile.draw(&mut target, &display).unwrap();
        target.assert_pattern(&[
            ".......#.#.#.###",
            "..#.#.#.#.######",
            ".....#.#.#.#####",
            "....#.#.########",
        ]);
    }
}
