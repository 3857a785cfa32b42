//! The neural filter: its sums against plain ones, what it keeps, and what it refuses.

use microlux::color::Rgb9e5;
use microlux::film::Feature;
use microlux::film::denoise::network::{
    BIASES, CHANNELS, CHECKSUM, FEATURES, HEAD, INPUTS, Input, LAYERS, LEVELS, Layer, MAX_SIDE, Needs,
    Network, NetworkError, Neural, Scratch, TRAINED, WEIGHTS, Weights, WeightsError, exposure, irradiance,
};
use microlux::film::denoise::{self, Alone, Filter, Pair, Size};
use microlux::film::feature::{DEPTH_NOTHING, ID_NOTHING, first_id};
use microlux::geom::Octahedral;
use microlux::num::Crc;

use crate::{Backwards, Random, Threads, value};

/// Memory with something in it.
struct Room {
    fine: Vec<[u8; HEAD]>,
    near: Vec<u32>,
    far: Vec<u32>,
}

impl Room {
    fn new(width: usize, height: usize, fill: u8) -> Room {
        let Needs { fine, near, far } = Needs::of(width, height);
        let word = u32::from(fill) * 0x0101_0101;
        Room {
            fine: vec![[fill; HEAD]; fine],
            near: vec![word; near],
            far: vec![word; far],
        }
    }

    fn lend(&mut self) -> Scratch<'_> {
        Scratch {
            fine: &mut self.fine,
            near: &mut self.near,
            far: &mut self.far,
        }
    }
}

fn denoised_by(
    pair: &impl Pair,
    weights: Weights,
    [width, height]: [usize; 2],
    light: &[[u16; 3]],
    input: impl Fn(usize) -> Input + Sync,
    fill: u8,
) -> Vec<[u16; 3]> {
    let mut room = Room::new(width, height, fill);
    let mut out = vec![[0; 3]; width * height];
    let mut network = Network::new(weights, width, height, room.lend()).unwrap();
    network.extract(pair, input);
    network
        .filter(pair, |at| light[at], &mut out, |light| light)
        .unwrap();
    out
}

fn denoised(
    weights: Weights,
    size: [usize; 2],
    light: &[[u16; 3]],
    input: impl Fn(usize) -> Input + Sync,
    fill: u8,
) -> Vec<[u16; 3]> {
    denoised_by(&Alone, weights, size, light, input, fill)
}

const SIZES: [[usize; 2]; 7] = [[1, 1], [2, 1], [1, 9], [7, 5], [8, 8], [33, 17], [40, 30]];

fn inputs(rng: &mut Random, count: usize) -> Vec<Input> {
    (0..count)
        .map(|_| Input::from_bits([0; INPUTS].map(|_| rng.below(64) as u8)))
        .collect()
}

/// Weights with as much in each sum as is allowed, in few large ones or many small ones.
fn weights(rng: &mut Random) -> (Box<[i8; WEIGHTS]>, Box<[i16; BIASES]>) {
    let mut table = Box::new([0i8; WEIGHTS]);
    let mut from = 0;
    for layer in LAYERS {
        let inputs = layer.weights() / layer.outputs;
        for output in 0..layer.outputs {
            let (mut above, mut below) = (520, 520);
            let largest = 1 + rng.below(127) as i32;
            for _ in 0..2 * inputs {
                let place = &mut table[from + rng.below(inputs as u32) as usize * layer.outputs + output];
                let w = rng.below(2 * largest as u32 + 1) as i32 - largest;
                if *place == 0 && w <= above && -w <= below {
                    *place = w as i8;
                    if w > 0 { above -= w } else { below += w }
                }
            }
        }
        from += inputs * layer.outputs;
    }
    let biases = Box::new([0i16; BIASES].map(|_| (rng.below(6000) as i32 - 2000) as i16));
    (table, biases)
}

