use crate::{Backwards, Random, Shift, Threads, value, with_denoiser};
use microlux::color::{Radiance, Rgb9e5};
use microlux::film::Feature;
use microlux::film::denoise::{
    Alone, Atrous, Band, Before, Denoiser, Filter, Memory, Off, Pair, Past, Reproject, Row, Seen, Size,
    TooShort, Whole, accumulate, beside, upsample, upsample_3x,
};
use microlux::film::feature::ID_NOTHING;
use microlux::geom::Octahedral;

const SIZE: Size = Size {
    width: 23,
    height: 17,
};

/// Nothing moves.
struct Still;

impl Reproject for Still {
    fn before(&self, x: u16, y: u16, depth: u8) -> Option<Before> {
        Some(Before {
            place: [x, y].map(|c| 16 * i32::from(c) + 8),
            depth,
        })
    }

    fn is_whole(&self) -> bool {
        true
    }
}

/// Anything at all.
struct Wild(u32);

impl Reproject for Wild {
    fn before(&self, x: u16, y: u16, depth: u8) -> Option<Before> {
        let mut random = Random(u64::from(self.0) << 32 | u64::from(x) << 16 | u64::from(y));
        match random.below(8) {
            0 => None,
            1 => Some(Before {
                place: [random.bits() as i32, random.bits() as i32],
                depth: random.bits() as u8,
            }),
            2 => Some(Before {
                place: [i32::MIN, i32::MAX],
                depth,
            }),
            3 => Still.before(x, y, depth),
            _ => Some(Before {
                place: [random.below(400) as i32, random.below(300) as i32],
                depth,
            }),
        }
    }

    fn is_whole(&self) -> bool {
        self.0.is_multiple_of(2)
    }
}

fn light(rgb: [u32; 3], exponent: i32) -> Rgb9e5 {
    Rgb9e5::encode(Radiance::from_bits(rgb, exponent))
}

/// Pixels of a wall with something before it, lit by noise of `spread` octaves about 1.
fn scene(random: &mut Random, spread: u32) -> Vec<Feature> {
    let pixel = |i: usize| {
        let (x, y) = (i % usize::from(SIZE.width), i / usize::from(SIZE.width));
        let is_near = (6..14).contains(&x) && (4..12).contains(&y);
        let mut bits = || ((1 << 14) + random.below(1 << 14)) << random.below(spread);
        Feature {
            irradiance: light([bits(), bits(), bits()], -15),
            albedo: [(40 + 9 * x) as u8, 200, 255 - 7 * y as u8],
            depth: if is_near { 90 } else { 120 },
            normal: Octahedral(if is_near { [0, 127] } else { [20, 30] }),
            id: u16::from(is_near),
        }
    };
    (0..SIZE.pixels()).map(pixel).collect()
}

/// All bytes drawn by lot; many of them extremes.
fn hostile(random: &mut Random) -> Feature {
    let mut word = || match random.below(4) {
        0 => 0,
        1 => u32::MAX,
        _ => random.bits(),
    };
    let (a, b) = (word(), word());
    Feature {
        irradiance: Rgb9e5(word()),
        albedo: [a as u8, (a >> 8) as u8, (a >> 16) as u8],
        depth: (a >> 24) as u8,
        normal: Octahedral([b as i8, (b >> 8) as i8]),
        id: if b >> 30 == 0 {
            ID_NOTHING
        } else {
            (b >> 16) as u16 & 3
        },
    }
}

