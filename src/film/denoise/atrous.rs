use super::weight::{FALL, FAR, Mean, luma_code, shines, short_normal, turn};
use super::{Filter, Pair, Scratch, Size};
use crate::color::Rgb9e5;
use crate::film::Feature;

/// The guided à-trous filter: a 5 × 5 B3 spline again and again, its taps 1, 2, 4, ... pixels apart, each weighted by how
/// alike two pixels are.
///
/// Dammertz, Sewtz, Hanika and Lensch, "Edge-Avoiding À-Trous Wavelet Transform for fast Global Illumination Filtering",
/// High Performance Graphics 2010. Unlikeness is counted in eighths of a halving and added up: turned normals, distance,
/// another thing's number, luminance.
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
                steps: 4,
                normal: 12,
                depth: 8,
                luma: [0, 16, 48, 96, 128],
                id: 24,
            }
        } else {
            Atrous {
                steps: 5,
                normal: 12,
                depth: 8,
                luma: [4, 48, 96, 160, 200],
                id: 24,
            }
        }
    }
}

/// The B3 spline, sixteenths: an outer product of it adds up to 256.
const SPLINE: [u32; 5] = [1, 4, 6, 4, 1];

/// √1 ..= √8, quarters.
const ROOTS: [u32; 8] = [4, 6, 7, 8, 9, 10, 11, 11];

impl Filter for Atrous {
    fn filter(&mut self, pair: &impl Pair, size: Size, frame: &[Feature], lengths: &[u8], scratch: Scratch) {
        let Scratch { light, other, aside } = scratch;
        let (mut from, mut to) = (light, other);
        // Steps alternate between two planes and shall end in the first: an odd number begins in the second.
        if self.steps.min(5) % 2 == 1 {
            core::mem::swap(&mut from, &mut to);
        }
        for (place, pixel) in from.iter_mut().zip(frame) {
            *place = pixel.irradiance;
        }
        let half = size.upper().min(frame.len());
        for step in 0..self.steps.min(5) {
            let (upper, lower) = aside.split_at_mut(half);
            pair.both(
                || see(upper, frame, from),
                || see(lower, &frame[half..], &from[half..]),
            );
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

/// [`beside`] of some pixels.
fn see(aside: &mut [[u8; 4]], frame: &[Feature], light: &[Rgb9e5]) {
    for ((aside, pixel), light) in aside.iter_mut().zip(frame).zip(light) {
        *aside = beside(pixel, *light);
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

impl Atrous {
    /// One step over whole rows, from number `first` on: as many as `to` holds.
    pub fn rows(&self, step: u8, whole: Whole, first: u16, to: &mut [Rgb9e5]) {
        let width = whole.size.width.max(1) as usize;
        for (i, place) in to.iter_mut().enumerate() {
            let (x, y) = ((i % width) as i32, first as i32 + (i / width) as i32);
            *place = self.pixel(step, &whole, x, y);
        }
    }

    #[inline]
    fn pixel(&self, step: u8, whole: &Whole, x: i32, y: i32) -> Rgb9e5 {
        let Whole { size, .. } = *whole;
        let here = size.clamped(x, y);
        let (Some(pixel), Some(aside), Some(light)) = (
            whole.frame.get(here),
            whole.aside.get(here),
            whole.light.get(here),
        ) else {
            return Rgb9e5::BLACK;
        };
        let spacing = 1i32 << step.min(4);
        let (own_normal, shines_here) = (normal(*aside), shines(pixel));
        // The noise of n frames is 1/√n of one's.
        let length = whole.lengths.get(here).map_or(1, |n| *n as usize).clamp(1, 8);
        let luma_slope = self.luma.get(step as usize).map_or(0, |s| *s as u32) * ROOTS[length - 1];
        let mut taps = [(Rgb9e5::BLACK, 0u32); 25];
        let mut count = 0;
        let mut mean = Mean::new();
        for (j, down) in SPLINE.iter().enumerate() {
            let ty = y + (j as i32 - 2) * spacing;
            if ty < 0 || ty >= size.height as i32 {
                continue;
            }
            for (i, across) in SPLINE.iter().enumerate() {
                let tx = x + (i as i32 - 2) * spacing;
                if tx < 0 || tx >= size.width as i32 {
                    continue;
                }
                let there = size.clamped(tx, ty);
                let (Some(tap), Some(beside), Some(tap_light)) = (
                    whole.frame.get(there),
                    whole.aside.get(there),
                    whole.light.get(there),
                ) else {
                    continue;
                };
                // A lamp's own light is no light on what is beside it, but for what smooths its outline.
                if step > 0 && shines(tap) != shines_here {
                    continue;
                }
                let mut unlike = 0;
                if tap.id != pixel.id {
                    unlike += self.id as u32;
                }
                unlike += (turn(own_normal, normal(*beside)) * self.normal as u32) >> 4;
                unlike += (tap.depth.abs_diff(pixel.depth) as u32 * self.depth as u32) >> (4 + step.min(4));
                unlike += (aside[3].abs_diff(beside[3]).min(64) as u32 * luma_slope) >> 6;
                let weight = across * down * FALL[unlike.min(FAR) as usize] as u32;
                if weight > 0 {
                    if let Some(place) = taps.get_mut(count) {
                        *place = (*tap_light, weight);
                        count += 1;
                    }
                    mean.see(*tap_light);
                }
            }
        }
        if count == 0 {
            return *light;
        }
        for (light, weight) in taps.iter().take(count) {
            mean.add(*light, *weight);
        }
        mean.light()
    }
}
