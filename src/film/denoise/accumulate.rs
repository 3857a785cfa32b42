use super::Size;
use super::near::{Near, is_bounded, is_plain, luma};
use super::remember::remember;
use crate::color::Rgb9e5;
use crate::film::Feature;
use crate::film::feature::albedo_share;
use crate::num::{isqrt, leading_zeros, mul_hi};

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
    /// The light of the row below as it was rendered; empty where there is none.
    pub below: &'a [Rgb9e5],
}

/// Frames that count: alpha is one over their number, 1/8 at least.
const MOST: u8 = 8;

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
        below,
    } = band;
    let width = size.width as usize;
    if width == 0 || above.len() < width {
        return;
    }
    let above = &mut above[..width];
    if first == 0 {
        // Black changes nothing.
        above.fill(Rgb9e5::BLACK);
    }
    let past = past.map(|past| (past, past.motion.prepared()));
    let mut rest = rows;
    let mut row = 0;
    while let Some((pixels, under)) = rest.split_at_mut_checked(width) {
        let y = first.wrapping_add(row as u16);
        let mut places = lengths.get_mut(row * width..).unwrap_or_default().iter_mut();
        // As they were rendered: to the left of the pixel, itself, to the right.
        let rendered = |pixel: Option<&Feature>| pixel.map_or(Rgb9e5::BLACK, |pixel| pixel.irradiance);
        let mut lights = [Rgb9e5::BLACK, Rgb9e5::BLACK, rendered(pixels.first())];
        let mut lumas = lights.map(luma);
        for x in 0..width {
            let right = rendered(pixels.get(x + 1));
            lights = [lights[1], lights[2], right];
            lumas = [lumas[1], lumas[2], luma(right)];
            let Some(pixel) = pixels.get_mut(x) else { break };
            let near = || Near {
                above,
                lights,
                under,
                below,
                x,
            };
            let light = if is_plain(lumas) {
                lights[1]
            } else {
                near().clamped()
            };
            let at = (x as u16, y);
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
                    let before = if then.is_here || is_bounded(then.light, lights, lumas) {
                        then.light
                    } else {
                        near().around(then.light)
                    };
                    (blend(light, before, length as u32, noise), length)
                }
                None => (light, 1),
            };
            pixel.irradiance = light;
            if let Some(place) = places.next() {
                *place = length;
            }
            if let Some(place) = above.get_mut(x.wrapping_sub(1)) {
                *place = lights[0];
            }
        }
        if let Some(place) = above.last_mut() {
            *place = lights[1];
        }
        (rest, row) = (under, row + 1);
    }
}

/// `then + (light − then)/n`, what is left over kept with a chance of its size; equal lights give themselves.
#[inline]
fn blend(light: Rgb9e5, then: Rgb9e5, n: u32, noise: u32) -> Rgb9e5 {
    if (light.0 | then.0) << 5 == 0 {
        return Rgb9e5::BLACK;
    }
    let ((a, ea), (b, eb)) = (light.to_parts(), then.to_parts());
    let exponent = ea.max(eb);
    // raw: under 2^9 · 2^16, and 2^3 times that in the sum.
    let wide = |m: u32, e: i32| (m << 16) >> (exponent - e).clamp(0, 31);
    let n = n.clamp(1, 8);
    // raw: under 2^28 + 4
    let sum = |i: usize| wide(a[i], ea) + wide(b[i], eb) * (n - 1) + n / 2;
    let sums = [sum(0), sum(1), sum(2)];
    let bits = if n & (n - 1) == 0 {
        let shift = SHIFTS[n as usize - 1];
        sums.map(|sum| sum >> shift)
    } else {
        let part = PARTS[n as usize - 1];
        // raw: times what the part is off by, under 8: under 2^32 / 8, so that this is the quotient.
        sums.map(|sum| mul_hi(sum, part))
    };
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

/// Logarithms of 1, 2, 4 and 8.
const SHIFTS: [u8; 8] = [0, 1, 0, 2, 0, 0, 0, 3];

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
    let m = [0, 1, 2].map(|i| (bits[i as usize] + up(i)) >> shift);
    let e = exponent + shift as i32 + 24;
    if (256..512).contains(&(m[0] | m[1] | m[2])) && (0..31).contains(&e) {
        return Rgb9e5(m[0] | m[1] << 9 | m[2] << 18 | (e as u32) << 27);
    }
    Rgb9e5::from_bits(m.map(|m| m << shift), exponent)
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
