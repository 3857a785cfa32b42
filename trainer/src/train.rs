//! The training itself: crops, gradients, Adam, and a file to go on from.

use std::fs;
use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use indicatif::{ProgressBar, ProgressStyle};
use microlux::film::denoise::network::LEVELS;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use crate::data::{SAMPLES, Shot};
use crate::nn::{self, Mode, Params};
use crate::picture::{self, Picture};
use crate::scenes::Split;
use crate::size::Size;

#[derive(Clone, Debug, clap::Args)]
pub struct Options {
    /// Channels of the network
    #[arg(long, value_enum, default_value_t)]
    size: Size,
    /// File that training goes on from, if it is there, and leaves
    #[arg(long, default_value = "state.bin")]
    state: PathBuf,
    /// Text that gets a line every `--every` steps
    #[arg(long, default_value = "train.txt")]
    log: PathBuf,
    /// Stop after this step, with the learning rate of `--steps`
    #[arg(long)]
    until: Option<u32>,
    #[command(flatten)]
    recipe: Recipe,
    /// Threads; the weights are the same for any number
    #[arg(long, default_value_t = 1)]
    threads: usize,
}

/// With what, and how, a network of any size is trained.
#[derive(Clone, Debug, clap::Args)]
pub struct Recipe {
    /// Folder that `data` filled
    #[arg(long, default_value = "data")]
    pub data: PathBuf,
    /// Steps in all but for `--again`; the learning rate falls over them
    #[arg(long, default_value_t = 20_000)]
    pub steps: u32,
    /// Further steps, rounded from their first on and with a learning rate of their own, before which the finest heads know
    /// nothing of what is seen of the pixel itself; without them they do from the beginning
    #[arg(long, default_value_t = 0)]
    again: u32,
    /// Learning rate at the top of those
    #[arg(long, default_value_t = 1.5e-3)]
    again_rate: f32,
    /// Crops a step
    #[arg(long, default_value_t = 4)]
    batch: u32,
    /// Width and height of a crop, pixels
    #[arg(long, default_value_t = 64)]
    crop: usize,
    /// Learning rate at the top, of weights of about 1
    #[arg(long, default_value_t = 4e-3)]
    rate: f32,
    /// Share of the steps after which numbers are rounded as in the core
    #[arg(long, default_value_t = 0.5)]
    rounded_from: f32,
    /// Each crop's gradient by its loss: clean pictures count as much as noisy ones, as in dB
    #[arg(long)]
    relative: bool,
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Steps between lines of the log, and between states that are kept
    #[arg(long, default_value_t = 500)]
    every: u32,
}

/// Steps over which a learning rate falls.
struct Phase {
    first: u32,
    steps: u32,
    rate: f32,
    rounded_from: f32,
    /// Whether the finest heads learn of what is seen of the pixel itself.
    own: bool,
}

impl Recipe {
    pub fn all(&self) -> u32 {
        self.steps + self.again
    }

    /// That of a step.
    fn phase(&self, step: u32) -> Phase {
        if step < self.steps {
            Phase {
                first: 0,
                steps: self.steps,
                rate: self.rate,
                rounded_from: self.rounded_from,
                own: self.again == 0,
            }
        } else {
            Phase {
                first: self.steps,
                steps: self.again,
                rate: self.again_rate,
                rounded_from: 0.0,
                own: true,
            }
        }
    }
}

/// Weights, the optimiser's moments, and how far it is.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    pub step: u32,
    pub params: Params,
    first: Params,
    second: Params,
}

const MAGIC: &[u8; 8] = b"mlxstat1";

impl State {
    /// Uniform weights that keep the size of a sum's numbers; nothing in the biases. Heads' are no smaller: features that differ
    /// little from pixel to pixel hardly learn to; but of what is seen of a pixel itself they begin with nothing.
    fn new(size: Size, seed: u64) -> State {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut params = Params::zero(size);
        for (number, layer) in size.layers().iter().enumerate() {
            let (from, _) = size.place(number);
            let own = if layer.taps == 1 { layer.own } else { 0 };
            let fan_in = layer.weights() / layer.outputs - own;
            let most = 64.0 * (3.0 / fan_in as f32).sqrt();
            for w in &mut params.weights[from..][..fan_in * layer.outputs] {
                *w = rng.random_range(-most..most);
            }
        }
        State {
            step: 0,
            params,
            first: Params::zero(size),
            second: Params::zero(size),
        }
    }

