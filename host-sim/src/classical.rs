//! What stood for denoising before networks, in `f32`: the measure for ours.

/// A noisy picture and what leads a filter through it, a pixel each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Guided {
    pub width: usize,
    pub height: usize,
    /// Light before the albedo.
    pub irradiance: Vec<[f32; 3]>,
    pub albedo: Vec<[f32; 3]>,
    pub normal: Vec<[f32; 3]>,
    /// Sixteenths of an octave.
    pub depth: Vec<f32>,
}

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
pub fn filter(picture: &Guided, kind: Kind, guides: &Guides) -> Vec<[f32; 3]> {
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
    picture: &Guided,
    light: &[[f32; 3]],
    guides: &Guides,
    reach: i32,
    stride: i32,
    sharper: f32,
    tap: impl Fn(i32, i32) -> f32,
) -> Vec<[f32; 3]> {
    let (width, height) = (picture.width as i32, picture.height as i32);
    let at = |x: i32, y: i32| (y.clamp(0, height - 1) * width + x.clamp(0, width - 1)) as usize;
    let guide: Vec<[f32; 8]> = (0..light.len())
        .map(|i| {
            let (x, y) = (i as i32 % width, i as i32 / width);
            let mut mean = 0.0;
            for dy in -1..=1 {
                for dx in -1..=1 {
                    let [r, g, b] = light[at(x + dx, y + dy)];
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
            let (mut total, mut sum) = (0.0, [0.0; 3]);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks of light on two surfaces that meet in the middle, one twice as bright.
    fn picture() -> Guided {
        let (width, height) = (24, 16);
        let pixel = |i: usize| (i % width, i / width);
        let each = |f: &dyn Fn(usize, usize) -> [f32; 3]| {
            (0..width * height)
                .map(|i| {
                    let (x, y) = pixel(i);
                    f(x, y)
                })
                .collect()
        };
        Guided {
            width,
            height,
            irradiance: each(&|x, y| {
                let noise = if (x + y) % 2 == 0 { 1.25 } else { 0.75 };
                [if x < 12 { noise } else { 2.0 * noise }; 3]
            }),
            albedo: each(&|_, _| [0.5; 3]),
            normal: each(&|x, _| if x < 12 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] }),
            depth: vec![100.0; width * height],
        }
    }

    #[test]
    fn noise_goes_and_edges_stay() {
        for kind in [Kind::ATrous, Kind::Bilateral] {
            let clean = filter(&picture(), kind, &[3.0, 4.0, 4.0, 0.1]);
            for (x, wanted) in [(2, 1.0), (11, 1.0), (12, 2.0), (20, 2.0)] {
                let [r, ..] = clean[8 * 24 + x];
                assert!((r - wanted).abs() < 0.05, "{kind:?} {x}: {r}");
            }
            let blind = filter(&picture(), kind, &[0.0; 4]);
            assert!(blind[8 * 24 + 11][0] > 1.2, "without guides the edge is blurred");
        }
    }
}
