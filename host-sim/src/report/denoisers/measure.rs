//! Renders what was asked for and takes the numbers.

use std::sync::atomic::AtomicBool;

use microlux::camera::Camera;
use microlux::color::Rgb9e5;
use microlux::film::Feature;
use microlux::film::denoise::{Clean, Size};

use super::motion::{Befores, Signals, flicker, signals};
use super::stage::{Frame, Light, Reference, Stage, guided, linear, lit};
use super::{FRAMES, Kind, Method, Part, Report, Request, SceneReport, Subject, Tried, Uncovered, still_spp};
use crate::animate::between;
use crate::classical::{self, Guides};
use crate::clean::{self, Cleaned, Cleaning, Denoise, Frames};
use crate::metrics::{Metrics, PSNR_MAX};
use crate::oidn::{Input, Oidn, Quality};
use crate::picture::{Picture, compressed};
use crate::quantise::CoreScene;
use crate::report::Shot;
use crate::report::work::Work;
use crate::run::{self, Error, Progress};

/// Joint bilateral guides for 1 and for 4 samples a pixel, tuned on the trainer's validation scenes after the clamp of
/// fireflies (`trainer evaluate`).
const BILATERAL: [Guides; 2] = [[1.0, 8.0, 1.333, 0.75], [1.333, 16.0, 4.0, 3.0]];

/// Samples a pixel of albedo and normals without noise.
const CLEAN: u32 = 64;

/// All of it; ends where the user stops it or a program fails.
pub fn measure(request: &Request, progress: &dyn Progress, cancel: &AtomicBool) -> Result<Report, Error> {
    let total = request.scenes.iter().map(|subject| samples(request, subject));
    let work = Work::of(total.sum(), progress);
    let mut scenes = Vec::new();
    for subject in &request.scenes {
        let began = work.done();
        let bench = Bench {
            request,
            subject,
            work: &work,
            cancel,
        };
        let outcome = match bench.scene() {
            Ok(parts) => Ok(parts),
            Err(Trouble::Run(Error::Scene(reason))) => Err(reason),
            Err(Trouble::Run(stop @ Error::Cancelled)) => return Err(stop),
            Err(Trouble::Oidn(reason)) => return Err(Error::Scene(reason)),
        };
        work.skip_to(began + samples(request, subject));
        scenes.push(SceneReport {
            name: subject.desc.name.clone(),
            width: subject.options.width as usize,
            height: subject.options.height as usize,
            outcome,
        });
    }
    Ok(Report {
        reference_spp: request.reference_spp,
        seed: request.scenes.first().map_or(0, |subject| subject.options.seed),
        has_oidn: request.oidn.is_some(),
        scenes,
    })
}

/// Samples of a scene's references: its still, the frames of the flight, the large picture.
fn samples(request: &Request, subject: &Subject) -> usize {
    let pixels = subject.options.width as usize * subject.options.height as usize;
    let spp = request.reference_spp;
    pixels * (still_spp(spp) as usize + spp as usize * (FRAMES + 4))
}

/// Why a scene's numbers are not there.
enum Trouble {
    Run(Error),
    /// The peer was asked for and failed.
    Oidn(String),
}

impl From<Error> for Trouble {
    fn from(error: Error) -> Trouble {
        Trouble::Run(error)
    }
}

/// A scene at work.
struct Bench<'a> {
    request: &'a Request,
    subject: &'a Subject,
    work: &'a Work<'a>,
    cancel: &'a AtomicBool,
}

type Outcome<T> = Result<T, Trouble>;

