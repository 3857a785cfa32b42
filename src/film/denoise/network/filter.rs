use super::{Head, LEVELS, Light, Network, NetworkError, Scratch, Shape, halves};
use crate::film::denoise::Pair;
use crate::num::{leading_zeros, short_recip};
use zerocopy::{FromBytes, IntoBytes};

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

/// A mean about a centre: the weights, and the lights by weight.
struct Mean {
    centre: Light,
    weight: u32,
    /// Under 2^31: a light is under 2^16, and all weights together are under 2^15.
    sum: [u32; 3],
}

impl Mean {
    fn new(centre: Light, weight: u32) -> Mean {
        Mean {
            centre,
            weight,
            sum: centre.map(|light| u32::from(light) * weight),
        }
    }

    #[inline(always)]
    fn add(&mut self, light: Light, weight: u32) {
        self.weight += weight;
        for (sum, light) in self.sum.iter_mut().zip(light) {
            *sum += u32::from(light) * weight;
        }
    }

    /// Error: 2^-13.5 of the difference at most, and half a step.
    #[inline(always)]
    fn value(&self) -> Light {
        let zeros = leading_zeros(self.weight);
        let short = short_recip((self.weight << zeros) >> 16) as u32;
        let mut out = self.centre;
        for (out, sum) in out.iter_mut().zip(self.sum) {
            // The differences by weight.
            let sum = sum as i32 - (u32::from(*out) * self.weight) as i32;
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
fn affinity(a: &[i32; 6], b: &Head) -> u32 {
    let mut square = 0u32;
    for i in 0..6 {
        let d = a[i] - i32::from(b[i] as i8);
        square += (d * d) as u32;
    }
    u32::from(EXP[(square >> 1).min(255) as usize])
}

#[inline(always)]
fn features(head: &Head) -> [i32; 6] {
    core::array::from_fn(|i| i32::from(head[i] as i8))
}

/// 1 ..= 256.
#[inline(always)]
fn confidence(head: &Head) -> u32 {
    u32::from(head[6]) + 1
}

impl Network<'_> {
    /// Filters by the heads that [`Self::extract`] left: `light` answers with the irradiance of pixel number i, and `out`
    /// gets what `make` says of each filtered one.
    pub fn filter<T: Send>(
        &mut self,
        pair: &impl Pair,
        light: impl Fn(usize) -> [u16; 3] + Sync,
        out: &mut [T],
        make: impl Fn([u16; 3]) -> T + Sync,
    ) -> Result<(), NetworkError> {
        let needed = self.shape[0].pixels();
        if out.len() != needed {
            return Err(NetworkError::Out { needed });
        }
        self.filter_coarse(pair, &light);
        let last = Last::new(self.shape, self.scratch.fine, self.scratch.coarse);
        last.filter(pair, light, |_| false, out, make);
        Ok(())
    }

    /// All but the finest size, which [`Last`] makes of this.
    pub(super) fn filter_coarse(&mut self, pair: &impl Pair, light: &(impl Fn(usize) -> Light + Sync)) {
        let shape = self.shape;
        let Scratch { fine, coarse, work } = &mut self.scratch;
        let (rest, done_half) = parted(coarse.as_mut_bytes(), shape[1].pixels());
        let mut rest: &[Head] = rest.as_chunks().0;
        let heads: [&[Head]; LEVELS] = core::array::from_fn(|level| {
            if level == 0 {
                return &**fine;
            }
            let (part, others) = rest.split_at(shape[level].pixels());
            rest = others;
            part
        });
        let mut rest = work.as_mut_bytes();
        let mut take = |level: usize| {
            let count = size_of::<Light>() * shape[level].pixels();
            let (part, others) = core::mem::take(&mut rest).split_at_mut(count);
            rest = others;
            lights(part)
        };
        let mut before: [&mut [Light]; LEVELS] =
            core::array::from_fn(|level| if level == 0 { &mut [] } else { take(level) });
        let [two, three] = [2, 3].map(take);
        let mut done = [&mut [], done_half, two, three];

        for level in 1..LEVELS {
            let (finer, coarser) = before.split_at_mut(level);
            let (finer, width) = (&*finer[level - 1], shape[level].width);
            let (heads, finer_shape) = (heads[level - 1], shape[level - 1]);
            halves(pair, coarser[0], width, |first, rows| {
                if level == 1 {
                    shrink(light, heads, finer_shape, first, rows, width);
                } else {
                    shrink(|at| finer[at], heads, finer_shape, first, rows, width);
                }
            });
        }
        for level in (1..LEVELS).rev() {
            let (finer, coarser) = done.split_at_mut(level + 1);
            let coarse = coarser.first().map(|light| Coarse {
                light,
                heads: heads[level + 1],
                shape: shape[level + 1],
            });
            let (light, heads, width) = (&*before[level], heads[level], shape[level].width);
            halves(pair, finer[level], width, |first, rows| {
                for (y, row) in (first..).zip(rows.chunks_exact_mut(width)) {
                    let near: Near<5> = Near::of(light, heads, width, y);
                    for (x, out) in row.iter_mut().enumerate() {
                        *out = near.filtered(x, y, coarse.as_ref());
                    }
                }
            });
        }
    }
}

/// What makes the finest light, when all coarser sizes are done.
pub(super) struct Last<'a> {
    shape: [Shape; LEVELS],
    heads: &'a [Head],
    coarse: Coarse<'a>,
    /// Three rows for each worker.
    rings: [&'a mut [Light]; 2],
}

impl<'a> Last<'a> {
    /// In what the other passes left of a [`Scratch`].
    pub fn new(shape: [Shape; LEVELS], fine: &'a [Head], coarse: &'a mut [u32]) -> Last<'a> {
        let half = shape[1].pixels();
        let (rest, light) = parted(coarse.as_mut_bytes(), half);
        let (heads, rest) = rest.split_at_mut(size_of::<Head>() * half);
        let ring = Shape::lights(shape[0].width);
        let (one, rest) = rest.split_at_mut(ring);
        Last {
            shape,
            heads: fine,
            coarse: Coarse {
                light,
                heads: heads.as_chunks().0,
                shape: shape[1],
            },
            rings: [lights(one), lights(&mut rest[..ring])],
        }
    }

    /// Pixels of which `keeps` is true have their own light.
    pub fn filter<T: Send>(
        self,
        pair: &impl Pair,
        light: impl Fn(usize) -> Light + Sync,
        keeps: impl Fn(usize) -> bool + Sync,
        out: &mut [T],
        make: impl Fn(Light) -> T + Sync,
    ) {
        let Shape { width, height } = self.shape[0];
        let Last { heads, coarse, .. } = self;
        let [one, two] = self.rings;
        let band = |first: usize, rows: &mut [T], ring: &mut [Light]| {
            let at = |y: usize| y % 3 * width..(y % 3 + 1) * width;
            for (y, row) in (first..).zip(rows.chunks_exact_mut(width)) {
                // Each row's light is looked at once; before the first row that of the one above it, too.
                let new = if y == first { y.saturating_sub(1) } else { y + 1 };
                for y in new..(y + 2).min(height) {
                    for (x, place) in ring[at(y)].iter_mut().enumerate() {
                        *place = light(y * width + x);
                    }
                }
                let near: Near<3> = Near {
                    light: core::array::from_fn(|i| match (y + i).checked_sub(1) {
                        Some(y) if y < height => &ring[at(y)],
                        _ => &[],
                    }),
                    heads: rows_about(heads, width, y),
                };
                for (x, out) in row.iter_mut().enumerate() {
                    *out = make(if keeps(y * width + x) {
                        near.light[1][x]
                    } else {
                        near.filtered(x, y, Some(&coarse))
                    });
                }
            }
        };
        let (upper, lower) = out.split_at_mut(height.div_ceil(2) * width);
        pair.both(|| band(0, upper, one), || band(height.div_ceil(2), lower, two));
    }
}

/// The bytes before, and at the end the light of so many pixels.
fn parted(bytes: &mut [u8], pixels: usize) -> (&mut [u8], &mut [Light]) {
    let (front, end) = bytes.split_at_mut(bytes.len() - size_of::<Light>() * pixels);
    (front, lights(end))
}

fn lights(bytes: &mut [u8]) -> &mut [Light] {
    // Whole pixels in a part of words, each part an even number of bytes: the cast cannot fail.
    <[Light]>::mut_from_bytes(bytes).unwrap_or(&mut [])
}

/// The next coarser size from its row `first` on: each 2 × 2 by confidence.
fn shrink(
    fine: impl Fn(usize) -> Light,
    heads: &[Head],
    shape: Shape,
    first: usize,
    coarse: &mut [Light],
    coarse_width: usize,
) {
    for (y, row) in (first..).zip(coarse.chunks_exact_mut(coarse_width)) {
        for (x, out) in row.iter_mut().enumerate() {
            let (left, top) = (2 * x, 2 * y);
            let (right, below) = ((left + 1).min(shape.width - 1), (top + 1).min(shape.height - 1));
            let first = top * shape.width + left;
            let mut mean = Mean::new(fine(first), confidence(&heads[first]));
            for (x, y) in [(right, top), (left, below), (right, below)] {
                let place = y * shape.width + x;
                mean.add(fine(place), confidence(&heads[place]));
            }
            *out = mean.value();
        }
    }
}

/// Row y in the middle, `ROWS` in all; those beside the picture are empty.
fn rows_about<T, const ROWS: usize>(all: &[T], width: usize, y: usize) -> [&[T]; ROWS] {
    core::array::from_fn(|i| match (y + i).checked_sub(ROWS / 2) {
        Some(y) => all.get(y * width..(y + 1) * width).unwrap_or(&[]),
        None => &[],
    })
}

/// A row with those about it.
struct Near<'a, const ROWS: usize> {
    light: [&'a [Light]; ROWS],
    heads: [&'a [Head]; ROWS],
}

impl<'a, const ROWS: usize> Near<'a, ROWS> {
    fn of(light: &'a [Light], heads: &'a [Head], width: usize, y: usize) -> Near<'a, ROWS> {
        Near {
            light: rows_about(light, width, y),
            heads: rows_about(heads, width, y),
        }
    }

    /// Pixel x of the middle row, which is number y: the mean about it, blended with the coarser size if there is one.
    #[inline(always)]
    fn filtered(&self, x: usize, y: usize, coarse: Option<&Coarse>) -> Light {
        let head = &self.heads[ROWS / 2][x];
        let mut out = self.mean(x, head);
        if let Some(coarse) = coarse {
            let raised = coarse.raise(head, x, y);
            // 0 ..= 256, both ends whole.
            let blend = i32::from(head[7]) + i32::from(head[7] >> 7);
            for (out, up) in out.iter_mut().zip(raised) {
                let (own, up) = (i32::from(*out), i32::from(up));
                *out = (up + (((own - up) * blend + 128) >> 8)) as u16;
            }
        }
        out
    }

    /// The mean of `ROWS`² pixels by affinity and confidence; those beyond the edge count for nothing.
    #[inline(always)]
    fn mean(&self, x: usize, head: &Head) -> Light {
        // raw: a weight is 1020 at most, 25 of them are under 2^15; the centre's is 3 at least.
        let own = features(head);
        let mut mean = Mean::new(self.light[ROWS / 2][x], 0);
        let width = self.light[ROWS / 2].len();
        let columns = x.saturating_sub(ROWS / 2)..(x + ROWS / 2 + 1).min(width);
        for (light, heads) in self.light.into_iter().zip(self.heads) {
            let (light, heads) = (light.get(columns.clone()), heads.get(columns.clone()));
            for (light, other) in light.unwrap_or(&[]).iter().zip(heads.unwrap_or(&[])) {
                mean.add(*light, (affinity(&own, other) * confidence(other)) >> 6);
            }
        }
        mean.value()
    }
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
        let head = features(head);
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
        let mut mean = Mean::new(self.light[near], 9 * affinity(&head, &self.heads[near]) + 1);
        for (x, y, share) in [(far_x, near_y, 3), (near_x, far_y, 3), (far_x, far_y, 1)] {
            let place = y * self.shape.width + x;
            mean.add(self.light[place], share * affinity(&head, &self.heads[place]));
        }
        mean.value()
    }
}
