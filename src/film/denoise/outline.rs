//! Outlines without steps, where few samples tell where they run.
//!
//! A sample meets one thing or another: a pixel that an outline cuts so that the share *p* of it is one thing's has that
//! thing's colour with chance *p*, and is off by √(p (1 − p)) of the step between both. A mean over 3 × 3 with the shares
//! (a, 1 − 2a, a) across and down is off by less, until what it blurs outweighs what it evens: for a straight outline
//! anywhere, and *n* samples a pixel, the squared error about it is in the mean
//!
//! ```text
//! a² + ((1 − 2a)² + 2a²)² / 6n        of the step's square; 1/6n without
//! ```
//!
//! whose least is 0.42 of that for one sample (a = 0.17), and at smaller *a* for more.
//!
//! Where three in a row at a side are all another thing's and the three across from them all of the pixel's own, a straight
//! outline runs along between both, and a mean along it blurs nothing but its ends ([`ALONG`]). Mixed there so, 0.49 of the error
//! about straight outlines anywhere is left of 2 samples, 0.53 of 4, 0.57 of 8, 0.65 of 16, where a mean over 3 × 3 leaves 0.57,
//! 0.72, 0.83 and 0.90.
//!
//! Of one sample a pixel it is known which thing it met, and how many of its neighbours met the same: of straight outlines
//! anywhere, at any angle, the mean share that is others' where as many sides and corners are ([`UNITS`]) leaves 0.25. If each
//! sample is in its pixel's middle, sides and corners say more of where the outline runs: shares by them ([`MIDDLES`]) leave
//! 0.28 of the error of steps, and 0.20 of that of the roots of light, a mean of 3 × 3 (a = 0.125) 0.43 and 0.48.
//!
//! Lights count by 1/(1 + luminance), so that what is shown is even, not what is added up (Karis, "High-Quality Temporal
//! Supersampling", 2014): else a lamp shines through its own outline.

use core::ops::Range;

use super::Size;
use super::remember::DEPTH_SLACK;
use super::weight::{Mean, luma_code};
use crate::color::{Radiance, Rgb9e5};
use crate::film::Feature;
use crate::film::feature::DEPTH_NOTHING;
use crate::num::{isqrt, leading_zeros};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// What a pixel shows, and of what: eight bytes of a row that [`Clean`](super::Clean) works in.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct Seen {
    light: Rgb9e5,
    /// From the highest bit: 16 of the number, 8 of the distance, and how many samples it is worth, places anywhere in the
    /// pixel, or [`MIDDLE`].
    of: u32,
}

/// In a number of samples' place: one in the middle. Of those anywhere fewer are counted.
pub(super) const MIDDLE: u32 = 254;

/// What a frame's samples of a pixel are worth. `spp` that keep out of each other's way know where an outline runs as √spp³ that
/// do not (Mitchell, "Consequences of Stratified Sampling in Graphics", 1996).
pub(super) fn worth(spp: u32) -> u32 {
    // raw: under 2^18
    let spp = spp.min(63);
    isqrt(spp * spp * spp)
}

impl Seen {
    pub const NOTHING: Seen = Seen {
        light: Rgb9e5::BLACK,
        of: 0,
    };

    /// As many as there is room for, in memory that is not needed meanwhile.
    pub fn over(memory: &mut [u32]) -> &mut [Seen] {
        let (pairs, _) = memory.as_chunks_mut::<2>();
        // Two words each: the cast cannot fail.
        <[Seen]>::mut_from_bytes(pairs.as_mut_bytes()).unwrap_or(&mut [])
    }

    pub(super) fn new(light: Rgb9e5, pixel: &Feature, samples: u32) -> Seen {
        Seen {
            light,
            of: (pixel.id as u32) << 16 | (pixel.depth as u32) << 8 | samples.min(MIDDLE),
        }
    }

    pub(super) fn light(&self) -> Rgb9e5 {
        self.light
    }

    pub(super) fn depth(&self) -> u8 {
        (self.of >> 8) as u8
    }

    fn samples(&self) -> u32 {
        self.of & 255
    }
}

/// Of 256, for one sample and for two or three: what a neighbour at the side counts, a (1 − 2a), and one at the corner, a²; a is
/// 0.17 and 0.125. For more, what that blurs of corners and of what is thin outweighs what it evens.
const SHARES: [[u32; 2]; 2] = [[29, 7], [24, 4]];