/// The heads of each size by plain sums: planes of `i32`, nothing packed, nothing in place.
fn plainly(
    table: &[i8],
    biases: &[i16],
    input: &[Input],
    width: usize,
    height: usize,
) -> Vec<Vec<[i32; HEAD]>> {
    struct Planes {
        width: usize,
        height: usize,
        pixels: Vec<Vec<i32>>,
    }
    let place = |number: usize| -> (usize, usize) {
        let before = &LAYERS[..number];
        let weights = before.iter().map(Layer::weights).sum();
        (weights, before.iter().map(|l| l.outputs).sum())
    };
    let sums = |number: usize, from: &Planes| -> Vec<Vec<i32>> {
        let layer = LAYERS[number];
        let (first, bias) = place(number);
        let reach = (layer.taps == 9) as i32;
        let at = |x: i32, y: i32| {
            let (x, y) = (
                x.clamp(0, from.width as i32 - 1),
                y.clamp(0, from.height as i32 - 1),
            );
            &from.pixels[y as usize * from.width + x as usize]
        };
        let mut out = Vec::new();
        for y in 0..from.height as i32 {
            for x in 0..from.width as i32 {
                let mut sum: Vec<i32> = biases[bias..][..layer.outputs]
                    .iter()
                    .map(|&b| b.into())
                    .collect();
                let mut weight = table[first..].iter();
                let add = |sum: &mut [i32], inputs: &[i32], weight: &mut std::slice::Iter<i8>| {
                    for a in inputs {
                        for sum in &mut *sum {
                            *sum += a * i32::from(*weight.next().unwrap());
                        }
                    }
                };
                for dy in -reach..=reach {
                    for dx in -reach..=reach {
                        add(&mut sum, &at(x + dx, y + dy)[..layer.inputs], &mut weight);
                    }
                }
                add(&mut sum, &at(x, y)[layer.inputs..], &mut weight);
                out.push(sum);
            }
        }
        out
    };
    let layer = |number: usize, from: &Planes| -> Planes {
        let activate = |sum: i32| (f64::from(sum) / 64.0 + 0.5).floor().clamp(0.0, 63.0) as i32;
        let pixels = sums(number, from)
            .into_iter()
            .map(|p| p.into_iter().map(activate).collect());
        Planes {
            pixels: pixels.collect(),
            ..*from
        }
    };
    let half = |from: &Planes| -> Planes {
        let (width, height) = (from.width.div_ceil(2), from.height.div_ceil(2));
        let mut pixels = vec![vec![i32::MIN; from.pixels[0].len()]; width * height];
        for (at, pixel) in from.pixels.iter().enumerate() {
            let to = &mut pixels[at / from.width / 2 * width + at % from.width / 2];
            to.iter_mut()
                .zip(pixel)
                .for_each(|(to, from)| *to = (*to).max(*from));
        }
        Planes {
            width,
            height,
            pixels,
        }
    };
    let seen = Planes {
        width,
        height,
        pixels: input
            .iter()
            .map(|i| i.to_bits().map(i32::from).to_vec())
            .collect(),
    };
    let mut down = vec![layer(0, &seen)];
    for level in 1..LEVELS {
        down.push(layer(level, &half(&down[level - 1])));
    }
    let mut up = layer(LEVELS, &down[LEVELS - 1]);
    let head = |level: usize, from: &Planes| -> Vec<[i32; HEAD]> {
        let round = |sum: i32, by: f64| (f64::from(sum) / by + 0.5).floor() as i32;
        let all = sums(11 + level, from).into_iter();
        all.map(|sum| {
            core::array::from_fn(|i| {
                if i < FEATURES {
                    round(sum[i], 128.0).clamp(-128, 127)
                } else {
                    (128 + round(sum[i], 16.0)).clamp(0, 255)
                }
            })
        })
        .collect()
    };
    let mut heads = vec![head(LEVELS - 1, &up)];
    for (number, level) in (0..LEVELS - 1).rev().enumerate() {
        let fine = &down[level];
        let mut joined = Planes {
            pixels: Vec::new(),
            ..*fine
        };
        for at in 0..fine.width * fine.height {
            let mut pixel = up.pixels[at / fine.width / 2 * up.width + at % fine.width / 2].clone();
            pixel.extend(&fine.pixels[at]);
            joined.pixels.push(pixel);
        }
        up = layer(6 + 2 * number, &layer(5 + 2 * number, &joined));
        if level > 0 {
            heads.push(head(level, &up));
        }
    }
    // What is seen of a pixel itself is beside its activations, unless its light is of one sample.
    for (pixel, input) in up.pixels.iter_mut().zip(input) {
        let [_, _, _, own @ ..] = input.to_bits().map(i32::from);
        pixel.extend(if own[7] == 0 { [0; 8] } else { own });
    }
    heads.push(head(0, &up));
    heads.reverse();
    heads
}

