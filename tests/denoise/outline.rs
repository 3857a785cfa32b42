//! Outlines without steps, and nothing else mixed.

use crate::{Random, value};
use microlux::color::{Radiance, Rgb9e5};
use microlux::film::Feature;
use microlux::film::denoise::{Clean, Row, Seen, Size};
use microlux::geom::{Dir, Octahedral};

const SIZE: Size = Size {
    width: 32,
    height: 24,
};

/// Dark enough that lights count by little else than their shares.
const LIGHT: f64 = 1.0 / 256.0;

fn light(level: f64) -> Rgb9e5 {
    Rgb9e5::encode(Radiance::from_bits([(level * 65536.0) as u32; 3], -16))
}

fn pixel(id: u16, share: f64) -> Feature {
    Feature {
        irradiance: light(LIGHT),
        albedo: [(255.0 * share.sqrt()).round() as u8; 3],
        depth: 90,
        normal: Octahedral::encode(Dir::Z),
        id,
    }
}

/// Everything to be seen of a frame, `frames` frames being remembered as a whole.
fn shown(frame: &[Feature], spp: u32, frames: u8) -> Vec<f64> {
    let lights: Vec<Rgb9e5> = frame.iter().map(|pixel| pixel.irradiance).collect();
    let lengths = vec![8; frame.len()];
    let clean = Clean {
        size: SIZE,
        frame,
        light: &lights,
        lengths: &lengths,
        spp,
        whole: frames,
    };
    let mut ring = [Seen::default(); 3 * SIZE.width as usize];
    let mut out = Vec::new();
    clean.rows(0..SIZE.height, &mut ring, |_, row| {
        out.extend(row.lights().map(|light| value(light)[0]));
    });
    out
}

/// Half a plane: what lies on its side is white, the other black.
struct Half {
    normal: [f64; 2],
    offset: f64,
}

impl Half {
    fn any(random: &mut Random) -> Half {
        let unit = |random: &mut Random| f64::from(random.bits()) / 2f64.powi(32);
        let (sin, cos) = (unit(random) * std::f64::consts::TAU).sin_cos();
        let middle = [SIZE.width, SIZE.height].map(|side| f64::from(side) / 2.0 + unit(random));
        Half {
            normal: [cos, sin],
            offset: cos * middle[0] + sin * middle[1],
        }
    }

    fn has(&self, place: [f64; 2]) -> bool {
        place[0] * self.normal[0] + place[1] * self.normal[1] > self.offset
    }

    /// Of a pixel.
    fn share(&self, x: usize, y: usize) -> f64 {
        let parts = (0..256).filter(|i| {
            let part = [i % 16, i / 16].map(|c| (f64::from(c) + 0.5) / 16.0);
            self.has([x as f64 + part[0], y as f64 + part[1]])
        });
        parts.count() as f64 / 256.0
    }
}

fn places() -> impl Iterator<Item = (usize, usize)> {
    let [width, height] = [SIZE.width, SIZE.height].map(usize::from);
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

/// Squared error about outlines, mixed and as it was, of the step's square: for `samples` of each pixel by chance.
fn errors(samples: u32, random: &mut Random, shown: impl Fn(&[Feature]) -> Vec<f64>) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for _ in 0..200 {
        let half = Half::any(random);
        let sampled = |(x, y): (usize, usize)| {
            let mut anywhere = || f64::from(random.bits()) / 2f64.powi(32);
            let met = (0..samples).filter(|_| half.has([x as f64 + anywhere(), y as f64 + anywhere()]));
            let count = met.count() as u32;
            pixel(
                u16::from(2 * count > samples),
                f64::from(count) / f64::from(samples),
            )
        };
        let frame: Vec<Feature> = places().map(sampled).collect();
        let mixed = shown(&frame);
        for (((x, y), pixel), mixed) in places().zip(&frame).zip(mixed) {
            // Where a pixel has all of its neighbours.
            let [last, lowest] = [SIZE.width, SIZE.height].map(|side| usize::from(side) - 1);
            if x % last == 0 || y % lowest == 0 {
                continue;
            }
            let truth = half.share(x, y);
            let own = value(pixel.radiance())[0];
            for (sum, seen) in sums.iter_mut().zip([mixed, own]) {
                *sum += (seen / LIGHT - truth).powi(2);
            }
        }
    }
    sums
}

#[test]
fn outlines_are_off_by_as_little_as_the_formula_says() {
    let mut random = Random(1);
    for (samples, meant) in [(1, 0.25), (2, 0.49), (4, 0.53), (8, 0.57), (16, 0.65)] {
        let [mixed, own] = errors(samples, &mut random, |frame| shown(frame, 1, samples as u8));
        let quotient = mixed / own;
        assert!((quotient / meant - 1.0).abs() < 0.06, "{samples}: {quotient}");
    }
}

