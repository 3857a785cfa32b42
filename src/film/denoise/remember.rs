//! What the frame before knows of a pixel.

use super::Size;
use super::accumulate::{Before, Past, Reproject};
use super::weight::{Mean, turn_of};
use crate::color::Rgb9e5;
use crate::film::Feature;
use crate::film::feature::DEPTH_NOTHING;
use crate::num::{mul_hi, recip};
use zerocopy::transmute_ref;

/// A tap is the same place if its distance is right to this many codes, 4.4 % each...
pub(super) const DEPTH_SLACK: u32 = 3;
/// ... and its normal is, by one less the cosine in 127ths.
const TURN_SLACK: u32 = 16;

/// What is remembered.
pub(super) struct Then {
    pub light: Rgb9e5,
    /// Of the very same pixel.
    pub is_here: bool,
    /// If it is remembered as a whole.
    pub whole: Option<Feature>,
}

/// What the past knows of a pixel, and of how many frames.
///
/// A whole pixel ([`Reproject::is_whole`]) is the same piece of the picture: all of it counts, and its albedo, too. A
/// silhouette goes through it where the samples meet one thing now and another then; the one of now was then to be seen
/// beside it.
#[inline]
pub(super) fn remember<M: Reproject>(
    size: Size,
    past: &Past<M>,
    pixel: &Feature,
    (x, y): (u16, u16),
    before: Before,
) -> Option<(Then, u8)> {
    let is_here = before.place == [x, y].map(|c| 16 * i32::from(c) + 8);
    let all = All {
        size,
        frame: past.frame,
        lengths: past.lengths,
    };
    if is_here && past.motion.is_whole() {
        return all.whole(pixel, before.depth, [x, y].map(i32::from));
    }
    let (light, length) = match all.alike(pixel, before) {
        Some(found) => found,
        None => all.mixed(pixel, before)?,
    };
    let then = Then {
        light,
        is_here,
        whole: None,
    };
    Some((then, length))
}

/// The frame before.
struct All<'a> {
    size: Size,
    frame: &'a [Feature],
    lengths: &'a [u8],
}

impl<'a> All<'a> {
    /// A pixel, if it is in the picture, and of how many frames it is, 15 at most, so that memory with anything in it does no
    /// harm.
    #[inline]
    fn at(&self, x: i32, y: i32) -> Option<(&'a Feature, u8)> {
        let is_inside = (0..self.size.width as i32).contains(&x) && (0..self.size.height as i32).contains(&y);
        if !is_inside {
            return None;
        }
        let number = y as usize * self.size.width as usize + x as usize;
        Some((self.frame.get(number)?, (*self.lengths.get(number)?).min(15)))
    }

    /// The very same pixel, if it or one beside it was of this one's thing.
    #[inline(never)]
    fn whole(&self, pixel: &Feature, depth: u8, [x, y]: [i32; 2]) -> Option<(Then, u8)> {
        let (was, length) = self.at(x, y)?;
        let mut around = (0..9).filter_map(|i| self.at(x + i % 3 - 1, y + i / 3 - 1));
        let is_known = is_alike(was, pixel, depth) || around.any(|(was, _)| is_alike(was, pixel, depth));
        let then = Then {
            light: was.irradiance,
            is_here: true,
            whole: Some(*was),
        };
        is_known.then_some((then, length))
    }

    /// The mean of the four pixels whose middles are about a place, where all that count look alike to the last bit and are
    /// as far away.
    #[inline]
    fn alike(&self, pixel: &Feature, Before { place, depth }: Before) -> Option<(Rgb9e5, u8)> {
        let Corner { at, parts } = Corner::of(place);
        let [left, top] = at;
        let [width, height] = [self.size.width, self.size.height].map(i32::from);
        // What has no weight is its neighbour once more.
        let right = left + i32::from(parts[0] > 0);
        let bottom = top + i32::from(parts[1] > 0);
        if left < 0 || top < 0 || right >= width || bottom >= height {
            return None;
        }
        let &[_, _, looks]: &[u32; 3] = transmute_ref!(pixel);
        let (nearest, slack) = if depth == DEPTH_NOTHING {
            (DEPTH_NOTHING, 0)
        } else {
            let nearest = depth.saturating_sub(DEPTH_SLACK as u8);
            (
                nearest,
                depth.saturating_add(DEPTH_SLACK as u8).min(DEPTH_NOTHING - 1) - nearest,
            )
        };
        let tap = |was: &Feature, length: u8| {
            let &[light, _, seen]: &[u32; 3] = transmute_ref!(was);
            let is_near = u32::from(was.depth).wrapping_sub(u32::from(nearest)) <= u32::from(slack);
            (seen == looks && is_near).then_some((Rgb9e5(light), u32::from(length.min(15))))
        };
        let pair = |number: usize| {
            let (frame, lengths) = (self.frame.get(number..)?, self.lengths.get(number..)?);
            if parts[0] == 0 {
                let only = tap(frame.first()?, *lengths.first()?)?;
                return Some([only; 2]);
            }
            let ([left, right], [of_left, of_right]) = (frame.first_chunk()?, lengths.first_chunk()?);
            Some([tap(left, *of_left)?, tap(right, *of_right)?])
        };
        let number = (top * width + left) as usize;
        let [a, b] = pair(number)?;
        let across = [16 - parts[0], parts[0]];
        if parts[1] == 0 {
            let lengths = a.1 * across[0] + b.1 * across[1];
            let light = mean_of_256([a.0, b.0], across.map(|weight| 16 * weight));
            return Some((light, (lengths >> 4) as u8));
        }
        let [c, d] = pair(number + width as usize)?;
        let under = across.map(|weight| weight * parts[1]);
        let over = [0, 1].map(|i| 16 * across[i] - under[i]);
        let lengths = a.1 * over[0] + b.1 * over[1] + c.1 * under[0] + d.1 * under[1];
        let light = mean_of_256([a.0, b.0, c.0, d.0], [over[0], over[1], under[0], under[1]]);
        Some((light, (lengths >> 8) as u8))
    }

