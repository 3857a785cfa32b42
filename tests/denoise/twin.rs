//! The same filters in f64, written from what they shall do, not from how the core does it.

use crate::{Random, Shift, value, with_denoiser};
use microlux::color::{Radiance, Rgb9e5};
use microlux::film::Feature;
use microlux::film::denoise::{Atrous, Size, upsample, upsample_3x};
use microlux::geom::Octahedral;

const SIZE: Size = Size {
    width: 40,
    height: 30,
};

/// A pixel in real numbers.
#[derive(Clone, Copy)]
struct Real {
    light: [f64; 3],
    normal: [f64; 3],
    depth: f64,
    albedo: [u8; 3],
    id: u16,
    length: f64,
}

impl Real {
    fn of(pixel: &Feature) -> Real {
        let [u, v] = pixel.normal.0.map(|c| f64::from(c) / 127.0);
        let z = 1.0 - u.abs() - v.abs();
        let [x, y] = if z < 0.0 {
            [(1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v)]
        } else {
            [u, v]
        };
        let length = (x * x + y * y + z * z).sqrt();
        Real {
            light: value(pixel.irradiance.decode()),
            normal: [x / length, y / length, z / length],
            depth: f64::from(pixel.depth),
            albedo: pixel.albedo,
            id: pixel.id,
            length: 1.0,
        }
    }

    fn luma(&self) -> f64 {
        let [r, g, b] = self.light;
        (54.0 * r + 183.0 * g + 19.0 * b) / 256.0
    }

    /// One less the cosine, in 127ths.
    fn turn(&self, other: &Real) -> f64 {
        let cosine: f64 = (0..3).map(|i| self.normal[i] * other.normal[i]).sum();
        127.0 * (1.0 - cosine.max(0.0))
    }
}

type Frame = Vec<Real>;

fn at(frame: &Frame, x: i64, y: i64) -> Option<&Real> {
    let (width, height) = (i64::from(SIZE.width), i64::from(SIZE.height));
    ((0..width).contains(&x) && (0..height).contains(&y)).then(|| &frame[(y * width + x) as usize])
}

fn each(mut make: impl FnMut(i64, i64) -> Real) -> Frame {
    let (width, height) = (i64::from(SIZE.width), i64::from(SIZE.height));
    (0..width * height).map(|i| make(i % width, i / width)).collect()
}

fn around(x: i64, y: i64) -> impl Iterator<Item = (i64, i64)> {
    (0..9).map(move |i| (x + i % 3 - 1, y + i / 3 - 1))
}

/// Down by whole octaves to four times the second brightest.
fn without_fireflies(frame: &Frame) -> Frame {
    each(|x, y| {
        let mut lumas: Vec<_> = around(x, y)
            .filter_map(|(x, y)| at(frame, x, y))
            .map(Real::luma)
            .collect();
        lumas.sort_by(f64::total_cmp);
        let limit = 4.0 * lumas[lumas.len() - 2];
        let mut pixel = *at(frame, x, y).unwrap();
        while pixel.luma() > limit {
            pixel.light = pixel.light.map(|c| c / 2.0);
        }
        pixel
    })
}

/// `moved` is how far to the right everything was, pixels.
fn accumulated(now: &Frame, past: &Frame, moved: [f64; 2]) -> Frame {
    let tame = without_fireflies(now);
    each(|x, y| {
        let mut pixel = *at(&tame, x, y).unwrap();
        let (px, py) = (x as f64 + moved[0], y as f64 + moved[1]);
        let (mut weight, mut light, mut length) = (0.0, [0.0; 3], 0.0);
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let (tx, ty) = (px.floor() + dx, py.floor() + dy);
            let share = (1.0 - (px - tx).abs()).max(0.0) * (1.0 - (py - ty).abs()).max(0.0);
            let Some(was) = at(past, tx as i64, ty as i64) else {
                continue;
            };
            if was.id == pixel.id && (was.depth - pixel.depth).abs() <= 3.0 && was.turn(&pixel) < 16.5 {
                weight += share;
                light = [0, 1, 2].map(|i| light[i] + share * was.light[i]);
                length += share * was.length;
            }
        }
        if weight < 0.125 {
            return pixel;
        }
        let mut then = light.map(|c| c / weight);
        if moved != [0.0; 2] {
            let near = around(x, y).filter_map(|(x, y)| at(now, x, y)).map(|p| p.light);
            let most = near.fold([0.0f64; 3], |m, l| [0, 1, 2].map(|i| m[i].max(l[i])));
            then = [0, 1, 2].map(|i| then[i].min(2.0 * most[i]));
        }
        pixel.length = ((length / weight + 1e-9).floor() + 1.0).min(8.0);
        pixel.light = [0, 1, 2].map(|i| then[i] + (pixel.light[i] - then[i]) / pixel.length);
        pixel
    })
}

