//! The pictures of the core's `tests/golden_denoise.txt`, denoised where the firmware runs.
//!
//! The memory that this takes is two frames of twelve bytes a pixel, their lengths and three rows: 12,768 bytes; the network's
//! own is beside it, or 3,840 of two pictures where each is half of the one before.

use microlux::{
    camera::Camera,
    color::{Radiance, Rgb9e5},
    film::Feature,
    film::denoise::network::{Neural, TRAINED},
    film::denoise::{Atrous, Denoiser, Filter, Memory, ROWS, Seen, Shown, Size},
    geom::{Dir, Point},
    integrator::Path,
    num::Crc,
    render::{Motion, Renderer, Settings},
    sampler::Sobol,
    scene::{Scene, builtin::Builtin},
};

use crate::{fingerprint, region};

const SIZE: Size = Size {
    width: 24,
    height: 20,
};
const PIXELS: usize = SIZE.pixels();
const FRAMES: u32 = 4;

/// What takes the noise away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    Atrous,
    Neural,
}

/// A row of the record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Case {
    pub scene: Builtin,
    pub way: Way,
    pub spp: u32,
    /// Whether each picture is half of the one shown before; of [`Way::Atrous`] alone.
    pub is_steadied: bool,
}

impl Case {
    /// The CRC of the record; region `id` is each frame's way from features to clean light, which is worth counting.
    #[inline(never)]
    pub fn run(self, id: u32) -> u32 {
        let with = |scene: &Scene, camera| match self.way {
            Way::Atrous if self.is_steadied => self.steadied(scene, camera, id),
            Way::Atrous => self.frames(
                scene,
                camera,
                &mut Atrous::for_spp(self.spp),
                Default::default(),
                id,
            ),
            Way::Neural => self.neural(scene, camera, id),
        };
        self.scene.with(with).unwrap_or(0)
    }

    /// Not inlined, so that its memory is taken while it runs and no longer.
    #[inline(never)]
    fn neural(self, scene: &Scene, camera: Camera, id: u32) -> u32 {
        let mut memory = [0; Neural::needs(SIZE)];
        match Neural::new(TRAINED, SIZE, self.spp, &mut memory) {
            Ok(mut neural) => self.frames(scene, camera, &mut neural, Default::default(), id),
            Err(_) => 0,
        }
    }

    #[inline(never)]
    fn steadied(self, scene: &Scene, camera: Camera, id: u32) -> u32 {
        let (mut now, mut before) = ([Rgb9e5::BLACK; PIXELS], [Rgb9e5::BLACK; PIXELS]);
        let pictures = [&mut now[..], &mut before[..]];
        self.frames(scene, camera, &mut Atrous::for_spp(self.spp), pictures, id)
    }

    /// `pictures` are this frame's and the last's, if those are mixed, and empty if not.
    #[inline(never)]
    fn frames(
        self,
        scene: &Scene,
        camera: Camera,
        filter: &mut impl Filter,
        [mut picture, mut last]: [&mut [Rgb9e5]; 2],
        id: u32,
    ) -> u32 {
        let (mut now, mut before) = ([Feature::default(); PIXELS], [Feature::default(); PIXELS]);
        let (mut lengths, mut lengths_before) = ([0; PIXELS], [0; PIXELS]);
        let mut rows = [Rgb9e5::BLACK; ROWS * SIZE.width as usize];
        let memory = Memory {
            frames: [&mut now, &mut before],
            lengths: [&mut lengths, &mut lengths_before],
            rows: &mut rows,
        };
        let Ok(mut denoiser) = Denoiser::new(SIZE, self.spp, memory) else {
            return 0;
        };
        let mut crc = Crc::new();
        let mut ring = [Seen::default(); 3 * 2 * SIZE.width as usize];
        let settings = |scale: u16, spp| Settings {
            width: scale * SIZE.width,
            height: scale * SIZE.height,
            spp,
        };
        for frame in 0..FRAMES {
            let (then, now) = (moved(camera, frame.saturating_sub(1)), moved(camera, frame));
            let motion = Motion::between(then, now, SIZE.width, SIZE.height);
            let coarse = settings(1, self.spp);
            let mut renderer = Renderer::new(scene, now, Path::new(8), Sobol::new(frame + 1), coarse);
            if let Some(area) = renderer.area(0, PIXELS as u32) {
                renderer.feature_tile(area, denoiser.frame());
            }
            let clean = region::count(id, || denoiser.denoise(Some(&motion), filter));
            let shown = Shown {
                size: SIZE,
                // Of the first frame there is none before.
                lights: if frame == 0 { &[] } else { &*last },
                motion: &motion,
            };
            let first = &mut ring[..3 * SIZE.width as usize];
            if picture.is_empty() {
                clean.rows(0..SIZE.height, first, |_, row| add(&mut crc, row.lights()));
            } else {
                clean.rows(0..SIZE.height, first, |y, row| {
                    let kept = picture.iter_mut().skip(y as usize * SIZE.width as usize);
                    for (kept, light) in kept.zip(row.steadied(y, &shown)) {
                        *kept = light;
                        fingerprint::pixel(&mut crc, light.decode());
                    }
                });
                core::mem::swap(&mut picture, &mut last);
            }
            if frame + 1 == FRAMES {
                let fine = settings(2, 1);
                let mut guides = Renderer::new(scene, now, Path::new(1), Sobol::new(0), fine);
                clean.rows_2x(
                    0..fine.height,
                    &mut ring,
                    |x, y| guides.guide(x, y),
                    |_, row| add(&mut crc, row.lights()),
                );
            }
        }
        crc.value()
    }
}

fn add(crc: &mut Crc, lights: impl Iterator<Item = Radiance>) {
    for light in lights {
        fingerprint::pixel(crc, light);
    }
}

/// A frame's camera: to the right by so many 64ths of its height above the floor, looking the same way.
pub(crate) fn moved(camera: Camera, frame: u32) -> Camera {
    let Point([x, y, z]) = camera.origin();
    let aside = (y.abs() / 64).wrapping_mul(frame as i32);
    let [Dir(right), ..] = camera.frame();
    let by = right.map(|c| ((c as i64 * aside as i64) >> 16) as i32);
    let origin = Point([x + by[0], y + by[1], z + by[2]]);
    Camera::from_frame(origin, camera.frame(), camera.half_width())
}
