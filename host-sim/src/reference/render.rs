//! Whole pictures: every pixel the mean of its samples, rows in parallel.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering::Relaxed};

use rayon::prelude::*;

use super::camera::lens_ray;
use super::integrate::{LENS_SLOT, PIXEL_SLOT, SLOTS, World};
use super::rng::Rng;
use super::scene::Scene;
use super::strata::{Sampler, Strata};
use super::vec::Rgb;

#[derive(Clone, Copy, Debug)]
pub struct Settings {
    pub width: u32,
    pub height: u32,
    /// Samples a pixel; best a number with a divisor near its square root, so that the strata are square.
    pub spp: u32,
    /// Paths of at most this many segments (1: emission only, 2: direct light); `None`: no limit but roulette.
    pub max_depth: Option<u32>,
    /// Segments after which Russian roulette may end a path.
    pub rr_depth: u32,
    /// The camera sees through emitting shapes and not the environment; light from them is as ever.
    pub hide_emitters: bool,
    pub seed: u64,
    pub estimator: Estimator,
}

/// How paths find light. The first two give the same picture in the mean, but for lights that a direction cannot find.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Estimator {
    /// Light samples and material samples joined by multiple importance sampling.
    #[default]
    Guided,
    /// Uniform directions and no light samples: blind to point and directional lights, noisy, hard to get wrong.
    Blind,
    /// No light at all, but (1/π) ∫ V cosθ dω over the hemisphere about the shading normal on the eye's side, where V is 1 if
    /// there is nothing within `radius`, which may be infinite; 0 where the camera ray meets nothing.
    AmbientOcclusion { radius: f64 },
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            width: 1,
            height: 1,
            spp: 64,
            max_depth: None,
            rr_depth: 5,
            hide_emitters: false,
            seed: 0,
            estimator: Estimator::Guided,
        }
    }
}

/// Linear radiance, row-major, top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    pub width: u32,
    pub height: u32,
    pub pixels: Vec<[f64; 3]>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Rendering {
    pub image: Image,
    /// Primary, bounce and shadow rays traced.
    pub rays: u64,
}

/// The picture, or `None` if `cancel` was set before it was done.
///
/// Runs on the current rayon pool. `progress` hears the number of rows done so far, from any thread, and not always in
/// order. The picture depends on scene and settings alone, not on the number of threads.
pub fn render(
    scene: &Scene,
    settings: &Settings,
    progress: &(dyn Fn(usize) + Sync),
    cancel: &AtomicBool,
) -> Option<Rendering> {
    let world = World::new(scene, settings);
    let (width, height) = (settings.width as usize, settings.height as usize);
    let mut pixels = vec![[0.0; 3]; width * height];
    let rays = AtomicU64::new(0);
    let rows_done = AtomicUsize::new(0);
    pixels
        .par_chunks_mut(width.max(1))
        .enumerate()
        .for_each(|(y, row)| {
            let mut strata = Strata::new(SLOTS, settings.spp as usize);
            let mut traced = 0;
            for (x, pixel) in row.iter_mut().enumerate() {
                if cancel.load(Relaxed) {
                    return;
                }
                *pixel = mean_radiance(&world, scene, settings, [x, y], &mut strata, &mut traced).into();
            }
            rays.fetch_add(traced, Relaxed);
            progress(rows_done.fetch_add(1, Relaxed) + 1);
        });
    let image = Image {
        width: settings.width,
        height: settings.height,
        pixels,
    };
    let finished = rows_done.into_inner() == height || width == 0;
    finished.then_some(Rendering {
        image,
        rays: rays.into_inner(),
    })
}

fn mean_radiance(
    world: &World,
    scene: &Scene,
    settings: &Settings,
    [x, y]: [usize; 2],
    strata: &mut Strata,
    rays: &mut u64,
) -> Rgb {
    let mut rng = Rng::new(settings.seed, (y * settings.width as usize + x) as u64);
    strata.refill(&mut rng);
    let mut sum = Rgb::ZERO;
    for sample in 0..settings.spp as usize {
        let mut sampler = Sampler::new(&mut rng, strata, sample);
        let [dx, dy] = sampler.slot(PIXEL_SLOT);
        let at = [x as f64 + dx, y as f64 + dy];
        let lens = sampler.slot(LENS_SLOT);
        let ray = lens_ray(&scene.camera, [settings.width, settings.height], at, lens);
        sum += world.radiance(ray, &mut sampler, rays);
    }
    sum / f64::from(settings.spp.max(1))
}
