//! A noisy picture of a few samples, as the network and the filter see it.

use microlux::film::denoise::FIREFLY;
use microlux::film::denoise::network::INPUTS;
use rand::Rng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64Mcg;

use crate::data::{SAMPLES, Shot};
use crate::nn::{self, Filtered, Heads, Light, Mode, Planes};

/// A part of a shot, and what it should become.
#[derive(Clone, Debug)]
pub struct Picture {
    pub width: usize,
    pub height: usize,
    /// Up to 16 once fireflies are clamped.
    pub irradiance: Vec<Light>,
    pub albedo: Vec<[f32; 3]>,
    pub normal: Vec<[f32; 3]>,
    /// Sixteenths of an octave.
    pub depth: Vec<f32>,
    pub reference: Vec<[f32; 3]>,
    pub samples: u32,
    /// Octaves by which the network sees the irradiance brighter: `microlux::film::denoise::network::exposure`.
    pub exposure: i32,
}

/// The largest irradiance: 16 less one step of 2^-12.
const MOST: f32 = 65535.0 / 4096.0;

impl Picture {
    /// The samples `from..from + count` of the pixels from (`left`, `top`) on, `side` each way, as the core's filters get
    /// them: after the clamp of fireflies.
    pub fn cut(shot: &Shot, from: usize, count: usize, place: [usize; 2], side: usize) -> Picture {
        let mut picture = Picture::rendered(shot, from, count, place, side);
        picture.clamp();
        picture.exposure = picture.exposed();
        picture
    }

    /// As rendered.
    fn rendered(shot: &Shot, from: usize, count: usize, [left, top]: [usize; 2], side: usize) -> Picture {
        let mut picture = Picture {
            width: side,
            height: side,
            irradiance: Vec::with_capacity(side * side),
            albedo: Vec::with_capacity(side * side),
            normal: Vec::with_capacity(side * side),
            depth: Vec::with_capacity(side * side),
            reference: Vec::with_capacity(side * side),
            samples: count as u32,
            exposure: 0,
        };
        for y in top..top + side {
            for x in left..left + side {
                let at = y * shot.side + x;
                let samples = &shot.samples[at * SAMPLES + from..][..count];
                let share = 1.0 / count as f32;
                let (mut light, mut albedo, mut normal, mut depth) = ([0.0; 4], [0.0; 3], [0.0; 3], 0.0);
                for s in samples {
                    for c in 0..3 {
                        light[c] += s.radiance[c].to_f32() * share;
                        albedo[c] += f32::from(s.albedo[c]) / 255.0 * share;
                        normal[c] += f32::from(s.normal[c]) / 127.0 * share;
                    }
                    depth += f32::from(s.depth) * share;
                }
                let length = normal.iter().map(|c| c * c).sum::<f32>().sqrt().max(1e-3);
                for (light, albedo) in light.iter_mut().zip(albedo) {
                    *light /= albedo.max(1.0 / 255.0);
                }
                picture.irradiance.push(light);
                picture.albedo.push(albedo);
                picture.normal.push(normal.map(|c| c / length));
                picture.depth.push(depth);
                picture.reference.push(shot.reference[at]);
            }
        }
        picture
    }

    /// The core's clamp of fireflies: darker by whole octaves until the luminance is at most that of the second brightest
    /// of the 3 × 3, times 2^`FIREFLY`; then no more than there may be.
    pub fn clamp(&mut self) {
        let luma: Vec<f32> = self.irradiance.iter().map(luminance).collect();
        let (width, height) = (self.width, self.height);
        for (at, light) in self.irradiance.iter_mut().enumerate() {
            let (x, y) = (at % width, at / width);
            let (mut first, mut second) = (0f32, 0f32);
            for row in y.saturating_sub(1)..=(y + 1).min(height - 1) {
                for column in x.saturating_sub(1)..=(x + 1).min(width - 1) {
                    let value = luma[row * width + column];
                    second = second.max(value.min(first));
                    first = first.max(value);
                }
            }
            let limit = second * (1 << FIREFLY) as f32;
            let over = if limit > 0.0 { luma[at] / limit } else { 0.0 };
            let by = if over > 1.0 {
                (-over.log2().ceil()).exp2()
            } else {
                1.0
            };
            let by = if limit > 0.0 { by } else { 0.0 };
            *light = light.map(|c| (c * by).min(MOST));
        }
    }

    /// Octaves, as the core judges them.
    pub fn exposed(&self) -> i32 {
        let (mut sum, mut count) = (0.0, 0.0);
        for (light, depth) in self.irradiance.iter().zip(&self.depth) {
            let luma = luminance(light);
            if *depth < 254.5 && luma > 0.0 {
                sum += luma.log2().max(-15.0);
                count += 1.0;
            }
        }
        if count > 0.0 {
            (-sum / count).round().clamp(-8.0, 8.0) as i32
        } else {
            0
        }
    }

