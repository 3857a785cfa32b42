//! How good the filter is on scenes that training never saw, beside others.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use host_sim::metrics::Metrics;
use host_sim::oidn::{self, Oidn, Quality};
use host_sim::picture;
use indicatif::{ProgressBar, ProgressStyle};
use microlux::color::{Radiance, Rgb9e5};
use microlux::film::denoise::network::{INPUTS, Input, Neural, TRAINED, Weights, exposure, irradiance};
use microlux::film::denoise::{self, Denoiser, Filter, Memory, Pair, ROWS, Seen};
use microlux::film::feature::{DEPTH_NOTHING, Feature, ID_NOTHING};
use microlux::render::Motion;

use crate::classical::{self, Guides, Kind};
use crate::data::{self, SAMPLES, Shot};
use crate::export;
use crate::nn::{self, Light, Mode, Params, Planes};
use crate::picture::Picture;
use crate::scenes::Split;
use crate::size::Size;
use crate::train::State;

#[derive(Clone, Debug, clap::Args)]
pub struct Options {
    /// Folder that `data` filled
    #[arg(long, default_value = "data")]
    data: PathBuf,
    /// What `train` left; without it the weights that the crate has
    #[arg(long)]
    state: Option<PathBuf>,
    /// The folder `pyoidn/oidn` of the Python package `pyoidn`, for Open Image Denoise beside ours
    #[arg(long)]
    oidn: Option<PathBuf>,
    /// Folder that gets a strip of pictures for each scene: noisy, each method, reference
    #[arg(long)]
    pictures: Option<PathBuf>,
    /// Markdown that is written
    #[arg(long, default_value = "evaluation.md")]
    out: PathBuf,
}

/// Light of each pixel, linear.
pub type Rgb = Vec<[f32; 3]>;

/// Scenes that training never saw, of `count` samples a pixel, and what other filters make of them.
pub struct Ground<'a> {
    shots: &'a [Shot],
    count: usize,
    /// À-trous and joint bilateral: guides, and whether the clamp of fireflies comes before.
    tuned: [(Guides, bool); 2],
    oidn: Option<&'a Oidn>,
}

impl<'a> Ground<'a> {
    pub fn new(shots: &'a [Shot], validation: &[Shot], count: usize, oidn: Option<&'a Oidn>) -> Ground<'a> {
        let clamped: Vec<Picture> = validation.iter().map(|s| Picture::whole(s, 0, count)).collect();
        let untouched: Vec<Picture> = validation.iter().map(|s| Picture::untouched(s, count)).collect();
        // Each with the clamp of fireflies or without, whichever is better for it.
        let tuned = [Kind::ATrous, Kind::Bilateral].map(|kind| {
            let [(with, a), (without, b)] = [&clamped, &untouched].map(|p| classical::tune(p, kind));
            if with <= without { (a, true) } else { (b, false) }
        });
        Ground {
            shots,
            count,
            tuned,
            oidn,
        }
    }

    /// The noisy picture itself, à-trous, joint bilateral.
    pub fn classical(&self, shot: &Shot) -> [Rgb; 3] {
        let [atrous, bilateral] = [Kind::ATrous, Kind::Bilateral].map(|kind| {
            let (guides, clamp) = &self.tuned[kind as usize];
            let scene = if *clamp {
                Picture::whole(shot, 0, self.count)
            } else {
                Picture::untouched(shot, self.count)
            };
            lit(&scene, &classical::filter(&scene, kind, guides))
        });
        [radiance(shot, self.count), atrous, bilateral]
    }

    /// Open Image Denoise, fast and high, if it is there.
    pub fn oidn(&self, shot: &Shot) -> Result<Vec<Rgb>> {
        let Some(oidn) = self.oidn else {
            return Ok(Vec::new());
        };
        let scene = Picture::whole(shot, 0, self.count);
        let noisy = radiance(shot, self.count);
        let qualities = [Quality::Fast, Quality::High];
        let each = qualities.map(|quality| by_oidn(oidn, quality, &scene, &noisy));
        each.into_iter().collect()
    }

    /// The rounded network of any size in the core's place: between the core's clamp and its mixing of outlines, its filter in
    /// `f32`.
    pub fn in_core(&self, shot: &Shot, params: &Params) -> Result<Rgb> {
        let mut filter = InCore {
            params: params.seen(Mode::Integer),
            samples: self.count as u32,
        };
        core(&mut filter, data::frame(shot, self.count)?, shot.side, self.count)
    }

    /// The trainer's network.
    pub fn network(&self, shot: &Shot, params: &Params, mode: Mode) -> Rgb {
        let scene = Picture::whole(shot, 0, self.count);
        let trace = nn::extract(&params.seen(mode), scene.input(), mode);
        let light = scene.filter(&trace.heads, mode).out.swap_remove(0);
        lit(&scene, &light)
    }

    /// PSNR (dB), SSIM and FLIP of some filters, the mean of all scenes.
    pub fn means(&self, filters: impl Fn(&Shot) -> Result<Vec<Rgb>>) -> Result<Vec<[f64; 3]>> {
        let mut means = Vec::new();
        for shot in self.shots {
            let made = filters(shot)?;
            means.resize(made.len(), [0.0; 3]);
            for (mean, made) in means.iter_mut().zip(&made) {
                let values = measure(shot.side, made, &shot.reference)?;
                (0..3).for_each(|k| mean[k] += values[k] / self.shots.len() as f64);
            }
        }
        Ok(means)
    }
}