impl Bench<'_> {
    fn scene(&self) -> Outcome<Vec<Part>> {
        let Subject { desc, options } = self.subject;
        let core = CoreScene::new(desc).map_err(Error::from)?;
        let lent = core.lend();
        let path = run::path(desc, options)?;
        let mut cells = run::cells(options, path);
        let scene = core.scene(&lent).map_err(Error::from)?.foresee(&mut cells);
        let stage = Stage {
            scene: &scene,
            path,
            options,
            work: self.work,
            cancel: self.cancel,
        };
        run::pool(options.threads)?.install(|| self.parts(&stage, core.camera))
    }

    fn parts(&self, stage: &Stage, camera: Camera) -> Outcome<Vec<Part>> {
        let size = [stage.options.width as u16, stage.options.height as u16];
        let spp = self.request.reference_spp;
        let reference = stage.reference(camera, size, still_spp(spp), 0)?;
        let clean = stage.frame(camera, size, CLEAN, 1 << 15)?;
        let mut parts = Vec::new();
        for spp in [1, 4] {
            let frame = stage.frame(camera, size, spp, 0)?;
            parts.push(self.frame(stage, spp, &frame, &clean, &reference)?);
        }
        let still = vec![camera; FRAMES];
        let references = vec![reference; FRAMES];
        parts.push(self.clip(stage, Kind::Still, &still, &references)?);
        let flight = stage.flight(camera, size);
        let references = (1..)
            .zip(flight)
            .map(|(number, camera)| stage.reference(camera, size, spp, number));
        let references = references.collect::<Result<Vec<_>, _>>()?;
        parts.push(self.clip(stage, Kind::Moving, &flight, &references)?);
        parts.push(self.double(stage, camera)?);
        Ok(parts)
    }

    /// One frame by itself.
    fn frame(
        &self,
        stage: &Stage,
        spp: u32,
        frame: &Frame,
        clean: &Frame,
        truth: &Reference,
    ) -> Outcome<Part> {
        let core = |denoise| {
            let frames = frames(frame, spp, denoise, 1);
            clean::sequence(frames, |it| it.take(stage.scene, frame.camera, &frame.features))
        };
        let (atrous, ours) = (core(Denoise::Atrous), core(Denoise::Neural));
        // Of a first frame: its fireflies are clamped, and that is all.
        let guides = guided(frame.width, &ours.gathered);
        let bilateral = &BILATERAL[usize::from(spp > 2)];
        let smooth = classical::filter(&guides, classical::Kind::Bilateral, bilateral);
        let mut made = vec![
            (Method::Noisy, vec![frame.light.clone()]),
            (Method::Atrous, vec![pixels(&atrous)]),
            (Method::Bilateral, vec![lit(&smooth, &guides.albedo)]),
            (Method::Ours, vec![pixels(&ours)]),
        ];
        if let Some(oidn) = &self.request.oidn {
            let seen = |features: &[Feature], quality| {
                by_oidn(oidn, quality, frame.width, &frame.light, features).map(|light| vec![light])
            };
            made.extend([
                (Method::OidnFast, seen(&frame.features, Quality::Fast)?),
                (Method::OidnHigh, seen(&frame.features, Quality::High)?),
                (Method::OidnClean, seen(&clean.features, Quality::HighClean)?),
            ]);
        }
        let truths = std::slice::from_ref(truth);
        Ok(part(
            Kind::Frame(spp),
            [frame.width, frame.height],
            made,
            truths,
            &[],
        ))
    }

    /// Frames of one sample a pixel, by these cameras.
    fn clip(&self, stage: &Stage, kind: Kind, cameras: &[Camera], truths: &[Reference]) -> Outcome<Part> {
        let size = [stage.options.width as u16, stage.options.height as u16];
        let noisy = (0..)
            .zip(cameras)
            .map(|(seed, camera)| stage.frame(*camera, size, 1, seed));
        let noisy = noisy.collect::<Result<Vec<Frame>, _>>()?;
        let flown = |denoise, has_history: bool, taa: bool| -> Vec<Cleaned> {
            let mut frames = frames(&noisy[0], 1, denoise, 1);
            frames.cleaning.taa = taa;
            clean::sequence(frames, |sequence| {
                let one = |frame: &Frame| {
                    if !has_history {
                        sequence.forget();
                    }
                    sequence.take(stage.scene, frame.camera, &frame.features)
                };
                noisy.iter().map(one).collect()
            })
        };
        let all = |cleaned: &[Cleaned]| cleaned.iter().map(pixels).collect::<Vec<Light>>();
        let [ours, unsteady] = [true, false].map(|taa| flown(Denoise::Neural, true, taa));
        let alone = flown(Denoise::Neural, false, false);
        let mut made = vec![
            (
                Method::Noisy,
                noisy.iter().map(|frame| frame.light.clone()).collect(),
            ),
            (Method::Atrous, all(&flown(Denoise::Atrous, true, false))),
            (Method::OursAlone, all(&alone)),
            (Method::OursUnsteady, all(&unsteady)),
            (Method::Ours, all(&ours)),
        ];
        if let Some(oidn) = &self.request.oidn {
            let width = noisy[0].width;
            let each = noisy
                .iter()
                .map(|frame| by_oidn(oidn, Quality::High, width, &frame.light, &frame.features));
            made.push((Method::OidnHigh, each.collect::<Outcome<_>>()?));
            let gathered = ours.iter().map(|cleaned| {
                let light: Light = cleaned
                    .gathered
                    .iter()
                    .map(|pixel| linear(pixel.radiance()))
                    .collect();
                by_oidn(oidn, Quality::High, width, &light, &cleaned.gathered)
            });
            made.push((Method::OidnGathered, gathered.collect::<Outcome<_>>()?));
        }
        let befores = stage.befores(cameras, size);
        let mut part = part(kind, size.map(usize::from), made, truths, &befores);
        part.uncovered = (kind == Kind::Moving).then(|| uncovered(&ours, &alone, truths));
        Ok(part)
    }

    /// Twice as wide and high, of four samples for each rendered pixel.
    fn double(&self, stage: &Stage, camera: Camera) -> Outcome<Part> {
        let size = [stage.options.width as u16, stage.options.height as u16];
        let large = size.map(|side| 2 * side);
        let truth = stage.reference(camera, large, self.request.reference_spp, 0)?;
        let frame = stage.frame(camera, size, 4, 0)?;
        let full = stage.frame(camera, large, 1, 0)?;
        let ours = |denoise| {
            let frames = frames(&frame, 4, denoise, 2);
            let cleaned = clean::sequence(frames, |it| it.take(stage.scene, camera, &frame.features));
            vec![pixels(&cleaned)]
        };
        let mut made = vec![
            (Method::Noisy, vec![full.light.clone()]),
            (Method::Atrous, ours(Denoise::Atrous)),
            (Method::Ours, ours(Denoise::Neural)),
        ];
        if let Some(oidn) = &self.request.oidn {
            let small = by_oidn(oidn, Quality::High, frame.width, &frame.light, &frame.features)?;
            let irradiance = guided(frame.width, &frame.features).irradiance;
            let smooth = by_oidn(oidn, Quality::High, frame.width, &irradiance, &frame.features)?;
            let light: Vec<Rgb9e5> = smooth.iter().map(shared).collect();
            let clean = Clean {
                size: Size {
                    width: size[0],
                    height: size[1],
                },
                frame: &frame.features,
                light: &light,
                lengths: &[],
                spp: 4,
                whole: 1,
            };
            let raised = clean::show(
                frames(&frame, 4, Denoise::Off, 2),
                stage.scene,
                camera,
                &clean,
                None,
            );
            made.extend([
                (
                    Method::OidnBilinear,
                    vec![enlarged([frame.width, frame.height], &small)],
                ),
                (
                    Method::OidnUpsampled,
                    vec![raised.into_iter().map(linear).collect()],
                ),
                (
                    Method::OidnFull,
                    vec![by_oidn(
                        oidn,
                        Quality::High,
                        full.width,
                        &full.light,
                        &full.features,
                    )?],
                ),
            ]);
        }
        Ok(part(Kind::Double, large.map(usize::from), made, &[truth], &[]))
    }
}

