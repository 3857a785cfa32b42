//! Where what is seen was in the frame before.

use crate::camera::{Camera, FilmPlane};
use crate::film::denoise::{Before, Reproject};
use crate::film::feature::{DEPTH_NOTHING, depth_code, depth_distance};
use crate::geom::Dir;
use crate::num::{Uniform, leading_zeros, mul_hi_signed, recip, recip_of_large, short_rsqrt};

/// Two frames' cameras: where what is seen now was seen before.
///
/// What is seen by way of flat mirrors is a thing behind them; by way of curved ones, a thing on them
/// ([`Feature::depth`](crate::film::Feature::depth)). Right to a sixteenth of a pixel and to what the distance's steps
/// (2.2 % at most) are worth.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    now: FilmPlane,
    before: FilmPlane,
    is_still: bool,
    is_whole: bool,
}

impl Motion {
    /// Between the frame before and the one now, both of this size.
    pub fn between(before: Camera, now: Camera, width: u16, height: u16) -> Motion {
        Motion {
            now: now.film(width, height),
            before: before.film(width, height),
            is_still: now == before,
            is_whole: false,
        }
    }

    /// For a picture that is shown at the size it is rendered: see [`Reproject::is_whole`].
    pub fn whole(self) -> Motion {
        Motion {
            is_whole: self.is_still,
            ..self
        }
    }
}

impl Reproject for Motion {
    fn before(&self, x: u16, y: u16, depth: u8) -> Option<Before> {
        if self.is_still {
            let place = [x, y].map(|c| 16 * c as i32 + 8);
            return Some(Before { place, depth });
        }
        let middle = [Uniform::from_bits(1 << 31); 2];
        let ray = self.now.ray(x, y, middle, middle)?;
        let origin = self.before.origin();
        let (point, depth) = if depth == DEPTH_NOTHING {
            (origin.along(ray.dir, 1 << 26), DEPTH_NOTHING)
        } else {
            let point = ray.origin.along(ray.dir, depth_distance(depth));
            let (_, norm) = origin.to(point).normalize()?;
            (point, depth_code(norm.length()))
        };
        // Q12 to sixteenths.
        let place = self.before.place(point)?.map(|c| (c + (1 << 7)) >> 8);
        Some(Before { place, depth })
    }

    fn prepared(&self) -> impl Fn(u16, u16, u8) -> Option<Before> {
        let glance = if self.is_still { None } else { Glance::new(self) };
        move |x, y, depth| {
            let found = glance.as_ref().and_then(|glance| glance.before(x, y, depth));
            found.or_else(|| self.before(x, y, depth))
        }
    }

    fn is_whole(&self) -> bool {
        self.is_whole
    }
}

/// [`Motion::before`] with a tenth of its work and an error that is known: it answers where the whole way cannot say
/// anything else.
///
/// For cameras without a lens that move by a 48th of the distance at most, which leaves its code as it is. A place is
/// (a/c, b/c) with a, b, c what the way to a pixel is along the camera's axes before: each the same step further from
/// pixel to pixel, and more by what the camera moved, over the distance.
struct Glance {
    /// Twice the middle of the film, pixels.
    size: [i32; 2],
    /// Along the axes before: right and down in pixels, Q`fraction`, ahead in Q28. Each in the middle of the film, a half
    /// pixel further to the right and up.
    axes: [[i32; 3]; 3],
    /// How far the camera moved along these, units, and what that may be off by.
    moved: [i32; 3],
    slack_moved: u32,
    /// Bits that these two are less than they should be.
    moved_down: i32,
    /// Half a pixel at distance 1, Q30.
    half: i32,
    /// What may be off for all, sixteenths with `spare` bits below the point.
    slack: u32,
    spare: u32,
    /// The middle, as `slack`, and half a sixteenth more.
    middle: [i32; 2],
    /// The nearest code.
    nearest: u8,
}

/// 2^(-i/16), Q15.
static SHARES: [u16; 16] = [
    32_768, 31_379, 30_048, 28_774, 27_554, 26_386, 25_268, 24_196, 23_170, 22_188, 21_247, 20_347, 19_484,
    18_658, 17_867, 17_109,
];

