//! What stood for denoising before networks, tuned on the validation scenes: the measure for ours.

use rayon::prelude::*;

use crate::nn::Light;
use crate::picture::{self, Picture};

/// How much each guide counts: normal, distance (octaves), albedo, light (octaves).
pub type Guides = [f32; 4];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Five passes of 5 × 5, each twice as wide (Dammertz et al. 2010), guided.
    ATrous,
    /// One pass of 13 × 13.
    Bilateral,
}

/// Irradiance, filtered.
pub fn filter(picture: &Picture, kind: Kind, guides: &Guides) -> Vec<Light> {
    match kind {
        Kind::ATrous => {
            let mut light = picture.irradiance.clone();
            for pass in 0..5 {
                // The light that guides gets sharper, as it has less noise (Schied et al. 2017 by variance).
                light = apply(picture, &light, guides, 2, 1 << pass, 2f32.powi(pass), |i, j| {
                    let tap = |i: i32| [0.375, 0.25, 0.0625][i.unsigned_abs() as usize];
                    tap(i) * tap(j)
                });
            }
            light
        }
        Kind::Bilateral => apply(picture, &picture.irradiance, guides, 6, 1, 1.0, |i, j| {
            (-((i * i + j * j) as f32) / 32.0).exp()
        }),
    }
}

fn apply(
    picture: &Picture,
    light: &[Light],
    guides: &Guides,
    reach: i32,
    stride: i32,
    sharper: f32,
    tap: impl Fn(i32, i32) -> f32,
) -> Vec<Light> {
    let (width, height) = (picture.width as i32, picture.height as i32);
    let at = |x: i32, y: i32| (y.clamp(0, height - 1) * width + x.clamp(0, width - 1)) as usize;
    let guide: Vec<[f32; 8]> = (0..light.len())
        .map(|i| {
            let (x, y) = (i as i32 % width, i as i32 / width);
            let mut mean = 0.0;
            for dy in -1..=1 {
                for dx in -1..=1 {
                    let [r, g, b, _] = light[at(x + dx, y + dy)];
                    mean += (r + g + b) / 27.0;
                }
            }
            let (n, a) = (picture.normal[i], picture.albedo[i]);
            let [kn, kd, ka, kl] = *guides;
            [
                n[0] * kn,
                n[1] * kn,
                n[2] * kn,
                picture.depth[i] / 16.0 * kd,
                a[0] * ka,
                a[1] * ka,
                a[2] * ka,
                (1.0 + 8.0 * mean).log2() * kl * sharper,
            ]
        })
        .collect();
    (0..light.len())
        .map(|i| {
            let (x, y) = (i as i32 % width, i as i32 / width);
            let (mut total, mut sum) = (0.0, [0.0; 4]);
            for dy in -reach..=reach {
                for dx in -reach..=reach {
                    let (px, py) = (x + dx * stride, y + dy * stride);
                    if px < 0 || py < 0 || px >= width || py >= height {
                        continue;
                    }
                    let j = (py * width + px) as usize;
                    let square: f32 = (0..8).map(|c| (guide[i][c] - guide[j][c]).powi(2)).sum();
                    let w = tap(dx, dy) * (-square).exp();
                    total += w;
                    (0..3).for_each(|c| sum[c] += w * light[j][c]);
                }
            }
            sum.map(|c| c / total)
        })
        .collect()
}

/// The guides with the least squared tone-mapped error (in dB, the mean of scenes) over `pictures`, one guide after the
/// other, twice; and that error.
pub fn tune(pictures: &[Picture], kind: Kind) -> (f64, Guides) {
    let error = |guides: &Guides| -> f64 {
        let each = pictures
            .par_iter()
            .map(|p| picture::squared(p, &filter(p, kind, guides)).log10());
        each.collect::<Vec<_>>().iter().sum()
    };
    let mut best: Guides = [2.0, 4.0, 4.0, 0.25];
    let mut least = error(&best);
    for by in [4.0, 2.0, 2.0, 1.5] {
        for guide in 0..4 {
            for by in [by, 1.0 / by] {
                loop {
                    let mut tried = best;
                    tried[guide] *= by;
                    let value = error(&tried);
                    if value >= least {
                        break;
                    }
                    (best, least) = (tried, value);
                }
            }
        }
    }
    (least, best)
}
