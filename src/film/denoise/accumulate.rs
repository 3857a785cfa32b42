use super::Size;
use super::weight::{Mean, turn_of};
use crate::color::Rgb9e5;
use crate::film::Feature;
use crate::film::feature::{DEPTH_NOTHING, albedo_share};
use crate::num::{isqrt, leading_zeros, mul_hi, recip};

/// Where a pixel's place was in the frame before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Before {
    /// Across and down, sixteenths of a pixel: the middle of pixel (x, y) is (16 x + 8, 16 y + 8).
    pub place: [i32; 2],
    /// Its distance then, as [`Feature::depth`].
    pub depth: u8,
}

/// What the camera did between two frames.
pub trait Reproject: Sync {
    /// Where what is seen in the middle of pixel (x, y), at this [`Feature::depth`], was before; `None` if out of sight.
    fn before(&self, x: u16, y: u16, depth: u8) -> Option<Before>;

    /// [`Self::before`] of many pixels: what is the same for all is told once.
    fn prepared(&self) -> impl Fn(u16, u16, u8) -> Option<Before> {
        |x, y, depth| self.before(x, y, depth)
    }

    /// Whether nothing moved, and pixels are remembered as a whole: silhouettes that go through them, and their albedo.
    ///
    /// Not for pictures that are made twice as large: each of their pixels is of one thing.
    fn is_whole(&self) -> bool {
        false
    }
}

/// The frame before: its light is what had been gathered up to it.
#[derive(Debug)]
pub struct Past<'a, M> {
    pub frame: &'a [Feature],
    pub lengths: &'a [u8],
    pub motion: &'a M,
}

/// Some rows of the frame, which another core may have the rest of.
#[derive(Debug)]
pub struct Band<'a> {
    pub size: Size,
    /// Number of the first row.
    pub first: u16,
    /// Its pixels; their light is changed.
    pub rows: &'a mut [Feature],
    /// How many frames each pixel's light is of: written.
    pub lengths: &'a mut [u8],
    /// The light of the row above the band as it was rendered, a row's length; anything where there is none.
    pub above: &'a mut [Rgb9e5],
    /// A row to work in.
    pub current: &'a mut [Rgb9e5],
    /// The light of the row below as it was rendered; empty where there is none.
    pub below: &'a [Rgb9e5],
}

/// A pixel's luminance is at most that of the second brightest of its 3 × 3, times two to this power.
pub const FIREFLY: u32 = 2;

/// Frames that count: alpha is one over their number, 1/8 at least.
const MOST: u8 = 8;

/// A tap is the same place if its distance is right to this many codes, 4.4 % each...
pub(super) const DEPTH_SLACK: u32 = 3;
/// ... and its normal is, by one less the cosine in 127ths.
const TURN_SLACK: u32 = 16;

/// Clamps fireflies and takes the light together with the past, row by row.
///
/// `count` tells frames apart: what rounding leaves over is kept by chance, without bias.
pub fn accumulate<M: Reproject>(band: Band, past: Option<&Past<M>>, count: u32) {
    let Band {
        size,
        first,
        rows,
        lengths,
        above,
        current,
        below,
    } = band;
    let width = size.width as usize;
    if width == 0 || above.len() < width || current.len() < width {
        return;
    }
    let (above, current) = (&mut above[..width], &mut current[..width]);
    if first == 0 {
        // Black changes nothing.
        above.fill(Rgb9e5::BLACK);
    }
    let past = past.map(|past| (past, past.motion.prepared()));
    let mut rest = rows;
    let mut row = 0;
    while let Some((pixels, under)) = rest.split_at_mut_checked(width) {
        let from = row * width;
        for (kept, pixel) in current.iter_mut().zip(&*pixels) {
            *kept = pixel.irradiance;
        }
        // The three columns about a pixel: each is looked at once.
        let column = |x: usize| {
            let (Some(above), Some(own)) = (above.get(x), current.get(x)) else {
                return Column::EMPTY;
            };
            let under = match under.get(x) {
                Some(pixel) => pixel.irradiance,
                None => below.get(x).copied().unwrap_or_default(),
            };
            Column::of([*above, *own, under])
        };
        let mut columns = [Column::EMPTY, Column::EMPTY, column(0)];
        for (x, pixel) in pixels.iter_mut().enumerate() {
            columns = [columns[1], columns[2], column(x + 1)];
            let near = Near::of(&columns);
            let light = near.clamped(pixel.irradiance, columns[1].own);
            let at = (x as u16, first.wrapping_add(row as u16));
            let known = past.as_ref().and_then(|(past, motion)| {
                let before = motion(at.0, at.1, pixel.depth)?;
                remember(size, past, pixel, at, before)
            });
            let (light, length) = match known {
                Some((then, length)) => {
                    let length = (length + 1).min(MOST);
                    let noise = hash(at.0 as u32 | (at.1 as u32) << 16, count);
                    if let Some(was) = then.whole {
                        pixel.albedo = blend_albedo(pixel.albedo, was.albedo, length as u32, noise);
                        // One of the frames' things, each with the same chance: what leads filters does not change with
                        // every sample.
                        if mul_hi(noise, length as u32) > 0 {
                            (pixel.normal, pixel.depth, pixel.id) = (was.normal, was.depth, was.id);
                        }
                    }
                    let before = if then.is_here {
                        then.light
                    } else {
                        near.around(then.light)
                    };
                    (blend(light, before, length as u32, noise), length)
                }
                None => (light, 1),
            };
            pixel.irradiance = light;
            if let Some(place) = lengths.get_mut(from + x) {
                *place = length;
            }
        }
        above.copy_from_slice(current);
        (rest, row) = (under, row + 1);
    }
}

