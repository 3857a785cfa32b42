//! The difference of two pictures as a picture.

use super::{DARK, MetricsError, all_finite, same_size};
use crate::picture::Picture;

/// Relative error at which a pixel has its full colour.
pub const FULL_COLOUR: f64 = 0.5;

const DARKER: [f64; 3] = [33.0, 102.0, 172.0];
const EQUAL: [f64; 3] = [247.0, 247.0, 247.0];
const BRIGHTER: [f64; 3] = [178.0, 24.0, 43.0];

/// Picture less reference, signed, linear light.
pub fn difference(picture: &Picture, reference: &Picture) -> Result<Picture, MetricsError> {
    same_size(picture, reference)?;
    let rgb = picture.rgb.iter().zip(&reference.rgb);
    let rgb = rgb.map(|(p, r)| std::array::from_fn(|c| p[c] - r[c])).collect();
    Ok(Picture {
        width: picture.width,
        height: picture.height,
        rgb,
        ..Picture::default()
    })
}

/// Signed relative error of each pixel (channels averaged; 0.01 added to the reference's light) as colours: white where
/// equal, red where brighter than the reference, blue where darker, full colour from [`FULL_COLOUR`] on.
///
/// Both ways are equally far from white to the eye: ends and middle of ColorBrewer's RdBu (Brewer, 2003).
pub fn difference_colours(picture: &Picture, reference: &Picture) -> Result<Vec<[u8; 3]>, MetricsError> {
    same_size(picture, reference)?;
    all_finite(picture)?;
    all_finite(reference)?;
    let sum = |rgb: &[f32; 3]| rgb.iter().map(|&x| f64::from(x)).sum::<f64>() / 3.0;
    let error = |(p, r): (&[f32; 3], &[f32; 3])| (sum(p) - sum(r)) / (sum(r) + DARK);
    Ok(picture
        .rgb
        .iter()
        .zip(&reference.rgb)
        .map(|pair| colour(error(pair)))
        .collect())
}

fn colour(error: f64) -> [u8; 3] {
    let end = if error < 0.0 { DARKER } else { BRIGHTER };
    let t = (error.abs() / FULL_COLOUR).min(1.0);
    std::array::from_fn(|c| (EQUAL[c] + (end[c] - EQUAL[c]) * t).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn red_is_brighter_and_blue_is_darker() {
        let row = |values: [f32; 3]| {
            let rgb = values.map(|x| [x; 3]).to_vec();
            Picture {
                width: 3,
                height: 1,
                rgb,
                ..Picture::default()
            }
        };
        let (picture, reference) = (row([0.5, 0.9, 0.1]), row([0.5; 3]));
        assert_eq!(
            difference_colours(&picture, &reference).unwrap(),
            [EQUAL, BRIGHTER, DARKER].map(|rgb| rgb.map(|x| x as u8))
        );
        let signed = difference(&picture, &reference).unwrap();
        assert!((signed.rgb[2][0] - -0.4).abs() < 1e-6 && (signed.rgb[1][0] - 0.4).abs() < 1e-6);
    }

    #[test]
    fn half_the_error_is_half_the_way() {
        assert_eq!(colour(FULL_COLOUR / 2.0), [213, 136, 145]);
        assert_eq!(colour(-9.0), DARKER.map(|x| x as u8));
    }
}
