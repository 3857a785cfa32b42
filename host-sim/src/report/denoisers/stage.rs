//! Frames as the core renders them, from anywhere.

use std::sync::atomic::{AtomicBool, Ordering};

use embedded_graphics::geometry::{Point as Place, Size as Extent};
use embedded_graphics::primitives::Rectangle;
use microlux::camera::Camera;
use microlux::color::Radiance;
use microlux::film::Feature;
use microlux::film::denoise::Reproject;
use microlux::film::feature::{DEPTH_NOTHING, depth_distance};
use microlux::geom::{Dir, Point};
use microlux::integrator::Path;
use microlux::render::{Motion, Renderer, Settings};
use microlux::sampler::AnySampler;
use microlux::scene::Scene;
use rayon::prelude::*;

use super::{FRAMES, STEPS};
use crate::animate::{self, guides};
use crate::classical::Guided;
use crate::dequantise;
use crate::report::work::Work;
use crate::run::{self, Error, Options};

/// Light, linear, a pixel each.
pub type Light = Vec<[f32; 3]>;

/// A scene to render frames of.
pub struct Stage<'a> {
    pub scene: &'a Scene<'a>,
    pub path: Path,
    pub options: &'a Options,
    pub work: &'a Work<'a>,
    pub cancel: &'a AtomicBool,
}

/// A frame, noisy.
pub struct Frame {
    pub camera: Camera,
    pub width: usize,
    pub height: usize,
    pub light: Light,
    pub features: Vec<Feature>,
}

/// Two pictures of half the samples each, and their mean.
#[derive(Clone)]
pub struct Reference {
    pub halves: [Light; 2],
    pub mean: Light,
}

impl Stage<'_> {
    /// `spp` samples a pixel; another `seed`, another noise.
    pub fn frame(
        &self,
        camera: Camera,
        [width, height]: [u16; 2],
        spp: u32,
        seed: u32,
    ) -> Result<Frame, Error> {
        let light = self.light(camera, [width, height], spp, seed)?;
        let rows = (0..height).into_par_iter().map(|y| {
            let mut renderer = self.renderer(camera, [width, height], spp, seed);
            (0..width).map(|x| renderer.feature(x, y)).collect::<Vec<_>>()
        });
        Ok(Frame {
            camera,
            width: width.into(),
            height: height.into(),
            light,
            features: rows.collect::<Vec<_>>().concat(),
        })
    }

    pub fn reference(
        &self,
        camera: Camera,
        size: [u16; 2],
        spp: u32,
        number: u32,
    ) -> Result<Reference, Error> {
        // Seeds that no noisy frame has.
        let half = |half| self.light(camera, size, spp.div_ceil(2), (1 << 16) + 2 * number + half);
        let halves = [half(0)?, half(1)?];
        let pairs = halves[0].iter().zip(&halves[1]);
        let mean = pairs
            .map(|(a, b)| [0, 1, 2].map(|c| (a[c] + b[c]) / 2.0))
            .collect();
        Ok(Reference { halves, mean })
    }

    fn light(&self, camera: Camera, [width, height]: [u16; 2], spp: u32, seed: u32) -> Result<Light, Error> {
        let rows = (0..height).into_par_iter().map(|y| {
            if self.cancel.load(Ordering::Relaxed) {
                return Err(Error::Cancelled);
            }
            let mut row = vec![Radiance::BLACK; width.into()];
            let area = Rectangle::new(Place::new(0, y.into()), Extent::new(width.into(), 1));
            self.renderer(camera, [width, height], spp, seed)
                .tile(area, &mut row);
            self.work.add(usize::from(width) * spp as usize);
            Ok(row.into_iter().map(linear).collect::<Light>())
        });
        Ok(rows.collect::<Result<Vec<_>, _>>()?.concat())
    }

    fn renderer(
        &self,
        camera: Camera,
        [width, height]: [u16; 2],
        spp: u32,
        seed: u32,
    ) -> Renderer<'_, AnySampler, Path> {
        let sampler = run::sampler(&Options {
            spp,
            seed: self.options.seed.wrapping_add(seed),
            ..self.options.clone()
        });
        let settings = Settings { width, height, spp };
        Renderer::new(self.scene, camera, self.path, sampler, settings)
    }

    /// Cameras to the left and right of `middle` that are [`STEPS`] apart.
    pub fn flight(&self, middle: Camera, [width, height]: [u16; 2]) -> [Camera; FRAMES] {
        let mut guides = guides(self.scene, middle, width, height);
        let depths: Vec<(u16, u16, u8)> = places([width, height])
            .map(|(x, y)| (x, y, guides.guide(x, y).depth))
            .filter(|place| place.2 != DEPTH_NOTHING)
            .collect();
        // A step aside by a sixteenth of the mean distance, and how many pixels that is.
        let total: f64 = depths
            .iter()
            .map(|place| f64::from(depth_distance(place.2)))
            .sum();
        let step = total / depths.len().max(1) as f64 / 16.0;
        let motion = Motion::between(moved(middle, step), middle, width, height);
        let shifts = depths.iter().filter_map(|&(x, y, depth)| {
            let [to, _] = motion.before(x, y, depth)?.place;
            Some(f64::from(to - (16 * i32::from(x) + 8)).abs() / 16.0)
        });
        let pixels = super::mean(shifts).max(1e-3);
        let whole: f64 = STEPS.iter().sum();
        std::array::from_fn(|frame| {
            let place = STEPS[..frame].iter().sum::<f64>() - whole / 2.0;
            moved(middle, place * step / pixels)
        })
    }

    /// Where each pixel of each frame but the first was.
    pub fn befores(&self, cameras: &[Camera], [width, height]: [u16; 2]) -> Vec<super::motion::Befores> {
        let features: Vec<Vec<Feature>> = cameras
            .iter()
            .map(|camera| {
                let mut guides = guides(self.scene, *camera, width, height);
                places([width, height]).map(|(x, y)| guides.guide(x, y)).collect()
            })
            .collect();
        let pairs = cameras.windows(2).zip(features.windows(2));
        pairs
            .map(|(camera, features)| {
                animate::befores(camera[0], camera[1], [width, height], &features[0], &features[1])
            })
            .collect()
    }
}