#[test]
fn two_sums_in_a_word_are_both_sums() {
    let mut rng = Random(1);
    for [width, height] in SIZES {
        let (table, biases) = weights(&mut rng);
        let input = inputs(&mut rng, width * height);
        let mut room = Room::new(width, height, 0xaa);
        let weights = Weights::new(&table, &biases).unwrap();
        let mut network = Network::new(weights, width, height, room.lend()).unwrap();
        network.extract(&Alone, |at| input[at]);
        let plain = plainly(&*table, &*biases, &input, width, height);
        for level in 0..LEVELS {
            let heads = network.heads(level);
            assert_eq!(heads.len(), plain[level].len());
            for (head, plain) in heads.iter().zip(&plain[level]) {
                let head: [i32; HEAD] = core::array::from_fn(|i| {
                    if i < FEATURES {
                        i32::from(head[i] as i8)
                    } else {
                        head[i].into()
                    }
                });
                assert_eq!(head, *plain, "{width} x {height}, size {level}");
            }
        }
    }
}

#[test]
fn light_that_is_the_same_all_over_stays() {
    let mut rng = Random(2);
    for [width, height] in SIZES {
        let (table, biases) = weights(&mut rng);
        let input = inputs(&mut rng, width * height);
        for light in [[0, 1, 65535], [4096, 3, 777], [65535; 3]] {
            let all = vec![light; width * height];
            for weights in [TRAINED, Weights::new(&table, &biases).unwrap()] {
                let out = denoised(weights, [width, height], &all, |at| input[at], 1);
                assert_eq!(out, all, "{width} x {height}");
            }
        }
    }
}

#[test]
fn light_is_mixed_and_never_made() {
    let mut rng = Random(3);
    for [width, height] in SIZES {
        let (table, biases) = weights(&mut rng);
        let weights = Weights::new(&table, &biases).unwrap();
        let input = inputs(&mut rng, width * height);
        let light: Vec<[u16; 3]> = (0..width * height)
            .map(|_| [0; 3].map(|_| (1000 + rng.below(40_000)) as u16))
            .collect();
        let out = denoised(weights, [width, height], &light, |at| input[at], 2);
        for c in 0..3 {
            let (low, high) = (light.iter().map(|l| l[c]).min(), light.iter().map(|l| l[c]).max());
            let (low, high) = (i32::from(low.unwrap()), i32::from(high.unwrap()));
            // A quotient's error: 2^-13.5 of the difference, at four sizes and between them.
            let slack = (high - low) / 1024 + 4;
            for pixel in &out {
                let value = i32::from(pixel[c]);
                assert!(
                    (low - slack..=high + slack).contains(&value),
                    "{value}: {low} to {high}"
                );
            }
        }
    }
}

