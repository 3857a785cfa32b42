use super::finest::{self, kept};
#[cfg(any(gathers, neighbours))]
use super::mean::EXP;
#[cfg(neighbours)]
use super::mean::TABLES;
use super::mean::{Mean, Spread, affinity, confidence, is_far, mean_of_alike};
use super::{FEATURES, Head, Light, Network, NetworkError, Scratch, Shape, halves};
use crate::film::denoise::Pair;
use zerocopy::{FromBytes, IntoBytes};

/// Bytes of what stands one after the other where the light of half the size will: heads and light of an eighth, light of a
/// quarter.
pub(super) const fn overlaid(half: usize, quarter: usize, eighth: usize) -> usize {
    let before = size_of::<Head>() * eighth + size_of::<Light>() * (quarter + 2 * eighth);
    let after = size_of::<Light>() * half;
    if before > after { before } else { after }
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
        let Shape { width, height } = self.shape[0];
        let needed = width * height;
        if out.len() != needed {
            return Err(NetworkError::Out { needed });
        }
        self.filter_in_place(pair, light, |_| 0, |_| false);
        let fine = &*self.scratch.fine;
        halves(pair, out, width, |first, rows| {
            for (place, out) in fine[first * width..].iter().zip(rows) {
                *out = make(kept(place));
            }
        });
        Ok(())
    }

    /// The same, the finest light in its heads' place: see [`kept`]. `thing` answers with the number of what a pixel sees;
    /// pixels of which `keeps` is true have their own light.
    pub(super) fn filter_in_place(
        &mut self,
        pair: &impl Pair,
        light: impl Fn(usize) -> Light + Sync,
        thing: impl Fn(usize) -> u16 + Sync,
        keeps: impl Fn(usize) -> bool + Sync,
    ) {
        let shape = self.shape;
        let [_, half, quarter, eighth] = shape.map(Shape::pixels);
        let Scratch { fine, near, far } = &mut self.scratch;
        let (heads, rest) = near
            .as_mut_bytes()
            .split_at_mut(size_of::<Head>() * (half + quarter));
        let (heads_half, heads_quarter) = heads.as_chunks().0.split_at(half);
        let (before_half, _) = lights(rest, half);
        let (overlaid, rest) = far.as_mut_bytes().split_at_mut(overlaid(half, quarter, eighth));
        let (done_quarter, _) = lights(rest, quarter);

        let (heads_eighth, rest) = overlaid.split_at_mut(size_of::<Head>() * eighth);
        let heads_eighth: &[Head] = heads_eighth.as_chunks().0;
        let (before_quarter, rest) = lights(rest, quarter);
        let (before_eighth, rest) = lights(rest, eighth);
        let (done_eighth, _) = lights(rest, eighth);
        let plane = |level: usize, heads| Plane {
            heads,
            shape: shape[level],
        };
        let at_half = plane(1, heads_half);
        let at_quarter = plane(2, heads_quarter);
        let at_eighth = Plane {
            heads: heads_eighth,
            shape: shape[3],
        };
        at_half.shrink(pair, plane(0, fine), &light, before_half);
        at_quarter.shrink(pair, at_half, &|at| before_half[at], before_quarter);
        at_eighth.shrink(pair, at_quarter, &|at| before_quarter[at], before_eighth);
        at_eighth.smooth(pair, before_eighth, None, done_eighth);
        at_quarter.smooth(
            pair,
            before_quarter,
            Some(at_eighth.with(done_eighth)),
            done_quarter,
        );
        // In the place of all that is of an eighth, and of a quarter's light.
        let (done_half, _) = lights(overlaid, half);
        at_half.smooth(pair, before_half, Some(at_quarter.with(done_quarter)), done_half);

        let (heads, rings) = near.as_mut_bytes().split_at_mut(size_of::<Head>() * half);
        let at_half = Plane {
            heads: heads.as_chunks().0,
            shape: shape[1],
        };
        finest::finish(
            pair,
            shape[0],
            fine,
            at_half.with(done_half),
            rings,
            &light,
            (&thing, &keeps),
        );
    }
}

/// The light of so many pixels, and the bytes behind it.
pub(super) fn lights(bytes: &mut [u8], pixels: usize) -> (&mut [Light], &mut [u8]) {
    let (front, rest) = bytes.split_at_mut(size_of::<Light>() * pixels);
    // Whole pixels, an even number of bytes behind a word: the cast cannot fail.
    (<[Light]>::mut_from_bytes(front).unwrap_or(&mut []), rest)
}

