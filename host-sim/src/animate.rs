//! A camera that moves through a scene, frame by frame, and how much the picture flickers meanwhile.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::time::Instant;

use embedded_graphics::geometry::{Point as Place, Size as Extent};
use embedded_graphics::primitives::Rectangle;
use microlux::camera::Camera;
use microlux::film::Feature;
use microlux::film::Tile;
use microlux::film::denoise::Reproject;
use microlux::geom::{Dir, Point};
use microlux::integrator::Path;
use microlux::render::{Motion, Renderer, Settings};
use microlux::sampler::{Independent, PcgRxsMXs32};
use microlux::scene::Scene;

use crate::clean;
use crate::desc::SceneDesc;
use crate::quantise::CoreScene;
use crate::run::{self, Error, Options, Progress};
use crate::show;

/// What the camera does, evenly over all frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    pub frames: u32,
    /// Degrees around what is in the middle of the first frame, about the camera's up.
    pub orbit: f64,
    /// Metres forward.
    pub dolly: f64,
}

/// A frame as it is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    pub width: usize,
    pub height: usize,
    pub rgb8: Vec<[u8; 3]>,
    /// Where each pixel was in the frame before, pixels from the left and top; `None` if it was not to be seen.
    before: Vec<Option<[f64; 2]>>,
}

/// All frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Animation {
    pub frames: Vec<Shown>,
    /// Wall clock of all of them.
    pub seconds: f64,
}

/// The camera of frame number `frame`.
fn camera(start: Camera, middle: i32, metre: f64, flight: Flight, frame: u32) -> Camera {
    let part = f64::from(frame) / f64::from(flight.frames.max(2) - 1);
    let frame = start.frame();
    let [right, up, forward] = frame.map(|Dir(d)| d.map(|c| f64::from(c) / 65536.0));
    let (sin, cos) = (flight.orbit * part).to_radians().sin_cos();
    // About `up`: forward leans to the right by the angle, and the eye goes to the left to look at the same place.
    let turned = |a: [f64; 3], b: [f64; 3], sin: f64| [0, 1, 2].map(|i| a[i] * cos + b[i] * sin);
    let (new_forward, new_right) = (turned(forward, right, sin), turned(right, forward, -sin));
    let Point(eye) = start.origin();
    let (middle, ahead) = (f64::from(middle), flight.dolly * part * metre);
    let eye = [0, 1, 2].map(|i| {
        let moved =
            f64::from(eye[i]) + forward[i] * middle - new_forward[i] * middle + new_forward[i] * ahead;
        moved.round() as i32
    });
    let unit = |v: [f64; 3]| Dir::new(v.map(|c| (c * 65536.0 * 64.0).round() as i32));
    let frame = [
        unit(new_right).unwrap_or(frame[0]),
        unit(up).unwrap_or(frame[1]),
        unit(new_forward).unwrap_or(frame[2]),
    ];
    let (radius, focus) = start.lens();
    Camera::from_frame(Point(eye), frame, start.half_width()).with_lens(radius, focus)
}

/// Renders all frames, each with a seed of its own; noise is taken away as the options say.
pub fn animation(
    desc: &SceneDesc,
    options: &Options,
    flight: Flight,
    progress: &dyn Progress,
    cancel: &AtomicBool,
) -> Result<Animation, Error> {
    let core = CoreScene::new(desc)?;
    let lent = core.lend();
    let path = run::path(desc, options)?;
    let mut cells = run::cells(options, path);
    let scene = core.scene(&lent)?.foresee(&mut cells);
    let frames = run::frames(options)?;
    let metre = f64::from(core.unit.fraction_bits()).exp2();
    let (width, height) = (frames.width, frames.height);
    let seen = guides(&scene, core.camera, width, height).features(width / 2, height / 2);
    let middle = seen.map_or(0, |seen| seen.depth.min(1 << 24));
    let (done, all_rays) = (AtomicUsize::new(0), AtomicU64::new(0));
    let total = frames.rows() * flight.frames as usize;
    let advance = |rays| {
        let rays = all_rays.fetch_add(rays, Ordering::Relaxed) + rays;
        progress.advance(done.fetch_add(1, Ordering::Relaxed) + 1, total, rays);
        !cancel.load(Ordering::Relaxed)
    };
    let started = Instant::now();
    let make = || {
        clean::sequence(frames, |sequence| {
            let mut shown = Vec::new();
            let mut last: Option<(Camera, Vec<Feature>)> = None;
            for number in 0..flight.frames {
                let now = camera(core.camera, middle, metre, flight, number);
                let sampler = run::sampler(&Options {
                    seed: options.seed.wrapping_add(number),
                    ..options.clone()
                });
                let (pixels, _) = sequence.frame(&scene, now, path, &sampler, &advance)?;
                let area = Rectangle::new(Place::zero(), Extent::new(u32::from(width), u32::from(height)));
                let tile = Tile {
                    area,
                    pixels: &pixels,
                };
                let mut guides = guides(&scene, now, width, height);
                let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
                let features: Vec<_> = places.map(|(x, y)| guides.guide(x, y)).collect();
                let before = last
                    .as_ref()
                    .map_or(vec![None; pixels.len()], |(camera, before)| {
                        befores(*camera, now, [width, height], before, &features)
                    });
                last = Some((now, features));
                shown.push(Shown {
                    width: usize::from(width),
                    height: usize::from(height),
                    rgb8: show::tiles(u32::from(width), [tile], options.display, options.look),
                    before,
                });
            }
            Some(shown)
        })
    };
    let made = run::pool(options.threads)?.install(make);
    Ok(Animation {
        frames: made.ok_or(Error::Cancelled)?,
        seconds: started.elapsed().as_secs_f64(),
    })
}

