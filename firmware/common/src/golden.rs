//! The pictures of the core's `tests/golden.txt` and `tests/golden_transport.txt`, rendered where the firmware runs: the
//! same bits, whatever the machine.
//!
//! The memory that this takes is a strip of one row, the scene and the renderer: it fits a micro:bit. Integrators whose
//! light arrives anywhere take the whole picture as sums besides, 18,000 bytes.

use microlux::{camera::Camera, integrator::Integrator as Follow, scene::Scene};
use microlux::{
    color::Radiance,
    integrator::Path,
    render::{Renderer, Settings},
    sampler::{AnySampler, Cmj, Independent, Sobol, Stratified, ZSobol},
    scene::builtin::Builtin,
};
#[cfg(feature = "roomy")]
use microlux::{
    film::Exposure,
    integrator::{AmbientOcclusion, Bdpt, LightTracer},
};

use microlux::num::Crc;

use crate::fingerprint;

/// Size and effort of every picture in the record.
pub const SETTINGS: Settings = Settings {
    width: 30,
    height: 25,
    spp: 4,
};

#[cfg(feature = "roomy")]
const PIXELS: usize = SETTINGS.width as usize * SETTINGS.height as usize;

/// Every strategy with 2 to 9 vertices from a light and as many from the camera, lens and light counted: all pairs of 8
/// vertices of surfaces with 8. Paths of 17 segments; none is ended by roulette, so that there are 8.
#[cfg(feature = "roomy")]
pub const DEEP: Bdpt<15> = Bdpt {
    max_depth: 17,
    rr_depth: 17,
    hide_emitters: false,
};

/// A row of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Case {
    pub scene: Builtin,
    pub integrator: Integrator,
    pub sampler: Pattern,
    pub seed: u32,
}

/// Which light is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator {
    /// Paths of at most two segments.
    Direct,
    /// Paths of at most eight.
    Path,
    /// Bidirectional, at most eight segments, in tiles.
    #[cfg(feature = "roomy")]
    Bdpt,
    /// The same with a whole frame.
    #[cfg(feature = "roomy")]
    Frame,
    /// Light tracing, at most eight segments.
    #[cfg(feature = "roomy")]
    Light,
    /// Ambient occlusion without end.
    #[cfg(feature = "roomy")]
    Ao,
    /// [`DEEP`] in tiles, one sample a pixel.
    #[cfg(feature = "roomy")]
    Deep,
}

/// Which sampler draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    Independent,
    Stratified,
    Sobol,
    Cmj,
    Blue,
}

/// What a picture came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// CRC-32 of all pixels' mean radiance row by row: three u16 mantissas and the i16 exponent, little-endian.
    pub crc: u32,
    /// Rays asked of the scene: path segments and shadow rays.
    pub rays: u32,
}

impl Integrator {
    pub const fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Path => "path",
            #[cfg(feature = "roomy")]
            Self::Bdpt => "bdpt",
            #[cfg(feature = "roomy")]
            Self::Frame => "frame",
            #[cfg(feature = "roomy")]
            Self::Light => "light",
            #[cfg(feature = "roomy")]
            Self::Ao => "ao",
            #[cfg(feature = "roomy")]
            Self::Deep => "bdpt-8x8",
        }
    }
}

impl Case {
    /// Size and effort of the picture.
    pub const fn settings(self) -> Settings {
        match self.integrator {
            #[cfg(feature = "roomy")]
            Integrator::Deep => Settings { spp: 1, ..SETTINGS },
            _ => SETTINGS,
        }
    }

    fn sampler(self) -> AnySampler {
        match self.sampler {
            Pattern::Independent => Independent::new(self.seed).into(),
            Pattern::Stratified => Stratified::new(self.seed, SETTINGS.spp).into(),
            Pattern::Sobol => Sobol::new(self.seed).into(),
            Pattern::Cmj => Cmj::new(self.seed, SETTINGS.spp).into(),
            Pattern::Blue => ZSobol::new(self.seed, SETTINGS.spp).into(),
        }
    }