/// Ours, of frames like this one.
fn frames(frame: &Frame, spp: u32, denoise: Denoise, upscale: u32) -> Frames {
    Frames {
        width: frame.width as u16 * upscale as u16,
        height: frame.height as u16 * upscale as u16,
        spp,
        cleaning: Cleaning {
            denoise,
            upscale,
            taa: false,
        },
    }
}

fn pixels(cleaned: &Cleaned) -> Light {
    cleaned.pixels.iter().map(|pixel| linear(*pixel)).collect()
}

/// By Open Image Denoise, with albedo and normals of these features.
fn by_oidn(
    oidn: &Oidn,
    quality: Quality,
    width: usize,
    light: &Light,
    features: &[Feature],
) -> Outcome<Light> {
    let guides = guided(width, features);
    let input = Input {
        width,
        light,
        albedo: &guides.albedo,
        normal: &guides.normal,
    };
    oidn.denoise(quality, input).map_err(Trouble::Oidn)
}

/// As the core keeps light.
fn shared(rgb: &[f32; 3]) -> Rgb9e5 {
    Rgb9e5::from_bits(rgb.map(|c| (c.max(0.0) * 65536.0) as u32), -16)
}

/// Twice as wide and high, a straight line between middles.
fn enlarged([width, height]: [usize; 2], small: &Light) -> Light {
    let place = |i: usize| {
        let (x, y) = (i % (2 * width), i / (2 * width));
        let middle = [x, y].map(|c| (c as f64 + 0.5) / 2.0);
        between([width, height], middle, |i| small[i].map(f64::from)).map(|c| c as f32)
    };
    (0..4 * width * height).map(place).collect()
}