/// Of 256, for 2, 4, 8, ... samples: what each of the two neighbours along a straight outline counts, by the least squared error
/// of straight outlines anywhere, at any angle.
const ALONG: [u32; 6] = [84, 77, 66, 51, 35, 22];

/// Of 256, for one sample: what a corner counts that is another thing's, half of what such a side counts, by how many sides
/// and then corners are. Means of four million straight outlines; where all corners are and none of these was seen, as of
/// [`SHARES`] together, and of what fewer than ten in a million were, as one beside it.
const UNITS: [[u8; 5]; 5] = [
    [0, 0, 0, 0, 7],
    [0, 1, 7, 16, 10],
    [0, 6, 15, 24, 11],
    [21, 21, 21, 24, 12],
    [24, 24, 24, 22, 12],
];

/// The same of one sample in the middle of each pixel, so that the root of light, which is what a display shows, is off by the
/// least where one of both things is black, whichever: less than the mean share. By rows and columns of middles a straight
/// outline has few ways to run; of others as one beside it, where all sides are others' as of [`SHARES`] for two samples.
const MIDDLES: [[u8; 5]; 5] = [
    [0, 0, 0, 0, 0],
    [0, 0, 3, 3, 3],
    [5, 5, 14, 14, 14],
    [14, 14, 14, 14, 14],
    [9, 9, 9, 9, 9],
];

/// 64/(1 + luminance), 1 at least, by [`luma_code`].
static TONE: [u8; 256] = {
    let mut table = [64; 256];
    let mut code = 1;
    while code < 256 {
        let eighths = code as u64 - 1;
        // Luminance, Q18.
        let luma = (8 + eighths % 8) << (eighths / 8);
        let tone = ((64 << 18) + (luma + (1 << 18)) / 2) / (luma + (1 << 18));
        table[code] = if tone == 0 { 1 } else { tone as u8 };
        code += 1;
    }
    table
};

/// What a light counts where what is shown is to be even.
pub(super) fn tone(light: Rgb9e5) -> u32 {
    u32::from(TONE[usize::from(luma_code(light))])
}

/// A row with those above and below it; at the picture's edge it is its own neighbour.
#[derive(Clone, Copy, Debug)]
pub struct Row<'r> {
    rows: [&'r [Seen]; 3],
}

/// What some pixels are of: the least and the most of [`Seen::of`], whose numbers are its highest bits, then distances.
#[derive(Clone, Copy)]
struct Span {
    least: u32,
    most: u32,
}

impl Span {
    const fn of(of: u32) -> Span {
        Span { least: of, most: of }
    }

    fn with(self, other: Span) -> Span {
        Span {
            least: self.least.min(other.least),
            most: self.most.max(other.most),
        }
    }

    /// Whether they are of one number and near the distance of `own`, one of them.
    fn is_one(self, own: u32) -> bool {
        let [least, own, most] = [self.least, own, self.most].map(|of| of >> 8);
        let is_far = most as u8 == DEPTH_NOTHING;
        least == most
            || least >> 8 == most >> 8 && !is_far && own - least <= DEPTH_SLACK && most - own <= DEPTH_SLACK
    }
}

