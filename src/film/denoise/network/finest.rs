//! The finest size's light, in the place of its heads, row after row.

use super::filter::{Beside, Coarse, Near, blend, blended, lights};
#[cfg(neighbours)]
use super::mean::{EXP, TABLES};
use super::mean::{Mean, Spread, affinity, confidence};
use super::{Head, Light, Shape};
use crate::film::denoise::Pair;

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
pub(super) fn finish(
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