#[test]
fn an_even_light_stays_as_it_is_in_every_filter() {
    let mut random = Random(1);
    for color in [[1, 1, 1], [255, 3, 0], [511, 510, 1], [300, 0, 0], [0, 0, 0]] {
        for exponent in [-24, -9, 0, 5] {
            let even = light(color, exponent);
            let mut pixels = scene(&mut random, 1);
            pixels.iter_mut().for_each(|p| p.irradiance = even);
            with_denoiser(SIZE, 1, |denoiser| {
                for frame in 0..12 {
                    denoiser.frame().copy_from_slice(&pixels);
                    let motion = Shift([frame * 5, -frame * 3]);
                    let mut filter = Atrous::for_spp(1 + frame as u32 % 4);
                    let clean = denoiser.denoise(Some(&motion), &mut filter);
                    assert!(
                        clean.light.iter().all(|l| *l == even),
                        "{color:?} {exponent} {frame}"
                    );
                    assert!(clean.frame.iter().all(|p| p.irradiance == even));
                    for (x, y) in [(0, 0), (13, 8), (45, 33), (12, 7)] {
                        let guide = pixels[random.below(SIZE.pixels() as u32) as usize];
                        let fine = upsample(SIZE, clean.frame, clean.light, [x, y], &guide);
                        assert_eq!(fine, even.decode(), "{color:?} {exponent}");
                        let fine = upsample_3x(SIZE, clean.frame, clean.light, [x, y], &guide);
                        assert_eq!(fine, even.decode(), "{color:?} {exponent}");
                    }
                }
            });
        }
    }
}

#[test]
fn edges_of_the_albedo_are_kept_exactly() {
    let mut random = Random(2);
    let mut pixels = scene(&mut random, 1);
    let even = light([1 << 15, 1 << 14, 1 << 13], -15);
    pixels.iter_mut().for_each(|p| p.irradiance = even);
    with_denoiser(SIZE, 1, |denoiser| {
        denoiser.frame().copy_from_slice(&pixels);
        let clean = denoiser.denoise(None::<&Still>, &mut Atrous::for_spp(1));
        for (i, pixel) in pixels.iter().enumerate() {
            let (x, y) = (i as u16 % SIZE.width, i as u16 / SIZE.width);
            assert_eq!(clean.pixel(x, y), even.decode().mul_albedo(pixel.albedo()));
        }
        assert_eq!(clean.pixel(SIZE.width, 0), Radiance::BLACK);
        assert_eq!(clean.pixel(0, SIZE.height), Radiance::BLACK);
    });
}

#[test]
fn frames_of_a_camera_at_rest_are_their_mean() {
    let mut random = Random(3);
    let frames: Vec<_> = (0..8).map(|_| scene(&mut random, 1)).collect();
    let mut worst = 0f64;
    let mut bias = 0f64;
    with_denoiser(SIZE, 1, |denoiser| {
        for (n, pixels) in frames.iter().enumerate() {
            denoiser.frame().copy_from_slice(pixels);
            let clean = denoiser.denoise(Some(&Still), &mut Off);
            for (i, (pixel, out)) in clean.frame.iter().zip(clean.light).enumerate() {
                assert_eq!(pixel.irradiance, *out);
                let got = value(out.decode());
                for (c, got) in got.into_iter().enumerate() {
                    let mean = frames[..=n]
                        .iter()
                        .map(|f| value(f[i].irradiance.decode())[c])
                        .sum::<f64>()
                        / (n + 1) as f64;
                    // Steps of the largest channel, which is under 2: 2^-8.
                    worst = worst.max((got - mean).abs() * 256.0);
                    bias += (got - mean) * 256.0;
                }
            }
        }
    });
    // Eight roundings, by chance, of a step each at most and an n-th of what was before.
    assert!(worst < 3.0, "{worst}");
    let count = (frames.len() * SIZE.pixels() * 3) as f64;
    assert!((bias / count).abs() < 0.02, "{}", bias / count);
}