    /// Where nothing was hit: light is kept as it is there. The core does so only where no mirror or glass was, either, which
    /// samples do not tell.
    fn nothing(&self, at: usize) -> bool {
        self.depth[at] >= 254.5
    }

    /// By heads of this picture.
    pub fn filter(&self, heads: &[Heads], mode: Mode) -> Filtered {
        let mut filtered = nn::filter(&self.irradiance, heads, mode);
        for (at, out) in filtered.out[0].iter_mut().enumerate() {
            if self.nothing(at) {
                *out = self.irradiance[at];
            }
        }
        filtered
    }

    pub fn whole(shot: &Shot, from: usize, count: usize) -> Picture {
        Picture::cut(shot, from, count, [0, 0], shot.side)
    }

    /// With its fireflies, of the first samples.
    pub fn untouched(shot: &Shot, count: usize) -> Picture {
        Picture::rendered(shot, 0, count, [0, 0], shot.side)
    }

    /// Mirrored and turned; colours in another order; brighter or darker; another frame for normals and for depth.
    pub fn vary(&mut self, rng: &mut Pcg64Mcg) {
        if rng.random_bool(0.5) {
            self.rearrange(|x, y, width, _| (width - 1 - x, y));
        }
        if rng.random_bool(0.5) {
            self.rearrange(|x, y, _, height| (x, height - 1 - y));
        }
        if rng.random_bool(0.5) {
            self.rearrange(|x, y, _, _| (y, x));
        }
        let mut order = [0, 1, 2];
        order.shuffle(rng);
        let brighter = 2f32.powf(rng.random_range(-1.0..1.0));
        for light in &mut self.irradiance {
            let [a, b, c] = order.map(|i| (light[i] * brighter).min(MOST));
            *light = [a, b, c, 0.0];
        }
        // As if it had been judged an octave off, now and then, but for what `brighter` makes of it.
        self.exposure =
            (self.exposure - brighter.log2().round() as i32 + rng.random_range(-1..=1)).clamp(-8, 8);
        for albedo in &mut self.albedo {
            *albedo = order.map(|i| albedo[i]);
        }
        for light in &mut self.reference {
            *light = order.map(|i| light[i] * brighter);
        }
        order.shuffle(rng);
        let signs = [0; 3].map(|_| if rng.random_bool(0.5) { 1.0 } else { -1.0 });
        for normal in &mut self.normal {
            *normal = order.map(|i| normal[i] * signs[i]);
        }
        let farther = rng.random_range(-24.0..24.0);
        for depth in &mut self.depth {
            if *depth < 254.5 {
                *depth = (*depth + farther).clamp(0.0, 254.0);
            }
        }
    }

    /// Pixel (x, y) from where `source` says; only for squares if it swaps x and y.
    fn rearrange(&mut self, source: impl Fn(usize, usize, usize, usize) -> (usize, usize)) {
        let (width, height) = (self.width, self.height);
        let places: Vec<usize> = (0..width * height)
            .map(|at| {
                let (x, y) = source(at % width, at / width, width, height);
                y * width + x
            })
            .collect();
        fn pick<T: Copy>(from: &mut Vec<T>, places: &[usize]) {
            *from = places.iter().map(|&at| from[at]).collect();
        }
        pick(&mut self.irradiance, &places);
        pick(&mut self.albedo, &places);
        pick(&mut self.normal, &places);
        pick(&mut self.depth, &places);
        pick(&mut self.reference, &places);
    }

    /// What `microlux::film::denoise::network::Input` makes of it, but for the rounding of a feature's bytes.
    pub fn input(&self) -> Planes {
        let size = self.width * self.height;
        let mut input = Planes::new(INPUTS, self.height, self.width);
        for at in 0..size {
            let mut put =
                |channel: usize, value: f32| input.data[channel * size + at] = value.clamp(0.0, 63.0);
            for c in 0..3 {
                let seen = (self.irradiance[at][c] * (self.exposure as f32).exp2()).min(MOST);
                put(c, (logarithm(1.0 + 8.0 * seen) * 9.0).floor());
                put(3 + c, (self.albedo[at][c].sqrt() * 255.0).round().div_euclid(4.0));
                put(6 + c, (self.normal[at][c] * 31.5 + 32.0).floor());
            }
            put(9, self.depth[at].round().div_euclid(4.0));
            put(10, (logarithm(self.samples as f32) * 9.0).floor());
        }
        input
    }
}

fn luminance(light: &Light) -> f32 {
    (54.0 * light[0] + 183.0 * light[1] + 19.0 * light[2]) / 256.0
}