/// Everything to be seen at twice the size, of light that is the same everywhere.
fn shown_2x(guide: impl Fn(u16, u16) -> Feature) -> Vec<f64> {
    let frame = vec![pixel(0, 1.0); SIZE.pixels()];
    let lights = vec![light(LIGHT); frame.len()];
    let clean = Clean {
        size: SIZE,
        frame: &frame,
        light: &lights,
        lengths: &vec![1; frame.len()],
        spp: 4,
        whole: 1,
    };
    let mut ring = [Seen::default(); 6 * SIZE.width as usize];
    let mut out = Vec::new();
    clean.rows_2x(0..2 * SIZE.height, &mut ring, guide, |_, row| {
        out.extend(row.lights().map(|light| value(light)[0]));
    });
    out
}

#[test]
fn outlines_of_middles_are_off_by_as_little_as_the_formula_says() {
    let mut random = Random(5);
    let mut sums = [0.0; 4];
    for _ in 0..60 {
        let half = Half::any(&mut random);
        let is_white = |x: u16, y: u16| half.has([f64::from(x) + 0.5, f64::from(y) + 0.5]);
        let seen = shown_2x(|x, y| pixel(is_white(x, y).into(), f64::from(u8::from(is_white(x, y)))));
        for (i, seen) in seen.iter().enumerate() {
            let (x, y) = (i % 64, i / 64);
            let truth = half.share(x, y);
            let own = f64::from(u8::from(is_white(x as u16, y as u16)));
            for (sums, seen) in sums.chunks_mut(2).zip([seen / LIGHT, own]) {
                sums[0] += (seen - truth).powi(2);
                sums[1] += (seen.sqrt() - truth.sqrt()).powi(2);
            }
        }
    }
    let quotients = [sums[0] / sums[2], sums[1] / sums[3]];
    for (quotient, meant) in quotients.iter().zip([0.28, 0.20]) {
        assert!((quotient / meant - 1.0).abs() < 0.1, "{quotients:?}");
    }
}

#[test]
fn what_is_known_well_is_left_alone() {
    // What a straight outline's neighbours blur are its ends: one that is steep has some.
    let half = Half {
        normal: [0.8, 0.6],
        offset: 20.0,
    };
    let frame: Vec<Feature> = places()
        .map(|(x, y)| {
            let share = half.share(x, y);
            pixel(u16::from(share > 0.5), share)
        })
        .collect();
    let own: Vec<f64> = frame.iter().map(|pixel| value(pixel.radiance())[0]).collect();
    let step = |spp, frames| {
        let seen = shown(&frame, spp, frames);
        let steps = seen.iter().zip(&own).map(|(seen, own)| (seen - own).abs());
        steps.fold(0.0, f64::max) / LIGHT
    };
    let steps = [(1, 2), (1, 4), (1, 8), (4, 8), (16, 2)].map(|(spp, frames)| step(spp, frames));
    assert!(steps.is_sorted_by(|a, b| a >= b), "{steps:?}");
    assert!(steps[0] > 0.1 && steps[2] > 0.01, "{steps:?}");
    // Sixteen samples of two frames, worth 128, know enough. Nine bits are what light is kept in.
    assert!(steps[3] > 0.01 && steps[4] < 0.002, "{steps:?}");
}

#[test]
fn within_one_thing_nothing_is_mixed() {
    let mut random = Random(3);
    let mut frame: Vec<Feature> = places()
        .map(|_| Feature {
            irradiance: light(f64::from(random.below(1000)) / 100.0),
            albedo: [0; 3].map(|_| random.bits() as u8),
            // Steps of the distance that are one surface's.
            depth: 90 + random.below(3) as u8,
            ..pixel(7, 1.0)
        })
        .collect();
    let own = |frame: &[Feature]| -> Vec<f64> {
        let kept = |pixel: &Feature| value(Rgb9e5::encode(pixel.radiance()).decode())[0];
        frame.iter().map(kept).collect()
    };
    assert_eq!(shown(&frame, 1, 1), own(&frame));
    // A pixel of another number, and one that is farther away: nine about each are mixed.
    let at = |x: usize, y: usize| y * usize::from(SIZE.width) + x;
    frame[at(5, 5)].id = 8;
    frame[at(20, 0)].depth = 120;
    let mixed = |frames| -> Vec<usize> {
        let pairs = shown(&frame, 1, frames).into_iter().zip(own(&frame));
        let mixed = pairs.enumerate().filter(|(_, (seen, own))| seen != own);
        mixed.map(|(i, _)| i).collect()
    };
    let about = |x: usize, y: usize| {
        let rows = y.saturating_sub(1)..=y + 1;
        rows.flat_map(move |y| (x - 1..=x + 1).map(move |x| at(x, y)))
    };
    assert_eq!(mixed(2), about(20, 0).chain(about(5, 5)).collect::<Vec<_>>());
    // Of one sample: what has one neighbour of another number is no outline's, that one by itself is.
    assert_eq!(mixed(1), about(20, 0).chain([at(5, 5)]).collect::<Vec<_>>());
}

