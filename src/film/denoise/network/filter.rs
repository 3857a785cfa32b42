use super::{FEATURES, Head, Light, Network, NetworkError, Scratch, Shape, halves};
use crate::film::denoise::Pair;
#[cfg(neighbours)]
use crate::num::{BYTE_ZEROS, RECIPS};
#[cfg(not(neighbours))]
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

#[cfg(neighbours)]
static TABLES: microlux_asm::Tables = microlux_asm::Tables {
    zeros: &BYTE_ZEROS,
    recips: &RECIPS,
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

    #[cfg(neighbours)]
    #[inline(always)]
    fn value(&self) -> Light {
        microlux_asm::mean(self.weight, self.sum, &self.centre, &TABLES)
    }

    /// Error: 2^-13.5 of the difference at most, and half a step.
    #[cfg(not(neighbours))]
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
#[cfg(not(neighbours))]
#[inline(always)]
fn quotient(a: u32, short: u32, zeros: u32) -> u32 {
    let before = leading_zeros(a);
    let product = ((a << before) >> 16) * (short & 0x1_ffff).min(0xffff);
    // 13 at least; a third of b has more than 31.
    let shift = 30 + before - zeros;
    if shift > 31 {
        return 0;
    }
    ((product >> shift) + 1) >> 1
}

#[inline(always)]
fn affinity(a: Spread, b: &Head) -> u32 {
    u32::from(EXP[(a.square(b) >> 1).min(255) as usize])
}

/// The squared distance from which an affinity is 0.
const FAR: u32 = {
    let mut i = 0;
    while EXP[i] > 0 {
        i += 1;
    }
    2 * i as u32
};

/// The difference of one feature from which it is that far.
const REACH: i32 = {
    let mut apart = 0;
    while ((apart * apart) as u32) < FAR {
        apart += 1;
    }
    apart
};

/// The feature in which heads of two sizes differ most, of [`TRAINED`](super::TRAINED).
const UNLIKE: usize = 3;

/// Whether one feature alone says that two heads have no affinity; most of two sizes have none.
#[inline(always)]
fn is_far(a: &Head, b: &Head) -> bool {
    let apart = i32::from(a[UNLIKE] as i8) - i32::from(b[UNLIKE] as i8);
    apart.abs() >= REACH
}

/// The mean of four lights that weigh 1 each.
#[inline(always)]
fn mean_of_alike(centre: Light, others: [Light; 3]) -> Light {
    let mut mean = Mean::new(centre, 1);
    for light in others {
        mean.add(light, 1);
    }
    // What [`Mean::value`] makes of it, which takes longer to say so.
    let mut out = centre;
    for (out, sum) in out.iter_mut().zip(mean.sum) {
        let sum = sum as i32 - 4 * i32::from(*out);
        if sum.unsigned_abs() >> 16 != 0 {
            return mean.value();
        }
        *out = (i32::from(*out)
            + if sum < 0 {
                -((1 - sum) >> 2)
            } else {
                (1 + sum) >> 2
            }) as u16;
    }
    out
}

#[cfg(gathers)]
use microlux_asm::Spread;

/// A head's features.
#[cfg(not(gathers))]
#[derive(Clone, Copy)]
struct Spread([i32; FEATURES]);

#[cfg(not(gathers))]
impl Spread {
    #[inline(always)]
    fn of(head: &Head) -> Spread {
        Spread(core::array::from_fn(|i| i32::from(head[i] as i8)))
    }

    /// The squared distance to another head's.
    #[inline(always)]
    fn square(self, other: &Head) -> u32 {
        let apart = |(own, other): (&i32, &u8)| own - i32::from(*other as i8);
        self.0.iter().zip(other).map(apart).map(|d| (d * d) as u32).sum()
    }
}

/// 1 ..= 256.
#[inline(always)]
fn confidence(head: &Head) -> u32 {
    u32::from(head[FEATURES]) + 1
}

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
        finish(
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

/// The light that [`Network::filter_in_place`] left in a head's place.
#[inline(always)]
pub(super) fn kept(place: &Head) -> Light {
    let [a, b, c, d, e, f, _, _] = *place;
    [[a, b], [c, d], [e, f]].map(u16::from_ne_bytes)
}

/// A row of light into the places of its heads.
fn keep(places: &mut [Head], lights: &[Light]) {
    for (place, light) in places.iter_mut().zip(lights) {
        let [[a, b], [c, d], [e, f]] = light.map(u16::to_ne_bytes);
        *place = [a, b, c, d, e, f, 0, 0];
    }
}

/// What a worker has for the finest light.
pub(super) struct Ring<'a> {
    /// The heads of the other worker's nearest row.
    beyond: &'a mut [Head],
    /// Affinities of the row before and of this one with each pixel's neighbours: see [`microlux_asm::kins`].
    #[cfg(neighbours)]
    kins: [&'a mut [[u8; 4]]; 2],
    /// Three rows of light as it was; row y is number y modulo 3.
    light: &'a mut [Light],
    /// A row's answers, and those of the row before, whose heads the row after it still asks for.
    done: [&'a mut [Light]; 2],
}

impl<'a> Ring<'a> {
    pub const fn bytes(width: usize) -> usize {
        let affinities = 2 * 4;
        ((5 * size_of::<Light>() + size_of::<Head>() + affinities) * width).next_multiple_of(4)
    }

    fn new(bytes: &'a mut [u8], width: usize) -> Ring<'a> {
        // Whole words first.
        let (beyond, rest) = bytes.split_at_mut(size_of::<Head>() * width);
        let (_affinities, rest) = rest.split_at_mut(2 * 4 * width);
        let (light, rest) = lights(rest, 3 * width);
        let (one, rest) = lights(rest, width);
        let (two, _) = lights(rest, width);
        Ring {
            beyond: beyond.as_chunks_mut().0,
            #[cfg(neighbours)]
            kins: _affinities.as_chunks_mut().0.split_at_mut(width).into(),
            light,
            done: [one, two],
        }
    }
}

/// What is known of a row's outlines: each column of three is looked at once.
struct Edges {
    /// The number in the middle of the last column.
    last: u16,
    /// From the last back, a bit for each column that is of more than one thing, or whose middle is another than the one before.
    bits: u32,
}

impl Edges {
    /// Of the first column, which is also the one before it.
    fn new(column: [u16; 3]) -> Edges {
        let mut edges = Edges {
            last: column[1],
            bits: 0,
        };
        edges.see(column);
        edges
    }

    #[inline(always)]
    fn see(&mut self, [above, own, below]: [u16; 3]) {
        self.bits =
            self.bits << 2 | u32::from(above != own || below != own) << 1 | u32::from(own != self.last);
        self.last = own;
    }

    /// Whether all about the last column's middle are of one thing, given the column after it.
    #[inline(always)]
    fn next_is_inside(&mut self, column: [u16; 3]) -> bool {
        self.see(column);
        // Three columns, and two steps between them.
        self.bits & 0b10_11_11 == 0
    }
}

/// The finest light, in its heads' place.
fn finish(
    pair: &impl Pair,
    Shape { width, height }: Shape,
    fine: &mut [Head],
    coarse: Coarse,
    rings: &mut [u8],
    light: &(impl Fn(usize) -> Light + Sync),
    (thing, keeps): (&(impl Fn(usize) -> u16 + Sync), &(impl Fn(usize) -> bool + Sync)),
) {
    let band = |first: usize, rows: &mut [Head], ring: Ring| {
        let Ring {
            light: near_light,
            done: [mut done, mut before],
            beyond,
            #[cfg(neighbours)]
                kins: [mut above, mut own],
        } = ring;
        let end = first + rows.len() / width;
        let at = |y: usize| y % 3 * width..(y % 3 + 1) * width;
        for y in first..end {
            // Each row's light is looked at once; before the first row that of the one above it, too.
            let new = if y == first { y.saturating_sub(1) } else { y + 1 };
            for y in new..(y + 2).min(height) {
                for (x, place) in near_light[at(y)].iter_mut().enumerate() {
                    *place = light(y * width + x);
                }
            }
            let heads = |y: usize| match y.checked_sub(first) {
                _ if y >= height => &[],
                Some(row) if y < end => &rows[row * width..][..width],
                _ => &*beyond,
            };
            let near: Near<3> = Near::new(
                core::array::from_fn(|i| match (y + i).checked_sub(1) {
                    Some(y) if y < height => &near_light[at(y)],
                    _ => &[],
                }),
                core::array::from_fn(|i| (y + i).checked_sub(1).map_or(&[][..], heads)),
            );
            #[cfg(neighbours)]
            let nine = {
                let [upper, middle, lower] = near.heads;
                if y == first {
                    microlux_asm::kins(upper, middle, &EXP, above);
                }
                microlux_asm::kins(middle, lower, &EXP, own);
                microlux_asm::Nine::new(near.heads, near.light, [above, own])
            };
            // What is beside the picture counts for nothing, whatever its number is.
            let lines = [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|y| y * width);
            let column = |x: usize| lines.map(|line| thing(line + x.min(width - 1)));
            let things = |x: usize| [column(x.saturating_sub(1)), column(x), column(x + 1)];
            let coarse = coarse.about(y);
            let mut edges = Edges::new(column(0));
            for (x, out) in done.iter_mut().enumerate() {
                let is_inside = edges.next_is_inside(column(x + 1));
                #[cfg(neighbours)]
                let filtered = || match nine.gather(x, if is_inside { 0 } else { others(&things(x)) }) {
                    Some(sums) => near.finished(x, &coarse, sums, is_inside),
                    None if is_inside => near.filtered_at_edge(x, &coarse),
                    None => near.filtered_at_outline(x, &coarse, &things(x)),
                };
                #[cfg(not(neighbours))]
                let filtered = || {
                    if is_inside {
                        near.filtered(x, Some(&coarse))
                    } else {
                        near.filtered_at_outline(x, &coarse, &things(x))
                    }
                };
                *out = if keeps(y * width + x) {
                    near.light[1][x]
                } else {
                    filtered()
                };
            }
            core::mem::swap(&mut done, &mut before);
            #[cfg(neighbours)]
            core::mem::swap(&mut above, &mut own);
            // Now `done` is the row before, which nobody asks for any more.
            if y > first {
                keep(&mut rows[(y - 1 - first) * width..], done);
            }
        }
        if end > first {
            keep(&mut rows[(end - 1 - first) * width..], before);
        }
    };
    let (one, two) = rings.split_at_mut(Ring::bytes(width));
    let [one, two] = [one, two].map(|bytes| Ring::new(bytes, width));
    let half = height.div_ceil(2);
    let (upper, lower) = fine.split_at_mut(half * width);
    if half < height {
        one.beyond.copy_from_slice(&lower[..width]);
        two.beyond.copy_from_slice(&upper[(half - 1) * width..]);
    }
    pair.both(|| band(0, upper, one), || band(half, lower, two));
}

/// The light of so many pixels, and the bytes behind it.
fn lights(bytes: &mut [u8], pixels: usize) -> (&mut [Light], &mut [u8]) {
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
struct Near<'a, const ROWS: usize> {
    light: [&'a [Light]; ROWS],
    heads: [&'a [Head]; ROWS],
    #[cfg(neighbours)]
    rows: microlux_asm::Rows<'a, ROWS>,
}

impl<'a, const ROWS: usize> Near<'a, ROWS> {
    fn new(light: [&'a [Light]; ROWS], heads: [&'a [Head]; ROWS]) -> Self {
        Near {
            light,
            heads,
            #[cfg(neighbours)]
            rows: microlux_asm::Rows::new(heads, light),
        }
    }

    /// Pixel x of the middle row: the mean about it, blended with the coarser size if there is one.
    #[inline(always)]
    fn filtered(&self, x: usize, coarse: Option<&Beside>) -> Light {
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
    fn runs(&self, x: usize) -> [(&[Head], &[Light]); ROWS] {
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

/// Which of 3 × 3, given by column, is of another thing than the middle one: a bit for each, row by row.
#[cfg(neighbours)]
#[inline(always)]
fn others(things: &[[u16; 3]; 3]) -> u32 {
    let mut bits = 0;
    for (x, column) in things.iter().enumerate() {
        for (y, thing) in column.iter().enumerate() {
            bits |= u32::from(*thing != things[1][1]) << (3 * y + x);
        }
    }
    bits
}

impl Near<'_, 3> {
    /// [`Self::filtered`] of what has not all of its neighbours.
    #[cfg(neighbours)]
    #[inline(never)]
    fn filtered_at_edge(&self, x: usize, coarse: &Beside) -> Light {
        self.filtered(x, Some(coarse))
    }

    /// [`Self::filtered`], or that at an outline, from its weights and lights by weight.
    #[cfg(neighbours)]
    #[inline(always)]
    fn finished(&self, x: usize, coarse: &Beside, [weight, sum @ ..]: [u32; 4], is_inside: bool) -> Light {
        let head = &self.heads[1][x];
        let own = microlux_asm::mean(weight, sum, &self.light[1][x], &TABLES);
        let blend = if is_inside {
            blend(head)
        } else {
            (blend(head) + 256) >> 1
        };
        blended(own, coarse.raise(head, x), blend)
    }

    /// [`Self::filtered`] where not all of the 3 × 3 are of one thing, by column: another thing's light counts a quarter, and the
    /// coarser size's, which knows no things, half.
    #[inline(never)]
    fn filtered_at_outline(&self, x: usize, coarse: &Beside, things: &[[u16; 3]; 3]) -> Light {
        let head = &self.heads[1][x];
        let own = Spread::of(head);
        let mut mean = Mean::new(self.light[1][x], 0);
        // There is no column before the first.
        let first = usize::from(x == 0);
        for (row, (heads, lights)) in self.runs(x).into_iter().enumerate() {
            for (column, (other, light)) in (first..).zip(heads.iter().zip(lights)) {
                let weight = (affinity(own, other) * confidence(other)) >> 6;
                let is_other = things[column][row] != things[1][1];
                mean.add(*light, if is_other { weight >> 2 } else { weight });
            }
        }
        blended(mean.value(), coarse.raise(head, x), (blend(head) + 256) >> 1)
    }
}

/// What the mean of its own size counts, 0 ..= 256, both ends whole.
#[inline(always)]
fn blend(head: &Head) -> i32 {
    let blend = head[FEATURES + 1];
    i32::from(blend) + i32::from(blend >> 7)
}

/// `raised + (own − raised) · blend / 256`.
#[inline(always)]
fn blended(mut own: Light, raised: Light, blend: i32) -> Light {
    for (out, up) in own.iter_mut().zip(raised) {
        let (own, up) = (i32::from(*out), i32::from(up));
        *out = (up + (((own - up) * blend + 128) >> 8)) as u16;
    }
    own
}

/// A finished coarser size.
#[derive(Clone, Copy)]
struct Coarse<'a> {
    light: &'a [Light],
    plane: Plane<'a>,
}

impl<'a> Coarse<'a> {
    /// What row y of the finer size is raised from.
    fn about(self, y: usize) -> Beside<'a> {
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
struct Beside<'a> {
    near: (&'a [Head], &'a [Light]),
    far: (&'a [Head], &'a [Light]),
}

impl Beside<'_> {
    /// What the four nearest coarse pixels say of pixel x, by affinity.
    #[inline(always)]
    fn raise(&self, head: &Head, x: usize) -> Light {
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
        let head = Spread::of(head);
        let mut mean = Mean::new(near_row.1[near], 9 * affinity(head, &near_row.0[near]) + 1);
        for ((heads, light), x, share) in [(near_row, far, 3), (far_row, near, 3), (far_row, far, 1)] {
            mean.add(light[x], share * affinity(head, &heads[x]));
        }
        mean.value()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_alike_are_what_their_weights_say() {
        let value = |centre: u16, other: u16| {
            let mut mean = Mean::new([centre; 3], 1);
            for light in [other, other, centre] {
                mean.add([light; 3], 1);
            }
            mean.value()
        };
        for apart in 0..=u16::MAX {
            for other in [apart, apart / 2, 65_535 - apart] {
                let four = mean_of_alike([apart; 3], [[other; 3], [other; 3], [apart; 3]]);
                assert_eq!(four, value(apart, other), "{apart} {other}");
                let [one, ..] = mean_of_alike([7; 3], [[apart; 3], [7; 3], [7; 3]]);
                let mut mean = Mean::new([7; 3], 1);
                for light in [apart, 7, 7] {
                    mean.add([light; 3], 1);
                }
                assert_eq!(one, mean.value()[0], "{apart}");
            }
        }
    }

    #[test]
    fn what_one_feature_says_is_far_has_no_affinity() {
        for a in 0..=255 {
            for b in 0..=255 {
                let (mut one, mut two) = ([0; 8], [0; 8]);
                (one[UNLIKE], two[UNLIKE]) = (a, b);
                assert_eq!(
                    is_far(&one, &two),
                    affinity(Spread::of(&one), &two) == 0,
                    "{a} {b}"
                );
            }
        }
    }
}