pub fn open_image_denoise(folder: Option<&Path>) -> Result<Option<Oidn>> {
    let oidn = folder.map(Oidn::at).transpose();
    oidn.map_err(|error| anyhow!(error))
}

pub fn run(options: &Options) -> Result<()> {
    let shots = Shot::read_all(&options.data, Split::Test)?;
    let validation = Shot::read_all(&options.data, Split::Validation)?;
    let params = params(options.state.as_deref())?;
    let (weights, biases) = export::rounded(&params)?;
    let weights = Weights::new(&weights, &biases).map_err(|error| anyhow!("{error:?}"))?;

    let oidn = open_image_denoise(options.oidn.as_deref())?;
    let mut text = String::new();
    for count in [1, 4] {
        let ground = Ground::new(&shots, &validation, count, oidn.as_ref());
        let mut methods = vec![
            "noisy",
            "à-trous",
            "joint bilateral",
            "ours, float",
            "ours, integers",
            "ours, the core",
        ];
        if options.oidn.is_some() {
            methods.extend(["OIDN fast", "OIDN high"]);
        }
        let mut sums = vec![[0.0; 3]; methods.len()];
        let bar = ProgressBar::new(shots.len() as u64).with_style(ProgressStyle::with_template(
            "{prefix} {wide_bar} {pos}/{len} {msg}",
        )?);
        bar.set_prefix(format!("{count} spp"));
        let mut each = String::new();
        for shot in &shots {
            bar.set_message(shot.name.clone());
            let mut results = ground.classical(shot).to_vec();
            results.extend([Mode::Float, Mode::Integer].map(|mode| ground.network(shot, &params, mode)));
            results.push(ours(weights, shot, count)?);
            results.extend(ground.oidn(shot)?);
            write!(each, "| `{}` |", shot.name)?;
            for (i, result) in results.iter().enumerate() {
                let values = measure(shot.side, result, &shot.reference)?;
                (0..3).for_each(|k| sums[i][k] += values[k]);
                write!(each, " {:.2} |", values[0])?;
            }
            writeln!(each)?;
            if let Some(folder) = &options.pictures {
                fs::create_dir_all(folder)?;
                results.push(shot.reference.clone());
                strip(
                    &folder.join(format!("{}-{count}.png", shot.name)),
                    shot.side,
                    &results,
                )?;
            }
            bar.inc(1);
        }
        bar.finish();
        let spp = shots[0].reference_spp;
        writeln!(
            text,
            "{count} spp, {} scenes, references of {spp} spp:\n",
            shots.len()
        )?;
        writeln!(text, "| | PSNR, dB | SSIM | FLIP |\n|---|--:|--:|--:|")?;
        for (name, sum) in methods.iter().zip(&sums) {
            let [psnr, ssim, flip] = sum.map(|x| x / shots.len() as f64);
            writeln!(text, "| {name} | {psnr:.2} | {ssim:.4} | {flip:.4} |")?;
        }
        writeln!(
            text,
            "\nPSNR of each scene:\n\n| | {} |\n|---|{}",
            methods.join(" | "),
            "--:|".repeat(methods.len())
        )?;
        writeln!(text, "{each}")?;
        let [atrous, bilateral] = &ground.tuned;
        writeln!(
            text,
            "Guides (normal, distance, albedo, light): à-trous {atrous:?}, joint bilateral {bilateral:?}.\n"
        )?;
    }
    fs::write(&options.out, &text)?;
    println!("{text}");
    Ok(())
}

