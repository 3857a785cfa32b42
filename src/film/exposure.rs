use super::Tile;
use crate::color::{Radiance, mean_q32};
use embedded_graphics::geometry::{Point, Size};
use embedded_graphics::primitives::Rectangle;

/// The whole picture as sums, 24 bytes a pixel, in memory that the caller brings: for light that arrives anywhere.
///
/// Sums are integers (32 bits below the point) and stop at the largest, so the order in which light is added, by
/// however many cores, cannot change a picture.
#[derive(Debug)]
pub struct Exposure<'t> {
    width: u16,
    height: u16,
    sums: &'t mut [[u64; 3]],
}

impl<'t> Exposure<'t> {
    /// Of `width` × `height` pixels, with what `sums` holds already; `None` if it has fewer places than that.
    pub fn new(width: u16, height: u16, sums: &'t mut [[u64; 3]]) -> Option<Exposure<'t>> {
        let count = width as usize * height as usize;
        let sums = sums.get_mut(..count)?;
        Some(Exposure { width, height, sums })
    }

    pub fn size(&self) -> Size {
        Size::new(self.width as u32, self.height as u32)
    }

    /// Adds light to pixel (x, y), if there is one: up to 2^16 at a time ([`Radiance::to_q32`]).
    #[inline]
    pub fn add(&mut self, x: u16, y: u16, light: Radiance) {
        if x >= self.width {
            return;
        }
        let place = y as usize * self.width as usize + x as usize;
        if let Some(sum) = self.sums.get_mut(place) {
            let more = light.to_q32();
            *sum = [
                sum[0].saturating_add(more[0]),
                sum[1].saturating_add(more[1]),
                sum[2].saturating_add(more[2]),
            ];
        }
    }

    /// The mean of a pixel over `spp` ≥ 1 samples of every pixel; black beside the picture.
    pub fn mean(&self, x: u16, y: u16, spp: u32) -> Radiance {
        let place = y as usize * self.width as usize + x as usize;
        match self.sums.get(place) {
            Some(sum) if x < self.width => mean_q32(*sum, spp.max(1)),
            _ => Radiance::BLACK,
        }
    }

    /// Rows from `first` on as a tile: as many as fit the strip and the picture; `None` if there is none.
    pub fn rows<'s>(&self, first: u16, spp: u32, strip: &'s mut [Radiance]) -> Option<Tile<'s>> {
        let width = self.width as usize;
        let rows = strip
            .len()
            .checked_div(width)?
            .min(self.height.checked_sub(first)? as usize);
        if rows == 0 {
            return None;
        }
        let strip = strip.get_mut(..rows * width)?;
        let from = first as usize * width;
        for (pixel, sum) in strip.iter_mut().zip(self.sums.get(from..)?) {
            *pixel = mean_q32(*sum, spp.max(1));
        }
        Some(Tile {
            area: Rectangle::new(Point::new(0, first as i32), Size::new(width as u32, rows as u32)),
            pixels: strip,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOME: Radiance = Radiance::from_bits([3, 2, 1], 0);

    #[test]
    fn light_adds_up_and_is_shared_out_among_the_samples() {
        let mut sums = [[0; 3]; 6];
        let mut exposure = Exposure::new(3, 2, &mut sums).unwrap();
        exposure.add(1, 1, SOME);
        exposure.add(1, 1, SOME);
        // Beside the picture, on each side of it.
        exposure.add(3, 0, SOME);
        exposure.add(0, 2, SOME);
        assert_eq!(exposure.mean(1, 1, 2), SOME);
        assert_eq!(exposure.mean(3, 0, 2), Radiance::BLACK);
        let mut strip = [Radiance::WHITE; 5];
        let tile = exposure.rows(1, 2, &mut strip).unwrap();
        assert_eq!(tile.area, Rectangle::new(Point::new(0, 1), Size::new(3, 1)));
        assert_eq!(tile.pixels, [Radiance::BLACK, SOME, Radiance::BLACK]);
        assert!(exposure.rows(2, 2, &mut strip).is_none());
        assert!(exposure.rows(0, 2, &mut strip[..2]).is_none());
    }

    #[test]
    fn sums_end_at_the_largest_and_memory_must_do() {
        let mut sums = [[u64::MAX - 1; 3]; 1];
        assert!(Exposure::new(1, 2, &mut sums).is_none());
        Exposure::new(1, 1, &mut sums).unwrap().add(0, 0, SOME);
        assert_eq!(sums, [[u64::MAX; 3]]);
    }
}