impl Row<'_> {
    /// From the left, each mixed with its neighbours if an outline is near.
    pub fn lights(&self) -> impl Iterator<Item = Radiance> {
        let [above, own, below] = self.rows;
        // The three columns about a pixel: each is looked at once.
        let mut columns =
            above.iter().zip(own).zip(below).map(|((above, own), below)| {
                Span::of(above.of).with(Span::of(own.of)).with(Span::of(below.of))
            });
        let first = columns.next().unwrap_or(Span::of(0));
        let mut near = [first; 2];
        own.iter().enumerate().map(move |(x, own)| {
            let next = columns.next().unwrap_or(near[1]);
            let both = near[1].with(next);
            let span = near[0].with(both);
            near = [near[1], next];
            let light = if span.is_one(own.of) {
                own.light
            } else {
                self.mixed(x)
            };
            light.decode()
        })
    }

    pub(super) fn len(&self) -> usize {
        self.rows[1].len()
    }

    /// The 3 × 3 about a pixel of the row.
    #[inline(always)]
    pub(super) fn near(&self, x: usize) -> [[&Seen; 3]; 3] {
        let row = self.rows[1];
        let Some(own) = row.get(x) else {
            return [[&Seen::NOTHING; 3]; 3];
        };
        let columns = [x.saturating_sub(1), x, (x + 1).min(row.len() - 1)];
        self.rows.map(|row| columns.map(|x| row.get(x).unwrap_or(own)))
    }

    /// Pixel x, the middle one of these, mixed with the others if an outline is near.
    pub(super) fn light(&self, x: usize, near: &[[&Seen; 3]; 3]) -> Rgb9e5 {
        let own = near[1][1];
        let all = near.iter().flatten();
        let span = all.fold(Span::of(own.of), |span, seen| span.with(Span::of(seen.of)));
        if span.is_one(own.of) {
            own.light
        } else {
            self.mixed(x)
        }
    }

    /// Pixel x mixed with those about it.
    #[inline(never)]
    fn mixed(&self, x: usize) -> Rgb9e5 {
        let near = self.near(x);
        let own = near[1][1];
        let is_other = |seen: &&Seen| (seen.of ^ own.of) >> 16 != 0;
        if own.samples() == MIDDLE {
            return of_middles(&near);
        }
        let shares = if own.samples() == 1 && near.iter().flatten().any(is_other) {
            counted(&near)
        } else {
            let doublings = 31 - leading_zeros(own.samples().max(1)) as usize;
            let Some(shares) = along(&near, doublings).or_else(|| everywhere(doublings)) else {
                return own.light;
            };
            shares
        };
        if shares[1][1] == 256 {
            return own.light;
        }
        // What counts for nothing is not looked at: a lamp there would take bits from what does.
        let mut mean = Mean::new();
        for (seen, share) in near.as_flattened().iter().zip(shares.as_flattened()) {
            if *share != 0 {
                mean.see(seen.light);
            }
        }
        for (seen, share) in near.as_flattened().iter().zip(shares.as_flattened()) {
            if *share != 0 {
                // raw: 256 · 64 in all.
                mean.add(seen.light, *share * tone(seen.light));
            }
        }
        mean.light()
    }
}

/// What each of these counts where a straight outline runs along, by rows or by columns: those beside the middle one on it,
/// whatever their things are, show two things as that does, one as much more of the one as the other less.
fn along(near: &[[&Seen; 3]; 3], doublings: usize) -> Option<[[u32; 3]; 3]> {
    let share = *ALONG.get(doublings.checked_sub(1)?)?;
    let own = near[1][1];
    let other = near.map(|row| row.map(|seen| (seen.of ^ own.of) >> 16 != 0));
    let part = |one: [bool; 3], across: [bool; 3]| {
        let [one, across] = [one, across].map(|side| side.iter().filter(|is_other| **is_other).count());
        one.abs_diff(across) == 3
    };
    let [left, right] = [0, 2].map(|x| other.map(|row| row[x]));
    let middle = 256 - 2 * share;
    if part(other[0], other[2]) {
        Some([[0; 3], [share, middle, share], [0; 3]])
    } else if part(left, right) {
        Some([[0, share, 0], [0, middle, 0], [0, share, 0]])
    } else {
        None
    }
}

/// What each of 3 × 3 counts by [`SHARES`].
fn everywhere(doublings: usize) -> Option<[[u32; 3]; 3]> {
    let [side, corner] = *SHARES.get(doublings)?;
    let own = 256 - 4 * (side + corner);
    Some([[corner, side, corner], [side, own, side], [corner, side, corner]])
}

/// The middle one of these mixed with the others by [`MIDDLES`]: shares that were found for what is shown have no need of a
/// [`tone`].
fn of_middles(near: &[[&Seen; 3]; 3]) -> Rgb9e5 {
    let [[a, b, c], [d, own, e], [f, g, h]] = *near;
    let mut mean = Mean::new();
    near.as_flattened().iter().for_each(|seen| mean.see(seen.light));
    // Sides that are others', twice, and corners; how many there are of those and of these.
    let mut others = [0; 3];
    let mut counts = [0; 2];
    for (seen, is_side) in [(b, 1), (d, 1), (e, 1), (g, 1), (a, 0), (c, 0), (f, 0), (h, 0)] {
        if (seen.of ^ own.of) >> 16 != 0 {
            let parts = mean.parts(seen.light);
            others = [0, 1, 2].map(|i| others[i] + (parts[i] << is_side));
            counts[1 - is_side] += 1;
        }
    }
    let [sides, corners] = counts;
    let unit = unit(&MIDDLES, sides, corners);
    if unit == 0 {
        return own.light;
    }
    mean.add(own.light, 256 - unit * (2 * sides + corners));
    mean.add_parts(others, unit);
    mean.light_of_256()
}