/// Measures what was made.
fn part(
    kind: Kind,
    size: [usize; 2],
    made: Vec<(Method, Vec<Light>)>,
    truths: &[Reference],
    befores: &[Befores],
) -> Part {
    let halves: Vec<[Signals; 2]> = truths
        .iter()
        .map(|truth| [signals(&truth.halves[0]), signals(&truth.halves[1])])
        .collect();
    let references: Vec<Picture> = truths.iter().map(|truth| picture(size, &truth.mean)).collect();
    let tried = |(method, frames): (Method, Vec<Light>)| {
        let pictures: Vec<Picture> = frames.iter().map(|light| picture(size, light)).collect();
        let metrics = pictures.iter().zip(&references);
        let all: Vec<Signals> = frames.iter().map(|light| signals(light)).collect();
        Tried {
            method,
            shots: pictures.iter().map(|picture| Shot::of(picture, 0.0)).collect(),
            metrics: metrics
                .map(|(picture, truth)| Metrics::of(picture, truth).expect("finite and of one size"))
                .collect(),
            flicker: kind.is_clip().then(|| flicker(size, &all, &halves, befores)),
        }
    };
    Part {
        kind,
        reference_db: own_noise(&halves),
        reference: references.iter().map(|picture| Shot::of(picture, 0.0)).collect(),
        tried: made.into_iter().map(tried).collect(),
        uncovered: None,
    }
}

/// As it is compared and shown: x / (1 + x); what no float holds is black.
fn picture([width, height]: [usize; 2], light: &Light) -> Picture {
    Picture {
        width,
        height,
        rgb: light.iter().map(|rgb| compressed(*rgb)).collect(),
        ..Picture::default()
    }
}

/// PSNR of the mean of two halves, whose difference has four times its squared noise.
fn own_noise(halves: &[[Signals; 2]]) -> f64 {
    let squares = halves.iter().map(|[a, b]| mean_square(a.iter().zip(b)) / 4.0);
    decibels(super::mean(squares))
}