#[test]
fn fireflies_are_brought_down_to_their_neighbours() {
    let mut random = Random(4);
    let mut pixels = scene(&mut random, 1);
    let at = 5 * usize::from(SIZE.width) + 18;
    pixels[at].irradiance = light([1 << 25, 1 << 25, 1 << 24], -15);
    with_denoiser(SIZE, 1, |denoiser| {
        denoiser.frame().copy_from_slice(&pixels);
        let clean = denoiser.denoise(None::<&Still>, &mut Off);
        let [r, g, b] = value(clean.light[at].decode());
        // Neighbours are under 1: four times that at most, more than the brightest, and of the same colour.
        assert!(
            r == g && (b / r - 0.5).abs() < 0.01 && r < 4.1 && r > 1.0,
            "{r} {g} {b}"
        );
        let others = pixels
            .iter()
            .zip(clean.light)
            .enumerate()
            .filter(|(i, _)| *i != at);
        assert!(others.filter(|(_, (p, l))| p.irradiance != **l).count() == 0);
    });
}

#[test]
fn what_was_uncovered_has_no_past() {
    let mut random = Random(5);
    let pixels = scene(&mut random, 1);
    let bright: Vec<_> = pixels
        .iter()
        .map(|p| Feature {
            irradiance: light([40 << 15; 3], -15),
            id: 7,
            ..*p
        })
        .collect();
    with_denoiser(SIZE, 1, |denoiser| {
        denoiser.frame().copy_from_slice(&bright);
        denoiser.denoise(Some(&Still), &mut Off);
        denoiser.frame().copy_from_slice(&pixels);
        let clean = denoiser.denoise(Some(&Still), &mut Off);
        assert!(clean.light.iter().zip(&pixels).all(|(l, p)| *l == p.irradiance));
        // And from outside of the picture nothing comes in.
        denoiser.frame().copy_from_slice(&pixels);
        let clean = denoiser.denoise(Some(&Shift([16 * i32::from(SIZE.width), 0])), &mut Off);
        assert!(clean.light.iter().zip(&pixels).all(|(l, p)| *l == p.irradiance));
    });
}

#[test]
fn lengths_are_of_the_frame_that_was_denoised() {
    with_denoiser(SIZE, 1, |denoiser| {
        for number in 1..=10 {
            denoiser.frame().fill(Feature::default());
            let clean = denoiser.denoise(Some(&Still), &mut Off);
            assert_eq!(clean.lengths, [number.min(8); SIZE.pixels()]);
        }
        denoiser.forget();
        let clean = denoiser.denoise(Some(&Still), &mut Off);
        assert_eq!(clean.lengths, [1; SIZE.pixels()]);
    });
}

/// Two walls that meet in a column, whose pixels are of one of them by chance.
fn corner(random: &mut Random) -> Vec<Feature> {
    let pixel = |i: usize| {
        let x = i % usize::from(SIZE.width);
        let is_right = x > 9 || x == 9 && random.below(2) == 1;
        Feature {
            irradiance: if is_right {
                light([3 << 14; 3], -15)
            } else {
                light([1 << 14; 3], -15)
            },
            albedo: [if is_right { 240 } else { 90 }; 3],
            depth: 100,
            normal: Octahedral([0, 0]),
            id: u16::from(is_right),
        }
    };
    (0..SIZE.pixels()).map(pixel).collect()
}

#[test]
fn at_rest_each_frame_leads_the_filters_with_the_same_chance() {
    let mut random = Random(22);
    // Each frame has a distance of its own, all near enough to be one thing's.
    let frame = |depth: u8, random: &mut Random| -> Vec<Feature> {
        let pixels = scene(random, 1).into_iter();
        pixels
            .map(|pixel| Feature {
                depth,
                id: 7,
                ..pixel
            })
            .collect()
    };
    with_denoiser(SIZE, 1, |denoiser| {
        for depth in 90..93 {
            denoiser.frame().copy_from_slice(&frame(depth, &mut random));
            denoiser.denoise(Some(&Still), &mut Off);
        }
        denoiser.frame().copy_from_slice(&frame(93, &mut random));
        let clean = denoiser.denoise(Some(&Still), &mut Off);
        let counts = [90, 91, 92, 93].map(|depth| clean.frame.iter().filter(|p| p.depth == depth).count());
        // A quarter of 391, within four standard deviations.
        assert!(counts.iter().all(|count| (64..133).contains(count)), "{counts:?}");
    });
}

