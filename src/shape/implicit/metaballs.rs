use super::length::length;
use super::line::FINE;
use super::march::{Field, chord};
use super::{Blob, MAX_BLOBS, Place, Solid, around};
use crate::geom::Point;
use crate::num::{Recip, Wide, mul_hi, mul_hi_signed, mul_q16, recip};

/// Fraction bits of the sum of the kernels.
const SUM_BITS: u32 = 27;

/// Blobs that flow together: f = threshold − Σ (1 − d²/r²)³ over the balls with d < r (after Wyvill, McPheeters and
/// Wyvill, "Data structure for soft objects", The Visual Computer 2, 1986).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Metaballs {
    /// Of the scene's blobs, the first and how many; all are balls.
    pub first: u16,
    pub count: u16,
    /// Q27, between 0 and 1.
    threshold: u32,
    /// A ball that holds it all.
    center: Point,
    reach: i32,
}

impl Metaballs {
    /// Of `count` of the scene's blobs, from `first` on; `threshold` in steps of 2^-27.
    pub fn new(blobs: &[Blob], first: u16, count: u16, threshold: u32) -> Metaballs {
        let balls = super::chosen(blobs, first, count);
        let (center, reach) = around(balls, |ball| ball.radius);
        Metaballs {
            first,
            count,
            threshold,
            center,
            reach,
        }
    }

    /// In steps of 2^-27.
    pub const fn threshold(&self) -> u32 {
        self.threshold
    }

    /// What share of its radius of influence a ball alone has, at least, Q16: √(1 − ∛threshold).
    pub(super) fn alone(&self) -> i32 {
        // The largest u in steps of 2^-8 with u³ ≥ threshold on the way down: the share is √(1 − u).
        let cube = |u: u32| (u * u * u) << (SUM_BITS - 24);
        let u = (0..256).find(|u| cube(*u) >= self.threshold).unwrap_or(256);
        crate::num::isqrt((256 - u) << 24) as i32
    }
}

impl Solid for Metaballs {
    type Field = BallsField;

    #[inline]
    fn place(&self) -> Place {
        Place {
            center: self.center,
            reach: self.reach,
            axes: None,
        }
    }

    fn field(&self, place: &Place, blobs: &[Blob]) -> BallsField {
        let up = place.up();
        let balls = super::chosen(blobs, self.first, self.count);
        let least = balls.iter().map(|ball| ball.radius).min().unwrap_or(1) << up;
        let mut field = BallsField {
            balls: [Ball::NOTHING; MAX_BLOBS],
            count: 0,
            threshold: self.threshold as i32,
            least,
        };
        for (ball, blob) in field.balls.iter_mut().zip(balls) {
            let radius = blob.radius << up;
            let square = square([radius, 0, 0]).max(1);
            let inverse = recip(square);
            // 1 for the least one, Q16.
            let share = recip(radius as u32).times(least, 16);
            *ball = Ball {
                center: place.center.to(blob.a).0.map(|c| c << up),
                radius,
                square,
                far: self::square([radius + (least >> 2), 0, 0]),
                inverse,
                share,
            };
            field.count += 1;
        }
        field
    }
}

/// |v|² in units of 2^17, components under 1.25 · 2^23 in magnitude: the squares of the upper bits, under 1.6 · 2^28
/// each, are doubled; what the lower nine bits add is rounded down.
#[inline]
fn square(v: [i32; 3]) -> u32 {
    let (mut high, mut low) = (0u32, 0i32);
    for c in v {
        let (h, l) = (c >> 9, c & 511);
        high = high.wrapping_add((h * h) as u32);
        low = low.wrapping_add(h * l + ((l * l) >> 10));
    }
    // (2^9 h + l)² = 2^18 h² + 2^10 h l + l².
    (high << 1).wrapping_add_signed(low >> 7)
}

#[derive(Clone, Copy)]
struct Ball {
    center: [i32; 3],
    radius: i32,
    /// Of the radius, and of the radius and the longest step: in units of 2^17.
    square: u32,
    far: u32,
    inverse: Recip,
    /// Least radius over this one, Q16.
    share: i32,
}

