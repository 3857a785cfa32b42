//! Rays and paths by themselves: what each costs without the scene's set-up, the film and the display.
//!
//! Every camera ray and every path is a [`region`] of its own, so that the counting emulator adds up exactly these. The
//! rays are those of the pictures in [`golden`](crate::golden), of which they are the first sample.

use core::hint::black_box;

use microlux::{
    camera::Camera,
    color::Radiance,
    integrator::Path,
    num::{Crc, Uniform},
    sampler::{Independent, Sampler},
    scene::{Scene, builtin::Builtin},
};

use crate::{fingerprint, golden::SETTINGS, region};
#[cfg(feature = "roomy")]
use crate::{mesh, stage::Pedestal};

/// Longest path, in segments.
pub const MAX_DEPTH: u16 = 8;

/// One ray or path through each pixel of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bundle {
    pub motif: Motif,
    pub kind: Kind,
}

/// What is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motif {
    Builtin(Builtin),
    /// The mesh in flash: a knot of 3,072 triangles, if no other was baked in.
    #[cfg(feature = "roomy")]
    Mesh,
}

/// What is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The camera's ray and its nearest hit.
    Primary,
    /// A path of up to [`MAX_DEPTH`] segments: nearest hits, light samples with their shadow rays, BSDF samples, weights.
    Path,
}

/// What came back along the camera's ray, one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Traced {
    /// CRC-32 of every hit, or of every path's radiance.
    pub crc: u32,
    /// How many rays or paths were counted.
    pub entries: u32,
    /// Rays asked of the scene.
    pub rays: u32,
}

impl Motif {
    pub const fn name(self) -> &'static str {
        match self {
            Self::Builtin(scene) => scene.name(),
            #[cfg(feature = "roomy")]
            Self::Mesh => "mesh",
        }
    }

    /// Lends out the scene; `None` if it is refused.
    pub fn with<R>(self, look: impl FnOnce(&Scene, Camera) -> R) -> Option<R> {
        match self {
            Self::Builtin(scene) => scene.with(look).ok(),
            #[cfg(feature = "roomy")]
            Self::Mesh => with_mesh(look),
        }
    }
}

/// Not inlined, so that its memory is taken while it runs and no longer.
#[cfg(feature = "roomy")]
#[inline(never)]
fn with_mesh<R>(look: impl FnOnce(&Scene, Camera) -> R) -> Option<R> {
    let mut pedestal = Pedestal::new(mesh::baked().ok()?);
    let (scene, camera) = pedestal.scene().ok()?;
    Some(look(&scene, camera))
}

/// Begins every pixel's sample in turn, with the place in the pixel and on the lens.
pub fn samples(mut each: impl FnMut(u16, u16, [[Uniform; 2]; 2], &mut Independent)) {
    let mut sampler: Independent = Independent::new(1);
    for y in 0..SETTINGS.height {
        for x in 0..SETTINGS.width {
            sampler.start(x, y, 0);
            let place = [sampler.next_2d(), sampler.next_2d()];
            each(x, y, place, &mut sampler);
        }
    }
}

impl Bundle {
    /// Traces all of it, each ray or path as region `id`.
    #[inline(never)]
    pub fn run(self, id: u32) -> Traced {
        let traced = self.motif.with(|scene, camera| match self.kind {
            Kind::Primary => primary(id, scene, camera),
            Kind::Path => paths(id, scene, camera),
        });
        traced.unwrap_or(Traced {
            crc: 0,
            entries: 0,
            rays: 0,
        })
    }
}

fn primary(id: u32, scene: &Scene, camera: Camera) -> Traced {
    let film = camera.film(SETTINGS.width, SETTINGS.height);
    let (mut crc, mut entries) = (Crc::new(), 0);
    samples(|x, y, place, _| {
        let start = (x, y, place);
        let hit = region::count(id, || {
            let (x, y, [place, lens]) = black_box(start);
            let ray = film.ray(x, y, place, lens);
            black_box(ray.and_then(|ray| scene.closest(&ray)))
        });
        entries += 1;
        if let Some(hit) = hit {
            crc.word(hit.t as u32);
            crc.word(u32::from(hit.shape) << 16 | (hit.triangle & 0xffff));
            crc.word(hit.barycentric[0] as u32);
            crc.word(hit.barycentric[1] as u32);
        }
        crc.word(hit.is_some().into());
    });
    Traced {
        crc: crc.value(),
        entries,
        rays: entries,
    }
}

fn paths(id: u32, scene: &Scene, camera: Camera) -> Traced {
    let film = camera.film(SETTINGS.width, SETTINGS.height);
    let (mut crc, mut entries, mut rays) = (Crc::new(), 0, 0);
    samples(|x, y, [place, lens], sampler| {
        let Some(ray) = film.ray(x, y, place, lens) else {
            return;
        };
        let radiance: Radiance = region::count(id, || {
            let path = Path::new(MAX_DEPTH);
            black_box(path.radiance(scene, black_box(ray), sampler, &mut rays))
        });
        entries += 1;
        fingerprint::pixel(&mut crc, radiance);
    });
    Traced {
        crc: crc.value(),
        entries,
        rays,
    }
}
