//! Random frames made two and three times the size: the former by assembly on ARMv6-M, by the portable code elsewhere.

use microlux::{
    color::Rgb9e5,
    film::{
        Feature,
        denoise::{Clean, Row, Seen, Size},
    },
    geom::Octahedral,
    num::Crc,
};

use crate::{fingerprint, random::Xorshift};

const FRAMES: u32 = 80;
const SIZE: Size = Size { width: 7, height: 4 };
const PIXELS: usize = SIZE.pixels();

pub(crate) fn twice() -> u32 {
    raised(2)
}

pub(crate) fn thrice() -> u32 {
    raised(3)
}

/// Of one thing or a few, turned and painted alike or not, near or far, lamps and nothing; of light that is alike or not, as
/// bright and as dark as can be.
#[inline(never)]
fn raised(scale: u16) -> u32 {
    let mut random = Xorshift::new(0x2545_f491);
    let mut crc = Crc::new();
    for round in 0..FRAMES {
        // How many things there may be, how unlike their places and lights are.
        let kinds = [1, 1, 2, 3, 5, 1, 1, 2, 3, 1][round as usize % 10];
        let palette = [(); 5].map(|()| random.u32());
        let depths = 1 + if round % 10 == 9 {
            0
        } else {
            below(&mut random, 12)
        };
        let exponents = 1 + below(&mut random, 20);
        let exponent = below(&mut random, 33 - exponents);
        let pixel = |random: &mut Xorshift| {
            let kind = palette[below(random, kinds) as usize];
            pixel(random, kind, round, depths)
        };
        let frame: [Feature; PIXELS] = [(); PIXELS].map(|()| pixel(&mut random));
        let guides: [Feature; 4 * PIXELS] = [(); 4 * PIXELS].map(|()| pixel(&mut random));
        let light: [Rgb9e5; PIXELS] = [(); PIXELS].map(|()| {
            let exponent = exponent + below(&mut random, exponents);
            // Black side by side, too.
            if round % 5 == 4 && below(&mut random, 4) > 0 {
                return Rgb9e5::BLACK;
            }
            light(&mut random, exponent)
        });
        let clean = Clean {
            size: SIZE,
            frame: &frame,
            light: &light,
            lengths: &[1; PIXELS],
            spp: 1,
            whole: 1,
        };
        let Size { width, height } = SIZE.times(scale);
        // Again from the first when all were taken.
        let guide =
            |x: u16, y: u16| guides[(usize::from(y) * usize::from(width) + usize::from(x)) % guides.len()];
        let mut ring = [Seen::NOTHING; 3 * 3 * SIZE.width as usize];
        let show = |_, row: Row| {
            row.lights().for_each(|light| fingerprint::pixel(&mut crc, light));
        };
        match scale {
            2 => clean.rows_2x(0..height, &mut ring, guide, show),
            _ => clean.rows_3x(0..height, &mut ring, guide, show),
        }
    }
    crc.value()
}

fn below(random: &mut Xorshift, end: u32) -> u32 {
    (random.u32() >> 8) % end
}

fn pixel(random: &mut Xorshift, kind: u32, round: u32, depths: u32) -> Feature {
    let [a, b, c, d] = kind.to_le_bytes();
    let mut albedo = [a, b, c];
    if round % 3 == 0 && below(random, 3) == 0 {
        albedo[1] ^= 16;
    }
    let mut depth = (d >> 1) + below(random, depths) as u8;
    match below(random, 24) {
        // A lamp, and what is infinitely far.
        0 if round % 4 == 0 => albedo = [255; 3],
        1 if round % 8 == 0 => (albedo, depth) = ([255; 3], 255),
        2 if round % 8 == 1 => albedo = [0; 3],
        _ => {}
    }
    // By nothing, a few steps, or far.
    let steps = [0, 1, 0, 1, 0, 1, 0, 1, 0, 30][round as usize % 10];
    let turned = c as i8 / 4 + below(random, 4) as i8 * steps;
    // Things that look the same way side by side.
    let id = kind as u16 & 3 ^ u16::from(round % 4 >= 2 && below(random, 4) == 0);
    Feature {
        irradiance: Rgb9e5::BLACK,
        albedo,
        depth,
        normal: Octahedral([b as i8 / 2, turned]),
        id,
    }
}

fn light(random: &mut Xorshift, exponent: u32) -> Rgb9e5 {
    let mantissas = match below(random, 8) {
        0 => 0,
        1 => 0x7ff_ffff,
        2 => random.u32() >> (5 + below(random, 27)),
        _ => random.u32() >> 5 | 0x100,
    };
    Rgb9e5(mantissas | exponent << 27)
}