    /// Renders it; never inlined, so that its memory is taken while it runs and no longer.
    ///
    /// A scene that the core refused would leave the CRC of nothing.
    #[inline(never)]
    pub fn run(self) -> Outcome {
        let outcome = self.scene.with(|scene, camera| match self.integrator {
            Integrator::Direct => self.tiles(scene, camera, Path::direct()),
            Integrator::Path => self.tiles(scene, camera, Path::new(8)),
            #[cfg(feature = "roomy")]
            Integrator::Bdpt => self.tiles(scene, camera, Bdpt::new(8)),
            #[cfg(feature = "roomy")]
            Integrator::Ao => self.tiles(scene, camera, AmbientOcclusion::new()),
            #[cfg(feature = "roomy")]
            Integrator::Deep => self.tiles(scene, camera, DEEP),
            #[cfg(feature = "roomy")]
            Integrator::Frame => self.frame(scene, camera, Bdpt::new(8)),
            #[cfg(feature = "roomy")]
            Integrator::Light => self.frame(scene, camera, LightTracer::new(8)),
        });
        outcome.unwrap_or(Outcome { crc: 0, rays: 0 })
    }

    /// Row by row.
    #[inline(never)]
    fn tiles<I: Follow>(self, scene: &Scene, camera: Camera, integrator: I) -> Outcome {
        let mut crc = Crc::new();
        let mut renderer = Renderer::new(scene, camera, integrator, self.sampler(), self.settings());
        let mut strip = [Radiance::BLACK; SETTINGS.width as usize];
        while let Some(tile) = renderer.step(&mut strip) {
            pixels(&mut crc, tile.pixels);
        }
        Outcome {
            crc: crc.value(),
            rays: renderer.rays(),
        }
    }

    /// Pixel by pixel into a frame.
    #[cfg(feature = "roomy")]
    #[inline(never)]
    fn frame<I: Follow>(self, scene: &Scene, camera: Camera, integrator: I) -> Outcome {
        let Settings { width, height, spp } = self.settings();
        let mut sums = [[0; 3]; PIXELS];
        let mut crc = Crc::new();
        let mut renderer = Renderer::new(scene, camera, integrator, self.sampler(), self.settings());
        if let Some(mut frame) = Exposure::new(width, height, &mut sums) {
            for y in 0..height {
                for x in 0..width {
                    renderer.expose(x, y, &mut frame);
                }
            }
            let mut strip = [Radiance::BLACK; SETTINGS.width as usize];
            for y in 0..height {
                pixels(
                    &mut crc,
                    frame.rows(y, spp, &mut strip).map_or(&[], |tile| tile.pixels),
                );
            }
        }
        Outcome {
            crc: crc.value(),
            rays: renderer.rays(),
        }
    }
}

fn pixels(crc: &mut Crc, pixels: &[Radiance]) {
    for pixel in pixels {
        fingerprint::pixel(crc, *pixel);
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use microlux::{
        integrator::{Strategy, Tally, View},
        num::Wide,
        sampler::Sampler,
    };
    use std::collections::BTreeSet;

    /// The strategies whose connections were made.
    struct Pairs(BTreeSet<(u16, u16)>);

    impl Tally for Pairs {
        const SPLATS: bool = false;
        const ALL: bool = true;

        fn gather(&mut self, strategy: Strategy, light: Radiance, _: Wide) {
            if !light.is_black() {
                self.0.insert((strategy.light, strategy.camera));
            }
        }

        fn splat(&mut self, _: Strategy, _: (u16, u16), _: Radiance, _: Wide) {}
    }

    /// The deep picture connects 8 vertices with 8.
    #[test]
    fn every_pair_of_eight_and_eight_vertices_is_connected() {
        let mut pairs = Pairs(BTreeSet::new());
        let mut sampler: Independent = Independent::new(1);
        let mut rays = 0;
        Builtin::Cornell
            .with(|scene, camera| {
                let film = camera.film(SETTINGS.width, SETTINGS.height);
                let view = View::new(scene, &film);
                for place in 0..PIXELS as u16 {
                    let (x, y) = (place % SETTINGS.width, place / SETTINGS.width);
                    sampler.start(x, y, 0);
                    let [place, lens] = [sampler.next_2d(), sampler.next_2d()];
                    if let Some(ray) = film.ray(x, y, place, lens) {
                        DEEP.follow(&view, ray, &mut sampler, &mut pairs, &mut rays);
                    }
                }
            })
            .unwrap();
        for light in 2..=9 {
            for camera in 2..=9 {
                assert!(pairs.0.contains(&(light, camera)), "{light} and {camera}");
            }
        }
    }
}
