use super::weight::{FALL, FAR, Mean, luma_code, shines, short_normal, turn};
use super::{Filter, Pair, Scratch, Size};
use crate::color::Rgb9e5;
use crate::film::Feature;
use zerocopy::{FromBytes, IntoBytes};

/// The guided à-trous filter: a 3 × 3 tent (1 : 2 : 1) again and again, its taps 1, 2, 4, ... pixels apart, each weighted by
/// how alike two pixels are.
///
/// Dammertz, Sewtz, Hanika and Lensch, "Edge-Avoiding À-Trous Wavelet Transform for fast Global Illumination Filtering",
/// High Performance Graphics 2010, whose 5 × 5 spline takes 25 taps where this takes 9. Unlikeness is counted in eighths of a
/// halving and added up: turned normals, distance, another thing's number, luminance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Atrous {
    /// Steps, 0 ..= 5.
    pub steps: u8,
    /// Eighths of a halving, in sixteenths, for a turn by a cosine of 1 − 1/127.
    pub normal: u8,
    /// The same for a distance of one code more, over the taps' spacing.
    pub depth: u8,
    /// The same for an eighth of an octave of luminance, by step, for the light of one frame; of n, √n times that.
    pub luma: [u8; 5],
    /// Eighths of a halving for another number.
    pub id: u8,
}

impl Atrous {
    /// For frames of this many samples a pixel: one is too noisy to be asked how bright it is before it was blurred once.
    ///
    /// Tuned on the built-in scenes.
    pub const fn for_spp(spp: u32) -> Atrous {
        if spp <= 2 {
            Atrous {
                steps: 3,
                normal: 8,
                depth: 8,
                luma: [0, 8, 32, 96, 128],
                id: 24,
            }
        } else {
            Atrous {
                steps: 3,
                normal: 8,
                depth: 8,
                luma: [4, 40, 120, 200, 240],
                id: 24,
            }
        }
    }
}

/// √1 ..= √8, quarters.
const ROOTS: [u32; 8] = [4, 6, 7, 8, 9, 10, 11, 11];

impl Filter for Atrous {
    fn filter(&mut self, pair: &impl Pair, size: Size, frame: &[Feature], lengths: &[u8], scratch: Scratch) {
        let Scratch { light, rest } = scratch;
        let (other, aside) = rest.split_at_mut(size_of_val(light).min(rest.len()));
        // Four bytes each, and as well aligned as light: the casts cannot fail.
        let other = <[Rgb9e5]>::mut_from_bytes(other).unwrap_or(&mut []);
        let aside = <[[u8; 4]]>::mut_from_bytes(aside).unwrap_or(&mut []);
        let (mut from, mut to) = (light, other);
        // Steps alternate between two planes and shall end in the first: an odd number begins in the second.
        if self.steps.min(5) % 2 == 1 {
            core::mem::swap(&mut from, &mut to);
        }
        for (place, pixel) in from.iter_mut().zip(frame) {
            *place = pixel.irradiance;
        }
        let half = size.upper().min(frame.len());
        let (upper, lower) = aside.split_at_mut(half);
        pair.both(|| turn_to(upper, frame), || turn_to(lower, &frame[half..]));
        for step in 0..self.steps.min(5) {
            let (upper, lower) = aside.split_at_mut(half);
            pair.both(|| look(upper, from), || look(lower, &from[half..]));
            let whole = Whole {
                size,
                frame,
                lengths,
                aside,
                light: from,
            };
            let (upper, lower) = to.split_at_mut(half);
            let this = &*self;
            pair.both(
                || this.rows(step, whole, 0, upper),
                || this.rows(step, whole, size.height.div_ceil(2), lower),
            );
            core::mem::swap(&mut from, &mut to);
        }
    }
}

/// What [`beside`] says of the normals, which stay.
fn turn_to(aside: &mut [[u8; 4]], frame: &[Feature]) {
    let mut last = Feature::default();
    let mut normal = short_normal(&last);
    for (aside, pixel) in aside.iter_mut().zip(frame) {
        // Neighbours often look the same way.
        if pixel.normal != last.normal {
            (last, normal) = (*pixel, short_normal(pixel));
        }
        let [x, y, z] = normal.map(|c| c as u8);
        *aside = [x, y, z, 0];
    }
}

/// What [`beside`] says of the light.
fn look(aside: &mut [[u8; 4]], light: &[Rgb9e5]) {
    for (aside, light) in aside.iter_mut().zip(light) {
        aside[3] = luma_code(*light);
    }
}

/// A step's input: all of the picture.
#[derive(Clone, Copy, Debug)]
pub struct Whole<'a> {
    pub size: Size,
    pub frame: &'a [Feature],
    pub lengths: &'a [u8],
    /// [`beside`] of each pixel.
    pub aside: &'a [[u8; 4]],
    pub light: &'a [Rgb9e5],
}

/// What a step wants to know of a pixel, so that it is found out once: the normal, 127ths, and luminance.
#[inline]
pub fn beside(pixel: &Feature, light: Rgb9e5) -> [u8; 4] {
    let [x, y, z] = short_normal(pixel).map(|c| c as u8);
    [x, y, z, luma_code(light)]
}

#[inline]
fn normal([x, y, z, _]: [u8; 4]) -> [i8; 3] {
    [x as i8, y as i8, z as i8]
}

