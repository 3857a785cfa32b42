//! Noisy pictures and their references, rendered by the core itself, and the file that keeps them.

use std::fs;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use half::f16;
use host_sim::desc::{GeometryDesc, LightDesc, SceneDesc};
use host_sim::quantise::CoreScene;
use indicatif::{ProgressBar, ProgressStyle};
use microlux::color::{Radiance, mean_q32};
use microlux::film::Feature;
use microlux::film::feature::{DEPTH_NOTHING, Sum, depth_code};
use microlux::integrator::{First, Integrator, Path as PathTracer, View};
use microlux::render;
use microlux::sampler::{Sampler, Sobol};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use crate::scenes::{Split, by_hand};

/// Samples of a pixel that are kept one by one: any aligned 1, 2, 4, 8 or 16 of them are a picture of that many.
pub const SAMPLES: usize = 16;

const MAGIC: &[u8; 8] = b"mlxdata3";

/// What one sample says of its pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    pub radiance: [f16; 3],
    /// 255 is 1.
    pub albedo: [u8; 3],
    /// 127 is 1.
    pub normal: [i8; 3],
    /// Sixteenths of an octave.
    pub depth: u8,
}

const SAMPLE_BYTES: usize = 13;

/// A scene's noisy samples and its reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Shot {
    pub name: String,
    pub side: usize,
    /// [`SAMPLES`] a pixel, pixel by pixel.
    pub samples: Vec<Sample>,
    /// Radiance.
    pub reference: Vec<[f32; 3]>,
    pub reference_spp: u32,
}

#[derive(Clone, Debug, clap::Args)]
pub struct Options {
    /// Folder that gets a file for each scene; scenes that are there already are left as they are
    #[arg(long, default_value = "data")]
    out: PathBuf,
    /// Which scenes; all if none is named
    #[arg(long, value_enum)]
    split: Vec<Split>,
    /// Scenes for training; a tenth of that for validation
    #[arg(long, default_value_t = 64)]
    scenes: u32,
    /// Scenes of each test family made by program
    #[arg(long, default_value_t = 4)]
    test_scenes: u32,
    /// Width and height in pixels
    #[arg(long, default_value_t = 80)]
    side: u32,
    /// Samples a pixel of the references for training
    #[arg(long, default_value_t = 256)]
    train_spp: u32,
    /// Samples a pixel of the references for validation
    #[arg(long, default_value_t = 512)]
    validation_spp: u32,
    /// Samples a pixel of the references for test
    #[arg(long, default_value_t = 2048)]
    test_spp: u32,
    /// Threads; the files are the same for any number
    #[arg(long, default_value_t = 1)]
    threads: usize,
}

/// The scenes of a split, `each` of a family, and for each the number that seeds its exposure and its noise.
fn scenes(split: Split, each: u32, side: u32) -> Vec<(SceneDesc, u32, bool)> {
    let (families, hand) = split.families();
    let made = (0..each).flat_map(|n| {
        families
            .iter()
            .map(move |f| (f.scene(n, side), n * 16 + *f as u32, true))
    });
    let hand = hand
        .iter()
        .zip(1 << 16..)
        .map(|(name, seed)| (by_hand(name, side), seed, false));
    made.chain(hand).collect()
}

pub fn run(options: &Options) -> Result<()> {
    let splits = if options.split.is_empty() {
        Split::ALL.to_vec()
    } else {
        options.split.clone()
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads)
        .build()?;
    for split in splits {
        let folder = options.out.join(split.name());
        fs::create_dir_all(&folder).with_context(|| format!("{}", folder.display()))?;
        let spp = match split {
            Split::Train => options.train_spp,
            Split::Validation => options.validation_spp,
            Split::Test => options.test_spp,
        };
        let families = split.families().0.len() as u32;
        let each = match split {
            Split::Train => options.scenes.div_ceil(families),
            Split::Validation => options.scenes.div_ceil(10 * families),
            Split::Test => options.test_scenes,
        };
        let scenes = scenes(split, each, options.side);
        let bar = ProgressBar::new(scenes.len() as u64).with_style(ProgressStyle::with_template(
            "{prefix:10} {wide_bar} {pos}/{len} {eta} {msg}",
        )?);
        bar.set_prefix(split.name());
        let one = |(desc, seed, dim): &(SceneDesc, u32, bool)| -> Result<()> {
            bar.set_message(desc.name.clone());
            let file = folder.join(format!("{}.shot", desc.name));
            if !file.exists() {
                let shot = shoot(desc, *seed, *dim, spp).with_context(|| desc.name.clone())?;
                shot.write(&file)?;
            }
            bar.inc(1);
            Ok(())
        };
        pool.install(|| scenes.par_iter().try_for_each(one))?;
        bar.finish();
        println!(
            "{}: {} scenes, references of {spp} spp",
            split.name(),
            scenes.len()
        );
    }
    Ok(())
}