#[test]
fn a_silhouette_at_rest_is_the_mean_of_both_sides() {
    let share = |code: u8| f64::from(microlux::film::feature::albedo_share(code).to_bits()) / 32768.0;
    let mut random = Random(21);
    let frames: Vec<_> = (0..8).map(|_| corner(&mut random)).collect();
    with_denoiser(SIZE, 1, |denoiser| {
        for pixels in &frames[..7] {
            denoiser.frame().copy_from_slice(pixels);
            denoiser.denoise(Some(&Still), &mut Off);
        }
        denoiser.frame().copy_from_slice(&frames[7]);
        let clean = denoiser.denoise(Some(&Still), &mut Off);
        let (mut worst, mut bias) = ([0f64; 2], [0f64; 2]);
        for (i, pixel) in clean.frame.iter().enumerate() {
            if i % usize::from(SIZE.width) != 9 {
                let was = &frames[7][i];
                assert_eq!((pixel.albedo, pixel.irradiance), (was.albedo, was.irradiance));
                continue;
            }
            let mean = |of: &dyn Fn(&Feature) -> f64| frames.iter().map(|f| of(&f[i])).sum::<f64>() / 8.0;
            let seen: [&dyn Fn(&Feature) -> f64; 2] =
                [&|p| share(p.albedo[1]), &|p| value(p.irradiance.decode())[1]];
            for (k, of) in seen.into_iter().enumerate() {
                let off = of(pixel) - mean(of);
                worst[k] = worst[k].max(off.abs());
                bias[k] += off / f64::from(SIZE.height);
            }
        }
        // Steps of the albedo's code are 0.008 at most, those of light 0.004.
        assert!(worst[0] < 0.02 && worst[1] < 0.012, "{worst:?}");
        assert!(bias.iter().all(|bias| bias.abs() < 0.006), "{bias:?}");
        // As soon as anything moves each thing keeps its own.
        denoiser.frame().copy_from_slice(&frames[0]);
        let clean = denoiser.denoise(Some(&Shift([0, 0])), &mut Off);
        assert!(
            clean
                .frame
                .iter()
                .zip(&frames[0])
                .all(|(c, p)| c.albedo == p.albedo)
        );
    });
}

/// What is far stays, what is near goes to the right by two pixels.
struct Passing;

impl Reproject for Passing {
    fn before(&self, x: u16, y: u16, depth: u8) -> Option<Before> {
        let [left, top] = [x, y].map(|c| 16 * i32::from(c) + 8);
        let place = [if depth == 255 { left } else { left - 32 }, top];
        Some(Before { place, depth })
    }
}

#[test]
fn what_goes_away_leaves_no_trail() {
    let sky = light([1 << 12; 3], -15);
    let frame = |number: usize| -> Vec<Feature> {
        let pixel = |i: usize| {
            let x = i % usize::from(SIZE.width);
            let is_near = (2 * number..2 * number + 6).contains(&x);
            Feature {
                irradiance: if is_near { light([9 << 15; 3], -15) } else { sky },
                albedo: [if is_near { 200 } else { 255 }; 3],
                depth: if is_near { 80 } else { 255 },
                normal: Octahedral([0, 0]),
                id: if is_near { 3 } else { ID_NOTHING },
            }
        };
        (0..SIZE.pixels()).map(pixel).collect()
    };
    with_denoiser(SIZE, 1, |denoiser| {
        for number in 0..8 {
            let pixels = frame(number);
            denoiser.frame().copy_from_slice(&pixels);
            let clean = denoiser.denoise(Some(&Passing), &mut Off);
            for (i, (found, pixel)) in clean.frame.iter().zip(&pixels).enumerate() {
                assert_eq!(found, pixel, "frame {number}, {i}");
            }
        }
    });
}