impl Ball {
    const NOTHING: Ball = Ball {
        center: [0; 3],
        radius: 0,
        square: 0,
        far: 0,
        inverse: Recip {
            mantissa: 1 << 31,
            shift: 63,
        },
        share: 0,
    };

    /// From the centre, and the square of that; `None` where the ball has no influence within `more` of the point.
    #[inline]
    fn near(&self, p: [i32; 3], more: i32) -> Option<([i32; 3], u32)> {
        let v = [0, 1, 2].map(|i| p[i] - self.center[i]);
        let bound = self.radius + more;
        if v.iter().any(|c| c.abs() >= bound) {
            return None;
        }
        Some((v, square(v)))
    }

    /// 1 − d²/r², Q31.
    #[inline]
    fn depth(&self, square: u32) -> u32 {
        if square >= self.square {
            return 0;
        }
        // square/self.square = square · mantissa / 2^shift, and 2^(63 − shift) normalises self.square.
        (1 << 31) - mul_hi(square << (63 - self.inverse.shift), self.inverse.mantissa).min(1 << 31)
    }
}

pub(crate) struct BallsField {
    balls: [Ball; MAX_BLOBS],
    count: usize,
    /// Q27.
    threshold: i32,
    /// Least radius.
    least: i32,
}

impl BallsField {
    fn balls(&self) -> &[Ball] {
        self.balls.get(..self.count).unwrap_or(&[])
    }
}

impl Field for BallsField {
    /// f over the most that it can change a step, over a way of a quarter of the least radius: each ball that is so near
    /// adds 1.7173/r to that (its steepest, at d = r/√5).
    fn distance(&self, p: [i32; 3]) -> i32 {
        let longest = self.least >> 2;
        let (mut sum, mut steep) = (0i32, 0i32);
        for ball in self.balls() {
            let Some((_, square)) = ball.near(p, longest) else {
                continue;
            };
            if square >= ball.far {
                continue;
            }
            steep += ball.share;
            let u = ball.depth(square);
            // Q30, then Q29.
            let cube = mul_hi(mul_hi(u, u), u);
            sum += (cube >> (29 - SUM_BITS)) as i32;
        }
        if steep == 0 {
            // No ball is near: the way to the nearest.
            let ways = self.balls().iter().map(|ball| {
                let v = [0, 1, 2].map(|i| p[i] - ball.center[i]);
                length(v) - ball.radius
            });
            return ways.min().unwrap_or(1 << 24).max(longest);
        }
        let f = self.threshold - sum;
        // f · least/1.7173 · 2^16/steep; 1/1.7173 = 0.58231 = 38162/2^16, and |f| ≤ 16.
        let way = mul_hi_signed(f << (29 - SUM_BITS), mul_q16(self.least, 38_162)).saturating_mul(8);
        let way = recip(steep as u32).times(way, 16).clamp(-longest, longest);
        if f > 0 { way.max(1) } else { way.min(0) }
    }

    fn slope(&self, p: [i32; 3]) -> ([i32; 3], i32) {
        let (mut gradient, mut sum) = ([0i32; 3], 0);
        for ball in self.balls() {
            let Some((v, square)) = ball.near(p, 0) else {
                continue;
            };
            let u = ball.depth(square);
            let squared = mul_hi(u, u);
            sum += (mul_hi(squared, u) >> (29 - SUM_BITS)) as i32;
            // u² (least/r)², Q30: ∇f = 6/least² · Σ that · v.
            let share = mul_q16(mul_q16(squared as i32, ball.share), ball.share);
            for (g, c) in gradient.iter_mut().zip(v) {
                *g += mul_hi_signed(c << 3, share);
            }
        }
        // Twice that sum: the way to the surface is f · least² / (3 |gradient|).
        let steep = (length(gradient) as u32).max(1);
        let f = self.threshold - sum;
        let least = Wide::new(self.least as u32, 0);
        let way = Wide::new(f.unsigned_abs(), -(SUM_BITS as i32)) * least * least / Wide::new(3 * steep, 0);
        let way = way.to_fixed(0).min(1 << 14) as i32;
        (gradient, if f < 0 { -way } else { way })
    }

    #[inline]
    fn step(&self) -> i32 {
        // Necks bend more than the balls.
        chord(self.least >> (FINE + 2)) >> 1
    }
}