/// Samples and reference of one scene; for `dim` see [`lit`].
fn shoot(desc: &SceneDesc, seed: u32, dim: bool, spp: u32) -> Result<Shot> {
    let desc = lit(desc, seed, dim)?;
    let side = desc.width as usize;
    // Two sequences: the noisy samples are none of the reference's.
    let mut samples = Vec::new();
    trace(&desc, side, 2 * seed + 1, SAMPLES as u32, |seen| {
        samples.push(seen.map_or(Sample::default(), |(light, first)| sample(light, first)));
    })?;
    let reference = trace(&desc, side, 2 * seed, spp, |_| ())?;
    Ok(Shot {
        name: desc.name.clone(),
        side,
        samples,
        reference,
        reference_spp: spp,
    })
}

/// The film's pixels of the first `count` samples of a shot for test, rendered once more: numbers of things are not in its
/// file.
pub fn frame(shot: &Shot, count: usize) -> Result<Vec<Feature>> {
    let number = shot.name.rsplit('-').next().and_then(|n| n.parse::<u32>().ok());
    let scenes = scenes(Split::Test, number.map_or(0, |n| n + 1), shot.side as u32);
    let scene = scenes.iter().find(|(desc, ..)| desc.name == shot.name);
    let (desc, seed, dim) = scene.with_context(|| format!("{}: no scene for test", shot.name))?;
    let (mut pixels, mut sum, mut samples) = (Vec::new(), Sum::default(), 0);
    trace(
        &lit(desc, *seed, *dim)?,
        shot.side,
        2 * seed + 1,
        count as u32,
        |seen| {
            if let Some((radiance, first)) = seen {
                sum.add(&render::sample(radiance, first));
            }
            samples += 1;
            if samples % count == 0 {
                pixels.push(core::mem::take(&mut sum).mean());
            }
        },
    )?;
    Ok(pixels)
}

/// `dim`: a scene's lights are made brighter or darker, to an exposure drawn from `seed`.
fn lit(desc: &SceneDesc, seed: u32, dim: bool) -> Result<SceneDesc> {
    let mut desc = desc.clone();
    if dim {
        let small = trace(&desc, 24, seed ^ 0x5eed, 8, |_| ())?;
        // What is black all over has no exposure.
        let seen: Vec<f64> = small.iter().map(|[r, g, b]| f64::from(r + g + b)).collect();
        let most = seen.iter().copied().fold(1e-6, f64::max);
        let logs: Vec<f64> = seen
            .iter()
            .filter(|&&x| x > 1e-4 * most)
            .map(|x| x.ln())
            .collect();
        let mean = (logs.iter().sum::<f64>() / logs.len().max(1) as f64).exp() / 3.0;
        let mut rng = Pcg64Mcg::seed_from_u64(u64::from(seed) + 77);
        let wanted = 0.03 * 16f64.powf(rng.random_range(0.0..1.0));
        brighten(&mut desc, wanted / mean);
    }
    Ok(desc)
}

/// Means of radiance; `seen` is told each sample, pixel by pixel, where there is a ray.
fn trace(
    desc: &SceneDesc,
    side: usize,
    seed: u32,
    spp: u32,
    mut seen: impl FnMut(Option<(Radiance, &First)>),
) -> Result<Vec<[f32; 3]>> {
    let core = CoreScene::new(desc)?;
    let lent = core.lend();
    let scene = core.scene(&lent)?;
    let film = core.camera.film(side as u16, side as u16);
    let view = View::new(&scene, &film);
    let tracer = PathTracer {
        max_depth: desc.integrator.max_depth.unwrap_or(8) as u16,
        rr_depth: desc.integrator.rr_depth as u16,
        hide_emitters: false,
    };
    let mut sampler = Sobol::new(seed);
    let mut means = Vec::new();
    for y in 0..side as u16 {
        for x in 0..side as u16 {
            let mut sum = [0u64; 3];
            for index in 0..spp {
                sampler.start(x, y, index);
                let (place, lens) = (sampler.next_2d(), sampler.next_2d());
                let mut light = Radiance::BLACK;
                if let Some(ray) = film.ray(x, y, place, lens) {
                    let (found, first) = tracer.sense(&view, ray, &mut sampler, &mut 0);
                    light = found;
                    seen(Some((light, &first)));
                } else {
                    seen(None);
                }
                sum.iter_mut()
                    .zip(light.to_q32())
                    .for_each(|(sum, light)| *sum += light);
            }
            means.push(linear(mean_q32(sum, spp)));
        }
    }
    Ok(means)
}

fn linear(light: Radiance) -> [f32; 3] {
    let (m, e) = light.to_parts();
    m.map(|m| f32::from(m) * (f32::from(e) - 15.0).exp2())
}