#[test]
fn nothing_panics_and_every_run_is_the_same() {
    let mut rng = Random(4);
    for round in 0..20 {
        let (table, biases) = weights(&mut rng);
        let biases = biases.map(|b| {
            if round % 2 == 0 {
                b
            } else {
                (rng.bits() >> 8) as i16
            }
        });
        let weights = Weights::new(&table, &biases).unwrap();
        let [width, height] = SIZES[round % SIZES.len()];
        let extreme = |rng: &mut Random| [0, u16::MAX, 1, rng.bits() as u16][rng.below(4) as usize];
        let light: Vec<[u16; 3]> = (0..width * height)
            .map(|_| [0; 3].map(|_| extreme(&mut rng)))
            .collect();
        let input: Vec<Input> = (0..width * height)
            .map(|_| {
                Input::from_bits([0; INPUTS].map(|_| [0, 63, 255, rng.bits() as u8][rng.below(4) as usize]))
            })
            .collect();
        let crc = |fill: u8| {
            let mut crc = Crc::new();
            for pixel in denoised(weights, [width, height], &light, |at| input[at], fill) {
                pixel.iter().for_each(|c| crc.bytes(&c.to_le_bytes()));
            }
            crc.value()
        };
        assert_eq!(crc(0), crc(0xff));
    }
}

#[test]
fn two_workers_do_what_one_does() {
    let mut rng = Random(5);
    for size in SIZES {
        let (table, biases) = weights(&mut rng);
        let weights = Weights::new(&table, &biases).unwrap();
        let count = size[0] * size[1];
        let input = inputs(&mut rng, count);
        let light: Vec<[u16; 3]> = (0..count)
            .map(|_| [0; 3].map(|_| rng.below(65_536) as u16))
            .collect();
        let alone = denoised(weights, size, &light, |at| input[at], 3);
        let threads = denoised_by(&Threads, weights, size, &light, |at| input[at], 4);
        let backwards = denoised_by(&Backwards, weights, size, &light, |at| input[at], 5);
        assert!(alone == threads && alone == backwards, "{size:?}");
    }
}

/// Where its work has room in the answer's place, and where it has not.
#[test]
fn a_filters_memory_does_not_matter() {
    let mut rng = Random(6);
    for (width, height) in [(80, 60), (77, 61), (24, 20), (3, 1)] {
        let size = Size { width, height };
        let count = size.pixels();
        let mut pixel = || Feature {
            irradiance: Rgb9e5::from_bits([0; 3].map(|_| 1 + rng.below(40_000)), -12),
            albedo: [0; 3].map(|_| rng.below(256) as u8),
            depth: [rng.below(256) as u8, DEPTH_NOTHING][rng.below(2) as usize],
            // All of one thing: the network by itself knows no others.
            id: 3,
            normal: Octahedral([0, 100, -100].map(|c| [c, 27])[rng.below(3) as usize]),
        };
        let frame: Vec<Feature> = (0..count).map(|_| pixel()).collect();
        // None of one frame alone, whose light is smoothed once more.
        let lengths: Vec<u8> = (0..count).map(|at| 2 + at as u8 % 7).collect();

        let exposure = exposure(&frame);
        let input = |at: usize| Input::new(&frame[at], 2 * u32::from(lengths[at]), exposure);
        let light: Vec<_> = frame.iter().map(irradiance).collect();
        let clean = denoised(TRAINED, [width.into(), height.into()], &light, input, 7);
        let encoded = |light: [u16; 3]| Rgb9e5::from_bits(light.map(u32::from), -12);
        let expected: Vec<Rgb9e5> = clean.into_iter().map(encoded).collect();

        let mut memory = vec![u32::MAX; Neural::needs(size)];
        let mut neural = Neural::new(TRAINED, size, 2, &mut memory).unwrap();
        assert!(
            filtered(&mut neural, size, &frame, &lengths) == expected,
            "{width} x {height}"
        );
        // Another size's frame becomes black.
        let mut room = frame.clone();
        let short = &mut room[1..];
        neural.filter(&Alone, size, &frame[1..], &lengths, denoise::Scratch::over(short));
        let black = denoise::Scratch::over(short).light;
        assert!(black.iter().all(|light| *light == Rgb9e5::BLACK));
    }
}

