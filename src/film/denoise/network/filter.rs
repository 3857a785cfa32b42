use super::extract::Cut;
use super::{HEAD, LEVELS, Network, NetworkError, Shape};
use crate::num::{leading_zeros, short_recip};

/// 255 exp(−i / 32).
pub static EXP: [u8; 256] = {
    // exp(−1/32), Q62: 1 − x + x²/2 − x³/6 + x⁴/24 − ... of x = 2^-5; then its powers.
    let mut step = 0i128;
    let mut term = 1i128 << 62;
    let mut n = 1;
    while n < 12 {
        step += term;
        term = -term / (32 * n);
        n += 1;
    }
    let mut table = [0; 256];
    let mut value = 255i128 << 62;
    let mut i = 0;
    while i < 256 {
        table[i] = ((value + (1 << 61)) >> 62) as u8;
        value = (value >> 31) * (step >> 31);
        i += 1;
    }
    table
};

type Light = [u16; 3];
type Head = [u8; HEAD];

/// A mean about a centre: the weights, and the differences by weight.
struct Mean {
    centre: Light,
    weight: u32,
    /// |difference| < 2^16, and all weights together < 2^15.
    sum: [i32; 3],
}

impl Mean {
    fn new(centre: Light, weight: u32) -> Mean {
        Mean {
            centre,
            weight,
            sum: [0; 3],
        }
    }

    #[inline(always)]
    fn add(&mut self, light: Light, weight: u32) {
        self.weight += weight;
        for ((sum, light), centre) in self.sum.iter_mut().zip(light).zip(self.centre) {
            *sum += (i32::from(light) - i32::from(centre)) * weight as i32;
        }
    }

    /// Error: 2^-13.5 of the difference at most, and half a step.
    #[inline(always)]
    fn value(&self) -> Light {
        let zeros = leading_zeros(self.weight);
        let short = short_recip((self.weight << zeros) >> 16) as u32;
        let mut out = self.centre;
        for (out, sum) in out.iter_mut().zip(self.sum) {
            if sum != 0 {
                let change = quotient(sum.unsigned_abs(), short, zeros) as i32;
                let value = i32::from(*out) + if sum < 0 { -change } else { change };
                *out = value.clamp(0, 0xffff) as u16;
            }
        }
        out
    }
}

/// a / b, rounded, where `short` is 2^31 over b's upper 16 bits and `zeros` those before them; a ≥ 1, a / b ≤ 2^16.
#[inline(always)]
fn quotient(a: u32, short: u32, zeros: u32) -> u32 {
    let before = leading_zeros(a);
    let product = ((a << before) >> 16) * (short & 0x1_ffff).min(0xffff);
    // 14 at least; a third of b has more than 31.
    let shift = (31 + before).saturating_sub(zeros).max(1);
    if shift > 32 {
        return 0;
    }
    ((product >> (shift - 1)) + 1) >> 1
}

#[inline(always)]
fn affinity(a: &Head, b: &Head) -> u32 {
    let mut square = 0u32;
    for i in 0..6 {
        let d = i32::from(a[i] as i8) - i32::from(b[i] as i8);
        square += (d * d) as u32;
    }
    u32::from(EXP[(square >> 1).min(255) as usize])
}

/// 1 ..= 256.
#[inline(always)]
fn confidence(head: &Head) -> u32 {
    u32::from(head[6]) + 1
}