fn places([width, height]: [u16; 2]) -> impl Iterator<Item = (u16, u16)> {
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

/// The camera so many units to its right.
fn moved(camera: Camera, by: f64) -> Camera {
    let Point(eye) = camera.origin();
    let [Dir(right), ..] = camera.frame();
    let eye = [0, 1, 2].map(|i| eye[i] + (f64::from(right[i]) / 65536.0 * by).round() as i32);
    let (radius, focus) = camera.lens();
    Camera::from_frame(Point(eye), camera.frame(), camera.half_width()).with_lens(radius, focus)
}

pub fn linear(light: Radiance) -> [f32; 3] {
    dequantise::radiance(light).map(|c| c as f32)
}

/// What leads filters, in `f32`; the light is the features' own.
pub fn guided(width: usize, features: &[Feature]) -> Guided {
    let each = |f: &dyn Fn(&Feature) -> [f32; 3]| features.iter().map(f).collect();
    Guided {
        width,
        height: features.len() / width.max(1),
        irradiance: each(&|pixel| linear(pixel.irradiance.decode())),
        albedo: each(&|pixel| dequantise::albedo(pixel.albedo()).map(|c| c as f32)),
        normal: each(&|pixel| pixel.normal.decode().0.map(|c| c as f32 / 65536.0)),
        depth: features.iter().map(|pixel| f32::from(pixel.depth)).collect(),
    }
}

/// Light times albedo.
pub fn lit(light: &[[f32; 3]], albedo: &[[f32; 3]]) -> Light {
    let pairs = light.iter().zip(albedo);
    pairs.map(|(l, a)| [0, 1, 2].map(|c| l[c] * a[c])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantise::CoreScene;

    #[test]
    fn the_camera_goes_by_as_many_pixels_as_it_is_said_to() {
        for name in ["cornell", "spheres"] {
            let desc = crate::builtin::scene(name).unwrap();
            let core = CoreScene::new(&desc).unwrap();
            let lent = core.lend();
            let options = Options::for_scene(&desc);
            let stage = Stage {
                scene: &core.scene(&lent).unwrap(),
                path: run::path(&desc, &options).unwrap(),
                options: &options,
                work: &Work::of(1, &()),
                cancel: &AtomicBool::new(false),
            };
            let size = [64, 48];
            let cameras = stage.flight(core.camera, size);
            let befores = stage.befores(&cameras, size);
            for (step, before) in STEPS.iter().zip(&befores) {
                let there = places(size).zip(before);
                let shifts = there.filter_map(|((x, _), before)| Some((*before)?[0] - f64::from(x) - 0.5));
                // What is infinitely far does not move, and is not in the mean.
                let moving: Vec<f64> = shifts.filter(|shift| *shift != 0.0).collect();
                let mean = moving.iter().sum::<f64>() / moving.len() as f64;
                assert!((mean / step - 1.0).abs() < 0.15, "{name}: {mean} for {step}");
            }
        }
    }
}