/// Bands of these many rows, the lowest first, then a-trous steps of such bands.
fn in_bands(pixels: &[Feature], past: Option<&[Feature]>, rows: u16) -> Vec<Rgb9e5> {
    let width = usize::from(SIZE.width);
    let raw: Vec<_> = pixels.iter().map(|p| p.irradiance).collect();
    let mut frame = pixels.to_vec();
    let mut lengths = vec![0; frame.len()];
    let past_lengths: Vec<u8> = (0..frame.len()).map(|i| i as u8 % 9).collect();
    let motion = Shift([5, -9]);
    let past = past.map(|frame| Past {
        frame,
        lengths: &past_lengths,
        motion: &motion,
    });
    for first in (0..SIZE.height).step_by(usize::from(rows)).rev() {
        let last = (first + rows).min(SIZE.height);
        let range = usize::from(first) * width..usize::from(last) * width;
        let mut above = match range.start {
            0 => vec![Rgb9e5(u32::MAX); width],
            start => raw[start - width..start].to_vec(),
        };
        let band = Band {
            size: SIZE,
            first,
            rows: &mut frame[range.clone()],
            lengths: &mut lengths[range.clone()],
            above: &mut above,
            below: raw.get(range.end..range.end + width).unwrap_or(&[]),
        };
        accumulate(band, past.as_ref(), 3);
    }
    let mut light: Vec<_> = frame.iter().map(|p| p.irradiance).collect();
    let filter = Atrous::for_spp(4);
    for step in 0..filter.steps {
        let aside: Vec<_> = frame.iter().zip(&light).map(|(p, l)| beside(p, *l)).collect();
        let mut to = vec![Rgb9e5::BLACK; light.len()];
        for first in (0..SIZE.height).step_by(usize::from(rows)).rev() {
            let last = (first + rows).min(SIZE.height);
            let range = usize::from(first) * width..usize::from(last) * width;
            let whole = Whole {
                size: SIZE,
                frame: &frame,
                lengths: &lengths,
                aside: &aside,
                light: &light,
            };
            filter.rows(step, whole, first, &mut to[range]);
        }
        light = to;
    }
    light
}

#[test]
fn bands_of_any_height_are_the_same_picture() {
    let mut random = Random(6);
    let (pixels, past) = (scene(&mut random, 6), scene(&mut random, 3));
    let whole = in_bands(&pixels, Some(&past), SIZE.height);
    for rows in [1, 2, 3, SIZE.height.div_ceil(2)] {
        assert!(in_bands(&pixels, Some(&past), rows) == whole, "{rows}");
    }
    // And the one that a denoiser makes by itself.
    with_denoiser(SIZE, 1, |denoiser| {
        denoiser.frame().copy_from_slice(&pixels);
        let clean = denoiser.denoise(None::<&Still>, &mut Atrous::for_spp(4));
        assert!(clean.light == in_bands(&pixels, None, 2));
    });
}

/// Frames with history, by each pair of workers.
fn by(pair: &impl Pair, size: Size, filter: &mut impl Filter) -> Vec<Rgb9e5> {
    let mut random = Random(11);
    let mut seen = Vec::new();
    with_denoiser(size, 1, |denoiser| {
        for _ in 0..3 {
            for pixel in denoiser.frame() {
                *pixel = scene(&mut random, 5)[random.below(SIZE.pixels() as u32) as usize];
            }
            let clean = denoiser.denoise_by(pair, Some(&Shift([3, -20])), filter);
            seen.extend_from_slice(clean.light);
            seen.extend(clean.frame.iter().map(|pixel| pixel.irradiance));
        }
    });
    seen
}

#[test]
fn two_workers_make_the_same_picture() {
    for (width, height) in [(9, 8), (9, 7), (1, 1), (5, 2), (3, 1), (0, 3), (3, 0)] {
        let size = Size { width, height };
        for spp in [1, 4] {
            let alone = by(&Alone, size, &mut Atrous::for_spp(spp));
            assert_eq!(alone, by(&Threads, size, &mut Atrous::for_spp(spp)), "{size:?}");
            assert_eq!(alone, by(&Backwards, size, &mut Atrous::for_spp(spp)), "{size:?}");
        }
    }
}

