//! Means with their errors, and how fast noise falls.

use crate::picture::Picture;

/// A mean and what chance alone does to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    pub value: f64,
    /// Standard deviation of `value`, were all of it done again with other random numbers.
    pub standard_error: f64,
}

impl Estimate {
    /// Mean of independent values of the same law; its standard error by the spread between them (0 for a single one,
    /// which says nothing).
    pub fn of(values: &[f64]) -> Estimate {
        let n = values.len().max(1) as f64;
        let value = values.iter().sum::<f64>() / n;
        let squares = values.iter().map(|x| (x - value) * (x - value)).sum::<f64>();
        let standard_error = (squares / (n - 1.0).max(1.0) / n).sqrt();
        Estimate {
            value,
            standard_error,
        }
    }

    /// Of two independent pictures of the same: the mean light of their mean, its error by what each pixel differs
    /// between the two. Holds where pixels do not share random numbers.
    pub fn of_twins(a: &Picture, b: &Picture) -> Estimate {
        let n = a.rgb.len().max(1) as f64;
        let half = |(p, q): (&[f32; 3], &[f32; 3])| (light(p) - light(q)) / 2.0;
        let squares: f64 = a.rgb.iter().zip(&b.rgb).map(|pair| half(pair).powi(2)).sum();
        Estimate {
            value: (mean_light(a) + mean_light(b)) / 2.0,
            standard_error: squares.sqrt() / n,
        }
    }

    /// This over a truth, less 1; both errors count. Nothing where the truth is black.
    pub fn relative_to(self, truth: Estimate) -> Option<Estimate> {
        let ratio = self.value / truth.value;
        let standard_error = self.standard_error.hypot(ratio * truth.standard_error) / truth.value.abs();
        let value = ratio - 1.0;
        (value.is_finite() && standard_error.is_finite()).then_some(Estimate {
            value,
            standard_error,
        })
    }

    /// How many standard errors the value is from zero.
    pub fn z(self) -> f64 {
        if self.standard_error > 0.0 {
            self.value / self.standard_error
        } else {
            0.0
        }
    }
}

fn light(rgb: &[f32; 3]) -> f64 {
    rgb.iter().map(|&x| f64::from(x)).sum::<f64>() / 3.0
}

/// Mean radiance of a picture over pixels and channels, nothing clipped.
pub fn mean_light(picture: &Picture) -> f64 {
    picture.rgb.iter().map(light).sum::<f64>() / picture.rgb.len().max(1) as f64
}

/// The mean of pictures of one size, each weighed by its samples a pixel.
#[derive(Clone, Debug, Default)]
pub struct Average {
    size: [usize; 2],
    sum: Vec<[f64; 3]>,
    weight: f64,
}

impl Average {
    pub fn add(&mut self, picture: &Picture, weight: f64) {
        self.size = [picture.width, picture.height];
        self.sum.resize(picture.rgb.len(), [0.0; 3]);
        for (sum, rgb) in self.sum.iter_mut().zip(&picture.rgb) {
            *sum = std::array::from_fn(|c| sum[c] + weight * f64::from(rgb[c]));
        }
        self.weight += weight;
    }

    pub fn picture(&self) -> Picture {
        let mean = |sum: &[f64; 3]| sum.map(|x| (x / self.weight) as f32);
        Picture {
            width: self.size[0],
            height: self.size[1],
            rgb: self.sum.iter().map(mean).collect(),
            ..Picture::default()
        }
    }
}

/// Exponent of the power of x that fits y best (least squares of the logarithms): -0.5 for the error of independent
/// samples. Points that are not above zero are left out; nothing is fitted to fewer than three.
pub fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<(f64, f64)> = points
        .iter()
        .filter(|(x, y)| *x > 0.0 && *y > 0.0)
        .map(|(x, y)| (x.ln(), y.ln()))
        .collect();
    if logs.len() < 3 {
        return None;
    }
    let n = logs.len() as f64;
    let (mean_x, mean_y) = logs
        .iter()
        .fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x / n, sy + y / n));
    let (xy, xx) = logs.iter().fold((0.0, 0.0), |(xy, xx), (x, y)| {
        (xy + (x - mean_x) * (y - mean_y), xx + (x - mean_x).powi(2))
    });
    (xx > 0.0).then_some(xy / xx)
}