/// Heads of one size.
#[derive(Clone, Copy)]
struct Plane<'a> {
    heads: &'a [Head],
    shape: Shape,
}

impl<'a> Plane<'a> {
    fn with(self, light: &'a [Light]) -> Coarse<'a> {
        Coarse { light, plane: self }
    }

    /// The light of this size from that of the finer one: each 2 × 2 by affinity and confidence.
    fn shrink(
        self,
        pair: &impl Pair,
        fine: Plane,
        light: &(impl Fn(usize) -> Light + Sync),
        out: &mut [Light],
    ) {
        let width = self.shape.width;
        halves(pair, out, width, |first, rows| {
            let heads = self.heads[first * width..].chunks_exact(width);
            for (y, (row, heads)) in (first..).zip(rows.chunks_exact_mut(width).zip(heads)) {
                for (x, (out, head)) in row.iter_mut().zip(heads).enumerate() {
                    *out = fine.mean_of_four(light, x, y, head);
                }
            }
        });
    }

    /// The mean of the four pixels of coarser pixel (x, y), whose head is `coarse`; at an odd edge some count twice.
    #[inline(always)]
    fn mean_of_four(self, light: &impl Fn(usize) -> Light, x: usize, y: usize, coarse: &Head) -> Light {
        let Shape { width, height } = self.shape;
        let (left, top) = (2 * x, 2 * y);
        let (right, below) = ((left + 1).min(width - 1), (top + 1).min(height - 1));
        let first = top * width + left;
        let others = [top * width + right, below * width + left, below * width + right];
        if is_far(coarse, &self.heads[first]) && others.iter().all(|&at| is_far(coarse, &self.heads[at])) {
            return mean_of_alike(light(first), others.map(light));
        }
        let own = Spread::of(coarse);
        // Never nothing.
        let weight = |at: usize| ((affinity(own, &self.heads[at]) * confidence(&self.heads[at])) >> 6) + 1;
        let mut mean = Mean::new(light(first), weight(first));
        for at in others {
            mean.add(light(at), weight(at));
        }
        mean.value()
    }

    /// Filters this size's light, of 5 × 5 pixels each.
    fn smooth(self, pair: &impl Pair, light: &[Light], coarse: Option<Coarse>, out: &mut [Light]) {
        let width = self.shape.width;
        halves(pair, out, width, |first, rows| {
            for (y, row) in (first..).zip(rows.chunks_exact_mut(width)) {
                let near: Near<5> = Near::new(rows_about(light, width, y), rows_about(self.heads, width, y));
                let coarse = coarse.map(|coarse| coarse.about(y));
                for (x, out) in row.iter_mut().enumerate() {
                    *out = near.filtered(x, coarse.as_ref());
                }
            }
        });
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
pub(super) struct Near<'a, const ROWS: usize> {
    pub light: [&'a [Light]; ROWS],
    pub heads: [&'a [Head]; ROWS],
    #[cfg(neighbours)]
    rows: microlux_asm::Rows<'a, ROWS>,
}

impl<'a, const ROWS: usize> Near<'a, ROWS> {
    pub fn new(light: [&'a [Light]; ROWS], heads: [&'a [Head]; ROWS]) -> Self {
        Near {
            light,
            heads,
            #[cfg(neighbours)]
            rows: microlux_asm::Rows::new(heads, light),
        }
    }

    /// Pixel x of the middle row: the mean about it, blended with the coarser size if there is one.
    #[inline(always)]
    pub fn filtered(&self, x: usize, coarse: Option<&Beside>) -> Light {
        let head = &self.heads[ROWS / 2][x];
        let own = self.mean(x, head);
        match coarse {
            Some(coarse) => blended(own, coarse.raise(head, x), blend(head)),
            None => own,
        }
    }

    /// The mean of `ROWS`² pixels by affinity and confidence; those beyond the edge count for nothing.
    #[inline(always)]
    #[cfg_attr(neighbours, expect(unused_variables, reason = "the rows know it"))]
    fn mean(&self, x: usize, head: &Head) -> Light {
        // raw: a weight is 1020 at most, 25 of them are under 2^15; the centre's is 3 at least.
        #[cfg(neighbours)]
        let [weight, sum @ ..] = self.rows.gather(x, &EXP);
        #[cfg(not(neighbours))]
        let [weight, sum @ ..] = gather(head, self.runs(x));
        let centre = &self.light[ROWS / 2][x];
        #[cfg(neighbours)]
        return microlux_asm::mean(weight, sum, centre, &TABLES);
        #[cfg(not(neighbours))]
        Mean {
            centre: *centre,
            weight,
            sum,
        }
        .value()
    }

    /// Heads and light of each row about a pixel, as far as there are any.
    #[inline(always)]
    pub fn runs(&self, x: usize) -> [(&[Head], &[Light]); ROWS] {
        let width = self.light[ROWS / 2].len();
        let columns = x.saturating_sub(ROWS / 2)..(x + ROWS / 2 + 1).min(width);
        core::array::from_fn(|i| {
            let (heads, light) = (
                self.heads[i].get(columns.clone()),
                self.light[i].get(columns.clone()),
            );
            (heads.unwrap_or(&[]), light.unwrap_or(&[]))
        })
    }
}

/// Weights of pixels in runs by affinity and confidence, and their lights by weight.
#[cfg(not(any(gathers, neighbours)))]
#[inline(always)]
fn gather<const RUNS: usize>(own: &Head, runs: [(&[Head], &[Light]); RUNS]) -> [u32; 4] {
    let own = Spread::of(own);
    let mut mean = Mean::new([0; 3], 0);
    for (heads, lights) in runs {
        for (head, light) in heads.iter().zip(lights) {
            mean.add(*light, (affinity(own, head) * confidence(head)) >> 6);
        }
    }
    let [r, g, b] = mean.sum;
    [mean.weight, r, g, b]
}

#[cfg(gathers)]
#[inline(always)]
fn gather<const RUNS: usize>(own: &Head, runs: [(&[Head], &[Light]); RUNS]) -> [u32; 4] {
    microlux_asm::gather(own, runs, &EXP)
}

/// What the mean of its own size counts, 0 ..= 256, both ends whole.
#[inline(always)]
pub(super) fn blend(head: &Head) -> i32 {
    let blend = head[FEATURES + 1];
    i32::from(blend) + i32::from(blend >> 7)
}

/// `raised + (own − raised) · blend / 256`.
#[inline(always)]
pub(super) fn blended(mut own: Light, raised: Light, blend: i32) -> Light {
    for (out, up) in own.iter_mut().zip(raised) {
        let (own, up) = (i32::from(*out), i32::from(up));
        *out = (up + (((own - up) * blend + 128) >> 8)) as u16;
    }
    own
}

/// A finished coarser size.
#[derive(Clone, Copy)]
pub(super) struct Coarse<'a> {
    light: &'a [Light],
    plane: Plane<'a>,
}

impl<'a> Coarse<'a> {
    /// What row y of the finer size is raised from.
    pub fn about(self, y: usize) -> Beside<'a> {
        let Shape { width, height } = self.plane.shape;
        let near = y >> 1;
        let far = if y & 1 == 0 {
            near.saturating_sub(1)
        } else {
            (near + 1).min(height - 1)
        };
        let row = |y: usize| {
            (
                &self.plane.heads[y * width..][..width],
                &self.light[y * width..][..width],
            )
        };
        Beside {
            near: row(near),
            far: row(far),
        }
    }
}

/// A row of coarse pixels, and the one that is next to it from a finer one's: heads and light.
pub(super) struct Beside<'a> {
    near: (&'a [Head], &'a [Light]),
    far: (&'a [Head], &'a [Light]),
}

impl Beside<'_> {
    /// What the four nearest coarse pixels say of pixel x, by affinity.
    #[inline(always)]
    pub fn raise(&self, head: &Head, x: usize) -> Light {
        let (near_row, far_row) = (self.near, self.far);
        let near = x >> 1;
        let far = if x & 1 == 0 {
            near.saturating_sub(1)
        } else {
            (near + 1).min(near_row.0.len() - 1)
        };
        // Then the others count for nothing, and the mean of one is itself.
        let is_alone =
            is_far(head, &near_row.0[far]) && is_far(head, &far_row.0[near]) && is_far(head, &far_row.0[far]);
        if is_alone {
            near_row.1[near]
        } else {
            self.mixed(head, near, far)
        }
    }

    #[inline(never)]
    fn mixed(&self, head: &Head, near: usize, far: usize) -> Light {
        let (near_row, far_row) = (self.near, self.far);
        let own = Spread::of(head);
        let mut mean = Mean::new(near_row.1[near], 9 * affinity(own, &near_row.0[near]) + 1);
        for ((heads, light), x, share) in [(near_row, far, 3), (far_row, near, 3), (far_row, far, 1)] {
            if !is_far(head, &heads[x]) {
                mean.add(light[x], share * affinity(own, &heads[x]));
            }
        }
        mean.value()
    }
}