pub(crate) fn guides<'s>(
    scene: &'s Scene<'s>,
    camera: Camera,
    width: u16,
    height: u16,
) -> Renderer<'s, Independent<PcgRxsMXs32>> {
    let settings = Settings {
        width,
        height,
        spp: 1,
    };
    Renderer::new(scene, camera, Path::new(1), Independent::new(0), settings)
}

/// Where each pixel was, pixels from the left and top, if the same thing was there.
pub(crate) fn befores(
    before: Camera,
    now: Camera,
    [width, height]: [u16; 2],
    then: &[Feature],
    features: &[Feature],
) -> Vec<Option<[f64; 2]>> {
    let motion = Motion::between(before, now, width, height);
    let place = |i: usize| {
        let (x, y) = (i % usize::from(width), i / usize::from(width));
        let found = motion.before(x as u16, y as u16, features[i].depth)?;
        let [px, py] = found.place.map(|c| c >> 4);
        let inside = (0..i32::from(width)).contains(&px) && (0..i32::from(height)).contains(&py);
        let was = inside.then(|| then[py as usize * usize::from(width) + px as usize])?;
        let is_same = was.id == features[i].id && was.depth.abs_diff(found.depth) <= 2;
        is_same.then(|| found.place.map(|c| f64::from(c) / 16.0))
    };
    (0..features.len()).map(place).collect()
}

/// The value between four pixels' middles; beside the picture that of its edge.
pub(crate) fn between(
    [width, height]: [usize; 2],
    [x, y]: [f64; 2],
    pixel: impl Fn(usize) -> [f64; 3],
) -> [f64; 3] {
    let (x, y) = (x - 0.5, y - 0.5);
    let mut sum = [0.0; 3];
    for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        let (tx, ty) = (x.floor() + dx, y.floor() + dy);
        let share = (1.0 - (x - tx).abs()) * (1.0 - (y - ty).abs());
        let column = tx.clamp(0.0, width as f64 - 1.0) as usize;
        let row = ty.clamp(0.0, height as f64 - 1.0) as usize;
        for (sum, c) in sum.iter_mut().zip(pixel(row * width + column)) {
            *sum += share * c;
        }
    }
    sum
}

impl Shown {
    /// The signal there, 0 ..= 1.
    fn at(&self, place: [f64; 2]) -> [f64; 3] {
        let signal = |i: usize| self.rgb8[i].map(|c| f64::from(c) / 255.0);
        between([self.width, self.height], place, signal)
    }
}

impl Animation {
    /// Mean change of a place's 8-bit signal from frame to frame, 0 ..= 1, followed as the camera moves: only where the same
    /// thing was seen before.
    pub fn flicker(&self) -> f64 {
        let (mut sum, mut count) = (0.0, 0usize);
        for pair in self.frames.windows(2) {
            let [then, now] = pair else { continue };
            for (pixel, before) in now.rgb8.iter().zip(&now.before) {
                let Some(before) = before else { continue };
                let was = then.at(*before);
                sum += (0..3)
                    .map(|c| (f64::from(pixel[c]) / 255.0 - was[c]).abs())
                    .sum::<f64>();
                count += 3;
            }
        }
        sum / count.max(1) as f64
    }