    /// Of whichever size has as many numbers as the file.
    pub fn read(file: &Path) -> Result<State> {
        let bytes = fs::read(file).with_context(|| format!("{}", file.display()))?;
        let numbers = |size: Size| {
            let (weights, biases) = size.place(size.layers().len());
            weights + biases
        };
        let mut sizes = Size::ALL.into_iter();
        let size = sizes.find(|size| bytes.len() == 12 + 12 * numbers(*size) && &bytes[..8] == MAGIC);
        let size = size.with_context(|| format!("{}: not a state of this network", file.display()))?;
        let step = u32::from_le_bytes([bytes[8], bytes[9], bytes[10], bytes[11]]);
        let mut floats = bytes[12..]
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        let mut params = || {
            let mut params = Params::zero(size);
            let places = params.weights.iter_mut().chain(&mut params.biases);
            places.zip(floats.by_ref()).for_each(|(place, x)| *place = x);
            params
        };
        Ok(State {
            step,
            params: params(),
            first: params(),
            second: params(),
        })
    }

    fn write(&self, file: &Path) -> Result<()> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend_from_slice(&self.step.to_le_bytes());
        for params in [&self.params, &self.first, &self.second] {
            for x in params.weights.iter().chain(&params.biases) {
                bytes.extend_from_slice(&x.to_le_bytes());
            }
        }
        let beside = file.with_extension("part");
        fs::File::create(&beside)?.write_all(&bytes)?;
        Ok(fs::rename(beside, file)?)
    }

    /// One step of Adam (Kingma and Ba, 2015), whose moments are of the steps from `first` on; then the bound on sums.
    fn update(&mut self, gradient: &Params, rate: f32, first: u32) {
        if self.step == first {
            let size = self.params.size;
            (self.first, self.second) = (Params::zero(size), Params::zero(size));
        }
        self.step += 1;
        let (b1, b2) = (0.9f32, 0.99f32);
        let [c1, c2] = [b1, b2].map(|b| 1.0 - b.powi((self.step - first) as i32));
        let all = |params: &mut [f32], first: &mut [f32], second: &mut [f32], gradient: &[f32], unit: f32| {
            for (((p, m), v), g) in params.iter_mut().zip(first).zip(second).zip(gradient) {
                *m = b1 * *m + (1.0 - b1) * g;
                *v = b2 * *v + (1.0 - b2) * g * g;
                *p -= rate * unit * (*m / c1) / ((*v / c2).sqrt() + 1e-12);
            }
        };
        let State {
            params,
            first,
            second,
            ..
        } = self;
        all(
            &mut params.weights,
            &mut first.weights,
            &mut second.weights,
            &gradient.weights,
            64.0,
        );
        all(
            &mut params.biases,
            &mut first.biases,
            &mut second.biases,
            &gradient.biases,
            1024.0,
        );
        bound(params);
    }
}

/// Where the finest heads' weights of what is seen of the pixel itself are.
fn own_of_heads(size: Size) -> Range<usize> {
    let number = size.layers().len() - LEVELS;
    let layer = size.layers()[number];
    let (from, _) = size.place(number);
    from + layer.inputs * layer.outputs..from + layer.weights()
}

/// The bound of `microlux`'s `Weights::new` on each output's weights above 0, and below, once rounded: those that
/// pass it are made smaller together.
pub fn bound(params: &mut Params) {
    params
        .weights
        .iter_mut()
        .for_each(|w| *w = w.clamp(-127.0, 127.0));
    params
        .biases
        .iter_mut()
        .for_each(|b| *b = b.clamp(-32768.0, 32767.0));
    for (number, layer) in params.size.layers().iter().enumerate() {
        let (from, _) = params.size.place(number);
        let weights = &mut params.weights[from..][..layer.weights()];
        for output in 0..layer.outputs {
            for sign in [1.0f32, -1.0] {
                loop {
                    let side = weights[output..]
                        .iter()
                        .step_by(layer.outputs)
                        .map(|w| (w * sign).round().max(0.0));
                    let sum: f32 = side.sum();
                    if sum <= 520.0 {
                        break;
                    }
                    for w in weights[output..].iter_mut().step_by(layer.outputs) {
                        if *w * sign > 0.0 {
                            *w *= 519.0 / sum;
                        }
                    }
                }
            }
        }
    }
}

/// A crop's loss, its gradient added to `gradient`.
fn learn(seen: &Params, picture: &Picture, mode: Mode, gradient: &mut Params) -> f32 {
    let trace = nn::extract(seen, picture.input(), mode);
    let filtered = picture.filter(&trace.heads, mode);
    let (loss, d) = picture::loss(picture, &filtered.out);
    let heads = nn::filter_back(&trace.heads, &filtered, d, mode);
    nn::extract_back(seen, &trace, &heads, gradient);
    loss
}

