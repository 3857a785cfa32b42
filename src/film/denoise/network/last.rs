//! What is done for light of one frame when the network's filter is through, which leaves blocks on smooth surfaces.

use crate::color::Rgb9e5;
use crate::film::Feature;
use crate::film::denoise::weight::{FALL, FAR, Mean, luma_code, turn_of};

/// What an eighth of an octave counts, halves: what differs by one sample may be noise, what differs by more less so.
pub(super) const fn luma(samples: u32) -> u32 {
    if samples == 1 { 3 } else { 6 }
}

/// The mean of 3 × 3 pixels of one thing about place `at` of a picture so wide, 1 : 2 : 1 across and down, by how alike they are.
///
/// Unlikeness is counted in eighths of a halving, as by the à-trous filter: 2 for a turn by a cosine of 1 − 1/127, ½ for a
/// sixteenth of an octave of distance, `luma` halves for an eighth of an octave of luminance.
pub(super) fn smooth(frame: &[Feature], light: &[Rgb9e5], width: usize, at: usize, luma: u32) -> Rgb9e5 {
    let (Some(own), Some(own_light)) = (frame.get(at), light.get(at)) else {
        return Rgb9e5::BLACK;
    };
    let own_luma = luma_code(*own_light);
    let x = at % width.max(1);
    let (mut lights, mut weights) = ([*own_light; 9], [0; 9]);
    let mut mean = Mean::new();
    let columns = x.saturating_sub(1)..(x + 2).min(width);
    let mut count = 0;
    for row in [at.checked_sub(width), Some(at), at.checked_add(width)] {
        // The first of the row.
        let Some(start) = row.map(|middle| middle - x) else {
            continue;
        };
        for column in columns.clone() {
            let (Some(pixel), Some(light)) = (frame.get(start + column), light.get(start + column)) else {
                continue;
            };
            if pixel.id != own.id || count == 9 {
                continue;
            }
            let unlike = 2 * turn_of(own, pixel)
                + u32::from(pixel.depth.abs_diff(own.depth)) / 2
                + luma * u32::from(luma_code(*light).abs_diff(own_luma)) / 2;
            let down = u32::from(start + x == at) + u32::from(column == x);
            // raw: 16 times 64 in all.
            let weight = u32::from(FALL[unlike.min(FAR) as usize]) << down;
            if weight > 0 {
                mean.see(*light);
                (lights[count], weights[count]) = (*light, weight);
                count += 1;
            }
        }
    }
    for (light, weight) in lights.iter().zip(weights).take(count) {
        mean.add(*light, weight);
    }
    mean.light()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of lights, in 64ths, each of a thing of this number.
    fn row<const N: usize>(pixels: [(u32, u16); N], luma: u32) -> [u32; N] {
        let frame = pixels.map(|(_, id)| Feature {
            id,
            ..Feature::default()
        });
        let light = pixels.map(|(light, _)| Rgb9e5::from_bits([light; 3], -6));
        core::array::from_fn(|at| {
            let ([bits, ..], exponent) = smooth(&frame, &light, N, at, luma).to_parts();
            bits >> (-6 - exponent)
        })
    }

    #[test]
    fn what_is_even_stays() {
        assert_eq!(row([(64, 1); 4], 3), [64; 4]);
        assert_eq!(row([(40, 1)], 3), [40]);
    }

    #[test]
    fn what_hardly_differs_is_mixed_and_what_differs_is_not() {
        assert_eq!(row([(64, 1), (72, 1), (64, 1)], luma(1)), [66, 68, 66]);
        assert_eq!(row([(64, 1), (80, 1), (64, 1)], luma(1)), [68, 73, 68]);
        assert_eq!(row([(64, 1), (80, 1), (64, 1)], luma(4)), [67, 74, 67]);
        assert_eq!(row([(1, 1), (255, 1), (1, 1)], luma(1)), [1, 255, 1]);
    }

    #[test]
    fn other_things_count_for_nothing() {
        assert_eq!(row([(64, 1), (72, 2), (64, 3)], 3), [64, 72, 64]);
    }
}
