//! Drives it all: [`Renderer::step`] renders one tile and returns.

use crate::camera::{Camera, FilmPlane};
use crate::color::{Radiance, mean_q32};
use crate::integrator::Path;
use crate::sampler::Sampler;
use crate::scene::Scene;

/// Size of the picture and effort a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    pub width: u16,
    pub height: u16,
    /// Samples a pixel, 1 ..= 65536.
    pub spp: u32,
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Area {
    pub x: u16,
    pub y: u16,
    pub width: u16,
    pub height: u16,
}

/// Renders a picture tile by tile; constant settings, and a sampler and a place that move.
#[derive(Clone, Debug)]
pub struct Renderer<'s, S> {
    scene: &'s Scene<'s>,
    film: FilmPlane,
    integrator: Path,
    settings: Settings,
    sampler: S,
    /// Pixels done, row by row.
    done: u32,
}

impl<'s, S: Sampler> Renderer<'s, S> {
    pub fn new(scene: &'s Scene<'s>, camera: Camera, integrator: Path, sampler: S, settings: Settings) -> Self {
        let film = camera.film(settings.width, settings.height);
        Renderer { scene, film, integrator, settings, sampler, done: 0 }
    }

    /// The mean radiance of one pixel: the same whoever renders it, and when.
    pub fn pixel(&mut self, x: u16, y: u16) -> Radiance {
        let mut sum = [0u64; 3];
        let spp = self.settings.spp.clamp(1, 1 << 16);
        for index in 0..spp {
            self.sampler.start(x, y, index);
            let place = self.sampler.next_2d();
            let lens = self.sampler.next_2d();
            if let Some(ray) = self.film.ray(x, y, place, lens) {
                let sample = self.integrator.radiance(self.scene, ray, &mut self.sampler).to_q32();
                sum = [sum[0] + sample[0], sum[1] + sample[1], sum[2] + sample[2]];
            }
        }
        mean_q32(sum, spp)
    }

    /// Renders the pixels of `area` row by row into `pixels`, as many as there is room for.
    pub fn render(&mut self, area: Area, pixels: &mut [Radiance]) {
        let mut places = (0..area.height).flat_map(|dy| (0..area.width).map(move |dx| (area.x + dx, area.y + dy)));
        for pixel in pixels {
            let Some((x, y)) = places.next() else { break };
            *pixel = self.pixel(x, y);
        }
    }
}
