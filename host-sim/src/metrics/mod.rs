//! How far one picture is from another, in numbers and as a picture.
//!
//! The numbers are those of the bars: light above [`CAP`] counts as [`CAP`], so that the lights' own pixels do not rule
//! the mean; PSNR, SSIM and FLIP look at what a display shows, sRGB clipped to 0..1.

mod diff;
mod percentile;
mod ssim;

pub use diff::{FULL_COLOUR, difference, difference_colours};
pub use percentile::Percentiles;

use crate::picture::{Picture, srgb};

/// Radiance above which brighter is no further away.
pub const CAP: f64 = 8.0;
/// PSNR reported at most, dB: that of equal pictures, which have none.
pub const PSNR_MAX: f64 = 200.0;
/// Side of the blocks of [`Metrics::block_p95`], pixels.
pub const BLOCK: usize = 8;
/// Means below this count as this, so that a relative error stays finite.
const DARKEST_MEAN: f64 = 1e-6;
/// Added to a block's or pixel's light before something is divided by it.
const DARK: f64 = 0.01;

/// Errors of a picture against a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metrics {
    /// Mean over the reference's mean, less 1 (all pixels and channels, capped).
    pub bias: f64,
    /// Root of the mean squared difference of linear light (capped).
    pub rmse: f64,
    /// 10 log₁₀(1 / mean squared difference) of the sRGB signals, at most [`PSNR_MAX`].
    pub psnr_db: f64,
    /// Structural similarity of the same signals' luma: 1 equal, 0 (or less) nothing in common.
    pub ssim: f64,
    /// Mean of the FLIP map: 0 equal, 1 as different as can be.
    pub flip: f64,
    /// 95th percentile of the relative error of 8×8 blocks (capped): a local bias that noise hides in single pixels.
    pub block_p95: f64,
    pub block_max: f64,
}

/// Why two pictures cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MetricsError {
    #[error("{} x {} pixels cannot be compared with {} x {}; render at the same size", .0.0, .0.1, .1.0, .1.1)]
    Sizes((usize, usize), (usize, usize)),
    #[error("pixel ({0}, {1}) is not a finite number")]
    NotFinite(usize, usize),
}

impl Metrics {
    pub fn of(picture: &Picture, reference: &Picture) -> Result<Metrics, MetricsError> {
        same_size(picture, reference)?;
        all_finite(picture)?;
        all_finite(reference)?;
        let (p, r) = (capped(picture), capped(reference));
        let reference_mean = mean(r.as_flattened());
        let (block_p95, block_max) = block_errors(&p, &r, picture.width);
        Ok(Metrics {
            bias: (mean(p.as_flattened()) - reference_mean) / reference_mean.max(DARKEST_MEAN),
            rmse: rmse(picture, reference)?,
            psnr_db: psnr(mean_square(&signals(picture), &signals(reference))),
            ssim: ssim::mean(&luma(picture), &luma(reference), picture.width),
            flip: mean(&flip_map(picture, reference)?.map(f64::from).collect::<Vec<_>>()),
            block_p95,
            block_max,
        })
    }