    /// Of the 8-bit signals against another's, dB (200: equal), over all frames from number `first` on.
    pub fn psnr(&self, truth: &Animation, first: usize) -> f64 {
        let (mut sum, mut count) = (0.0, 0usize);
        for (frame, truth) in self.frames.iter().zip(&truth.frames).skip(first) {
            let pairs = frame.rgb8.as_flattened().iter().zip(truth.rgb8.as_flattened());
            sum += pairs
                .map(|(a, b)| ((f64::from(*a) - f64::from(*b)) / 255.0).powi(2))
                .sum::<f64>();
            count += frame.rgb8.len() * 3;
        }
        (-10.0 * (sum / count.max(1) as f64).log10()).min(200.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clean::{Cleaning, Denoise};

    fn small(name: &str) -> (SceneDesc, Options) {
        let desc = crate::builtin::scene(name).unwrap();
        let options = Options {
            width: 64,
            height: 64,
            spp: 2,
            max_depth: Some(4),
            ..Options::for_scene(&desc)
        };
        (desc, options)
    }

    fn made(name: &str, orbit: f64, change: impl FnOnce(&mut Options)) -> Animation {
        let (desc, mut options) = small(name);
        change(&mut options);
        let flight = Flight {
            frames: 6,
            orbit,
            dolly: 0.0,
        };
        animation(&desc, &options, flight, &(), &AtomicBool::new(false)).unwrap()
    }

    fn clean(denoise: Denoise, upscale: u32) -> impl FnOnce(&mut Options) {
        cleaned(denoise, upscale, false)
    }

    fn cleaned(denoise: Denoise, upscale: u32, taa: bool) -> impl FnOnce(&mut Options) {
        move |options: &mut Options| {
            options.cleaning = Cleaning {
                denoise,
                upscale,
                taa,
            }
        }
    }

    #[test]
    fn what_was_shown_before_makes_it_calmer() {
        for (orbit, upscale) in [(0.0, 1), (0.0, 2), (3.0, 1), (3.0, 2)] {
            let truth = made("cornell", orbit, |options| options.spp = 128);
            let [plain, steady] =
                [false, true].map(|taa| made("cornell", orbit, cleaned(Denoise::Atrous, upscale, taa)));
            let over = |animation: &Animation| animation.flicker() - truth.flicker();
            let [a, b] = [&plain, &steady].map(over);
            assert!(b < 0.8 * a, "{orbit} {upscale}: {a} {b}");
            let [a, b] = [&plain, &steady].map(|animation| animation.psnr(&truth, 5));
            assert!(b > a - 1.0, "{orbit} {upscale}: {a} {b}");
        }
    }

    #[test]
    fn what_is_denoised_is_nearer_the_truth_and_flickers_less() {
        for orbit in [0.0, 3.0] {
            let truth = made("cornell", orbit, |options| options.spp = 128);
            let noisy = made("cornell", orbit, |_| ());
            // Twice as large from a quarter of the samples, outlines are steps: they cost more than noise does.
            for (denoise, upscale, gain) in [
                (Denoise::Atrous, 1, 4.0),
                (Denoise::Atrous, 2, 0.5),
                (Denoise::Neural, 1, 4.0),
                (Denoise::Neural, 2, 0.5),
            ] {
                let clean = made("cornell", orbit, clean(denoise, upscale));
                assert!(
                    clean.psnr(&truth, 5) > noisy.psnr(&truth, 5) + gain,
                    "{orbit} {denoise:?} {upscale}: {} {}",
                    clean.psnr(&truth, 5),
                    noisy.psnr(&truth, 5)
                );
                let over = |animation: &Animation| animation.flicker() - truth.flicker();
                assert!(
                    over(&clean) < 0.2 * over(&noisy),
                    "{orbit} {denoise:?} {upscale}: {} {} {}",
                    clean.flicker(),
                    noisy.flicker(),
                    truth.flicker()
                );
            }
        }
    }

    #[test]
    fn threads_do_not_change_a_frame() {
        let one = made("spheres", 2.0, |options| {
            clean(Denoise::Atrous, 2)(options);
            options.threads = 1;
        });
        let three = made("spheres", 2.0, |options| {
            clean(Denoise::Atrous, 2)(options);
            options.threads = 3;
        });
        assert_eq!(one.frames, three.frames);
    }

    #[test]
    fn an_orbit_looks_at_the_same_place() {
        let start = Camera::look_at(
            Point([1000, 2000, 300_000]),
            Point([0, 0, 0]),
            [0, 1, 0],
            Camera::tan_half(microlux::num::Turn::from_bits(1 << 29)),
        )
        .unwrap();
        let flight = Flight {
            frames: 3,
            orbit: 20.0,
            dolly: 0.0,
        };
        let distance = 300_008;
        for frame in 0..3 {
            let camera = camera(start, distance, 1.0, flight, frame);
            let film = camera.film(100, 100);
            let place = film.place(Point([0, 0, 0])).unwrap();
            for c in place {
                assert!((f64::from(c) / 4096.0 - 50.0).abs() < 0.1, "{place:?}");
            }
            let Point([x, ..]) = camera.origin();
            let expected = 1000.0 + [0.0, -52_094.0, -102_606.0][frame as usize];
            assert!((f64::from(x) - expected).abs() < 900.0, "{x} {expected}");
        }
    }
}