/// dB of the tone-mapped pictures of a split, of 1 and of 4 samples; noisy ones where there are no params.
pub fn quality(shots: &[Shot], params: Option<(&Params, Mode)>) -> [f64; 2] {
    [1, 4].map(|count| {
        let each = shots.par_iter().map(|shot| {
            let picture = Picture::whole(shot, 0, count);
            let squared = match params {
                None => picture::squared(&picture, &picture.irradiance),
                Some((params, mode)) => {
                    let seen = params.seen(mode);
                    let trace = nn::extract(&seen, picture.input(), mode);
                    let filtered = picture.filter(&trace.heads, mode);
                    picture::squared(&picture, &filtered.out[0])
                }
            };
            -10.0 * squared.max(1e-9).log10()
        });
        each.collect::<Vec<_>>().iter().sum::<f64>() / shots.len() as f64
    })
}

pub fn run(options: &Options) -> Result<()> {
    let bar = ProgressBar::new(0);
    let recipe = &options.recipe;
    let until = options.until.unwrap_or(recipe.all());
    let state = by_threads(options.threads, || {
        train(recipe, options.size, until, &options.state, &options.log, &bar)
    })?;
    bar.finish();
    println!("{} steps: {}", state.step, options.state.display());
    Ok(())
}

pub fn by_threads<T: Send>(threads: usize, work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    pool.install(work)
}