/// The luminance of a light as a number that grows with it; 2^16 more for each octave, 0 for black.
#[inline]
fn luma(light: Rgb9e5) -> u32 {
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

/// What is known of three lights, one above the other.
#[derive(Clone, Copy)]
struct Column {
    /// The middle one's luminance.
    own: u32,
    rank: Rank,
    most: Most,
}

impl Column {
    const EMPTY: Column = Column {
        own: 0,
        rank: Rank { first: 0, second: 0 },
        most: Most {
            parts: [0; 3],
            exponent: -24,
        },
    };

    #[inline]
    fn of(lights: [Rgb9e5; 3]) -> Column {
        let [above, own, below] = lights.map(luma);
        let rank = Rank {
            first: above.max(own),
            second: above.min(own),
        };
        Column {
            own,
            rank: rank.with(below),
            most: Most::of(lights.map(|light| {
                let (m, exponent) = light.to_parts();
                Most {
                    parts: m.map(|m| m << 8),
                    exponent,
                }
            })),
        }
    }
}

/// The two largest luminances.
#[derive(Clone, Copy)]
struct Rank {
    first: u32,
    second: u32,
}

impl Rank {
    #[inline(always)]
    fn with(self, luma: u32) -> Rank {
        Rank {
            first: self.first.max(luma),
            second: self.second.max(self.first.min(luma)),
        }
    }
}

/// Largest of each channel, in 256ths of the exponent, which is the largest one.
#[derive(Clone, Copy)]
struct Most {
    parts: [u32; 3],
    exponent: i32,
}

impl Most {
    #[inline(always)]
    fn of(all: [Most; 3]) -> Most {
        let [a, b, c] = all;
        let exponent = a.exponent.max(b.exponent).max(c.exponent);
        // raw: under 2^17; exponents are 31 apart at most.
        let [a, b, c] = all.map(|most| most.parts.map(|part| part >> ((exponent - most.exponent) & 31)));
        Most {
            parts: [0, 1, 2].map(|i| a[i].max(b[i]).max(c[i])),
            exponent,
        }
    }
}

/// What is known of the light about a pixel.
struct Near {
    /// The second largest luminance.
    second: u32,
    most: Most,
}

impl Near {
    #[inline]
    fn of(columns: &[Column; 3]) -> Near {
        let [left, own, right] = columns.map(|column| column.rank);
        let rank = own
            .with(left.first)
            .with(left.second)
            .with(right.first)
            .with(right.second);
        Near {
            second: rank.second,
            most: Most::of(columns.map(|column| column.most)),
        }
    }

    /// The light, made darker by whole octaves until it is no firefly.
    #[inline]
    fn clamped(&self, light: Rgb9e5, luma: u32) -> Rgb9e5 {
        let limit = self.second + (FIREFLY << 16);
        if luma <= limit {
            return light;
        }
        // As many octaves as it takes; beside black nothing is left.
        let down = match self.second {
            0 => 40,
            _ => (luma - limit).div_ceil(1 << 16).min(40),
        };
        let (m, exponent) = light.to_parts();
        Rgb9e5::from_bits(m, exponent - down as i32)
    }

    /// Light of another place, at most twice the brightest here, by channel.
    #[inline]
    fn around(&self, light: Rgb9e5) -> Rgb9e5 {
        let Most {
            parts: most,
            exponent: least,
        } = self.most;
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

/// What is remembered.
struct Then {
    light: Rgb9e5,
    /// Of the very same pixel.
    is_here: bool,
    /// If it is remembered as a whole.
    whole: Option<Feature>,
}

/// What the past knows of a pixel, and of how many frames.
///
/// A whole pixel ([`Reproject::is_whole`]) is the same piece of the picture: all of it counts, and its albedo, too. A
/// silhouette goes through it where the samples meet one thing now and another then; the one of now was then to be seen
/// beside it.
#[inline]
fn remember<M: Reproject>(
    size: Size,
    past: &Past<M>,
    pixel: &Feature,
    (x, y): (u16, u16),
    Before { place, depth }: Before,
) -> Option<(Then, u8)> {
    let is_alike =
        |was: &Feature| was.id == pixel.id && is_near(was.depth, depth) && turn_of(was, pixel) <= TURN_SLACK;
    let at = |tx: i32, ty: i32| -> Option<(&Feature, u8)> {
        let is_inside = (0..size.width as i32).contains(&tx) && (0..size.height as i32).contains(&ty);
        if !is_inside {
            return None;
        }
        let number = ty as usize * size.width as usize + tx as usize;
        Some((past.frame.get(number)?, *past.lengths.get(number)?))
    };
    let (here_x, here_y) = (x as i32, y as i32);
    let is_here = place == [here_x, here_y].map(|c| 16 * c + 8);
    if is_here && past.motion.is_whole() {
        let (was, length) = at(here_x, here_y)?;
        let mut around = (0..9).filter_map(|i| at(here_x + i % 3 - 1, here_y + i / 3 - 1));
        let is_known = is_alike(was) || around.any(|(was, _)| is_alike(was));
        let then = Then {
            light: was.irradiance,
            is_here,
            whole: Some(*was),
        };
        return is_known.then_some((then, length.min(15)));
    }
    // The four pixels whose middles are about it.
    let corner = place.map(|c| c.wrapping_sub(8));
    let (left, top) = (corner[0] >> 4, corner[1] >> 4);
    let part = corner.map(|c| (c & 15) as u32);
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
        let Some((was, length)) = at(left + dx, top + dy).filter(|(was, _)| is_alike(was)) else {
            continue;
        };
        *tap = (was.irradiance, weight);
        mean.see(was.irradiance);
        // 15 at most, so that memory with anything in it does no harm.
        lengths += length.min(15) as u32 * weight;
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
    let then = Then {
        light,
        is_here,
        whole: None,
    };
    Some((then, length as u8))
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

/// `then + (light − then)/n`, what is left over kept with a chance of its size; equal lights give themselves.
#[inline]
fn blend(light: Rgb9e5, then: Rgb9e5, n: u32, noise: u32) -> Rgb9e5 {
    let ((a, ea), (b, eb)) = (light.to_parts(), then.to_parts());
    let exponent = ea.max(eb);
    // raw: under 2^9 · 2^16, and 2^3 times that in the sum.
    let wide = |m: u32, e: i32| (m << 16) >> (exponent - e).clamp(0, 31);
    let n = n.clamp(1, 8);
    let part = PARTS[n as usize - 1];
    let mixed = |i: usize| {
        let sum = wide(a[i], ea) + wide(b[i], eb) * (n - 1) + n / 2;
        // raw: under 2^28 + 4, times what the part is off by, under 8: under 2^32 / 8, so that this is the quotient.
        if n == 1 { sum } else { mul_hi(sum, part) }
    };
    let bits = [mixed(0), mixed(1), mixed(2)];
    dithered(bits, exponent - 16, noise)
}

/// 2^32 over 1 ..= 8, rounded up, but for the first.
const PARTS: [u32; 8] = {
    let mut parts = [u32::MAX; 8];
    let mut n = 2;
    while n <= 8 {
        parts[n - 1] = (1u64 << 32).div_ceil(n as u64) as u32;
        n += 1;
    }
    parts
};

/// The same of codes of albedo, by the shares they stand for.
#[inline]
fn blend_albedo(albedo: [u8; 3], then: [u8; 3], n: u32, noise: u32) -> [u8; 3] {
    let n = n.clamp(1, 8);
    let part = PARTS[n as usize - 1];
    let share = |code: u8| albedo_share(code).to_bits() as u32;
    let mixed = |i: usize| {
        if albedo[i] == then[i] {
            return albedo[i];
        }
        let sum = share(albedo[i]) + share(then[i]) * (n - 1) + n / 2;
        // raw: under 2^18 + 4: the quotient, as in `blend`.
        let mean = if n == 1 { sum } else { mul_hi(sum, part) };
        // 256 · 255 · √(a/2^15) = √(a · 130050). raw: a ≤ 2^15, so under 2^32.
        let code = isqrt(mean * 130_050);
        ((code + (noise.rotate_left(11 * i as u32) & 255)) >> 8) as u8
    };
    [mixed(0), mixed(1), mixed(2)]
}

/// [`Rgb9e5::from_bits`] that rounds up with a chance of what is left over.
#[inline]
fn dithered(bits: [u32; 3], exponent: i32, noise: u32) -> Rgb9e5 {
    let all = bits[0] | bits[1] | bits[2];
    let filled = 32 - leading_zeros(all) as i32;
    let shift = (filled - 9).max(-24 - exponent).clamp(0, 31) as u32;
    let mask = (1u32 << shift) - 1;
    // A chance for each channel.
    let up = |i: u32| noise.rotate_left(11 * i) & mask;
    let rounded = [0, 1, 2].map(|i| ((bits[i as usize] + up(i)) >> shift) << shift);
    Rgb9e5::from_bits(rounded, exponent)
}

/// PCG's output function of a place and a frame.
#[inline]
fn hash(place: u32, count: u32) -> u32 {
    let state = place
        .wrapping_mul(747_796_405)
        .wrapping_add(count.wrapping_mul(2_891_336_453) | 1);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}
