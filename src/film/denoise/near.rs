//! What the light about a pixel says of its own, and of what is remembered.

use crate::color::Rgb9e5;
use crate::film::Feature;
use crate::num::leading_zeros;

/// A pixel's luminance is at most that of the second brightest of its 3 × 3, times two to this power.
pub const FIREFLY: u32 = 2;

/// The luminance of a light as a number that grows with it; 2^16 more for each octave, 0 for black.
#[inline]
pub(super) fn luma(light: Rgb9e5) -> u32 {
    let ([r, g, b], exponent) = light.to_parts();
    // raw: under 2^17
    let y = 54 * r + 183 * g + 19 * b;
    if y == 0 {
        return 0;
    }
    let zeros = leading_zeros(y);
    // The highest bit is in the octave: 64 + 31 − 14 − 24 at least.
    let octave = (64 + 31 + exponent) as u32 - zeros;
    (octave << 16) + ((y << zeros << 1) >> 16)
}

/// The 3 × 3 pixels about one, as they were rendered; black beside the picture.
pub(super) struct Near<'a> {
    /// The row above.
    pub above: &'a [Rgb9e5],
    /// To the left of the pixel, its own, to the right.
    pub lights: [Rgb9e5; 3],
    /// The row below, and what there is of it otherwise.
    pub under: &'a [Feature],
    pub below: &'a [Rgb9e5],
    /// The pixel's place in its row.
    pub x: usize,
}

/// Whether the pixel's light, of these three that lie side by side, is seen to be no firefly: their luminances.
#[inline]
pub(super) fn is_plain([left, own, right]: [u32; 3]) -> bool {
    own <= left.max(right) + (FIREFLY << 16)
}

/// Whether the pixel's light, of these three that lie side by side, or the brighter one beside it tells that no channel of
/// another is too much; `lumas` are theirs.
#[inline]
pub(super) fn is_bounded(light: Rgb9e5, [left, own, right]: [Rgb9e5; 3], lumas: [u32; 3]) -> bool {
    let beside = if lumas[0] > lumas[2] { left } else { right };
    light.0 == 0 || is_under(light, own, 0) || is_under(light, beside, 0)
}

impl Near<'_> {
    /// The pixel's light, made darker by whole octaves until it is no firefly.
    #[inline(never)]
    pub fn clamped(&self) -> Rgb9e5 {
        let [left, light, right] = self.lights;
        let [above, below] = self.rows();
        let others = [above, [left, Rgb9e5::BLACK, right], below];
        let second = others
            .iter()
            .flatten()
            .map(|light| luma(*light))
            .max()
            .unwrap_or(0);
        let own = luma(light);
        let limit = second + (FIREFLY << 16);
        if own <= limit {
            return light;
        }
        // As many octaves as it takes; beside black nothing is left.
        let down = match second {
            0 => 40,
            _ => (own - limit).div_ceil(1 << 16).min(40),
        };
        let (m, exponent) = light.to_parts();
        Rgb9e5::from_bits(m, exponent - down as i32)
    }

    /// The three lights above and the three below.
    #[inline]
    fn rows(&self) -> [[Rgb9e5; 3]; 2] {
        let above = |x: usize| self.above.get(x).copied();
        let below = |x: usize| match self.under.get(x) {
            Some(pixel) => Some(pixel.irradiance),
            None => self.below.get(x).copied(),
        };
        let columns = [self.x.wrapping_sub(1), self.x, self.x + 1];
        let is_inside = |x: usize| x < self.above.len();
        [
            columns.map(|x| above(x).unwrap_or_default()),
            columns.map(|x| below(x).filter(|_| is_inside(x)).unwrap_or_default()),
        ]
    }

    /// Light of another place, at most twice the brightest here, by channel.
    #[inline(never)]
    pub fn around(&self, light: Rgb9e5) -> Rgb9e5 {
        let [above, below] = self.rows();
        let all = [above, self.lights, below];
        // Largest of each channel, in 256ths of the exponent, which is the largest one.
        let top = all.iter().flatten().fold(0, |top, light| top.max(light.0 >> 27));
        // Twice a light has no bits below those.
        let mut exact = all.iter().flatten().filter(|near| (near.0 >> 27) + 8 >= top);
        if exact.any(|near| is_under(light, *near, 1)) {
            return light;
        }
        let mut most = [0; 3];
        for near in all.iter().flatten() {
            let down = top - (near.0 >> 27);
            for (most, m) in most.iter_mut().zip(near.to_parts().0) {
                // raw: under 2^17; exponents are 31 apart at most.
                *most = (m << 8 >> (down & 31)).max(*most);
            }
        }
        let least = top as i32 - 24;
        let (m, exponent) = light.to_parts();
        let up = exponent - least;
        // Both in 256ths of the exponent here. raw: under 2^17 before, and 2^14 more.
        let whole = if up >= 14 {
            m.map(|m| if m == 0 { 0 } else { u32::MAX >> 1 })
        } else if up >= 0 {
            m.map(|m| m << 8 << up)
        } else {
            m.map(|m| (m << 8) >> (-up).min(31))
        };
        let bits = [0, 1, 2].map(|i| whole[i].min(2 * most[i]));
        // As it was, to the last bit, where nothing is too much.
        if up < 14 && (0..3).all(|i| bits[i] == whole[i]) {
            return light;
        }
        Rgb9e5::from_bits(bits, least - 8)
    }
}