impl Glance {
    /// `None` of cameras that it is not for.
    fn new(motion: &Motion) -> Option<Glance> {
        let (film, now, before) = (&motion.now, motion.now.camera(), motion.before.camera());
        let size = film.size();
        let tans = [now, before].map(|camera| camera.half_width().to_bits());
        let is_fit = size.iter().all(|side| (8..1 << 9).contains(side))
            && size[1] <= size[0]
            && tans.iter().all(|tan| (1 << 17..=1 << 20).contains(tan))
            && [now, before]
                .iter()
                .all(|camera| !camera.has_lens() && camera.is_square());
        let offset = before.origin().to(now.origin());
        if !is_fit || offset.0.iter().any(|c| c.unsigned_abs() >= 1 << 22) {
            return None;
        }
        let way = offset.normalize().map_or(0, |(_, norm)| norm.length() + 1);
        let [width, height] = size;
        let [tan, tan_before] = tans.map(i64::from);
        let (per_tan, per_width) = (recip(tan_before as u32), recip(width as u32));
        let bits = 32 - leading_zeros(width as u32);
        let fraction = 27 - bits;

        // Pixels that are 1 at distance 1, times 2^(`fraction` − 28 + `pixel_shift`).
        let pixels = (i64::from(width) * i64::from(per_tan.mantissa)) >> bits;
        let pixel_shift = per_tan.shift - 18;
        // A half pixel now: half pixels before, and at distance 1.
        let step = (tan * i64::from(per_tan.mantissa)) >> 21;
        let half = tan * i64::from(per_width.mantissa);
        let in_pixels = |cos: i64| (cos * pixels) >> pixel_shift;
        let by_pixel = |cos: i64| (cos * step) >> (8 + per_tan.shift - fraction);
        let by_half = |cos: i64| (cos * (half >> 21)) >> (per_width.shift - 1);
        // Cosines between the axes before and now, Q28.
        let [right, up, forward] = before.frame().map(|Dir(axis)| {
            now.frame()
                .map(|Dir(other)| (0..3).map(|i| wide(axis[i], other[i])).sum::<i64>() >> 4)
        });
        let axes = [
            [in_pixels(right[2]), by_pixel(right[0]), by_pixel(right[1])],
            [-in_pixels(up[2]), -by_pixel(up[0]), -by_pixel(up[1])],
            [forward[2], by_half(forward[0]), by_half(forward[1])],
        ];

        // From the way before, in half units: points on the way are rounded down, by half a unit in the mean.
        let twice = offset.0.map(|c| 2 * c - 1);
        let [right, up, forward] = before
            .frame()
            .map(|Dir(axis)| (0..3).map(|i| wide(axis[i], twice[i])).sum::<i64>());
        let in_pixels = |way: i64| ((way >> 10) * pixels) >> (pixel_shift - 10);
        let moved = [in_pixels(right), -in_pixels(up), forward];
        let most = moved.iter().fold(0, |most, c| most | c.unsigned_abs());
        // A unit either way, and 2^-12 of it all by the short factors.
        let unit = (pixels << 17 >> pixel_shift) as u64;
        let slack_moved = 2 * unit + (most >> 12);
        let bits = most | slack_moved;
        let bits_moved = match (bits >> 32) as u32 {
            0 => 32 - leading_zeros(bits as u32) as i32,
            upper => 64 - leading_zeros(upper) as i32,
        };
        let moved_down = (bits_moved - 15).max(0);

        let half = (half >> (per_width.shift - 10)) as i32;
        // What a direction's last bit is in the corner, where the film is seen aslant: Q(`fraction` − 1) of a pixel.
        let corner = size.map(|side| (side * half) >> 16);
        let corner = ((1 << 28) + corner[0] * corner[0] + corner[1] * corner[1]) as u32 >> 18;
        let pixel = (pixels << 27 >> pixel_shift) as u32;
        let last = (pixel >> 16) * corner;
        // Places are rounded down, too, twice.
        let floor = (1 << (fraction - 14)) + (pixel >> 21) as i32;
        let rounding = 1 << (fraction - 6);
        Some(Glance {
            size,
            axes: axes.map(|axis| axis.map(|c| c as i32)),
            moved: moved.map(|c| (c >> moved_down) as i32),
            slack_moved: (slack_moved >> moved_down) as u32 + 1,
            moved_down,
            half,
            slack: (last >> 10) + (last >> 14) + (2 << (fraction - 13)),
            spare: fraction - 5,
            middle: [
                (width << (fraction - 2)) + rounding - floor,
                (height << (fraction - 2)) + rounding + floor,
            ],
            nearest: depth_code(48 * way)
                .saturating_add(1)
                .max(((moved_down - 15).max(0) as u8) << 4),
        })
    }