/// log2, a straight line between powers of two.
fn logarithm(x: f32) -> f32 {
    let whole = x.max(1.0).log2().floor();
    whole + x / whole.exp2() - 1.0
}

/// What the eye makes of light: within 0 ..= 1.
pub fn tone(x: f32) -> f32 {
    (x / (1.0 + x) + 0.01).powf(1.0 / 2.2)
}

/// The slope of [`tone`].
fn tone_slope(x: f32) -> f32 {
    (x / (1.0 + x) + 0.01).powf(1.0 / 2.2 - 1.0) / 2.2 / ((1.0 + x) * (1.0 + x))
}

/// What the coarser sizes' light counts beside the finest: without it they learn nothing once the finer ones do not ask
/// for them.
const COARSE: f32 = 0.15;

/// How far light of each size is from the reference, and the gradients: those of [`near`] for the picture itself, and
/// less for what is coarser, against means.
pub fn loss(picture: &Picture, out: &[Vec<Light>]) -> (f32, Vec<Vec<Light>>) {
    let (mut width, mut height) = (picture.width, picture.height);
    let (mut albedo, mut reference) = (picture.albedo.clone(), picture.reference.clone());
    let (mut sum, mut gradients) = (0.0, Vec::new());
    for (level, out) in out.iter().enumerate() {
        if level > 0 {
            albedo = halved(&albedo, width, height);
            reference = halved(&reference, width, height);
            (width, height) = (width.div_ceil(2), height.div_ceil(2));
        }
        let (loss, mut gradient) = near(width, &albedo, &reference, out);
        let counts = if level > 0 { COARSE } else { 1.0 };
        for (at, g) in gradient.iter_mut().enumerate() {
            let kept = level == 0 && picture.nothing(at);
            *g = if kept { [0.0; 4] } else { g.map(|c| c * counts) };
        }
        sum += counts * loss;
        gradients.push(gradient);
    }
    (sum, gradients)
}

/// Means of each 2 × 2; at an odd edge some count twice.
fn halved(fine: &[[f32; 3]], width: usize, height: usize) -> Vec<[f32; 3]> {
    let mut coarse = Vec::with_capacity(fine.len() / 4 + width + height);
    for y in (0..height).step_by(2) {
        for x in (0..width).step_by(2) {
            let (right, below) = ((x + 1).min(width - 1), (y + 1).min(height - 1));
            let four = [(x, y), (right, y), (x, below), (right, below)].map(|(x, y)| fine[y * width + x]);
            coarse.push([0, 1, 2].map(|c| four.iter().map(|p| p[c]).sum::<f32>() / 4.0));
        }
    }
    coarse
}

/// How far `out` (irradiance) times `albedo` is from the reference, and the gradient: tone-mapped |d| + 8 d², and a quarter
/// of |d| of differences between neighbours.
fn near(width: usize, albedo: &[[f32; 3]], reference: &[[f32; 3]], out: &[Light]) -> (f32, Vec<Light>) {
    let size = out.len();
    let share = 1.0 / (3 * size) as f32;
    let mut errors = vec![[0.0f32; 3]; size];
    let mut slopes = vec![[0.0f32; 3]; size];
    let mut gradient = vec![[0.0f32; 4]; size];
    let mut sum = 0.0;
    for at in 0..size {
        for c in 0..3 {
            let x = (out[at][c] * albedo[at][c]).max(0.0);
            let e = tone(x) - tone(reference[at][c]);
            errors[at][c] = e;
            slopes[at][c] = tone_slope(x) * albedo[at][c];
            sum += e.abs() + 8.0 * e * e;
            gradient[at][c] = e.signum() + 16.0 * e;
        }
    }
    for at in 0..size {
        let (right, below) = ((at + 1) % width != 0, at + width < size);
        for (there, is) in [(at + 1, right), (at + width, below)] {
            if is {
                for c in 0..3 {
                    let e = errors[there][c] - errors[at][c];
                    sum += 0.25 * e.abs();
                    gradient[there][c] += 0.25 * e.signum();
                    gradient[at][c] -= 0.25 * e.signum();
                }
            }
        }
    }
    for (gradient, slopes) in gradient.iter_mut().zip(&slopes) {
        (0..3).for_each(|c| gradient[c] *= slopes[c] * share);
    }
    (sum * share, gradient)
}

/// Mean squared tone-mapped error.
pub fn squared(picture: &Picture, out: &[Light]) -> f64 {
    let mut sum = 0.0;
    for (at, out) in out.iter().enumerate() {
        for c in 0..3 {
            let e = tone(out[c] * picture.albedo[at][c]) - tone(picture.reference[at][c]);
            sum += f64::from(e * e);
        }
    }
    sum / (3 * out.len()) as f64
}