fn step(frame: &Frame, step: usize, filter: &Atrous) -> Frame {
    let tent = [0.25, 0.5, 0.25];
    let spacing = 1 << step;
    each(|x, y| {
        let mut pixel = *at(frame, x, y).unwrap();
        let own = pixel;
        let (mut sum, mut weight) = ([0.0; 3], 0.0);
        for i in 0..9 {
            let (dx, dy) = (i % 3, i / 3);
            let Some(tap) = at(
                frame,
                x + (dx as i64 - 1) * spacing,
                y + (dy as i64 - 1) * spacing,
            ) else {
                continue;
            };
            let octaves = if own.luma() == tap.luma() {
                0.0
            } else {
                (own.luma() / tap.luma()).log2().abs().min(8.0)
            };
            let luma = octaves * 8.0 * f64::from(filter.luma[step]) / 16.0 * own.length.sqrt();
            let turned = own.turn(tap) * f64::from(filter.normal) / 16.0;
            let far = (own.depth - tap.depth).abs() * f64::from(filter.depth) / 16.0 / spacing as f64;
            let other = if tap.id == own.id {
                0.0
            } else {
                f64::from(filter.id)
            };
            let share = tent[dx] * tent[dy] * 2f64.powf(-(luma + turned + far + other) / 8.0);
            sum = [0, 1, 2].map(|i| sum[i] + share * tap.light[i]);
            weight += share;
        }
        pixel.light = sum.map(|c| c / weight);
        pixel
    })
}

/// A floor that runs away, a ball and a wall; light with a gradient and noise of a half about it.
fn scene(random: &mut Random) -> Vec<Feature> {
    let pixel = |i: usize| {
        let (x, y) = (i % usize::from(SIZE.width), i / usize::from(SIZE.width));
        let (dx, dy) = (x as i32 - 24, y as i32 - 14);
        let ball = dx * dx + dy * dy < 64;
        let noise = |random: &mut Random| 3000 + random.below(6000);
        let bits = [0; 3].map(|_| noise(random) * (x as u32 + 5));
        let (normal, depth, id) = if ball {
            (Octahedral([(12 * dx) as i8, (12 * -dy) as i8]), 100, 2)
        } else if y > 18 {
            (Octahedral([0, 127]), 160 - 4 * y as u8, 1)
        } else {
            (Octahedral([0, 0]), 110, 0)
        };
        Feature {
            irradiance: Rgb9e5::from_bits(bits, -17),
            albedo: [255; 3],
            depth,
            normal,
            id,
        }
    };
    (0..SIZE.pixels()).map(pixel).collect()
}

/// RMS and largest difference, as shares of the luminance that should be; of all but one in `leave`, the worst.
fn off(found: &[Rgb9e5], exact: &Frame, leave: usize) -> (f64, f64) {
    let off = |(found, exact): (&Rgb9e5, &Real)| {
        let found = value(found.decode());
        (0..3)
            .map(|i| (found[i] - exact.light[i]).abs() / exact.luma())
            .fold(0.0, f64::max)
    };
    let mut all: Vec<_> = found.iter().zip(exact).map(off).collect();
    all.sort_by(f64::total_cmp);
    all.truncate(all.len() - all.len().checked_div(leave).unwrap_or(0));
    let square = all.iter().map(|x| x * x).sum::<f64>() / all.len() as f64;
    (square.sqrt(), all.last().copied().unwrap_or(0.0))
}