/// Of a state, or those that the crate has.
pub fn params(state: Option<&Path>) -> Result<Params> {
    if let Some(file) = state {
        return Ok(State::read(file)?.params);
    }
    let (weights, biases) = TRAINED.tables();
    Ok(Params {
        size: Size::Xs,
        weights: weights.iter().map(|&w| w.into()).collect(),
        biases: biases.iter().map(|&b| b.into()).collect(),
    })
}

/// The noisy picture itself.
fn radiance(shot: &Shot, count: usize) -> Rgb {
    let pixels = shot.samples.chunks_exact(SAMPLES);
    pixels
        .map(|samples| {
            let mut sum = [0.0; 3];
            for s in &samples[..count] {
                for (sum, light) in sum.iter_mut().zip(s.radiance) {
                    *sum += light.to_f32() / count as f32;
                }
            }
            sum
        })
        .collect()
}

fn lit(scene: &Picture, light: &[Light]) -> Rgb {
    let pixels = light.iter().zip(&scene.albedo);
    pixels
        .map(|(l, a)| [l[0] * a[0], l[1] * a[1], l[2] * a[2]])
        .collect()
}

/// By the core's denoiser, one frame without history.
fn core(filter: &mut impl Filter, frame: Vec<Feature>, width: usize, samples: usize) -> Result<Rgb> {
    let size = size(&frame, width);
    let mut frames = [frame, vec![Feature::default(); size.pixels()]];
    let mut lengths = [vec![0; size.pixels()], vec![0; size.pixels()]];
    let mut rows = vec![Rgb9e5::BLACK; ROWS * width];
    let [a, b] = &mut frames;
    let [c, d] = &mut lengths;
    let memory = Memory {
        frames: [a, b],
        lengths: [c, d],
        rows: &mut rows,
    };
    let mut denoiser = Denoiser::new(size, samples as u32, memory)?;
    let clean = denoiser.denoise(None::<&Motion>, filter);
    let linear = |light: Radiance| {
        let (m, e) = light.to_parts();
        m.map(|m| f32::from(m) * (f32::from(e) - 15.0).exp2())
    };
    let mut ring = vec![Seen::default(); 3 * width];
    let mut pixels = Vec::new();
    clean.rows(0..size.height, &mut ring, |_, row| {
        pixels.extend(row.lights().map(linear))
    });
    Ok(pixels)
}

fn size(frame: &[Feature], width: usize) -> denoise::Size {
    denoise::Size {
        width: width as u16,
        height: (frame.len() / width) as u16,
    }
}

/// By the network, in the core.
fn ours(weights: Weights, shot: &Shot, count: usize) -> Result<Rgb> {
    let frame = data::frame(shot, count)?;
    let size = size(&frame, shot.side);
    let mut memory = vec![0; Neural::needs(size)];
    let mut neural = Neural::new(weights, size, count as u32, &mut memory)?;
    core(&mut neural, frame, shot.side, count)
}

/// [`Neural`] by the trainer's means.
struct InCore {
    params: Params,
    samples: u32,
}

impl Filter for InCore {
    fn filter(
        &mut self,
        _: &impl Pair,
        size: denoise::Size,
        frame: &[Feature],
        lengths: &[u8],
        scratch: denoise::Scratch,
    ) {
        let exposure = exposure(frame);
        let mut input = Planes::new(INPUTS, size.height.into(), size.width.into());
        for (at, (pixel, length)) in frame.iter().zip(lengths).enumerate() {
            let seen = Input::new(pixel, self.samples * u32::from(*length), exposure);
            for (channel, value) in seen.to_bits().into_iter().enumerate() {
                input.data[channel * frame.len() + at] = value.into();
            }
        }
        let own: Vec<Light> = frame
            .iter()
            .map(|pixel| {
                let [r, g, b] = irradiance(pixel).map(f32::from);
                [r, g, b, 0.0]
            })
            .collect();
        let trace = nn::extract(&self.params, input, Mode::Integer);
        let filtered = nn::filter(&own, &trace.heads, Mode::Integer);
        for (at, light) in scratch.light.iter_mut().enumerate() {
            let nothing = frame[at].depth == DEPTH_NOTHING && frame[at].id == ID_NOTHING;
            let [r, g, b, _] = if nothing { own[at] } else { filtered.out[0][at] };
            *light = Rgb9e5::from_bits([r, g, b].map(|c| (c + 0.5) as u32), -12);
        }
    }
}