    /// The mean of those of the four that are of the pixel's thing.
    #[inline(never)]
    fn mixed(&self, pixel: &Feature, Before { place, depth }: Before) -> Option<(Rgb9e5, u8)> {
        let Corner {
            at: [left, top],
            parts: part,
        } = Corner::of(place);
        let mut taps = [(Rgb9e5::BLACK, 0u32); 4];
        let mut mean = Mean::new();
        let mut lengths = 0;
        for (i, tap) in taps.iter_mut().enumerate() {
            let (dx, dy) = (i as i32 & 1, i as i32 >> 1);
            let across = if dx == 0 { 16 - part[0] } else { part[0] };
            let down = if dy == 0 { 16 - part[1] } else { part[1] };
            let weight = across * down;
            if weight == 0 {
                continue;
            }
            let was = self.at(left + dx, top + dy);
            let Some((was, length)) = was.filter(|(was, _)| is_alike(was, pixel, depth)) else {
                continue;
            };
            *tap = (was.irradiance, weight);
            mean.see(was.irradiance);
            lengths += length as u32 * weight;
        }
        for (light, weight) in taps {
            if weight > 0 {
                mean.add(light, weight);
            }
        }
        // An eighth of the pixel is not enough to speak for it.
        if mean.weight() < 32 {
            return None;
        }
        let (light, length) = match mean.weight() {
            256 => (mean.light_of_256(), lengths >> 8),
            weight => (mean.light(), quotient(lengths, weight)),
        };
        Some((light, length as u8))
    }
}

/// The upper left one of the four pixels whose middles are about a place, and how far right and down of its middle that is,
/// sixteenths.
struct Corner {
    at: [i32; 2],
    parts: [u32; 2],
}

impl Corner {
    #[inline]
    fn of(place: [i32; 2]) -> Corner {
        let corner = place.map(|c| c.wrapping_sub(8));
        Corner {
            at: corner.map(|c| c >> 4),
            parts: corner.map(|c| (c & 15) as u32),
        }
    }
}

/// [`Mean::light_of_256`] of lights whose weights are 256 in all.
#[inline]
fn mean_of_256<const N: usize>(lights: [Rgb9e5; N], weights: [u32; N]) -> Rgb9e5 {
    let all = lights.iter().fold(0, |all, light| all | light.0);
    if all << 5 == 0 {
        return Rgb9e5::BLACK;
    }
    let mut mean = Mean::new();
    lights.iter().for_each(|light| mean.see(*light));
    for (light, weight) in lights.into_iter().zip(weights) {
        mean.add(light, weight);
    }
    mean.light_of_256()
}

#[inline]
fn is_alike(was: &Feature, pixel: &Feature, depth: u8) -> bool {
    was.id == pixel.id && is_near(was.depth, depth) && turn_of(was, pixel) <= TURN_SLACK
}

/// ⌊a / b⌋, exactly, for a ≤ 15 b and b ≤ 2^8: cheaper than a division where that is no instruction.
#[inline]
fn quotient(a: u32, b: u32) -> u32 {
    let r = recip(b);
    // raw: a < 2^12; the reciprocal is right to 2^-28, so that the answer is, or one less.
    let guess = mul_hi(a, r.mantissa) >> (r.shift - 32);
    guess + u32::from((guess + 1) * b <= a)
}

#[inline]
fn is_near(a: u8, b: u8) -> bool {
    (a == DEPTH_NOTHING) == (b == DEPTH_NOTHING) && u32::from(a.abs_diff(b)) <= DEPTH_SLACK
}