/// A sample as the film takes it, in the file's numbers.
fn sample(light: Radiance, first: &First) -> Sample {
    let albedo = first.albedo.0.map(|share| f32::from(share.to_bits()) / 32768.0);
    let albedo = albedo.map(|a| a.clamp(1.0 / 32.0, 1.0));
    Sample {
        radiance: linear(light).map(|c| f16::from_f32(c.min(65504.0))),
        albedo: albedo.map(|a| (a * 255.0).round() as u8),
        normal: first
            .normal
            .0
            .map(|c| (f64::from(c) / 65536.0 * 127.0).round() as i8),
        // As the network sees it: a sky is one in a mirror, too.
        depth: match (first.id, first.distance) {
            (Some(_), Some(distance)) => depth_code(distance),
            _ => DEPTH_NOTHING,
        },
    }
}

/// All lights `by` times as bright.
fn brighten(desc: &mut SceneDesc, by: f64) {
    let more = |light: &mut [f64; 3]| light.iter_mut().for_each(|c| *c *= by);
    for shape in &mut desc.shapes {
        if let Some(emission) = &mut shape.emission {
            more(emission);
        }
        debug_assert!(!matches!(shape.geometry, GeometryDesc::Instance(_)));
    }
    for light in &mut desc.lights {
        match light {
            LightDesc::Point { intensity, .. } => more(intensity),
            LightDesc::Directional { irradiance, .. } => more(irradiance),
            LightDesc::Constant { radiance } => more(radiance),
            LightDesc::Gradient {
                zenith,
                horizon,
                ground,
                sun,
                ..
            } => {
                [zenith, horizon, ground].into_iter().for_each(more);
                if let Some(sun) = sun {
                    more(&mut sun.radiance);
                }
            }
            LightDesc::EnvMap { pixels, .. } => pixels.iter_mut().for_each(more),
        }
    }
}

impl Shot {
    /// Written beside and renamed, so that a file that is there is whole.
    fn write(&self, file: &Path) -> Result<()> {
        let mut bytes = Vec::new();
        bytes.extend_from_slice(MAGIC);
        bytes.extend_from_slice(&(self.side as u32).to_le_bytes());
        bytes.extend_from_slice(&self.reference_spp.to_le_bytes());
        for s in &self.samples {
            s.radiance
                .iter()
                .for_each(|c| bytes.extend_from_slice(&c.to_le_bytes()));
            bytes.extend_from_slice(&s.albedo);
            bytes.extend(s.normal.map(|c| c as u8));
            bytes.push(s.depth);
        }
        for pixel in &self.reference {
            pixel
                .iter()
                .for_each(|c| bytes.extend_from_slice(&c.to_le_bytes()));
        }
        let beside = file.with_extension("part");
        fs::File::create(&beside)?.write_all(&bytes)?;
        Ok(fs::rename(beside, file)?)
    }

    pub fn read(file: &Path) -> Result<Shot> {
        let mut bytes = Vec::new();
        fs::File::open(file)?.read_to_end(&mut bytes)?;
        ensure!(
            bytes.len() > 16 && &bytes[..8] == MAGIC,
            "{}: not of this trainer",
            file.display()
        );
        let word = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        let side = word(8) as usize;
        let (count, body) = (side * side * SAMPLES, &bytes[16..]);
        if body.len() != count * SAMPLE_BYTES + side * side * 12 {
            bail!("{}: {} bytes do not fit its size", file.display(), bytes.len());
        }
        let (samples, reference) = body.split_at(count * SAMPLE_BYTES);
        let samples = samples.chunks_exact(SAMPLE_BYTES).map(|b| Sample {
            radiance: [0, 2, 4].map(|i| f16::from_le_bytes([b[i], b[i + 1]])),
            albedo: [b[6], b[7], b[8]],
            normal: [b[9] as i8, b[10] as i8, b[11] as i8],
            depth: b[12],
        });
        let reference = reference
            .chunks_exact(12)
            .map(|b| [0, 4, 8].map(|i| f32::from_le_bytes([b[i], b[i + 1], b[i + 2], b[i + 3]])));
        Ok(Shot {
            name: file
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned(),
            side,
            samples: samples.collect(),
            reference: reference.collect(),
            reference_spp: word(12),
        })
    }

    /// All files of a split, by name.
    pub fn read_all(data: &Path, split: Split) -> Result<Vec<Shot>> {
        let folder = data.join(split.name());
        let entries =
            fs::read_dir(&folder).with_context(|| format!("{}: run `data` first", folder.display()))?;
        let mut files: Vec<PathBuf> = entries.map(|e| Ok(e?.path())).collect::<Result<_>>()?;
        files.retain(|f| f.extension().is_some_and(|e| e == "shot"));
        files.sort();
        ensure!(!files.is_empty(), "{}: empty, run `data` first", folder.display());
        files.iter().map(|f| Shot::read(f)).collect()
    }
}
