//! Errors of pictures from their spread.

use crate::picture::{CAP, Picture};

/// How much pictures that differ by their seed vary.
#[derive(Clone, Copy, Default)]
pub struct Spread {
    /// Root mean square of all pixels.
    pub rmse: f64,
    /// Mean of the pixels' standard deviations: a lamp's rim and caustics, few pixels, count less.
    pub mean: f64,
}

impl Spread {
    /// Standard deviation of each pixel over the pictures, channels in root mean square.
    pub fn of(pictures: &[Picture]) -> Spread {
        let count = pictures.len() as f64;
        let size = pictures.first().map_or(0, |picture| picture.pixels.len());
        let variance = |pixel: usize, channel: usize| {
            let seen = || {
                let light = |picture: &Picture| f64::from(picture.pixels[pixel][channel].min(CAP));
                pictures.iter().map(light)
            };
            let mean = seen().sum::<f64>() / count;
            seen().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0)
        };
        let of_pixel = |i: usize| (0..3).map(|channel| variance(i, channel)).sum::<f64>() / 3.0;
        let variances: Vec<f64> = (0..size).map(of_pixel).collect();
        let pixels = size.max(1) as f64;
        Spread {
            rmse: (variances.iter().sum::<f64>() / pixels).sqrt(),
            mean: variances.iter().map(|v| v.sqrt()).sum::<f64>() / pixels,
        }
    }
}

/// Spreads of equally many pictures each, block by block.
#[derive(Clone, Default)]
pub struct Blocks(Vec<Spread>);

impl Blocks {
    pub fn push(&mut self, block: Spread) {
        self.0.push(block);
    }

    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Of all: mean variance of the blocks, and mean of their means.
    pub fn spread(&self) -> Spread {
        let count = self.0.len() as f64;
        Spread {
            rmse: self.rmse(),
            mean: self.0.iter().map(|block| block.mean).sum::<f64>() / count,
        }
    }

    /// Standard error of [`Self::spread`]'s RMSE, as a share of it; of at least two blocks.
    pub fn error(&self) -> f64 {
        let count = self.0.len() as f64;
        let square = self.rmse().powi(2);
        let apart: f64 = self.0.iter().map(|b| (b.rmse.powi(2) - square).powi(2)).sum();
        // The root's share is half of the square's.
        (apart / (count - 1.0) / count).sqrt() / square / 2.0
    }

    fn rmse(&self) -> f64 {
        let sum: f64 = self.0.iter().map(|block| block.rmse.powi(2)).sum();
        (sum / self.0.len() as f64).sqrt()
    }
}

/// Standard deviation of [`far`]'s blur, in pixels.
const SIGMA: f32 = 1.5;

/// The picture as seen from far off: blurred by a Gaussian. Edges count their own pixels again.
pub fn far(picture: &Picture) -> Picture {
    let reach = (3.0 * SIGMA) as isize;
    let weights: Vec<f32> = (-reach..=reach)
        .map(|i| (-(i * i) as f32 / (2.0 * SIGMA * SIGMA)).exp())
        .collect();
    let sum: f32 = weights.iter().sum();
    let (width, height) = (picture.width, picture.pixels.len() / picture.width.max(1));
    let blur = |pixels: &[[f32; 3]], step: [isize; 2]| -> Vec<[f32; 3]> {
        let at = |x: isize, y: isize| {
            let x = x.clamp(0, width as isize - 1) as usize;
            let y = y.clamp(0, height as isize - 1) as usize;
            pixels[y * width + x].map(|channel| channel.min(CAP))
        };
        let one = |i: usize| {
            let (x, y) = ((i % width) as isize, (i / width) as isize);
            let mut total = [0.0; 3];
            for (offset, weight) in (-reach..=reach).zip(&weights) {
                let seen = at(x + offset * step[0], y + offset * step[1]);
                for (total, seen) in total.iter_mut().zip(seen) {
                    *total += weight * seen / sum;
                }
            }
            total
        };
        (0..pixels.len()).map(one).collect()
    };
    Picture {
        width,
        pixels: blur(&blur(&picture.pixels, [1, 0]), [0, 1]),
    }
}

/// Power of x with which y goes, by least squares of the logarithms.
pub fn slope(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = logs.len() as f64;
    let mean = |pick: fn(&(f64, f64)) -> f64| logs.iter().map(pick).sum::<f64>() / count;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let both: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    both / logs.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: usize, values: &[f32]) -> Picture {
        Picture {
            width,
            pixels: values.iter().map(|v| [*v; 3]).collect(),
        }
    }

    #[test]
    fn the_spread_is_that_of_one_picture() {
        let pictures = [picture(3, &[1.0, 20.0, 5.0]), picture(3, &[3.0, 9.0, 5.0])];
        // Variances 2 and, beyond the cap and where nothing varies, 0.
        let spread = Spread::of(&pictures);
        assert!((spread.rmse - (2.0f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((spread.mean - 2.0f64.sqrt() / 3.0).abs() < 1e-12);
    }

    #[test]
    fn blocks_are_joined_by_their_squares() {
        let mut blocks = Blocks::default();
        for rmse in [1.0, 7.0, 5.0, 5.0] {
            blocks.push(Spread {
                rmse,
                mean: rmse / 2.0,
            });
        }
        // Squares 1, 49, 25, 25: mean 25, variance 384, of the mean 96.
        assert_eq!(blocks.spread().rmse, 5.0);
        assert_eq!(blocks.spread().mean, 2.25);
        assert!((blocks.error() - 96f64.sqrt() / 50.0).abs() < 1e-12);
    }

    #[test]
    fn what_alternates_is_gone_from_afar() {
        let board: Vec<f32> = (0..400).map(|i| ((i % 20 + i / 20) % 2) as f32).collect();
        let middle = far(&picture(20, &board)).pixels[10 * 20 + 10][0];
        assert!((middle - 0.5).abs() < 1e-3, "{middle}");
        let flat = far(&picture(20, &[0.7; 400]));
        assert!(flat.pixels.iter().all(|p| (p[0] - 0.7).abs() < 1e-5));
    }

    #[test]
    fn slopes_are_powers() {
        let points: Vec<(f64, f64)> = (1..6)
            .map(|x| (f64::from(x), 3.0 * f64::from(x).powf(-0.75)))
            .collect();
        assert!((slope(&points) + 0.75).abs() < 1e-12);
    }
}