impl Network<'_> {
    /// Filters by the heads that [`Self::extract`] left; `sink` gets each finished row, from the top.
    pub fn filter(
        &mut self,
        irradiance: &[Light],
        mut sink: impl FnMut(usize, &[Light]),
    ) -> Result<(), NetworkError> {
        let shape = self.shape;
        let needed = shape[0].pixels();
        if irradiance.len() != needed {
            return Err(NetworkError::Irradiance { needed });
        }
        let Cut {
            activations, heads, ..
        } = Cut::new(self.scratch.bytes, &shape);
        let heads: [&[Head]; LEVELS] = core::array::from_fn(|level| {
            let bytes: &[u8] = if level == 0 {
                &*activations[0]
            } else {
                &*heads[level]
            };
            bytes.as_chunks().0
        });
        let (row, mut rest) = self.scratch.light.split_at_mut(shape[0].width);
        let mut take = |count: usize| {
            let (part, others) = core::mem::take(&mut rest).split_at_mut(count);
            rest = others;
            part
        };
        let pixels = |level: usize| if level == 0 { 0 } else { shape[level].pixels() };
        let mut light: [&mut [Light]; LEVELS] = core::array::from_fn(|level| take(pixels(level)));
        let mut done: [&mut [Light]; LEVELS] = core::array::from_fn(|level| take(pixels(level)));

        for level in 1..LEVELS {
            let (finer, coarser) = light.split_at_mut(level);
            let fine = if level == 1 {
                irradiance
            } else {
                &*finer[level - 1]
            };
            shrink(fine, heads[level - 1], shape[level - 1], coarser[0], shape[level]);
        }
        let bottom = LEVELS - 1;
        for y in 0..shape[bottom].height {
            for x in 0..shape[bottom].width {
                let mean = around::<2>(light[bottom], heads[bottom], shape[bottom], x, y);
                done[bottom][y * shape[bottom].width + x] = mean;
            }
        }
        for level in (0..bottom).rev() {
            let (finer, coarser) = done.split_at_mut(level + 1);
            let own = if level == 0 { irradiance } else { &*light[level] };
            let coarse = Coarse {
                light: &*coarser[0],
                heads: heads[level + 1],
                shape: shape[level + 1],
            };
            for y in 0..shape[level].height {
                let from = y * shape[level].width;
                let out = if level == 0 {
                    &mut *row
                } else {
                    &mut finer[level][from..][..shape[level].width]
                };
                for (x, out) in out.iter_mut().enumerate() {
                    let head = &heads[level][from + x];
                    let filtered = if level == 0 {
                        around::<1>(own, heads[level], shape[level], x, y)
                    } else {
                        around::<2>(own, heads[level], shape[level], x, y)
                    };
                    let raised = coarse.raise(head, x, y);
                    // 0 ..= 256, both ends whole.
                    let blend = i32::from(head[7]) + i32::from(head[7] >> 7);
                    for i in 0..3 {
                        let (up, own) = (i32::from(raised[i]), i32::from(filtered[i]));
                        out[i] = (up + (((own - up) * blend + 128) >> 8)) as u16;
                    }
                }
                if level == 0 {
                    sink(y, row);
                }
            }
        }
        Ok(())
    }
}

/// The next coarser size: each 2 × 2 by confidence.
fn shrink(fine: &[Light], heads: &[Head], shape: Shape, coarse: &mut [Light], coarse_shape: Shape) {
    for (y, row) in coarse.chunks_exact_mut(coarse_shape.width).enumerate() {
        for (x, out) in row.iter_mut().enumerate() {
            let (left, top) = (2 * x, 2 * y);
            let (right, below) = ((left + 1).min(shape.width - 1), (top + 1).min(shape.height - 1));
            let first = top * shape.width + left;
            let mut mean = Mean::new(fine[first], confidence(&heads[first]));
            for (x, y) in [(right, top), (left, below), (right, below)] {
                let place = y * shape.width + x;
                mean.add(fine[place], confidence(&heads[place]));
            }
            *out = mean.value();
        }
    }
}

/// The mean of (2 `REACH` + 1)² pixels by affinity and confidence; those beyond the edge count for nothing.
#[inline(always)]
fn around<const REACH: usize>(light: &[Light], heads: &[Head], shape: Shape, x: usize, y: usize) -> Light {
    let centre = y * shape.width + x;
    let head = &heads[centre];
    // raw: a weight is 1020 at most, 25 of them are under 2^15; the centre's is 3 at least.
    let mut mean = Mean::new(light[centre], (255 * confidence(head)) >> 6);
    for row in y.saturating_sub(REACH)..=(y + REACH).min(shape.height - 1) {
        for column in x.saturating_sub(REACH)..=(x + REACH).min(shape.width - 1) {
            let place = row * shape.width + column;
            let other = &heads[place];
            let weight = (affinity(head, other) * confidence(other)) >> 6;
            // The centre's difference is nothing; its weight was counted.
            if place != centre {
                mean.add(light[place], weight);
            }
        }
    }
    mean.value()
}

/// A finished coarser size.
struct Coarse<'a> {
    light: &'a [Light],
    heads: &'a [Head],
    shape: Shape,
}

impl Coarse<'_> {
    /// What the four nearest coarse pixels say of a fine one, by affinity.
    #[inline(always)]
    fn raise(&self, head: &Head, x: usize, y: usize) -> Light {
        let (near_x, near_y) = (x >> 1, y >> 1);
        let far_x = if x & 1 == 0 {
            near_x.saturating_sub(1)
        } else {
            (near_x + 1).min(self.shape.width - 1)
        };
        let far_y = if y & 1 == 0 {
            near_y.saturating_sub(1)
        } else {
            (near_y + 1).min(self.shape.height - 1)
        };
        let near = near_y * self.shape.width + near_x;
        let mut mean = Mean::new(self.light[near], 9 * affinity(head, &self.heads[near]) + 1);
        for (x, y, share) in [(far_x, near_y, 3), (near_x, far_y, 3), (far_x, far_y, 1)] {
            let place = y * self.shape.width + x;
            mean.add(self.light[place], share * affinity(head, &self.heads[place]));
        }
        mean.value()
    }
}