/// A picture of `factor` times the size, each pixel the mean of those it covers: what a box filter sees. `None` where
/// the size is no multiple.
pub fn shrunk(picture: &Picture, width: usize, height: usize) -> Option<Picture> {
    let factor = picture.width / width.max(1);
    if factor == 0 || width * factor != picture.width || height * factor != picture.height {
        return None;
    }
    let pixel = |i: usize| {
        let (left, top) = (i % width * factor, i / width * factor);
        let mut sum = [0.0; 3];
        for j in 0..factor * factor {
            let rgb = picture.rgb[(top + j / factor) * picture.width + left + j % factor];
            sum = std::array::from_fn(|c| sum[c] + f64::from(rgb[c]));
        }
        sum.map(|x| (x / (factor * factor) as f64) as f32)
    };
    Some(Picture {
        width,
        height,
        rgb: (0..width * height).map(pixel).collect(),
        ..Picture::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: usize, values: &[f32]) -> Picture {
        Picture {
            width,
            height: values.len() / width,
            rgb: values.iter().map(|&x| [x; 3]).collect(),
            ..Picture::default()
        }
    }

    #[test]
    fn the_error_of_a_mean_falls_with_the_root_of_the_number() {
        let e = Estimate::of(&[1.0, 3.0]);
        assert_eq!((e.value, e.standard_error), (2.0, 1.0));
        // Deviation 2/√3 of each (8 - 1 degrees of freedom aside), by √8.
        let e = Estimate::of(&[1.0, 3.0, 1.0, 3.0, 1.0, 3.0, 1.0, 3.0]);
        assert!((e.standard_error - (8.0f64 / 7.0 / 8.0).sqrt()).abs() < 1e-12);
        assert_eq!(Estimate::of(&[5.0]).z(), 0.0);
    }

    #[test]
    fn twins_tell_their_noise() {
        // Four pixels that differ by ±0.2: their means' deviation is 0.1 each, that of all 0.1 / √4.
        let (a, b) = (
            picture(2, &[0.6, 0.4, 0.6, 0.4]),
            picture(2, &[0.4, 0.6, 0.4, 0.6]),
        );
        let e = Estimate::of_twins(&a, &b);
        assert!((e.value - 0.5).abs() < 1e-7 && (e.standard_error - 0.05).abs() < 1e-7);
    }

    #[test]
    fn a_share_takes_both_errors() {
        let of = |value, standard_error| Estimate {
            value,
            standard_error,
        };
        let share = of(1.02, 0.003).relative_to(of(1.0, 0.004)).unwrap();
        assert!((share.value - 0.02).abs() < 1e-12);
        assert!((share.standard_error - 0.003f64.hypot(1.02 * 0.004)).abs() < 1e-12);
        assert_eq!(of(1.0, 0.1).relative_to(of(0.0, 0.0)), None);
    }

    #[test]
    fn averages_weigh_by_samples() {
        let mut average = Average::default();
        average.add(&picture(1, &[1.0]), 3.0);
        average.add(&picture(1, &[5.0]), 1.0);
        assert_eq!(average.picture().rgb, [[2.0; 3]]);
    }

    #[test]
    fn slopes_are_exponents() {
        let points: Vec<_> = (0..6)
            .map(|i| (f64::from(1 << i), 3.0 * f64::from(1 << i).powf(-0.75)))
            .collect();
        assert!((slope(&points).unwrap() - -0.75).abs() < 1e-12);
        assert_eq!(slope(&points[..2]), None);
        assert_eq!(slope(&[(1.0, 0.0), (2.0, 0.0), (4.0, 0.0)]), None);
    }

    #[test]
    fn a_box_filter_shrinks() {
        let large = picture(4, &[1.0, 3.0, 0.0, 0.0, 5.0, 7.0, 0.0, 8.0]);
        assert_eq!(shrunk(&large, 2, 1).unwrap().rgb, [[4.0; 3], [2.0; 3]]);
        assert_eq!(shrunk(&large, 4, 2), Some(large.clone()));
        assert!(
            shrunk(&large, 3, 1).is_none()
                && shrunk(&large, 2, 2).is_none()
                && shrunk(&large, 8, 4).is_none()
        );
    }
}