#[test]
fn accumulation_is_its_twins() {
    let mut random = Random(11);
    for shift in [[0, 0], [16, 0], [5, -9], [-40, 24]] {
        let mut past: Option<Frame> = None;
        with_denoiser(SIZE, 1, |denoiser| {
            for _ in 0..10 {
                let pixels = scene(&mut random);
                let now: Frame = pixels.iter().map(Real::of).collect();
                let exact = match &past {
                    None => without_fireflies(&now),
                    Some(past) => accumulated(&now, past, shift.map(|c| f64::from(c) / 16.0)),
                };
                denoiser.frame().copy_from_slice(&pixels);
                let clean = denoiser.denoise(Some(&Shift(shift)), &mut microlux::film::denoise::Off);
                // One in 16 turns by a hair more than it may, or less: on the ball, where it moves by more than a pixel.
                let (rms, worst) = off(clean.light, &exact, if shift[0] == -40 { 16 } else { 0 });
                // Rounding to nine bits by chance, of each frame's light.
                assert!(rms < 0.004 && worst < 0.03, "{shift:?}: {rms} {worst}");
                past = Some(exact);
            }
        });
    }
}

#[test]
fn a_trous_is_its_twins() {
    let mut random = Random(12);
    for spp in [1, 4] {
        let filter = Atrous::for_spp(spp);
        let pixels = scene(&mut random);
        let mut exact = without_fireflies(&pixels.iter().map(Real::of).collect());
        let mut plain = exact.clone();
        for i in 0..usize::from(filter.steps) {
            exact = step(&exact, i, &filter);
            let blind = Atrous {
                luma: [0; 5],
                ..filter
            };
            plain = step(&plain, i, &blind);
        }
        with_denoiser(SIZE, 1, |denoiser| {
            denoiser.frame().copy_from_slice(&pixels);
            let clean = denoiser.denoise(None::<&Shift>, &mut filter.clone());
            let (rms, worst) = off(clean.light, &exact, 0);
            // Luminance is compared by eighths of an octave, weights have six bits.
            assert!(rms < 0.025 && worst < 0.1, "{spp}: {rms} {worst}");
            // A filter without edges is farther away than that.
            let (rms_plain, _) = off(clean.light, &plain, 0);
            assert!(rms_plain > 2.0 * rms, "{rms} {rms_plain}");
        });
    }
}

#[test]
fn upsampling_is_its_twins() {
    let mut random = Random(13);
    let mut pixels = scene(&mut random);
    for pixel in &mut pixels {
        pixel.albedo = if random.below(4) == 0 {
            [150, 90, 60]
        } else {
            [200; 3]
        };
    }
    let frame: Frame = pixels.iter().map(Real::of).collect();
    let light: Vec<_> = pixels.iter().map(|p| p.irradiance).collect();
    // Weights have six bits; where fewer pixels count, less evens out.
    for (scale, raised, most) in [(2, upsample as Upsample, 0.035), (3, upsample_3x, 0.045)] {
        let worst = upsampled(&frame, &pixels, &light, scale, raised);
        assert!(worst < most, "{scale}: {worst}");
    }
}

type Upsample = fn(Size, &[Feature], &[Rgb9e5], [u16; 2], &Feature) -> Radiance;

/// The largest difference, as a share of the brightest channel.
fn upsampled(frame: &Frame, pixels: &[Feature], light: &[Rgb9e5], scale: u16, raised: Upsample) -> f64 {
    let mut worst = 0f64;
    for y in scale..scale * (SIZE.height - 1) {
        for x in scale..scale * (SIZE.width - 1) {
            let guide = pixels[usize::from(y / scale * SIZE.width + x / scale)];
            let real = Real::of(&guide);
            let [px, py] = [x, y].map(|c| (f64::from(c) + 0.5) / f64::from(scale) - 0.5);
            let (mut sum, mut weight) = ([0.0; 3], 0.0);
            for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
                let (tx, ty) = (px.floor() + dx, py.floor() + dy);
                let tap = at(frame, tx as i64, ty as i64).unwrap();
                let mut unlike = 2.0 * real.turn(tap) + 4.0 * (real.depth - tap.depth).abs();
                if tap.id != real.id {
                    unlike += 32.0;
                }
                if tap.albedo != real.albedo {
                    unlike += 16.0;
                }
                let share = (1.0 - (px - tx).abs()) * (1.0 - (py - ty).abs());
                let share = share * 2f64.powf(-unlike.min(48.0) / 8.0);
                sum = [0, 1, 2].map(|i| sum[i] + share * tap.light[i]);
                weight += share;
            }
            let exact = sum.map(|c| c / weight);
            let found = value(raised(SIZE, pixels, light, [x, y], &guide));
            let largest = exact.iter().fold(0f64, |m, c| m.max(*c));
            for i in 0..3 {
                worst = worst.max((found[i] - exact[i]).abs() / largest);
            }
        }
    }
    worst
}
