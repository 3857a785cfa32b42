use crate::color::Albedo;
use crate::num::Share;

/// Colours over a surface: a picture of few colours, each texel a number in a palette.
///
/// Coordinates (u, v) are 0 ..= 1 across and down the picture, and it is repeated beyond. The first row is at v = 0. A texel
/// covers 1/width × 1/height, and its colour is its middle's, as in Mitsuba 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Texture<'a> {
    pub width: u16,
    pub height: u16,
    /// Shares of light in 2^-15, 1 to 256 colours, or 1 to 16 with half a byte a texel.
    pub palette: &'a [[u16; 3]],
    pub texels: Texels<'a>,
    pub filter: Filter,
}

/// Numbers in the palette, row after row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Texels<'a> {
    /// Half a byte each, the left one low; a row begins at a byte.
    Half(&'a [u8]),
    Byte(&'a [u8]),
}

/// How colours between the middles of texels come about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// The nearest texel's.
    Nearest,
    /// Between the four nearest, of light, not of signals.
    Bilinear,
}

/// What is wrong with a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureError {
    /// It has no texel.
    Empty,
    /// It has fewer bytes than its texels take, or more.
    Length { expected: usize, found: usize },
    /// It has no colour, or more than there are numbers.
    Palette { colors: usize },
    /// A share of this colour is above 1.
    Color { color: u16 },
    /// This texel's number is beyond the palette.
    Texel { x: u16, y: u16 },
}

impl core::fmt::Display for TextureError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Empty => f.write_str("it has no texel"),
            Self::Length { expected, found } => write!(f, "{found} bytes of texels instead of {expected}"),
            Self::Palette { colors } => write!(
                f,
                "a palette of {colors} colours: 1 to 256 (16 by halves) it must be"
            ),
            Self::Color { color } => write!(f, "a share of its colour {color} is above 1"),
            Self::Texel { x, y } => write!(f, "texel ({x}, {y}) names a colour there is not"),
        }
    }
}

impl core::error::Error for TextureError {}

