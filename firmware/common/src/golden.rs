//! The pictures of the core's `tests/golden.txt`, rendered where the firmware runs: the same bits, whatever the machine.
//!
//! The memory that this takes is a strip of one row, the scene and the renderer: it fits a micro:bit.

use microlux::{
    color::Radiance,
    integrator::Path,
    render::{Renderer, Settings},
    sampler::{AnySampler, Cmj, Independent, Sobol, Stratified, ZSobol},
    scene::builtin::Builtin,
};

use crate::crc::Crc;

/// Size and effort of every picture in the record.
pub const SETTINGS: Settings = Settings {
    width: 30,
    height: 25,
    spp: 4,
};

/// A row of the record.
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
        }
    }

    pub const fn path(self) -> Path {
        match self {
            Self::Direct => Path::direct(),
            Self::Path => Path::new(8),
        }
    }
}

impl Case {
    fn sampler(self) -> AnySampler {
        match self.sampler {
            Pattern::Independent => Independent::new(self.seed).into(),
            Pattern::Stratified => Stratified::new(self.seed, SETTINGS.spp).into(),
            Pattern::Sobol => Sobol::new(self.seed).into(),
            Pattern::Cmj => Cmj::new(self.seed, SETTINGS.spp).into(),
            Pattern::Blue => ZSobol::new(self.seed, SETTINGS.spp).into(),
        }
    }

    /// Renders it row by row; never inlined, so that its memory is taken while it runs and no longer.
    ///
    /// A scene that the core refused would leave the CRC of nothing.
    #[inline(never)]
    pub fn run(self) -> Outcome {
        let mut crc = Crc::new();
        let rays = self.scene.with(|scene, camera| {
            let mut renderer = Renderer::new(scene, camera, self.integrator.path(), self.sampler(), SETTINGS);
            let mut strip = [Radiance::BLACK; SETTINGS.width as usize];
            while let Some(tile) = renderer.step(&mut strip) {
                for pixel in tile.pixels {
                    let (mantissas, exponent) = pixel.to_parts();
                    for half in mantissas {
                        crc.bytes(&half.to_le_bytes());
                    }
                    crc.bytes(&exponent.to_le_bytes());
                }
            }
            renderer.rays()
        });
        Outcome {
            crc: crc.value(),
            rays: rays.unwrap_or(0),
        }
    }
}
