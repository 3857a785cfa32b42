//! The picture that a board draws, tile by tile, and the passes in which it gets better.

use embedded_graphics_core::pixelcolor::{IntoStorage, Rgb565};
use embedded_graphics_core::{prelude::*, primitives::Rectangle};
use microlux::{
    camera::Camera,
    color::Radiance,
    film::{Display, Dither},
    integrator::Path,
    render::{Renderer, Settings},
    sampler::Independent,
};

use crate::stage::Stage;

/// Edge of a tile in pixels.
pub const SIDE: u32 = 16;
/// Pixels in a tile.
pub const PIXELS: usize = (SIDE * SIDE) as usize;

/// How light becomes colour. Blue noise hides the few levels of RGB565.
pub const DISPLAY: Display = Display {
    dither: Dither::BlueNoise,
    ..DEFAULT
};
const DEFAULT: Display = Display {
    exposure: microlux::film::Stops::ZERO,
    tone_map: microlux::film::ToneMap::Clamp,
    dither: Dither::None,
};

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
}

/// The camera whose view fills a frame: what it sees across is seen along the shorter side.
pub(crate) fn widened(camera: Camera, width: u32, height: u32) -> Camera {
    let shorter = width.min(height);
    let wider = camera.half_width().to_bits() * width as i32 / shorter as i32;
    Camera::from_frame(
        camera.origin(),
        camera.frame(),
        fixed::types::I12F20::from_bits(wider),
    )
}

/// The frame of a square 1.3 inch display.
pub const SQUARE: Frame = Frame::new(240, 240);

/// The frame of a 2 inch display, held with its long side level.
pub const WIDE: Frame = Frame::new(320, 240);

/// One time over the whole frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pass {
    /// Edge in pixels of what gets one colour: a divisor of [`SIDE`].
    pub block: u32,
    /// Samples for each.
    pub spp: u32,
}

/// A preview of a sixteenth of the work, then twice the samples each time, always begun anew: no picture is kept.
pub const PASSES: [Pass; 6] = [
    Pass { block: 4, spp: 1 },
    Pass { block: 1, spp: 1 },
    Pass { block: 1, spp: 2 },
    Pass { block: 1, spp: 4 },
    Pass { block: 1, spp: 8 },
    Pass { block: 1, spp: 16 },
];

/// Draws the tiles of one pass. Samples are independent of one another: the cheapest, and no worse where they are few.
pub struct Painter<'s> {
    frame: Frame,
    pass: Pass,
    renderer: Renderer<'s, Independent>,
    light: [Radiance; PIXELS],
}

impl<'s> Painter<'s> {
    /// For direct light from `stage`.
    pub fn new(stage: &Stage<'s>, frame: Frame, pass: Pass) -> Self {
        Self::of(Path::direct(), stage, frame, pass)
    }

    /// For the light of such paths.
    pub fn of(path: Path, stage: &Stage<'s>, frame: Frame, pass: Pass) -> Self {
        let settings = Settings {
            width: (frame.width / pass.block) as u16,
            height: (frame.height / pass.block) as u16,
            spp: pass.spp,
        };
        let camera = widened(stage.camera, frame.width, frame.height);
        Self {
            frame,
            pass,
            renderer: Renderer::new(stage.scene, camera, path, Independent::new(1), settings),
            light: [Radiance::BLACK; PIXELS],
        }
    }

    /// Writes tile `index` row by row as RGB565, 5 bits red on top.
    pub fn render(&mut self, index: u32, pixels: &mut [u16; PIXELS]) {
        let block = self.pass.block;
        let (left, top) = self.frame.origin(index);
        let area = Rectangle::new(
            Point::new((left / block) as i32, (top / block) as i32),
            Size::new(SIDE / block, SIDE / block),
        );
        let tile = self.renderer.tile(area, &mut self.light);
        let mut colors = tile.colors::<Rgb565>(&DISPLAY);
        for rows in pixels.chunks_exact_mut((SIDE * block) as usize) {
            let (first, others) = rows.split_at_mut(SIDE as usize);
            for (blocks, color) in first.chunks_exact_mut(block as usize).zip(&mut colors) {
                blocks.fill(color.into_storage());
            }
            for row in others.chunks_exact_mut(SIDE as usize) {
                row.copy_from_slice(first);
            }
        }
    }

    /// Rays asked of the scene so far, wrapping.
    pub fn rays(&self) -> u32 {
        self.renderer.rays()
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::stage::Cornell;

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

    /// Every pass shows the same room: red on its left, green on its right, whatever the blocks and the samples.
    #[test]
    fn passes_show_the_same() {
        let mut cornell = Cornell::new().unwrap();
        let (scene, camera) = cornell.scene().unwrap();
        let stage = Stage {
            scene: &scene,
            camera,
        };
        for pass in &PASSES[..3] {
            let mut painter = Painter::new(&stage, SQUARE, *pass);
            let mut pixels = [0; PIXELS];
            let mut mean = |index| {
                painter.render(index, &mut pixels);
                let sum = |mask: u16, shift: u32| -> u32 {
                    pixels
                        .iter()
                        .map(|&pixel| u32::from((pixel & mask) >> shift))
                        .sum()
                };
                (sum(0xf800, 11), sum(0x07e0, 6))
            };
            let (left, right) = (mean(15 * 8), mean(15 * 8 + 14));
            assert!(left.0 > 3 * left.1, "{pass:?} {left:?}");
            assert!(2 * right.1 > 3 * right.0, "{pass:?} {right:?}");
        }
    }

    #[test]
    fn a_block_has_one_colour() {
        let mut cornell = Cornell::new().unwrap();
        let (scene, camera) = cornell.scene().unwrap();
        let mut painter = Painter::new(
            &Stage {
                scene: &scene,
                camera,
            },
            WIDE,
            PASSES[0],
        );
        let mut pixels = [0; PIXELS];
        painter.render(150, &mut pixels);
        for (place, pixel) in pixels.iter().enumerate() {
            assert_eq!(*pixel, pixels[place / 64 * 64 + place % 16 / 4 * 4]);
        }
        let kinds: std::collections::BTreeSet<_> = pixels.iter().collect();
        assert!(kinds.len() > 4);
    }
}