    /// The numbers with the names that files have for them.
    pub fn entries(&self) -> [(&'static str, f64); 7] {
        [
            ("bias", self.bias),
            ("rmse", self.rmse),
            ("psnr_db", self.psnr_db),
            ("ssim", self.ssim),
            ("flip", self.flip),
            ("block_p95", self.block_p95),
            ("block_max", self.block_max),
        ]
    }
}

/// [`Metrics::rmse`] alone.
pub fn rmse(picture: &Picture, reference: &Picture) -> Result<f64, MetricsError> {
    same_size(picture, reference)?;
    all_finite(picture)?;
    all_finite(reference)?;
    Ok(mean_square(&capped(picture), &capped(reference)).sqrt())
}

/// FLIP of each pixel, 0..1, at 67 pixels a degree (0.7 m from a 0.7 m wide screen of 3840 pixels, the paper's default).
///
/// Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: A difference evaluator for alternating
/// images", 2020; its authors' own code, which reads 8-bit sRGB: against their evaluator on unrounded signals the mean
/// is at most 0.002 off (measured; the most where pictures hardly differ), on the same 8 bits at most 0.0001.
pub fn flip_map(
    picture: &Picture,
    reference: &Picture,
) -> Result<impl Iterator<Item = f32> + use<>, MetricsError> {
    same_size(picture, reference)?;
    let image = |p: &Picture| {
        let bytes: Vec<u8> = signals(p)
            .as_flattened()
            .iter()
            .map(|x| (x * 255.0).round() as u8)
            .collect();
        nv_flip::FlipImageRgb8::with_data(p.width as u32, p.height as u32, &bytes)
    };
    let map = nv_flip::flip(
        image(reference),
        image(picture),
        nv_flip::DEFAULT_PIXELS_PER_DEGREE,
    );
    Ok(map.to_vec().into_iter())
}

fn same_size(a: &Picture, b: &Picture) -> Result<(), MetricsError> {
    match (a.width, a.height) == (b.width, b.height) {
        true => Ok(()),
        false => Err(MetricsError::Sizes((a.width, a.height), (b.width, b.height))),
    }
}

fn all_finite(picture: &Picture) -> Result<(), MetricsError> {
    match picture
        .rgb
        .iter()
        .position(|rgb| !rgb.iter().all(|x| x.is_finite()))
    {
        None => Ok(()),
        Some(i) => Err(MetricsError::NotFinite(i % picture.width, i / picture.width)),
    }
}

fn capped(picture: &Picture) -> Vec<[f64; 3]> {
    picture
        .rgb
        .iter()
        .map(|rgb| rgb.map(|x| f64::from(x).min(CAP)))
        .collect()
}

fn signals(picture: &Picture) -> Vec<[f64; 3]> {
    picture
        .rgb
        .iter()
        .map(|rgb| rgb.map(|x| srgb(f64::from(x))))
        .collect()
}

/// Rec. 709 luma of the signals.
fn luma(picture: &Picture) -> Vec<f64> {
    let signals = signals(picture);
    signals
        .iter()
        .map(|[r, g, b]| 0.2126 * r + 0.7152 * g + 0.0722 * b)
        .collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn mean_square(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let squares: Vec<f64> = a
        .as_flattened()
        .iter()
        .zip(b.as_flattened())
        .map(|(x, y)| (x - y) * (x - y))
        .collect();
    mean(&squares)
}

fn psnr(mean_square: f64) -> f64 {
    (-10.0 * mean_square.log10()).min(PSNR_MAX)
}

/// 95th percentile and maximum of |block - reference's| / (reference's + 0.01) over whole blocks, channels averaged; a
/// picture smaller than a block is one.
fn block_errors(picture: &[[f64; 3]], reference: &[[f64; 3]], width: usize) -> (f64, f64) {
    let height = picture.len() / width.max(1);
    let (across, down) = (BLOCK.min(width), BLOCK.min(height));
    let mut errors = Vec::new();
    for top in (0..height.saturating_sub(down - 1)).step_by(down) {
        for left in (0..width.saturating_sub(across - 1)).step_by(across) {
            let (mut p, mut r) = ([0.0; 3], [0.0; 3]);
            for i in (0..across * down).map(|i| (top + i / across) * width + left + i % across) {
                for c in 0..3 {
                    p[c] += picture[i][c] / (across * down) as f64;
                    r[c] += reference[i][c] / (across * down) as f64;
                }
            }
            let error = (0..3).map(|c| (p[c] - r[c]).abs()).sum::<f64>() / 3.0;
            errors.push(error / (mean(&r) + DARK));
        }
    }
    errors.sort_by(f64::total_cmp);
    (
        percentile::interpolated(&errors, 0.95),
        errors.last().copied().unwrap_or(0.0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(width: usize, height: usize, value: f32) -> Picture {
        Picture {
            width,
            height,
            rgb: vec![[value; 3]; width * height],
            ..Picture::default()
        }
    }

    #[test]
    fn a_flat_picture_a_tenth_too_bright() {
        let m = Metrics::of(&flat(16, 16, 0.55), &flat(16, 16, 0.5)).unwrap();
        assert!((m.bias - 0.1).abs() < 1e-6);
        assert!((m.rmse - 0.05).abs() < 1e-6);
        // sRGB signals 0.76738, 0.73536.
        assert!((m.psnr_db - 29.892).abs() < 1e-3, "{}", m.psnr_db);
        assert!((m.block_p95 - 0.05 / 0.51).abs() < 1e-6 && (m.block_max - m.block_p95).abs() < 1e-9);
        assert!((m.flip - 0.12158).abs() < 1e-4, "{}", m.flip); // as flip_evaluator 1.7 has it
    }

    #[test]
    fn flip_is_that_of_its_authors() {
        let picture = |columns: [f32; 3]| {
            let pixel = |i: usize| {
                let (x, y) = (i % 32, i / 32);
                let steps = [(x * 7 + y * 13) % 32, (x * 3 + y * 5) % 16, (x + y) % 8];
                std::array::from_fn(|c| steps[c] as f32 / columns[c])
            };
            Picture {
                width: 32,
                height: 24,
                rgb: (0..32 * 24).map(pixel).collect(),
                ..Picture::default()
            }
        };
        let m = Metrics::of(&picture([36.0, 16.0, 7.0]), &picture([32.0, 16.0, 8.0])).unwrap();
        // flip_evaluator 1.7 on the same signals, rounded to 8 bits: 0.200447; not rounded: 0.200478.
        assert!((m.flip - 0.200_447).abs() < 1e-4, "{}", m.flip);
        // numpy on the same pictures, as Mitsuba wrote and read them.
        assert!((m.rmse - 0.056_287_04).abs() < 1e-7 && (m.psnr_db - 29.848_339).abs() < 1e-5);
        // scikit-image 0.26 on the same lumas: Gaussian of 1.5 pixels, no sample covariance.
        assert!((m.ssim - 0.999_874_518).abs() < 1e-6, "{}", m.ssim);
    }

    #[test]
    fn equal_pictures_are_at_no_distance() {
        let m = Metrics::of(&flat(3, 2, 0.5), &flat(3, 2, 0.5)).unwrap();
        let expected = Metrics {
            bias: 0.0,
            rmse: 0.0,
            psnr_db: PSNR_MAX,
            ssim: 1.0,
            flip: 0.0,
            block_p95: 0.0,
            block_max: 0.0,
        };
        assert_eq!(m, expected);
        assert_eq!(Metrics::of(&flat(1, 1, 0.0), &flat(1, 1, 0.0)).unwrap(), expected);
    }

    #[test]
    fn black_against_white_is_far() {
        let m = Metrics::of(&flat(8, 8, 1.0), &flat(8, 8, 0.0)).unwrap();
        assert!(m.rmse == 1.0 && m.psnr_db.abs() < 1e-9);
        assert!(m.flip > 0.9 && m.bias > 1e5, "{m:?}");
    }

    #[test]
    fn light_beyond_the_cap_does_not_count() {
        let m = Metrics::of(&flat(8, 8, 900.0), &flat(8, 8, 8.0)).unwrap();
        assert_eq!((m.bias, m.rmse), (0.0, 0.0));
    }

    #[test]
    fn bias_has_a_sign_and_blocks_find_what_it_hides() {
        let mut picture = flat(16, 8, 0.5);
        for i in 0..picture.rgb.len() {
            picture.rgb[i] = if i % 16 < 8 { [0.25; 3] } else { [0.75; 3] };
        }
        let m = Metrics::of(&picture, &flat(16, 8, 0.5)).unwrap();
        assert!(m.bias.abs() < 1e-9 && (m.block_p95 - 0.25 / 0.51).abs() < 1e-6);
        assert!(Metrics::of(&flat(8, 8, 0.4), &flat(8, 8, 0.5)).unwrap().bias < -0.19);
    }

    #[test]
    fn what_cannot_be_compared_is_told() {
        let error = Metrics::of(&flat(8, 8, 0.0), &flat(8, 9, 0.0)).unwrap_err();
        assert_eq!(
            error.to_string(),
            "8 x 8 pixels cannot be compared with 8 x 9; render at the same size"
        );
        let mut broken = flat(8, 8, 0.0);
        broken.rgb[11][1] = f32::NAN;
        assert_eq!(
            Metrics::of(&flat(8, 8, 0.0), &broken),
            Err(MetricsError::NotFinite(3, 1))
        );
    }
}