/// Whether no channel is more than the other's times 2^`up`.
#[inline]
fn is_under(light: Rgb9e5, other: Rgb9e5, up: u32) -> bool {
    let (low, high) = (light.0 >> 27, (other.0 >> 27) + up);
    if low > high {
        return false;
    }
    let up = (high - low).min(9);
    let channels = [0, 9, 18].map(|shift| [light, other].map(|light| light.0 >> shift & 511));
    channels.iter().all(|[light, other]| *light <= other << up)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the rules say, of all nine at once.
    fn clamped(all: [Rgb9e5; 9]) -> Rgb9e5 {
        let mut lumas = all.map(luma);
        lumas.sort_unstable();
        let (own, limit) = (luma(all[4]), lumas[7] + (FIREFLY << 16));
        if own <= limit {
            return all[4];
        }
        let down = if lumas[7] == 0 {
            40
        } else {
            (own - limit).div_ceil(1 << 16).min(40)
        };
        let (m, exponent) = all[4].to_parts();
        Rgb9e5::from_bits(m, exponent - down as i32)
    }

    fn around(all: [Rgb9e5; 9], light: Rgb9e5) -> Rgb9e5 {
        let top = all.map(|near| near.to_parts().1).into_iter().max().unwrap();
        // 256ths of the largest exponent.
        let bits = |light: Rgb9e5| {
            let (m, exponent) = light.to_parts();
            let up = exponent - top;
            m.map(|m| match u64::from(m) << 8 {
                m if up >= 0 => m << up,
                m => m >> -up,
            })
        };
        let most = all.map(bits);
        let limit = [0, 1, 2].map(|i| 2 * most.iter().map(|m| m[i]).max().unwrap());
        if (0..3).all(|i| bits(light)[i] <= limit[i]) {
            return light;
        }
        Rgb9e5::from_bits([0, 1, 2].map(|i| bits(light)[i].min(limit[i]) as u32), top - 8)
    }

    #[test]
    fn quick_answers_are_the_rules() {
        let mut state = 3u32;
        let mut random = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            state ^ (state >> 15)
        };
        let (mut darker, mut held) = (0, 0);
        for round in 0..300_000 {
            let (least, spread) = (random() % 20, [1, 2, 4, 12][round & 3]);
            let blacks = random() % 9;
            // Mantissas are full, as they are encoded, so that black alone has a small luminance.
            let masks = [0x07ff_ffff, 0x07fc_0000, 0x01ff, 0];
            let mut light = || {
                let exponent = least + random() % spread;
                let full = 256 << [0, 9, 18][random() as usize % 3];
                let mantissas = random() & masks[random() as usize % 4] | full;
                if random() % 9 < blacks {
                    Rgb9e5::BLACK
                } else {
                    Rgb9e5(mantissas | exponent << 27)
                }
            };
            let all = [0; 9].map(|_| light());
            // One of them twice, or of another exponent, or any.
            let one = all[round / 5 % 9].0;
            let remembered = match round % 5 {
                _ if one == 0 => light(),
                0 => light(),
                1 | 2 => Rgb9e5(one.saturating_add(1 << 27)),
                _ => Rgb9e5(one & 0x07ff_ffff | (least + round as u32 / 45 % 12) << 27),
            };
            let x = round % 3;
            let mut above = [Rgb9e5::BLACK; 5];
            above[x..x + 3].copy_from_slice(&all[..3]);
            let mut below = [Rgb9e5::BLACK; 5];
            below[x..x + 3].copy_from_slice(&all[6..]);
            let under = below.map(|irradiance| Feature {
                irradiance,
                ..Feature::default()
            });
            let is_last = round % 8 < 4;
            let near = Near {
                above: &above,
                lights: [all[3], all[4], all[5]],
                under: if is_last { &[] } else { &under },
                below: if is_last { &below } else { &[] },
                x: x + 1,
            };
            let lumas = near.lights.map(luma);
            let expected = clamped(all);
            assert_eq!(near.clamped(), expected, "{all:?}");
            assert!(!is_plain(lumas) || expected == all[4], "{all:?}");
            darker += u32::from(expected != all[4]);
            let expected = around(all, remembered);
            assert_eq!(near.around(remembered), expected, "{all:?} {remembered:?}");
            let is_bounded = is_bounded(remembered, near.lights, lumas);
            assert!(!is_bounded || expected == remembered, "{all:?} {remembered:?}");
            held += u32::from(expected != remembered);
        }
        assert!(darker > 5_000 && held > 10_000, "{darker} {held}");
    }
}