/// Goes on from `file` up to step `until`, or all steps.
pub fn train(
    recipe: &Recipe,
    size: Size,
    until: u32,
    file: &Path,
    log: &Path,
    bar: &ProgressBar,
) -> Result<State> {
    let shots = Shot::read_all(&recipe.data, Split::Train)?;
    let validation = Shot::read_all(&recipe.data, Split::Validation)?;
    ensure!(
        recipe.crop % 8 == 0 && shots.iter().all(|shot| shot.side >= recipe.crop),
        "crops of {} do not fit the pictures, or 8",
        recipe.crop
    );
    let mut state = if file.exists() {
        State::read(file)?
    } else {
        State::new(size, recipe.seed)
    };
    ensure!(
        state.params.size == size,
        "{}: a network of size {}",
        file.display(),
        state.params.size.name()
    );
    let mut log = fs::OpenOptions::new().create(true).append(true).open(log)?;
    if state.step == 0 {
        writeln!(
            log,
            "# size {}; {} scenes, {} for validation; steps {}, batch {}, crop {}, rate {}, rounded from {}, seed {}; \
             again {}, rate {}",
            size.name(),
            shots.len(),
            validation.len(),
            recipe.steps,
            recipe.batch,
            recipe.crop,
            recipe.rate,
            recipe.rounded_from,
            recipe.seed,
            recipe.again,
            recipe.again_rate
        )?;
        let [one, four] = quality(&validation, None);
        writeln!(
            log,
            "# validation, noisy: {one:.2} dB at 1 spp, {four:.2} dB at 4 spp"
        )?;
        writeln!(
            log,
            "# step  rate  loss  dB at 1 spp, 4 spp (as rounded at that step)  seconds"
        )?;
    }
    let last = until.min(recipe.all());
    bar.set_length(u64::from(last));
    bar.set_style(ProgressStyle::with_template(
        "{prefix}{wide_bar} {pos}/{len} {per_sec} {eta} {msg}",
    )?);
    let started = Instant::now();
    let mut losses = Vec::new();
    while state.step < last {
        let step = state.step;
        let phase = recipe.phase(step);
        let since = step - phase.first;
        let share = since as f32 / phase.steps as f32;
        let mode = if share < phase.rounded_from {
            Mode::Float
        } else {
            Mode::Integer
        };
        let cosine = 0.5 * (1.0 + (std::f32::consts::PI * share).cos());
        let rate = phase.rate * ((since + 1) as f32 / 100.0).min(1.0) * (0.99 * cosine + 0.01);
        let seen = state.params.seen(mode);
        let one = |number: u32| {
            let stream = recipe.seed << 40 | u64::from(step) << 8 | u64::from(number);
            let mut rng = Pcg64Mcg::seed_from_u64(stream);
            let shot = &shots[rng.random_range(0..shots.len())];
            let count = [1, 1, 2, 4, 4, 8, 16][rng.random_range(0..7usize)];
            let from = rng.random_range(0..SAMPLES / count) * count;
            let room = shot.side - recipe.crop;
            let place = [0; 2].map(|_| rng.random_range(0..=room));
            let mut picture = Picture::cut(shot, from, count, place, recipe.crop);
            picture.vary(&mut rng);
            let mut gradient = Params::zero(size);
            let loss = learn(&seen, &picture, mode, &mut gradient);
            (loss, gradient)
        };
        // In order, so that any number of threads adds up the same.
        let parts: Vec<(f32, Params)> = (0..recipe.batch).into_par_iter().map(one).collect();
        let mut gradient = Params::zero(size);
        let mut loss = 0.0;
        for (part, g) in &parts {
            loss += part / recipe.batch as f32;
            // Flat below what the best pictures have.
            let by = if recipe.relative {
                0.03 / (part + 0.003)
            } else {
                1.0
            };
            let sum = |to: &mut [f32], from: &[f32]| to.iter_mut().zip(from).for_each(|(a, b)| *a += by * b);
            sum(&mut gradient.weights, &g.weights);
            sum(&mut gradient.biases, &g.biases);
        }
        if !phase.own {
            gradient.weights[own_of_heads(size)].fill(0.0);
        }
        state.update(&gradient, rate, phase.first);
        losses.push(loss);
        bar.set_position(u64::from(state.step));
        if state.step % recipe.every == 0 || state.step == last {
            let [one, four] = quality(&validation, Some((&state.params, mode)));
            let mean = losses.iter().sum::<f32>() / losses.len() as f32;
            let seconds = started.elapsed().as_secs();
            let line = format!(
                "{:6} {rate:.5} {mean:.4} {one:.2} {four:.2} {seconds}",
                state.step
            );
            writeln!(log, "{line}")?;
            bar.set_message(line);
            losses.clear();
            state.write(file)?;
        }
    }
    Ok(state)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nn::{Light, Planes};
    use microlux::film::denoise::network::INPUTS;

    fn picture(side: usize, seed: u64) -> Picture {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let size = side * side;
        let mut three = |from: f32, to: f32| -> Vec<[f32; 3]> {
            (0..size)
                .map(|_| [0; 3].map(|_| rng.random_range(from..to)))
                .collect()
        };
        Picture {
            width: side,
            height: side,
            albedo: three(0.1, 0.9),
            normal: three(-0.5, 0.5),
            reference: three(0.0, 2.0),
            irradiance: three(0.0, 3.0)
                .into_iter()
                .map(|[r, g, b]| [r, g, b, 0.0])
                .collect(),
            depth: vec![80.0; size],
            samples: 2,
            exposure: 0,
        }
    }

    /// What heads know of a pixel itself begins with nothing, and moments begin anew where a phase does.
    #[test]
    fn a_phase_begins_with_nothing() {
        for size in Size::ALL {
            let mut state = State::new(size, 5);
            let own = own_of_heads(size);
            assert_eq!(own.len(), 8 * 8);
            let (before, after) = (own.start - 1, own.end);
            let [before, after] = [before, after].map(|at| state.params.weights[at]);
            assert!(before != 0.0 && after != 0.0);
            assert!(state.params.weights[own].iter().all(|w| *w == 0.0));

            // Two steps the one way; two of another phase the other way are as long.
            let mut gradient = Params::zero(size);
            let place = |state: &State| state.params.biases[0];
            let mut walk = |by: f32, first: u32| {
                gradient.biases[0] = by;
                let from = place(&state);
                (0..2).for_each(|_| state.update(&gradient, 0.01, first));
                place(&state) - from
            };
            let (there, back) = (walk(1.0, 0), walk(-1.0, 2));
            assert!(there < -1.0 && there + back == 0.0, "{there} {back}");
        }
    }

    /// The gradient by hand is that of differences, for some weights of each layer, edges and odd sizes included.
    #[test]
    fn gradients_are_slopes() {
        for (side, size) in [(16, Size::S), (13, Size::S), (13, Size::Xl)] {
            let picture = picture(side, 3);
            let mut params = State::new(size, 5).params;
            let mut rng = Pcg64Mcg::seed_from_u64(9);
            params
                .biases
                .iter_mut()
                .for_each(|b| *b = rng.random_range(0.0..200.0));
            let mut gradient = Params::zero(size);
            learn(&params, &picture, Mode::Float, &mut gradient);
            let value =
                |params: &Params| f64::from(learn(params, &picture, Mode::Float, &mut Params::zero(size)));
            let (mut agree, mut all) = (0, 0);
            for number in 0..size.layers().len() {
                let (from, biases) = size.place(number);
                let layer = size.layers()[number];
                for _ in 0..6 {
                    let at = from + rng.random_range(0..layer.weights());
                    let step = 0.25;
                    let mut moved = params.clone();
                    moved.weights[at] += step;
                    let up = value(&moved);
                    moved.weights[at] -= 2.0 * step;
                    let slope = (up - value(&moved)) / f64::from(2.0 * step);
                    let given = f64::from(gradient.weights[at]);
                    all += 1;
                    agree += usize::from((slope - given).abs() <= 0.05 * slope.abs().max(given.abs()) + 2e-6);
                }
                let at = biases + rng.random_range(0..layer.outputs);
                let mut moved = params.clone();
                moved.biases[at] += 4.0;
                let up = value(&moved);
                moved.biases[at] -= 8.0;
                let slope = (up - value(&moved)) / 8.0;
                let given = f64::from(gradient.biases[at]);
                all += 1;
                agree += usize::from((slope - given).abs() <= 0.05 * slope.abs().max(given.abs()) + 1e-7);
            }
            // Kinks (largest of four, range of activations) lie between some.
            assert!(agree * 10 >= all * 9, "{side}, {size:?}: {agree} of {all}");
        }
    }

    /// The heads of the float network with everything rounded are the core's, bit for bit.
    #[test]
    fn rounded_heads_are_the_cores() {
        use microlux::film::denoise::Alone;
        use microlux::film::denoise::network::{
            FEATURES, HEAD, Input, LEVELS, Needs, Network, Scratch, Weights,
        };
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        for (seed, (width, height)) in [(64, 48), (1, 1), (7, 5), (33, 9), (2, 31)]
            .into_iter()
            .enumerate()
        {
            let mut params = State::new(Size::Xs, seed as u64).params;
            params.weights.iter_mut().for_each(|w| *w *= 3.0);
            params
                .biases
                .iter_mut()
                .for_each(|b| *b = rng.random_range(-3000.0..3000.0));
            bound(&mut params);
            let seen = params.seen(Mode::Integer);
            let weights: Vec<i8> = seen.weights.iter().map(|&w| w as i8).collect();
            let biases: Vec<i16> = seen.biases.iter().map(|&b| b as i16).collect();
            let (weights, biases) = (weights.try_into().unwrap(), biases.try_into().unwrap());
            let weights = Weights::new(&weights, &biases).unwrap();
            let size = width * height;
            let inputs: Vec<[u8; INPUTS]> = (0..size)
                .map(|_| [0; INPUTS].map(|_| rng.random_range(0..64)))
                .collect();
            let light: Vec<[u16; 3]> = (0..size)
                .map(|_| [0; 3].map(|_| rng.random::<u16>() >> rng.random_range(0..12)))
                .collect();
            let needs = Needs::of(width, height);
            let scratch = Scratch {
                fine: &mut vec![[0xaa; HEAD]; needs.fine],
                near: &mut vec![7; needs.near],
                far: &mut vec![9; needs.far],
            };
            let mut network = Network::new(weights, width, height, scratch).unwrap();
            network.extract(&Alone, |at| Input::from_bits(inputs[at]));

            let mut planes = Planes::new(INPUTS, height, width);
            for (at, input) in inputs.iter().enumerate() {
                (0..INPUTS).for_each(|c| planes.data[c * size + at] = f32::from(input[c]));
            }
            let trace = nn::extract(&seen, planes, Mode::Integer);
            let mut busy = 0;
            for level in 0..LEVELS {
                let core = network.heads(level);
                assert_eq!(core.len(), trace.heads[level].heads.len());
                for (core, float) in core.iter().zip(&trace.heads[level].heads) {
                    let signed: [f32; HEAD] = core::array::from_fn(|i| {
                        if i < FEATURES {
                            f32::from(core[i] as i8)
                        } else {
                            f32::from(core[i])
                        }
                    });
                    assert_eq!(signed, float[..HEAD], "{width} x {height}, size {level}");
                    busy += usize::from(core[..FEATURES].iter().any(|&f| f != 0));
                }
            }
            assert!(busy > 0);

            // The filter by those heads: within 4 steps of 2^-12, or as much of the value.
            let floats: Vec<Light> = light
                .iter()
                .map(|l| [l[0], l[1], l[2], 0].map(f32::from))
                .collect();
            let filtered = nn::filter(&floats, &trace.heads, Mode::Integer);
            let mut worst = 0f32;
            let mut out = vec![[0; 3]; size];
            network
                .filter(&Alone, |at| light[at], &mut out, |light| light)
                .unwrap();
            for (pixel, float) in out.iter().zip(&filtered.out[0]) {
                for c in 0..3 {
                    worst = worst.max((f32::from(pixel[c]) - float[c]).abs());
                }
            }
            println!("{width} x {height}: filter off by {worst}");
            assert!(worst < 700.0, "{worst}");
        }
    }
}