/// By two threads, in memory that another frame was in.
fn filtered(neural: &mut Neural, size: Size, frame: &[Feature], lengths: &[u8]) -> Vec<Rgb9e5> {
    let mut room = frame.to_vec();
    neural.filter(&Threads, size, frame, lengths, denoise::Scratch::over(&mut room));
    denoise::Scratch::over(&mut room).light.to_vec()
}

/// What sees nothing keeps its light, whatever is beside it; what sees nothing by way of glass is noise.
#[test]
fn what_sees_nothing_keeps_its_light() {
    let size = Size {
        width: 24,
        height: 20,
    };
    let sky = Rgb9e5::from_bits([100, 200, 400], -12);
    let frame: Vec<Feature> = (0..size.pixels())
        .map(|at| {
            let lit = at % 24 < 11 || at % 7 == 0;
            let glass = at / 24 >= 12;
            Feature {
                irradiance: if lit {
                    Rgb9e5::from_bits([60_000; 3], -12)
                } else if glass && at % 5 == 0 {
                    Rgb9e5::BLACK
                } else {
                    sky
                },
                albedo: [255; 3],
                depth: if lit { 90 } else { DEPTH_NOTHING },
                id: match (lit, glass) {
                    (true, _) => 7,
                    (false, true) => first_id(ID_NOTHING, 2),
                    (false, false) => ID_NOTHING,
                },
                ..Feature::default()
            }
        })
        .collect();
    let mut memory = vec![0; Neural::needs(size)];
    let mut neural = Neural::new(TRAINED, size, 1, &mut memory).unwrap();
    let clean = filtered(&mut neural, size, &frame, &vec![1; size.pixels()]);
    for (pixel, light) in frame.iter().zip(clean) {
        assert!(pixel.id != ID_NOTHING || light == sky);
        assert!(pixel.irradiance != Rgb9e5::BLACK || light != Rgb9e5::BLACK);
    }
}

/// Two halves that differ in nothing but number and light, which is noisy, are less mixed than one thing's.
#[test]
fn another_things_light_stays_out() {
    let size = Size {
        width: 24,
        height: 400,
    };
    let mut rng = Random(9);
    let level = |at: usize| if at % 24 < 12 { 2000 } else { 8000 };
    let frame: Vec<Feature> = (0..size.pixels())
        .map(|at| Feature {
            irradiance: Rgb9e5::from_bits([level(at) / 2 + rng.below(level(at)); 3], -12),
            albedo: [180; 3],
            depth: 90,
            id: 1 + u16::from(at % 24 >= 12),
            ..Feature::default()
        })
        .collect();
    let one: Vec<Feature> = frame.iter().map(|pixel| Feature { id: 1, ..*pixel }).collect();
    let mut memory = vec![0; Neural::needs(size)];
    let mut neural = Neural::new(TRAINED, size, 2, &mut memory).unwrap();
    let [two, one] = [frame, one].map(|frame| {
        let clean = filtered(&mut neural, size, &frame, &vec![1; size.pixels()]);
        // Means of the columns beside the edge, so that noise does not hide what came across.
        let errors = [11, 12].map(|x| {
            let column = (0..size.pixels()).skip(x).step_by(24);
            let seen = column.clone().map(|at| value(clean[at].decode())[0]);
            let rendered = column.map(|at| value(frame[at].irradiance.decode())[0]);
            (seen.sum::<f64>() / rendered.sum::<f64>() - 1.0).powi(2)
        });
        errors.iter().sum::<f64>()
    });
    assert!(two < 0.5 * one, "{two} {one}");
}