/// A row of a step's input; all of one length.
#[derive(Clone, Copy)]
struct Row<'a> {
    /// [`Feature`]s, word by word, little end first.
    frame: &'a [[u32; 3]],
    aside: &'a [[u8; 4]],
    light: &'a [Rgb9e5],
}

impl<'a> Row<'a> {
    const EMPTY: Row<'static> = Row {
        frame: &[],
        aside: &[],
        light: &[],
    };

    /// Row y; an empty one beside the picture.
    fn of(whole: &Whole<'a>, y: i32) -> Row<'a> {
        if y < 0 || y >= whole.size.height as i32 {
            return Row::EMPTY;
        }
        let width = whole.size.width as usize;
        let range = y as usize * width..(y as usize + 1) * width;
        match (
            whole.frame.get(range.clone()),
            whole.aside.get(range.clone()),
            whole.light.get(range),
        ) {
            (Some(frame), Some(aside), Some(light)) => Row {
                // As long and as well aligned: the cast cannot fail.
                frame: <[[u32; 3]]>::ref_from_bytes(frame.as_bytes()).unwrap_or(&[]),
                aside,
                light,
            },
            _ => Row::EMPTY,
        }
    }
}

impl Atrous {
    /// One step over whole rows, from number `first` on: as many as `to` holds.
    pub fn rows(&self, step: u8, whole: Whole, first: u16, to: &mut [Rgb9e5]) {
        let width = whole.size.width.max(1) as usize;
        let spacing = 1i32 << step.min(4);
        for (y, to) in (first as i32..).zip(to.chunks_mut(width)) {
            let rows = [-spacing, 0, spacing].map(|down| Row::of(&whole, y + down));
            let lengths = whole.lengths.get(y as usize * width..).unwrap_or(&[]);
            for (x, place) in to.iter_mut().enumerate() {
                let length = lengths.get(x).map_or(1, |n| *n as usize);
                *place = self.pixel(step, &rows, length, x);
            }
        }
    }

    /// Pixel x of the middle one of three rows.
    #[inline]
    fn pixel(&self, step: u8, rows: &[Row; 3], length: usize, x: usize) -> Rgb9e5 {
        let [_, row, _] = rows;
        let (Some(pixel), Some(aside), Some(light)) = (row.frame.get(x), row.aside.get(x), row.light.get(x))
        else {
            return Rgb9e5::BLACK;
        };
        let own = Own {
            looks: pixel[2],
            aside: *aside,
            shines: shines(pixel[1]),
            depth: u32::from_le(pixel[1]) >> 24,
            // The noise of n frames is 1/√n of one's.
            luma_slope: self.luma.get(step as usize).map_or(0, |s| *s as u32) * ROOTS[length.clamp(1, 8) - 1],
            depth_shift: 4 + step.min(4) as u32,
            is_first: step == 0,
        };
        let spacing = 1usize << step.min(4);
        let width = row.frame.len();
        let first = if x < spacing { x } else { x - spacing };
        let last = if x + spacing < width { x + spacing } else { x };
        let (mut lights, mut weights) = ([Rgb9e5::BLACK; 9], [0; 9]);
        let mut count = 0;
        let mut mean = Mean::new();
        for (row, down) in rows.iter().zip([0, 1, 0]) {
            // One length for all three, so that one look at it is enough.
            let (Some(aside), Some(light)) =
                (row.aside.get(..row.frame.len()), row.light.get(..row.frame.len()))
            else {
                continue;
            };
            let mut at = first;
            while at <= last && at < row.frame.len() {
                let (tap, beside, light) = (&row.frame[at], &aside[at], &light[at]);
                let weight = self.weight(&own, tap, beside) << (down + u32::from(at == x));
                if weight > 0 && count < 9 {
                    lights[count] = *light;
                    weights[count] = weight;
                    count += 1;
                    mean.see(*light);
                }
                at += spacing;
            }
        }
        if count == 0 {
            return *light;
        }
        for (light, weight) in lights.iter().zip(weights).take(count) {
            mean.add(*light, weight);
        }
        mean.light()
    }

    /// How much a tap says of a pixel, but for where it is: 64 at most.
    #[inline(always)]
    fn weight(&self, own: &Own, &[_, seen, looks]: &[u32; 3], beside: &[u8; 4]) -> u32 {
        // A lamp's own light is no light on what is beside it, but for what smooths its outline.
        if !own.is_first && shines(seen) != own.shines {
            return 0;
        }
        let mut unlike = 0;
        // Most are of the same thing and look the same way, to the last bit.
        let differs = u32::from_le(looks ^ own.looks);
        if differs != 0 {
            if differs & 0xffff != 0 {
                unlike += (turn(normal(own.aside), normal(*beside)) * self.normal as u32) >> 4;
            }
            if differs >> 16 != 0 {
                unlike += self.id as u32;
            }
        }
        let depth = u32::from_le(seen) >> 24;
        unlike += (depth.abs_diff(own.depth) * self.depth as u32) >> own.depth_shift;
        unlike += (own.aside[3].abs_diff(beside[3]).min(64) as u32 * own.luma_slope) >> 6;
        FALL[unlike.min(FAR) as usize] as u32
    }
}

/// What a pixel's taps are held against.
struct Own {
    /// Normal and number.
    looks: u32,
    aside: [u8; 4],
    shines: bool,
    depth: u32,
    luma_slope: u32,
    depth_shift: u32,
    is_first: bool,
}
