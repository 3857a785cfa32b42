//! Drives it all: [`Renderer::step`] renders one tile and returns.

mod motion;

pub use motion::Motion;

use crate::camera::{Camera, FilmPlane};
use crate::color::{Radiance, mean_q32};
use crate::film::feature::{self, Feature, ID_NOTHING};
use crate::film::{Exposure, Tile};
use crate::integrator::{Features, First, Integrator, NoSplats, Path, SplatSink, View, features, first};
use crate::num::Uniform;
use crate::sampler::Sampler;
use crate::scene::{Ahead, Scene};
use embedded_graphics::geometry::{Point, Size};
use embedded_graphics::primitives::Rectangle;

/// Size of the picture and effort a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    pub width: u16,
    pub height: u16,
    /// Samples a pixel, 1 ..= 65536.
    pub spp: u32,
}

/// Renders a picture tile by tile; constant settings, and a sampler and a place that move.
///
/// An integrator whose light arrives anywhere in the picture exposes a whole frame instead: [`Self::expose`].
#[derive(Clone, Debug)]
pub struct Renderer<'s, S, I = Path> {
    scene: &'s Scene<'s>,
    film: FilmPlane,
    integrator: I,
    settings: Settings,
    sampler: S,
    blocks: Blocks,
    /// Pixels done, row by row.
    done: u32,
    rays: u32,
}

impl<'s, S: Sampler, I: Integrator> Renderer<'s, S, I> {
    pub fn new(scene: &'s Scene<'s>, camera: Camera, integrator: I, sampler: S, settings: Settings) -> Self {
        let film = camera.film(settings.width, settings.height);
        Renderer {
            scene,
            film,
            integrator,
            settings,
            sampler,
            blocks: Blocks::of(settings.width),
            done: 0,
            rays: 0,
        }
    }

    /// The mean radiance of one pixel: the same whoever renders it, and when.
    pub fn pixel(&mut self, x: u16, y: u16) -> Radiance {
        const {
            assert!(
                !I::NEEDS_SPLATS,
                "this integrator needs a whole frame: Renderer::expose"
            )
        };
        let mut sum = [0u64; 3];
        let spp = self.settings.spp.clamp(1, 1 << 16);
        let ahead = self.blocks.ahead(self.scene, &self.film, x, y, true);
        for index in 0..spp {
            self.sampler.start(x, y, index);
            let place = self.sampler.next_2d();
            let lens = self.sampler.next_2d();
            if let Some(ray) = self.film.ray(x, y, place, lens) {
                let view = View {
                    scene: self.scene,
                    film: &self.film,
                    ahead,
                };
                let light =
                    self.integrator
                        .radiance(&view, ray, &mut self.sampler, &mut NoSplats, &mut self.rays);
                if spp == 1 && light.is_its_mean() {
                    return light;
                }
                let sample = light.to_q32();
                sum = [sum[0] + sample[0], sum[1] + sample[1], sum[2] + sample[2]];
            }
        }
        mean_q32(sum, spp)
    }

    /// Renders one pixel of a whole frame: what its samples bring, there and elsewhere.
    ///
    /// With every pixel rendered once, by whichever cores, the frame over [`Settings::spp`] is the picture.
    pub fn expose(&mut self, x: u16, y: u16, splats: &mut impl SplatSink) {
        let view = View {
            scene: self.scene,
            film: &self.film,
            ahead: self.blocks.ahead(self.scene, &self.film, x, y, true),
        };
        for index in 0..self.settings.spp.clamp(1, 1 << 16) {
            self.sampler.start(x, y, index);
            let place = self.sampler.next_2d();
            let lens = self.sampler.next_2d();
            if let Some(ray) = self.film.ray(x, y, place, lens) {
                let light = self
                    .integrator
                    .radiance(&view, ray, &mut self.sampler, splats, &mut self.rays);
                splats.add(x, y, light);
            }
        }
    }

    /// One pixel for a denoiser: of the same samples as [`Self::pixel`].
    pub fn feature(&mut self, x: u16, y: u16) -> Feature {
        const {
            assert!(
                !I::NEEDS_SPLATS,
                "this integrator needs a whole frame: Renderer::expose"
            )
        };
        let mut sum = feature::Sum::default();
        let ahead = self.blocks.ahead(self.scene, &self.film, x, y, true);
        for index in 0..self.settings.spp.clamp(1, 1 << 16) {
            self.sampler.start(x, y, index);
            let place = self.sampler.next_2d();
            let lens = self.sampler.next_2d();
            let Some(ray) = self.film.ray(x, y, place, lens) else {
                continue;
            };
            let view = View {
                scene: self.scene,
                film: &self.film,
                ahead,
            };
            let (radiance, first) = self
                .integrator
                .sense(&view, ray, &mut self.sampler, &mut self.rays);
            sum.add(&sample(radiance, &first));
        }
        sum.mean()
    }

    /// What the ray through the middle of a pixel meets first, without its light: what leads [`film::denoise::upsample`].
    ///
    /// [`film::denoise::upsample`]: crate::film::denoise::upsample
    pub fn guide(&mut self, x: u16, y: u16) -> Feature {
        let middle = [Uniform::from_bits(1 << 31); 2];
        let mut sum = feature::Sum::default();
        if let Some(ray) = self.film.ray(x, y, middle, middle) {
            let ahead = self.blocks.ahead(self.scene, &self.film, x, y, false);
            let first = first(self.scene, ahead.seen, ray, &mut 0);
            sum.add(&sample(Radiance::BLACK, &first));
        }
        sum.mean()
    }