#[test]
fn rows_of_one_thing_are_its_pixels() {
    let mut random = Random(6);
    let frame = vec![pixel(7, 0.5); SIZE.pixels()];
    let lights: Vec<Rgb9e5> = places()
        .map(|_| light(f64::from(1 + random.below(1000)) / 100.0))
        .collect();
    let clean = Clean {
        size: SIZE,
        frame: &frame,
        light: &lights,
        lengths: &vec![1; frame.len()],
        spp: 1,
        whole: 1,
    };
    let mut ring = vec![Seen::default(); 9 * usize::from(SIZE.width)];
    for scale in [2, 3] {
        let rows = 0..scale * SIZE.height;
        let guide = |_, _| frame[0];
        let show = |y: u16, row: Row| {
            assert_eq!(row.lights().count(), usize::from(scale * SIZE.width));
            for (x, seen) in (0..).zip(row.lights()) {
                let fine = match scale {
                    2 => clean.pixel_2x(x, y, &frame[0]),
                    _ => clean.pixel_3x(x, y, &frame[0]),
                };
                let [seen, fine] = [seen, fine].map(|light| value(light)[0]);
                // Nine bits, rounded once and twice.
                assert!((seen / fine - 1.0).abs() < 0.003, "{x} {y}: {seen}, not {fine}");
            }
        };
        match scale {
            2 => clean.rows_2x(rows, &mut ring[..6 * usize::from(SIZE.width)], guide, show),
            _ => clean.rows_3x(rows, &mut ring, guide, show),
        }
    }
}

#[test]
fn a_lamp_does_not_shine_through_its_outline() {
    let half = |(x, _): (usize, usize)| {
        let is_lamp = x >= 16;
        Feature {
            irradiance: light(if is_lamp { 16.0 } else { 0.25 }),
            ..pixel(u16::from(is_lamp), 1.0)
        }
    };
    let frame: Vec<Feature> = places().map(half).collect();
    let seen = shown(&frame, 1, 1);
    // 0.17 of 16 would be 2.7.
    let beside = seen[usize::from(SIZE.width) * 5 + 15];
    assert!((0.25..0.6).contains(&beside), "{beside}");
    let lamp = seen[usize::from(SIZE.width) * 5 + 16];
    assert!((1.0..16.0).contains(&lamp), "{lamp}");
}

#[test]
fn bands_of_rows_are_the_picture() {
    let mut random = Random(4);
    let frame: Vec<Feature> = places()
        .map(|_| Feature {
            irradiance: light(f64::from(random.below(100)) / 100.0),
            ..pixel(random.below(2) as u16, 0.5)
        })
        .collect();
    let lights: Vec<Rgb9e5> = frame.iter().map(|pixel| pixel.irradiance).collect();
    let lengths = vec![1; frame.len()];
    let clean = Clean {
        size: SIZE,
        frame: &frame,
        light: &lights,
        lengths: &lengths,
        spp: 1,
        whole: 1,
    };
    let by = |band: u16, scale: u16| {
        // Longer than it has to be for some.
        let mut ring = vec![Seen::default(); 3 * usize::from(scale * SIZE.width + band % 7)];
        let mut out = Vec::new();
        let mut next = 0;
        let mut show = |y: u16, row: Row| {
            assert_eq!(y, next);
            next += 1;
            out.extend(row.lights());
        };
        let guide =
            |x: u16, y: u16| frame[usize::from(y / scale) * usize::from(SIZE.width) + usize::from(x / scale)];
        for first in (0..scale * SIZE.height).step_by(band.into()) {
            let rows = first..first + band;
            match scale {
                1 => clean.rows(rows, &mut ring, &mut show),
                2 => clean.rows_2x(rows, &mut ring, guide, &mut show),
                _ => clean.rows_3x(rows, &mut ring, guide, &mut show),
            }
        }
        out
    };
    for scale in [1, 2, 3] {
        let whole = by(98, scale);
        assert_eq!(whole.len(), usize::from(scale * scale) * frame.len());
        for band in [1, 2, 7] {
            assert!(by(band, scale) == whole, "{scale}: {band}");
        }
    }
}