/// What a corner counts where so many sides and corners are another thing's.
fn unit(units: &[[u8; 5]; 5], sides: u32, corners: u32) -> u32 {
    let row = units.get(sides as usize);
    row.and_then(|row| row.get(corners as usize))
        .copied()
        .map_or(0, u32::from)
}

/// What each of these counts where each is of one sample, by [`UNITS`]. Others of the middle one's thing count for nothing.
fn counted(near: &[[&Seen; 3]; 3]) -> [[u32; 3]; 3] {
    let own = near[1][1];
    let mut shares = near.map(|row| row.map(|seen| u32::from((seen.of ^ own.of) >> 16 != 0)));
    let [[a, b, c], [d, _, e], [f, g, h]] = shares;
    let (sides, corners) = (b + d + e + g, a + c + f + h);
    let unit = unit(&UNITS, sides, corners);
    for (share, tap) in shares.iter_mut().flatten().zip([1, 2, 1, 2, 1, 2, 1, 2, 1]) {
        *share *= unit * tap;
    }
    shares[1][1] = 256 - unit * (2 * sides + corners);
    shares
}

/// Goes down a picture of this size: each of `rows`, and one more above and below, is asked of `make` once, and those
/// of `rows` are given to `show`, from the top. `ring` is as long as three rows.
pub(super) fn go_down(
    rows: Range<u16>,
    Size { width, height }: Size,
    ring: &mut [Seen],
    mut make: impl FnMut(u16, &mut [Seen]),
    mut show: impl FnMut(u16, Row),
) {
    let rows = rows.start..rows.end.min(height);
    if rows.is_empty() {
        return;
    }
    let width = (ring.len() / 3).min(width.into());
    let (mut above, rest) = ring.split_at_mut(width);
    let (mut own, rest) = rest.split_at_mut(width);
    let mut below = &mut rest[..width];
    make(rows.start, own);
    match rows.start.checked_sub(1) {
        Some(y) => make(y, above),
        None => above.copy_from_slice(own),
    }
    for y in rows {
        if y + 1 < height {
            make(y + 1, below);
        } else {
            below.copy_from_slice(own);
        }
        show(
            y,
            Row {
                rows: [above, own, below],
            },
        );
        (above, own, below) = (own, below, above);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// Of the square about the origin, beyond a line so far away, whose normal is (a, b).
    fn share_beyond(distance: f64, a: f64, b: f64) -> f64 {
        let (a, b) = (a.abs().max(1e-6), b.abs().max(1e-6));
        let corner = |side: f64| (distance + side / 2.0).max(0.0).powi(2) / 2.0;
        let nearer = corner(a + b) - corner(a - b) - corner(b - a) + corner(-a - b);
        (1.0 - nearer / (a * b)).clamp(0.0, 1.0)
    }

    /// (1 − 2w) own + w (both) is off by the least where w is the noise that it takes away over the square of what it adds, in the
    /// mean of outlines that numbers, each of one sample, show to run along.
    #[test]
    fn along_an_outline_neighbours_count_what_leaves_the_least_error() {
        for (doublings, share) in (1..).zip(ALONG) {
            let (mut gain, mut cost) = (0.0, 0.0);
            for angle in 0..200 {
                let (b, a) = (f64::from(angle) * core::f64::consts::TAU / 200.0 + 0.003).sin_cos();
                for step in 0..220 {
                    let distance = (f64::from(step) + 0.5) / 50.0 - 2.2;
                    let at = |along: i32, across: i32| {
                        share_beyond(distance - a * f64::from(along) - b * f64::from(across), a, b)
                    };
                    let side = |across: i32| [-1, 0, 1].map(|along| at(along, across));
                    let all = |side: [f64; 3]| side.iter().product::<f64>();
                    let (one, across) = (side(-1), side(1));
                    let none = |side: [f64; 3]| all(side.map(|p| 1.0 - p));
                    let chance = none(one) * all(across) + all(one) * none(across);
                    let (own, beside) = (at(0, 0), [at(-1, 0), at(1, 0)]);
                    let noise = |p: f64| p * (1.0 - p) / f64::from(1 << doublings);
                    gain += chance * 2.0 * noise(own);
                    let bend = beside[0] + beside[1] - 2.0 * own;
                    cost += chance * (bend * bend + noise(beside[0]) + noise(beside[1]) + 4.0 * noise(own));
                }
            }
            let best = 256.0 * gain / cost;
            assert!((best - f64::from(share)).abs() < 1.0, "{doublings}: {best}");
        }
    }

    #[test]
    fn outlines_run_along_where_both_sides_are_of_one_thing() {
        let shares = |ids: [[u32; 3]; 3], samples: u32| {
            let seen = ids.map(|row| {
                row.map(|id| Seen {
                    light: Rgb9e5::BLACK,
                    of: id << 16 | samples,
                })
            });
            let near = seen.each_ref().map(|row| row.each_ref());
            along(&near, 31 - leading_zeros(samples) as usize)
        };
        let across = [[0; 3], [66, 124, 66], [0; 3]];
        let down = [[0, 66, 0], [0, 124, 0], [0, 66, 0]];
        assert_eq!(shares([[2, 3, 2], [1, 1, 1], [1, 1, 1]], 8), Some(across));
        assert_eq!(shares([[1, 1, 1], [2, 1, 3], [2, 2, 2]], 9), Some(across));
        assert_eq!(shares([[2, 2, 1], [3, 1, 1], [2, 1, 1]], 15), Some(down));
        assert_eq!(shares([[1, 1, 4], [1, 1, 4], [1, 1, 4]], 8), Some(down));
        // A corner, a line, what is not all of the pixel's own, one thing; of one sample, of as many as can be.
        assert_eq!(shares([[2, 2, 2], [2, 1, 1], [2, 1, 1]], 8), None);
        assert_eq!(shares([[2, 2, 2], [1, 1, 1], [2, 2, 2]], 8), None);
        assert_eq!(shares([[2, 2, 2], [1, 1, 1], [1, 1, 2]], 8), None);
        assert_eq!(shares([[1; 3]; 3], 8), None);
        assert_eq!(shares([[2; 3], [1; 3], [1; 3]], 1), None);
        assert_eq!(shares([[2; 3], [1; 3], [1; 3]], 128), None);
    }

    /// Whatever shines beside it: of lights in 32 bits, a lamp leaves what is 2^18 times darker none.
    #[test]
    fn an_outline_is_mixed_of_what_lies_on_it_alone() {
        let mixed = |beside: i32| {
            let seen = [3, 4, 6].map(|light| {
                let at = |id: u32, exponent| Seen {
                    light: Rgb9e5::from_bits([light, 2 * light, light], exponent),
                    of: id << 16 | 8,
                };
                [at(2, beside), at(1, -12), at(1, -12)]
            });
            let rows = seen.each_ref().map(|row| &row[..]);
            Row { rows }.mixed(1)
        };
        let dark = mixed(-12);
        assert!(dark.to_parts().0.iter().all(|part| *part > 0), "{dark:?}");
        assert_eq!(mixed(4), dark);
        assert_eq!(mixed(12), dark);
    }

    #[test]
    fn middles_are_mixed_by_what_straight_outlines_leave() {
        // Shares beyond each of the lines that leave so many sides and corners beyond.
        let mut shares: [[Vec<f64>; 5]; 5] = Default::default();
        for angle in 0..400 {
            let (b, a) = (f64::from(angle) * core::f64::consts::TAU / 400.0 + 0.003).sin_cos();
            for step in 0..150 {
                let distance = (f64::from(step) + 0.5) / 100.0;
                let is_beyond = |(x, y): &(f64, f64)| a * x + b * y > distance;
                let sides = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];
                let corners = [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)];
                let [sides, corners] =
                    [sides, corners].map(|all| all.iter().filter(|it| is_beyond(it)).count());
                shares[sides][corners].push(share_beyond(distance, a, b));
            }
        }
        let mut seen = 0;
        for (sides, corners) in (0..25).map(|i| (i / 5, i % 5)) {
            let shares = &shares[sides][corners];
            if shares.len() < 60 {
                continue;
            }
            seen += 1;
            let off = |unit: u8| -> f64 {
                let other = f64::from(unit) * (2 * sides + corners) as f64 / 256.0;
                let each = shares.iter().map(|share| {
                    let off = |a: f64, b: f64| (a.sqrt() - b.sqrt()).powi(2);
                    off(other, *share) + off(1.0 - other, 1.0 - share)
                });
                each.sum()
            };
            let best = (0..=21).min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap();
            assert_eq!(MIDDLES[sides][corners], best, "{sides} sides, {corners} corners");
        }
        assert_eq!(seen, 6);
    }
}
