//! A noisy picture of a few samples, as the network and the filter see it.

use microlux::film::denoise::network::INPUTS;
use rand::Rng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64Mcg;

use crate::data::{SAMPLES, Shot};
use crate::nn::{Light, Planes};

/// A part of a shot, and what it should become.
#[derive(Clone, Debug)]
pub struct Picture {
    pub width: usize,
    pub height: usize,
    /// Up to 16.
    pub irradiance: Vec<Light>,
    pub albedo: Vec<[f32; 3]>,
    pub normal: Vec<[f32; 3]>,
    /// Sixteenths of an octave.
    pub depth: Vec<f32>,
    pub reference: Vec<[f32; 3]>,
    pub samples: u32,
}

/// The largest irradiance: 16 less one step of 2^-12.
const MOST: f32 = 65535.0 / 4096.0;

impl Picture {
    /// The samples `from..from + count` of the pixels from (`left`, `top`) on, `side` each way.
    pub fn cut(shot: &Shot, from: usize, count: usize, [left, top]: [usize; 2], side: usize) -> Picture {
        let mut picture = Picture {
            width: side,
            height: side,
            irradiance: Vec::with_capacity(side * side),
            albedo: Vec::with_capacity(side * side),
            normal: Vec::with_capacity(side * side),
            depth: Vec::with_capacity(side * side),
            reference: Vec::with_capacity(side * side),
            samples: count as u32,
        };
        for y in top..top + side {
            for x in left..left + side {
                let at = y * shot.side + x;
                let samples = &shot.samples[at * SAMPLES + from..][..count];
                let share = 1.0 / count as f32;
                let (mut light, mut albedo, mut normal, mut depth) = ([0.0; 4], [0.0; 3], [0.0; 3], 0.0);
                for s in samples {
                    for c in 0..3 {
                        light[c] += s.irradiance[c].to_f32() * share;
                        albedo[c] += f32::from(s.albedo[c]) / 255.0 * share;
                        normal[c] += f32::from(s.normal[c]) / 127.0 * share;
                    }
                    depth += f32::from(s.depth) * share;
                }
                let length = normal.iter().map(|c| c * c).sum::<f32>().sqrt().max(1e-3);
                picture.irradiance.push(light.map(|c| c.min(MOST)));
                picture.albedo.push(albedo);
                picture.normal.push(normal.map(|c| c / length));
                picture.depth.push(depth);
                picture.reference.push(shot.reference[at]);
            }
        }
        picture
    }

    pub fn whole(shot: &Shot, from: usize, count: usize) -> Picture {
        Picture::cut(shot, from, count, [0, 0], shot.side)
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
                put(c, (logarithm(1.0 + 8.0 * self.irradiance[at][c]) * 9.0).floor());
                put(3 + c, (self.albedo[at][c].sqrt() * 255.0).round().div_euclid(4.0));
                put(6 + c, (self.normal[at][c] * 31.5 + 32.0).floor());
            }
            put(9, self.depth[at].round().div_euclid(4.0));
            put(10, (logarithm(self.samples as f32) * 9.0).floor());
        }
        input
    }
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

/// How far `out` (irradiance) is from the reference, and the gradient: tone-mapped |d| + 2 d², and a quarter of that of
/// differences between neighbours.
pub fn loss(picture: &Picture, out: &[Light]) -> (f32, Vec<Light>) {
    let (width, size) = (picture.width, picture.width * picture.height);
    let share = 1.0 / (3 * size) as f32;
    let mut errors = vec![[0.0f32; 3]; size];
    let mut slopes = vec![[0.0f32; 3]; size];
    let mut gradient = vec![[0.0f32; 4]; size];
    let mut sum = 0.0;
    for at in 0..size {
        for c in 0..3 {
            let x = (out[at][c] * picture.albedo[at][c]).max(0.0);
            let e = tone(x) - tone(picture.reference[at][c]);
            errors[at][c] = e;
            slopes[at][c] = tone_slope(x) * picture.albedo[at][c];
            sum += e.abs() + 2.0 * e * e;
            gradient[at][c] = e.signum() + 4.0 * e;
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