#[test]
fn what_is_short_is_named() {
    let [width, height] = [33, 17];
    let Needs { fine, near, far } = Needs::of(width, height);
    let refused = |less: [usize; 3]| {
        let mut room = Room::new(width, height, 0);
        room.fine.truncate(fine - less[0]);
        room.near.truncate(near - less[1]);
        room.far.truncate(far - less[2]);
        Network::new(TRAINED, width, height, room.lend()).err()
    };
    assert_eq!(refused([0; 3]), None);
    assert_eq!(refused([1, 0, 0]), Some(NetworkError::Fine { needed: fine }));
    assert_eq!(refused([0, 1, 0]), Some(NetworkError::Near { needed: near }));
    assert_eq!(refused([0, 0, 1]), Some(NetworkError::Far { needed: far }));
    for [width, height] in [[0, 4], [4, 0], [MAX_SIDE + 1, 4], [usize::MAX; 2]] {
        let mut room = Room::new(4, 4, 0);
        let error = Network::new(TRAINED, width, height, room.lend()).err();
        assert_eq!(error, Some(NetworkError::Size { width, height }));
    }
    let mut room = Room::new(width, height, 0);
    let mut network = Network::new(TRAINED, width, height, room.lend()).unwrap();
    let needed = width * height;
    let error = network.filter(&Alone, |_| [0; 3], &mut vec![[0; 3]; needed - 1], |light| light);
    assert_eq!(error, Err(NetworkError::Out { needed }));
    let size = Size {
        width: 33,
        height: 17,
    };
    let needed = Neural::needs(size);
    let mut memory = vec![0; needed];
    assert!(Neural::new(TRAINED, size, 1, &mut memory).is_ok());
    let error = Neural::new(TRAINED, size, 1, &mut memory[1..]).err();
    assert_eq!(error, Some(NetworkError::Memory { needed }));
    let size = Size { height: 0, ..size };
    let (width, height) = (33, 0);
    let error = Neural::new(TRAINED, size, 1, &mut memory).err();
    assert_eq!(error, Some(NetworkError::Size { width, height }));
    let words = NetworkError::Near { needed: 7 }.to_string();
    assert_eq!(words, "scratch.near is short: 7 words are needed");
}

#[test]
fn weights_whose_sums_do_not_fit_are_refused() {
    let mut table = Box::new([0i8; WEIGHTS]);
    let biases = [0; BIASES];
    let [one, two, ..] = CHANNELS;
    let second = LAYERS[0].weights();
    // Output 2 of the first layer, from its last input of light on, and of the second: 520 is the most, above and below 0.
    let own = LAYERS[0].own * one;
    for (layer, first, step) in [(0, second - own - one + 2, one), (1, second + 2, two)] {
        for sign in [1, -1] {
            for (i, w) in [100, 100, 100, 100, 120].into_iter().enumerate() {
                table[first + i * step] = w * sign;
            }
            assert!(Weights::new(&table, &biases).is_ok());
            table[first + 5 * step] = sign;
            let error = Weights::new(&table, &biases).err();
            assert_eq!(error, Some(WeightsError { layer, output: 2 }));
            table.fill(0);
        }
    }
}

#[test]
fn trained_weights_are_those_that_were_exported() {
    let (weights, biases) = TRAINED.tables();
    let mut crc = Crc::new();
    weights.iter().for_each(|w| crc.bytes(&w.to_le_bytes()));
    biases.iter().for_each(|b| crc.bytes(&b.to_le_bytes()));
    assert_eq!(crc.value(), CHECKSUM);
    assert!(size_of_val(weights) + size_of_val(biases) <= 16 << 10);
}

#[test]
fn memory_at_the_size_of_a_small_display() {
    let needs = Needs::of(80, 60);
    let bytes = [HEAD * needs.fine, 4 * needs.near, 4 * needs.far];
    assert_eq!(bytes, [38_400, 19_200, 9_000]);
    // What is of half the size has the answer's place; not so in a picture of few pixels, whose rows do not fit there.
    let own = |width: u16, height: u16| Neural::needs(Size { width, height });
    assert_eq!(own(80, 60), needs.far);
    let Needs { near, far, .. } = Needs::of(24, 20);
    assert_eq!(own(24, 20), near + far);
}