#[test]
fn a_fine_pixel_has_the_light_of_its_own_thing() {
    let wall = Feature {
        irradiance: light([1 << 15; 3], -15),
        depth: 90,
        id: 3,
        ..Feature::default()
    };
    let nothing = Feature {
        irradiance: Rgb9e5::BLACK,
        depth: 255,
        id: ID_NOTHING,
        ..wall
    };
    // A wall as far as column 10, of which the samples say more than there is.
    let frame: Vec<Feature> = (0..SIZE.pixels())
        .map(|i| {
            if i % usize::from(SIZE.width) <= 10 {
                wall
            } else {
                nothing
            }
        })
        .collect();
    let lights: Vec<Rgb9e5> = frame.iter().map(|pixel| pixel.irradiance).collect();
    for y in [0, 1, 16, 33] {
        let fine = |x: u16, guide: &Feature| upsample(SIZE, &frame, &lights, [x, y], guide);
        // Columns 9 and 10 are nearest.
        assert_eq!(fine(20, &nothing), Radiance::BLACK);
        assert_eq!(fine(20, &wall), wall.irradiance.decode());
        assert_eq!(fine(23, &wall), wall.irradiance.decode());
        // Too far from any of its own.
        assert_eq!(fine(17, &nothing), wall.irradiance.decode());
        let fine = |x: u16, guide: &Feature| upsample_3x(SIZE, &frame, &lights, [x, y], guide);
        // Column 10 has 30 to 32: none of these is beside column 11, where both would count, but by way of the sixteen about it.
        for x in [29, 30, 31] {
            assert_eq!(fine(x, &nothing), Radiance::BLACK, "{x}");
        }
        for x in [31, 34, 35] {
            assert_eq!(fine(x, &wall), wall.irradiance.decode(), "{x}");
        }
        assert_eq!(fine(27, &nothing), wall.irradiance.decode());
    }
}

#[test]
fn light_of_two_things_counts_a_quarter() {
    let wall = Feature {
        irradiance: light([1 << 15; 3], -15),
        albedo: [200; 3],
        depth: 90,
        id: 3,
        ..Feature::default()
    };
    let mut frame = vec![wall; SIZE.pixels()];
    // One of its four samples met a lamp.
    let lit = Feature {
        irradiance: light([5 << 15; 3], -15),
        albedo: [215; 3],
        ..wall
    };
    frame[5 * usize::from(SIZE.width) + 10] = lit;
    let fine = |guide: &Feature, place| {
        let lights: Vec<Rgb9e5> = frame.iter().map(|pixel| pixel.irradiance).collect();
        value(upsample(SIZE, &frame, &lights, place, guide))[0]
    };
    // Sixteenths: the pixel's own place, beside it, across its corner.
    for (place, shares) in [
        ([20, 10], [9.0, 7.0]),
        ([19, 10], [3.0, 13.0]),
        ([19, 9], [1.0, 15.0]),
    ] {
        let [own, others] = shares;
        let exact = (5.0 * own / 4.0 + others) / (own / 4.0 + others);
        let found = fine(&wall, place);
        assert!(
            (found / exact - 1.0).abs() < 0.02,
            "{place:?}: {found}, not {exact}"
        );
    }
}

