use super::Size;
use super::weight::{FALL, FAR, Mean, shines, turn_of};
use crate::color::{Radiance, Rgb9e5};
use crate::film::Feature;
use zerocopy::transmute_ref;

/// Half-lives, in eighths, that tell neighbours apart: for another number, for a turn by a cosine of 1 − 1/127, for a code
/// of distance.
const UNLIKE: [u32; 3] = [32, 2, 4];

/// The light of pixel (x, y) of a picture twice as wide and high, before its albedo.
///
/// Joint bilateral upsampling (Kopf et al., 2007): the four pixels about it, by where they are (9 : 3 : 3 : 1) and how
/// like `guide` they are. Where none of them is of the same thing, those of it among the twelve about them speak; where
/// there is none either, the least unlike of the four speaks most.
pub fn upsample(
    size: Size,
    frame: &[Feature],
    light: &[Rgb9e5],
    [x, y]: [u16; 2],
    guide: &Feature,
) -> Radiance {
    // The middle of the fine pixel lies a quarter of a coarse one beside a middle, left and up if it is even.
    let both = |c: u16, side: u16| {
        let near = (c / 2) as i32;
        let far = if c.is_multiple_of(2) { near - 1 } else { near + 1 };
        [near, far].map(|c| c.clamp(0, (side as i32 - 1).max(0)) as usize)
    };
    let columns = both(x, size.width);
    let rows = both(y, size.height).map(|y| y * size.width as usize);
    let mut taps = [(Rgb9e5::BLACK, 0); 4];
    let mut mean = Mean::new();
    let mut least = FAR;
    for (i, tap) in taps.iter_mut().enumerate() {
        let there = rows[i >> 1] + columns[i & 1];
        let (Some(pixel), Some(light)) = (frame.get(there), light.get(there)) else {
            continue;
        };
        let unlike = unlike(pixel, guide);
        least = least.min(unlike);
        let share = [9, 3, 3, 1][i];
        // Never nothing.
        *tap = (*light, share * FALL[unlike.min(48) as usize] as u32);
        mean.see(*light);
    }
    if least >= UNLIKE[0]
        && let Some(light) = about(size, frame, light, [x, y], guide)
    {
        return light;
    }
    for (light, weight) in taps {
        mean.add(light, weight);
    }
    answer(&mean)
}

/// Of the sixteen about pixel (x, y), those that are of the guide's thing; the same for each of them.
#[cold]
fn about(
    size: Size,
    frame: &[Feature],
    light: &[Rgb9e5],
    [x, y]: [u16; 2],
    guide: &Feature,
) -> Option<Radiance> {
    let [left, top] = [x, y].map(|c| (c.div_ceil(2) as i32) - 2);
    let alike = || {
        (0..16).filter_map(|i| {
            let (x, y) = (left + (i & 3), top + (i >> 2));
            let is_inside = (0..size.width as i32).contains(&x) && (0..size.height as i32).contains(&y);
            let place = is_inside.then(|| y as usize * size.width as usize + x as usize)?;
            let (pixel, light) = (frame.get(place)?, light.get(place)?);
            let unlike = unlike(pixel, guide);
            (unlike < UNLIKE[0]).then(|| (*light, FALL[unlike as usize] as u32))
        })
    };
    let mut mean = Mean::new();
    alike().for_each(|(light, _)| mean.see(light));
    alike().for_each(|(light, weight)| mean.add(light, weight));
    (mean.weight() > 0).then(|| answer(&mean))
}

/// Eighths of a half-life.
#[inline(always)]
fn unlike(pixel: &Feature, guide: &Feature) -> u32 {
    let &[_, seen, looks]: &[u32; 3] = transmute_ref!(guide);
    let &[_, tap_seen, tap_looks]: &[u32; 3] = transmute_ref!(pixel);
    if shines(tap_seen) != shines(seen) {
        return FAR;
    }
    let depth = u32::from_le(seen) >> 24;
    let mut unlike = (u32::from_le(tap_seen) >> 24).abs_diff(depth) * UNLIKE[2];
    // Most are of the same thing and look the same way, to the last bit.
    let differs = u32::from_le(tap_looks ^ looks);
    if differs != 0 {
        unlike += turn_of(pixel, guide) * UNLIKE[1];
        if differs >> 16 != 0 {
            unlike += UNLIKE[0];
        }
    }
    unlike
}

fn answer(mean: &Mean) -> Radiance {
    if mean.weight() == 0 {
        return Radiance::BLACK;
    }
    let (bits, exponent) = mean.divided();
    Radiance::from_bits(bits, exponent)
}
