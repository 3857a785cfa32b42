use super::Size;
use super::weight::{FALL, FAR, Mean, shines, short_normal, turn};
use crate::color::{Radiance, Rgb9e5};
use crate::film::Feature;

/// Half-lives, in eighths, that tell neighbours apart: for another number, for a turn by a cosine of 1 − 1/127, for a code
/// of distance.
const UNLIKE: [u32; 3] = [32, 2, 4];

/// The light of pixel (x, y) of a picture twice as wide and high, before its albedo.
///
/// Joint bilateral upsampling (Kopf et al., 2007): the four pixels about it, by where they are (9 : 3 : 3 : 1) and how
/// like `guide` they are. Where none is like it, the least unlike speaks most.
pub fn upsample(
    size: Size,
    frame: &[Feature],
    light: &[Rgb9e5],
    [x, y]: [u16; 2],
    guide: &Feature,
) -> Radiance {
    // Most look the same way as the guide to the last bit: no normal is asked for.
    let mut normal = None;
    let mut turned = |pixel: &Feature| {
        let normal = *normal.get_or_insert_with(|| short_normal(guide));
        if pixel.normal == guide.normal {
            turn(normal, normal)
        } else {
            turn(short_normal(pixel), normal)
        }
    };
    // The middle of the fine pixel lies a quarter of a coarse one beside a middle, left and up if it is even.
    let near = [x, y].map(|c| (c / 2) as i32);
    let far = [x, y].map(|c| (c / 2) as i32 + if c % 2 == 0 { -1 } else { 1 });
    let mut taps = [(Rgb9e5::BLACK, 0); 4];
    let mut mean = Mean::new();
    for (i, tap) in taps.iter_mut().enumerate() {
        let tx = if i & 1 == 0 { near[0] } else { far[0] };
        let ty = if i & 2 == 0 { near[1] } else { far[1] };
        let there = size.clamped(tx, ty);
        let (Some(pixel), Some(light)) = (frame.get(there), light.get(there)) else {
            continue;
        };
        let mut unlike = turned(pixel) * UNLIKE[1];
        unlike += pixel.depth.abs_diff(guide.depth) as u32 * UNLIKE[2];
        if pixel.id != guide.id {
            unlike += UNLIKE[0];
        }
        if shines(pixel) != shines(guide) {
            unlike = FAR;
        }
        let share = [9, 3, 3, 1][i];
        // Never nothing.
        *tap = (*light, share * FALL[unlike.min(48) as usize] as u32);
        mean.see(*light);
    }
    for (light, weight) in taps {
        if weight > 0 {
            mean.add(light, weight);
        }
    }
    if mean.weight() == 0 {
        return Radiance::BLACK;
    }
    let (bits, exponent) = mean.divided();
    Radiance::from_bits(bits, exponent)
}