#[test]
fn anything_at_all_goes_through() {
    let mut random = Random(7);
    for round in 0..60 {
        let size = Size {
            width: random.below(12) as u16,
            height: random.below(9) as u16,
        };
        with_denoiser(size, 1, |denoiser| {
            for frame in 0..4 {
                denoiser
                    .frame()
                    .iter_mut()
                    .for_each(|p| *p = hostile(&mut random));
                let mut filter = Atrous {
                    steps: random.bits() as u8,
                    normal: random.bits() as u8,
                    depth: random.bits() as u8,
                    luma: [0; 5].map(|_| random.bits() as u8),
                    id: random.bits() as u8,
                };
                let clean = denoiser.denoise(Some(&Wild(round * 4 + frame)), &mut filter);
                for _ in 0..20 {
                    let guide = hostile(&mut random);
                    let [x, y] = [random.bits() as u16, random.bits() as u16];
                    clean.pixel_2x(x, y, &guide);
                    clean.pixel_2x(x % 24, y % 18, &guide);
                    clean.pixel_3x(x, y, &guide);
                    clean.pixel_3x(x % 36, y % 27, &guide);
                    clean.pixel(x, y);
                }
                let mut ring = vec![Seen::default(); random.below(50) as usize];
                let [from, to] = [0; 2].map(|_| random.below(20) as u16);
                clean.rows(from..to, &mut ring, |_, row| assert!(row.lights().count() < 17));
                let guide = |_, _| hostile(&mut random);
                let show = |_: u16, row: Row| assert!(row.lights().count() < 17);
                clean.rows_2x(from..to, &mut ring, guide, show);
                let guide = |_, _| hostile(&mut random);
                clean.rows_3x(from..to, &mut ring, guide, show);
            }
        });
    }
}

#[test]
fn memory_that_is_too_short_is_named() {
    let size = Size { width: 4, height: 3 };
    let told = |lens: [usize; 5]| {
        let mut frames = [
            vec![Feature::default(); lens[0]],
            vec![Feature::default(); lens[1]],
        ];
        let mut lengths = [vec![0; lens[2]], vec![0; lens[3]]];
        let mut rows = vec![Rgb9e5::BLACK; lens[4]];
        let [a, b] = &mut frames;
        let [c, d] = &mut lengths;
        let memory = Memory {
            frames: [a, b],
            lengths: [c, d],
            rows: &mut rows,
        };
        Denoiser::new(size, 1, memory).map(|_| ())
    };
    assert_eq!(told([12, 12, 12, 12, 12]), Ok(()));
    let short = |slice, needed| Err(TooShort { slice, needed });
    assert_eq!(told([11, 12, 12, 12, 12]), short("frames[0]", 12));
    assert_eq!(told([12, 11, 12, 12, 12]), short("frames[1]", 12));
    assert_eq!(told([12, 12, 11, 12, 12]), short("lengths[0]", 12));
    assert_eq!(told([12, 12, 12, 11, 8]), short("lengths[1]", 12));
    assert_eq!(told([12, 12, 12, 12, 11]), short("rows", 12));
    let text = told([12, 12, 12, 12, 11]).unwrap_err().to_string();
    assert_eq!(text, "`rows` is too short: 12 are needed");
}

/// Noise that a filter may take away, across an edge that it may not.
#[test]
fn noise_goes_and_edges_stay() {
    let mut random = Random(8);
    let mut pixels = scene(&mut random, 1);
    for pixel in &mut pixels {
        if pixel.id == 1 {
            let (m, e) = pixel.irradiance.to_parts();
            pixel.irradiance = Rgb9e5::from_bits(m, e + 4);
        }
    }
    with_denoiser(SIZE, 1, |denoiser| {
        denoiser.frame().copy_from_slice(&pixels);
        let clean = denoiser.denoise(None::<&Still>, &mut Atrous::for_spp(1));
        for id in [0, 1] {
            let spread = |of: &dyn Fn(usize) -> f64| {
                let all: Vec<_> = (0..pixels.len())
                    .filter(|i| pixels[*i].id == id)
                    .map(of)
                    .collect();
                let mean = all.iter().sum::<f64>() / all.len() as f64;
                let square = all.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / all.len() as f64;
                (mean, square.sqrt() / mean)
            };
            let (mean, noise) = spread(&|i| value(pixels[i].irradiance.decode())[1]);
            let (mean_after, noise_after) = spread(&|i| value(clean.light[i].decode())[1]);
            assert!(noise_after < 0.25 * noise, "{id}: {noise} {noise_after}");
            assert!(
                (mean_after / mean - 1.0).abs() < 0.03,
                "{id}: {mean} {mean_after}"
            );
        }
    });
}