impl Texture<'_> {
    /// Whether every texel has a colour.
    pub fn check(&self) -> Result<(), TextureError> {
        if self.width == 0 || self.height == 0 {
            return Err(TextureError::Empty);
        }
        let (bytes, most) = match self.texels {
            Texels::Half(bytes) => (bytes, 16),
            Texels::Byte(bytes) => (bytes, 256),
        };
        let expected = self.stride() * usize::from(self.height);
        if bytes.len() != expected {
            return Err(TextureError::Length {
                expected,
                found: bytes.len(),
            });
        }
        let colors = self.palette.len();
        if colors == 0 || colors > most {
            return Err(TextureError::Palette { colors });
        }
        let above = |color: &[u16; 3]| color.iter().any(|share| *share > Share::ONE.to_bits());
        if let Some(color) = self.palette.iter().position(above) {
            return Err(TextureError::Color { color: color as u16 });
        }
        for y in 0..self.height {
            for x in 0..self.width {
                if self
                    .number(x, y)
                    .is_none_or(|number| usize::from(number) >= colors)
                {
                    return Err(TextureError::Texel { x, y });
                }
            }
        }
        Ok(())
    }

    /// Bytes of flash.
    pub fn bytes(&self) -> usize {
        let texels = match self.texels {
            Texels::Half(bytes) | Texels::Byte(bytes) => bytes.len(),
        };
        texels + size_of_val(self.palette)
    }

    /// Bytes of a row.
    fn stride(&self) -> usize {
        match self.texels {
            Texels::Half(_) => usize::from(self.width).div_ceil(2),
            Texels::Byte(_) => usize::from(self.width),
        }
    }

    fn number(&self, x: u16, y: u16) -> Option<u8> {
        let row = self.stride() * usize::from(y);
        match self.texels {
            Texels::Half(bytes) => {
                let two = *bytes.get(row + usize::from(x >> 1))?;
                Some(two >> (4 * (x & 1)) & 15)
            }
            Texels::Byte(bytes) => bytes.get(row + usize::from(x)).copied(),
        }
    }

    /// A texel's colour; black for one there is not.
    fn texel(&self, x: u32, y: u32) -> [u16; 3] {
        let number = self.number(x as u16, y as u16);
        let color = number.and_then(|number| self.palette.get(usize::from(number)));
        color.copied().unwrap_or_default()
    }

    /// The colour at coordinates in Q16: of the nearest texels exactly, between them to 2^-8 of their difference.
    pub fn at(&self, uv: [i32; 2]) -> Albedo {
        // Where in the picture, texels in Q16; the sides have up to 16 bits, so that both factors do.
        let size = [u32::from(self.width.max(1)), u32::from(self.height.max(1))];
        let place = [0, 1].map(|axis| (uv[axis] as u32 & 0xffff) * size[axis]);
        let [x, y] = place;
        if self.filter == Filter::Nearest {
            return Albedo::from_bits(self.texel(x >> 16, y >> 16));
        }
        // From the middle of one texel to the next's; before the first is the last.
        let [(x0, x1, fx), (y0, y1, fy)] = [0, 1].map(|axis| {
            let (place, size) = (place[axis], size[axis]);
            let before = if place < 1 << 15 {
                place + (size << 16).wrapping_sub(1 << 15)
            } else {
                place - (1 << 15)
            };
            let first = before >> 16;
            let next = if first + 1 == size { 0 } else { first + 1 };
            (first, next, before >> 8 & 0xff)
        });
        let [a, b, c, d] =
            [(x0, y0), (x1, y0), (x0, y1), (x1, y1)].map(|(x, y)| self.texel(x, y).map(u32::from));
        // Weights of 2^16 together, shares of 2^15 at most: under 2^31.
        Albedo::from_bits([0, 1, 2].map(|i| {
            let above = a[i] * (256 - fx) + b[i] * fx;
            let below = c[i] * (256 - fx) + d[i] * fx;
            ((above * (256 - fy) + below * fy + (1 << 15)) >> 16) as u16
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PALETTE: [[u16; 3]; 3] = [[0, 0, 0], [32_768, 12_345, 777], [99, 20_000, 32_768]];

    fn texture(filter: Filter) -> Texture<'static> {
        Texture {
            width: 3,
            height: 2,
            palette: &PALETTE,
            texels: Texels::Half(&[0x10, 0x2, 0x21, 0x0]),
            filter,
        }
    }

    #[test]
    fn texels_are_where_they_are() {
        let texture = texture(Filter::Nearest);
        assert_eq!(texture.check(), Ok(()));
        let rows = [[0, 1, 2], [1, 2, 0]];
        for (y, row) in rows.into_iter().enumerate() {
            for (x, number) in row.into_iter().enumerate() {
                let color = Albedo::from_bits(PALETTE[number]);
                // Its first and last coordinate, and repeated.
                for (part, turn) in [(1, 0), (21_844, 5), (10_000, -3)] {
                    let u = (turn << 16) + (x as i32 * 65_536 + 2) / 3 + part.min(21_843);
                    let v = (turn << 16) + y as i32 * 32_768 + part;
                    assert_eq!(texture.at([u, v]), color, "{x} {y} {part}");
                }
            }
        }
        let bytes = Texture {
            texels: Texels::Byte(&[0, 1, 2, 1, 2, 0]),
            ..texture
        };
        for u in (0..1 << 16).step_by(777) {
            assert_eq!(bytes.at([u, 40_000]), texture.at([u, 40_000]));
        }
    }

    #[test]
    fn between_texels_light_is_mixed() {
        let texture = texture(Filter::Bilinear);
        let light = |number: usize| PALETTE[number].map(|c| f64::from(c) / 32768.0);
        let rows = [[0, 1, 2], [1, 2, 0]];
        for step in 0..400 {
            let (u, v) = (f64::from(step) * 0.01731 - 1.0, f64::from(step) * 0.0377 - 2.0);
            let (x, y) = ((u.rem_euclid(1.0)) * 3.0 - 0.5, (v.rem_euclid(1.0)) * 2.0 - 0.5);
            let mut sum = [0.0f64; 3];
            for (dx, wx) in [(0.0, 1.0 - (x - x.floor())), (1.0, x - x.floor())] {
                for (dy, wy) in [(0.0, 1.0 - (y - y.floor())), (1.0, y - y.floor())] {
                    let texel = rows[(y.floor() + dy).rem_euclid(2.0) as usize]
                        [(x.floor() + dx).rem_euclid(3.0) as usize];
                    let mixed = light(texel);
                    sum = [0, 1, 2].map(|i| sum[i] + wx * wy * mixed[i]);
                }
            }
            let found = texture.at([(u * 65536.0).floor() as i32, (v * 65536.0).floor() as i32]);
            for (share, sum) in found.0.into_iter().zip(sum) {
                let error = f64::from(share.to_bits()) / 32768.0 - sum;
                assert!(error.abs() < 0.009, "{u} {v}: {error}");
            }
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        let good = texture(Filter::Nearest);
        let empty = Texture { width: 0, ..good };
        assert_eq!(empty.check(), Err(TextureError::Empty));
        let short = Texture { height: 3, ..good };
        let (expected, found) = (6, 4);
        assert_eq!(short.check(), Err(TextureError::Length { expected, found }));
        let none = Texture { palette: &[], ..good };
        assert_eq!(none.check(), Err(TextureError::Palette { colors: 0 }));
        let many = Texture {
            palette: &[[0; 3]; 17],
            ..good
        };
        assert_eq!(many.check(), Err(TextureError::Palette { colors: 17 }));
        let two = Texture {
            palette: &PALETTE[..2],
            ..good
        };
        assert_eq!(two.check(), Err(TextureError::Texel { x: 2, y: 0 }));
        let bright = Texture {
            palette: &[[0; 3], [0, 32_769, 0], [0; 3]],
            ..good
        };
        assert_eq!(bright.check(), Err(TextureError::Color { color: 1 }));
        assert_eq!(two.at([60_000, 0]), Albedo::BLACK);
    }

    #[test]
    fn srgb_is_decoded_to_the_nearest() {
        for byte in 0..=255u8 {
            let signal = f64::from(byte) / 255.0;
            let light = if signal <= 0.04045 {
                signal / 12.92
            } else {
                ((signal + 0.055) / 1.055).powf(2.4)
            };
            let found = Albedo::from_srgb([byte; 3]).0[1].to_bits();
            assert_eq!(f64::from(found), (light * 32768.0).round(), "{byte}");
        }
    }
}
