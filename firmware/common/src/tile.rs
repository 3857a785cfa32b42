//! The picture that a board draws, tile by tile: for now a test card in integers.

use crate::crc::Crc;

/// Edge of a tile in pixels.
pub const SIDE: u32 = 16;
/// Pixels in a tile.
pub const PIXELS: usize = (SIDE * SIDE) as usize;

/// A picture's size in pixels, both multiples of [`SIDE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    width: u32,
    height: u32,
}

impl Frame {
    pub const fn new(width: u32, height: u32) -> Self {
        assert!(width.is_multiple_of(SIDE) && height.is_multiple_of(SIDE) && width > 0 && height > 0);
        Self { width, height }
    }

    pub const fn width(self) -> u32 {
        self.width
    }

    pub const fn height(self) -> u32 {
        self.height
    }

    /// Number of tiles; they are counted along the rows.
    pub const fn tiles(self) -> u32 {
        (self.width / SIDE) * (self.height / SIDE)
    }

    /// Upper left pixel of tile `index < tiles()`.
    pub const fn origin(self, index: u32) -> (u32, u32) {
        let columns = self.width / SIDE;
        (index % columns * SIDE, index / columns * SIDE)
    }

    /// Writes tile `index` row by row as RGB565, 5 bits red on top.
    pub fn render(self, index: u32, pixels: &mut [u16; PIXELS]) {
        let (left, top) = self.origin(index);
        for (row, y) in pixels.chunks_exact_mut(SIDE as usize).zip(top..) {
            for (pixel, x) in row.iter_mut().zip(left..) {
                *pixel = self.card(x, y);
            }
        }
    }

    /// CRC-32 of the whole frame as the display receives it: tiles in order, each pixel high byte first.
    pub fn crc(self) -> u32 {
        let mut crc = Crc::new();
        let mut pixels = [0; PIXELS];
        for index in 0..self.tiles() {
            self.render(index, &mut pixels);
            for pixel in pixels {
                crc.bytes(&pixel.to_be_bytes());
            }
        }
        crc.value()
    }

    /// Red grows to the right and green downwards, blue is a checker of 32 pixels, and a white ring is in the middle.
    /// A white square marks the upper left corner, so that a mirrored or turned picture shows.
    fn card(self, x: u32, y: u32) -> u16 {
        const WHITE: u16 = 0xffff;
        if x < 8 && y < 8 {
            return WHITE;
        }
        let from_middle = x.abs_diff(self.width / 2).pow(2) + y.abs_diff(self.height / 2).pow(2);
        if from_middle.isqrt().abs_diff(self.height / 4) < 2 {
            return WHITE;
        }
        let red = x * 31 / (self.width - 1);
        let green = y * 63 / (self.height - 1);
        let blue = if (x / 32 + y / 32).is_multiple_of(2) {
            31
        } else {
            0
        };
        (red << 11 | green << 5 | blue) as u16
    }
}

/// The frame of a square 1.3 inch display.
pub const SQUARE: Frame = Frame::new(240, 240);

/// The frame of a 2 inch display, held with its long side level.
pub const WIDE: Frame = Frame::new(320, 240);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_the_frame_once() {
        for frame in [SQUARE, WIDE] {
            let columns = frame.width() / SIDE;
            let mut seen = [false; 400];
            for index in 0..frame.tiles() {
                let (left, top) = frame.origin(index);
                assert!(left + SIDE <= frame.width() && top + SIDE <= frame.height());
                let place = (top / SIDE * columns + left / SIDE) as usize;
                assert!(!core::mem::replace(&mut seen[place], true));
            }
            assert_eq!(frame.tiles() * SIDE * SIDE, frame.width() * frame.height());
        }
    }

    #[test]
    fn card_shows_which_way_is_up() {
        let mut pixels = [0; PIXELS];
        SQUARE.render(0, &mut pixels);
        assert_eq!(pixels[0], 0xffff, "white upper left");
        SQUARE.render(SQUARE.tiles() - 1, &mut pixels);
        assert_eq!(
            pixels[PIXELS - 1],
            0xffff,
            "red, green and blue at the lower right"
        );
        SQUARE.render(14, &mut pixels);
        assert_eq!(pixels[15], 0xf800, "red alone at the upper right");
    }
}