    /// The pixels of `area`, row by row, for a denoiser; answers with how many `strip` held.
    pub fn feature_tile(&mut self, area: Rectangle, strip: &mut [Feature]) -> usize {
        fill(area, strip, |x, y| self.feature(x, y))
    }

    /// Rays asked of the scene so far, wrapping: nearest hits and shadow rays.
    pub fn rays(&self) -> u32 {
        self.rays
    }

    /// What the ray through the middle of a pixel meets first that is no mirror or glass.
    pub fn features(&self, x: u16, y: u16) -> Option<Features> {
        let middle = [Uniform::from_bits(1 << 31); 2];
        features(self.scene, self.film.ray(x, y, middle, middle)?)
    }

    /// Renders the next tile into `strip` and returns; `None` when the picture is done.
    ///
    /// A tile is as many whole rows as fit the strip, or a part of a row if none does: the picture is the same, only
    /// the memory differs. Stop calling to cancel; [`Self::restart`] begins again.
    pub fn step<'t>(&mut self, strip: &'t mut [Radiance]) -> Option<Tile<'t>> {
        let area = self.area(self.done, strip.len() as u32)?;
        self.done += area.size.width * area.size.height;
        Some(self.tile(area, strip))
    }

    /// The tile that begins at pixel number `from` (row by row) and holds at most `room` pixels.
    ///
    /// For several cores: each takes the next number from a common counter and renders with a renderer of its own.
    pub fn area(&self, from: u32, room: u32) -> Option<Rectangle> {
        let (width, height) = (self.settings.width as u32, self.settings.height as u32);
        let (x, y) = (from.checked_rem(width)?, from.checked_div(width)?);
        if y >= height || room == 0 {
            return None;
        }
        let (across, down) = if x == 0 && room >= width {
            (width, (room / width).min(height - y))
        } else {
            (room.min(width - x), 1)
        };
        Some(Rectangle::new(
            Point::new(x as i32, y as i32),
            Size::new(across, down),
        ))
    }

    /// Renders one tile, whichever.
    pub fn tile<'t>(&mut self, area: Rectangle, strip: &'t mut [Radiance]) -> Tile<'t> {
        let done = fill(area, strip, |x, y| self.pixel(x, y));
        Tile {
            area,
            pixels: strip.get(..done).unwrap_or(&[]),
        }
    }

    /// Begins at the first tile again.
    pub fn restart(&mut self) {
        self.done = 0;
    }

    pub fn settings(&self) -> Settings {
        self.settings
    }
}

/// What is ahead of the camera's rays in each of a row of square blocks of pixels, as far as it was asked for.
#[derive(Clone, Copy, Debug)]
struct Blocks {
    /// Log2 of a block's side: at least 16 pixels, and no more blocks than there is room for.
    bits: u32,
    /// Which row of blocks it is.
    row: u16,
    ahead: [Option<Ahead>; 16],
}

impl Blocks {
    fn of(width: u16) -> Blocks {
        Blocks {
            bits: (4..12).find(|bits| width as u32 <= 16 << bits).unwrap_or(12),
            row: 0,
            ahead: [None; 16],
        }
    }

    /// `is_lit` where light samples are taken; what is ahead of a block is told as it is asked for first.
    #[inline]
    fn ahead(&mut self, scene: &Scene, film: &FilmPlane, x: u16, y: u16, is_lit: bool) -> Ahead {
        let (column, row) = (x >> self.bits, y >> self.bits);
        if self.row == row
            && let Some(Some(ahead)) = self.ahead.get(column as usize)
        {
            return *ahead;
        }
        self.look(scene, film, [column, row], is_lit)
    }

    #[cold]
    #[inline(never)]
    fn look(&mut self, scene: &Scene, film: &FilmPlane, [column, row]: [u16; 2], is_lit: bool) -> Ahead {
        if self.row != row {
            (self.row, self.ahead) = (row, [None; 16]);
        }
        let ahead = match &film.beam(column << self.bits, row << self.bits, 1 << self.bits) {
            Some(beam) => scene.ahead(beam, is_lit),
            None => Ahead::ANY,
        };
        if let Some(known) = self.ahead.get_mut(column as usize) {
            *known = Some(ahead);
        }
        ahead
    }
}

/// Row by row what there is at each place of `area`, as far as the strip goes; answers with how many it holds.
#[inline(always)]
fn fill<T>(area: Rectangle, strip: &mut [T], mut at: impl FnMut(u16, u16) -> T) -> usize {
    let (left, top) = (area.top_left.x as u16, area.top_left.y as u16);
    let (width, height) = (area.size.width as u16, area.size.height as u16);
    let mut done = 0;
    if width == 0 {
        return done;
    }
    for (row, y) in strip.chunks_mut(width as usize).zip(top..top + height) {
        for (place, x) in row.iter_mut().zip(left..left + width) {
            *place = at(x, y);
        }
        done += row.len();
    }
    done
}

/// What a path of this light, and what it met first, say of their pixel.
pub fn sample(radiance: Radiance, first: &First) -> feature::Sample {
    feature::Sample {
        radiance,
        albedo: first.albedo,
        normal: first.normal,
        distance: first.distance,
        id: feature::first_id(first.id.unwrap_or(ID_NOTHING), first.bounces),
    }
}

impl SplatSink for Exposure<'_> {
    const EXISTS: bool = true;

    #[inline]
    fn add(&mut self, x: u16, y: u16, light: Radiance) {
        Exposure::add(self, x, y, light);
    }
}