    #[inline(always)]
    fn before(&self, x: u16, y: u16, depth: u8) -> Option<Before> {
        if depth < self.nearest {
            return None;
        }
        // Half pixels from the middle.
        let across = 2 * i32::from(x) + 1 - self.size[0];
        let up = self.size[1] - 1 - 2 * i32::from(y);
        let along = |i: usize| {
            let [middle, right, above] = self.axes[i];
            middle
                .wrapping_add(across.wrapping_mul(right))
                .wrapping_add(up.wrapping_mul(above))
        };
        let (mut a, mut b, mut c) = (along(0), along(1), along(2));
        let mut slack = self.slack;
        if depth != DEPTH_NOTHING {
            // The way to the film, Q15: a square Q30 and its root.
            let side = [across, up].map(|c| c.wrapping_mul(self.half) >> 16);
            let square = ((1u32 << 28) + (side[0] * side[0]) as u32 + (side[1] * side[1]) as u32) << 2;
            let way = ((square >> 16) * short_rsqrt(square)) >> 15;
            // Over the distance, Q15.
            let share = (way * u32::from(SHARES[usize::from(depth & 15)])) >> 15;
            let down = (15 + i32::from(depth >> 4) - self.moved_down).clamp(0, 31) as u32;
            let more = |i: usize| (self.moved[i] * share as i32) >> down;
            (a, b, c) = (
                a.wrapping_add(more(0)),
                b.wrapping_add(more(1)),
                c.wrapping_add(more(2)),
            );
            slack += (self.slack_moved * share) >> down >> 1;
        }
        if c < 1 << 28 {
            (a, b, c) = (a << 1, b << 1, c << 1);
        }
        if !(1 << 28..1 << 29).contains(&c) {
            return None;
        }
        let r = (recip_of_large((c as u32) << 3) >> 1) as i32;
        let mut place = [0; 2];
        for (i, (place, part)) in place.iter_mut().zip([a, b]).enumerate() {
            let there = self.middle[i] + mul_hi_signed(part, r);
            let (least, most) = (there - slack as i32, there + slack as i32);
            *place = least >> self.spare;
            if most >> self.spare != *place {
                return None;
            }
        }
        Some(Before { place, depth })
    }
}

/// a·b.
#[inline]
fn wide(a: i32, b: i32) -> i64 {
    i64::from(a) * i64::from(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Point;
    use fixed::types::I12F20;

    #[test]
    fn a_glance_is_the_whole_way() {
        let mut state = 5u32;
        let mut random = |bits: u32| {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            (state ^ (state >> 15)) >> (32 - bits)
        };
        let (mut told, mut all) = (0, 0);
        for round in 0..4000 {
            let size = [80 + random(7) as u16, 16 + random(6) as u16];
            let tan = I12F20::from_bits((1 << 17) + (random(31) % 0xe_0001) as i32);
            // Near and far, at rest but for a hair and fast, turning and not.
            let mut vector = |bits: u32| [0; 3].map(|_| random(bits) as i32 - (1 << (bits - 1)));
            let scale = 14 + round % 10;
            let (origin, target) = (vector(scale), vector(scale));
            let (moved, turned) = (vector(4 + round % 15), vector(4 + round / 15 % 15));
            let plus = |a: [i32; 3], b: [i32; 3]| Point([0, 1, 2].map(|i| a[i] + b[i]));
            let up = [0, 1, 0];
            let Some(now) = Camera::look_at(Point(origin), Point(target), up, tan) else {
                continue;
            };
            let origin = plus(origin, moved);
            let before = match round % 3 {
                0 => Some(Camera::from_frame(origin, now.frame(), tan)),
                _ => Camera::look_at(origin, plus(target, turned), up, tan),
            };
            let Some(before) = before else { continue };
            let motion = Motion::between(before, now, size[0], size[1]);
            let glance = Glance::new(&motion);
            for _ in 0..200 {
                let [x, y] = size.map(|side| random(16) as u16 % side);
                let depth = match random(4) {
                    0 => DEPTH_NOTHING,
                    _ => (random(31) % 255) as u8,
                };
                let whole = motion.before(x, y, depth);
                let found = glance.as_ref().and_then(|glance| glance.before(x, y, depth));
                let is_inside = |at: &Before| (0..2).all(|i| (at.place[i] as u32) < 16 * u32::from(size[i]));
                if whole.as_ref().is_some_and(is_inside) || found.as_ref().is_some_and(is_inside) {
                    all += 1;
                    told += usize::from(found.is_some());
                    assert!(found.is_none() || found == whole, "{x} {y} {depth} {motion:?}");
                }
            }
        }
        assert!(told > 300_000 && 2 * told > all, "{told} of {all}");
    }
}