/// By Open Image Denoise, with albedo and normals of the same few samples.
fn by_oidn(oidn: &Oidn, quality: Quality, scene: &Picture, noisy: &Rgb) -> Result<Rgb> {
    let input = oidn::Input {
        width: scene.width,
        light: noisy,
        albedo: &scene.albedo,
        normal: &scene.normal,
    };
    oidn.denoise(quality, input).map_err(|error| anyhow!(error))
}

fn picture_of(width: usize, rgb: Rgb) -> picture::Picture {
    picture::Picture {
        width,
        height: rgb.len() / width,
        rgb,
        ..picture::Picture::default()
    }
}

/// PSNR (dB), SSIM and FLIP of sRGB signals of x / (1 + x).
fn measure(width: usize, rgb: &Rgb, reference: &Rgb) -> Result<[f64; 3]> {
    let mapped = |rgb: &Rgb| {
        let light = rgb.iter().map(|rgb| picture::compressed(*rgb));
        picture_of(width, light.collect())
    };
    let metrics = Metrics::of(&mapped(rgb), &mapped(reference))?;
    Ok([metrics.psnr_db, metrics.ssim, metrics.flip])
}

/// Pictures side by side, each pixel three wide.
fn strip(file: &Path, side: usize, pictures: &[Rgb]) -> Result<()> {
    let scale = 2;
    let mut strip = image::RgbImage::new((pictures.len() * side * scale) as u32, (side * scale) as u32);
    for (x, y, pixel) in strip.enumerate_pixels_mut() {
        let (x, y) = (x as usize / scale, y as usize / scale);
        let rgb = pictures[x / side][y * side + x % side];
        let light = picture::compressed(rgb);
        *pixel = image::Rgb(light.map(|c| (picture::srgb(f64::from(c)) * 255.0).round() as u8));
    }
    Ok(strip.save(file)?)
}

#[cfg(test)]
mod tests {
    use microlux::film::denoise::Off;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use microlux::film::feature::albedo_code;
    use microlux::geom::{Dir, Octahedral};
    use microlux::num::Share;

    use super::*;

    /// Features as the film has them.
    fn features(scene: &Picture) -> Vec<Feature> {
        (0..scene.depth.len())
            .map(|at| {
                let [r, g, b, _] = scene.irradiance[at].map(|c| (c * 65536.0) as u32);
                let share = |a: f32| Share::from_bits((a * 32768.0).round() as u16);
                let normal = scene.normal[at].map(|c| (c * 65536.0) as i32);
                Feature {
                    irradiance: Rgb9e5::from_bits([r, g, b], -16),
                    albedo: scene.albedo[at].map(|a| albedo_code(share(a))),
                    depth: scene.depth[at].round() as u8,
                    normal: Octahedral::encode(Dir::new(normal).unwrap_or(Dir::Z)),
                    id: 0,
                }
            })
            .collect()
    }

    /// Fireflies are clamped, and exposures judged, as the core does.
    #[test]
    fn pictures_are_seen_as_the_core_sees_them() {
        let (width, height) = (23, 17);
        let mut rng = Pcg64Mcg::seed_from_u64(4);
        for octaves in [-5, -1, 2] {
            let grey = |rng: &mut Pcg64Mcg| {
                let fly = if rng.random_bool(0.1) {
                    rng.random_range(0..12)
                } else {
                    0
                };
                let m = if rng.random_bool(0.5) {
                    0.0
                } else {
                    rng.random_range(256..288) as f32
                };
                [m * 2f32.powi(octaves - 8 + fly); 3]
            };
            let light: Vec<[f32; 3]> = (0..width * height).map(|_| grey(&mut rng)).collect();
            let mut scene = Picture {
                width,
                height,
                irradiance: light.iter().map(|l| [l[0], l[1], l[2], 0.0]).collect(),
                albedo: vec![[1.0; 3]; width * height],
                normal: vec![[0.0, 0.0, 1.0]; width * height],
                depth: vec![90.0; width * height],
                reference: light,
                samples: 1,
                exposure: 0,
            };
            let by_core = core(&mut Off, features(&scene), width, 1).unwrap();
            scene.clamp();
            let mut clamped = 0;
            for (at, (a, b)) in by_core.iter().zip(&scene.irradiance).enumerate() {
                assert!(
                    (a[0].min(16.0) - b[0]).abs() < 0.01 * b[0].max(1e-3),
                    "{at}: {a:?} {b:?}"
                );
                clamped += usize::from(b[0] != scene.reference[at][0].min(16.0));
            }
            assert!(clamped > 8, "{clamped}");
            let (ours, cores) = (scene.exposed(), exposure(&features(&scene)));
            assert!(ours == cores && ours != 0, "{ours} {cores}");
        }
    }
}