fn mean_square<'a>(pairs: impl Iterator<Item = (&'a [f64; 3], &'a [f64; 3])>) -> f64 {
    super::mean(pairs.flat_map(|(a, b)| [0, 1, 2].map(|c| (a[c] - b[c]).powi(2))))
}

fn decibels(mean_square: f64) -> f64 {
    (-10.0 * mean_square.log10()).min(PSNR_MAX)
}

/// How good pixels are that have no history, in frames that have one, against frames that have none at all.
fn uncovered(ours: &[Cleaned], alone: &[Cleaned], truths: &[Reference]) -> Uncovered {
    let (mut pixels, mut all, mut sums) = (0, 0, [0.0; 2]);
    for ((ours, alone), truth) in ours.iter().zip(alone).zip(truths).skip(1) {
        let truth = signals(&truth.mean);
        let seen = [ours, alone].map(|cleaned| signals(&self::pixels(cleaned)));
        all += truth.len();
        for (at, length) in ours.lengths.iter().enumerate() {
            if *length == 1 {
                pixels += 1;
                for (sum, seen) in sums.iter_mut().zip(&seen) {
                    *sum += mean_square([(&seen[at], &truth[at])].into_iter());
                }
            }
        }
    }
    let [with_history, without] = sums.map(|sum| decibels(sum / pixels.max(1) as f64));
    Uncovered {
        pixels,
        share: pixels as f64 / all.max(1) as f64,
        with_history,
        without,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twice_the_size_is_a_straight_line_between_middles() {
        let small: Light = (0..6).map(|i| [(i % 3) as f32, (i / 3) as f32, 0.5]).collect();
        let large = enlarged([3, 2], &small);
        let row = |channel: usize| -> Vec<f32> { large[6..12].iter().map(|rgb| rgb[channel]).collect() };
        assert_eq!(row(0), [0.0, 0.25, 0.75, 1.25, 1.75, 2.0]);
        assert_eq!((row(1), row(2)), (vec![0.25; 6], vec![0.5; 6]));
    }

    #[test]
    fn the_reference_s_own_noise_is_known_from_its_halves() {
        let half = |sign: f64| -> Signals {
            let noise = |i: usize| {
                if i.is_multiple_of(2) {
                    sign * 0.02
                } else {
                    -sign * 0.02
                }
            };
            (0..64).map(|i| [0.5 + noise(i); 3]).collect()
        };
        // Halves that are off by 0.02 each have a mean that is off by 0.02/√2.
        let db = own_noise(&[[half(1.0), half(-1.0)]]);
        assert!((db - -20.0 * (0.02f64).log10()).abs() < 1e-9, "{db}");
        assert_eq!(own_noise(&[[half(1.0), half(1.0)]]), PSNR_MAX);
    }

    #[test]
    fn only_pixels_without_history_are_uncovered() {
        let cleaned = |level: f32, lengths: [u8; 4]| Cleaned {
            pixels: vec![microlux::color::Radiance::from_bits([(level * 32768.0) as u32; 3], -15); 4],
            gathered: Vec::new(),
            lengths: lengths.to_vec(),
        };
        let light: Light = vec![[0.5; 3]; 4];
        let truth = Reference {
            halves: [light.clone(), light.clone()],
            mean: light,
        };
        let truths = vec![truth; 2];
        // The first frame has no history at all and does not count; of the second one pixel has none.
        let ours = [cleaned(9.0, [1; 4]), cleaned(0.25, [2, 1, 2, 8])];
        let alone = [cleaned(9.0, [1; 4]), cleaned(0.5, [1; 4])];
        let found = uncovered(&ours, &alone, &truths);
        assert_eq!((found.pixels, found.share, found.without), (1, 0.25, PSNR_MAX));
        let off = signals(&[[0.5; 3]])[0][0] - signals(&[[0.25; 3]])[0][0];
        assert!(
            (found.with_history - -20.0 * off.log10()).abs() < 0.05,
            "{found:?}"
        );
    }
}
