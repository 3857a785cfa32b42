//! Directions and lengths of vectors as the core finds them: in assembly on ARMv6-M, by the portable code elsewhere.

use core::hint::black_box;

use microlux::{geom::Offset, num::Crc};

use crate::random::Xorshift;

const CORNERS: [i32; 17] = [
    0,
    1,
    -1,
    2,
    -2,
    3,
    255,
    -256,
    257,
    0xffff,
    -0x1_0000,
    0x3fff_ffff,
    -0x4000_0000,
    0x4000_0000,
    i32::MAX,
    -i32::MAX,
    i32::MIN,
];

/// Whose squares lie so near below 2^30 that the root's last step goes too far.
const STEPS: [[i32; 3]; 3] = [[32_767, 213, 142], [-32_767, 252, -45], [4, 362, 32_766]];

/// All vectors of corners, powers of two along each axis and aside, and random ones of every magnitude.
pub(crate) fn run() -> u32 {
    let mut crc = Crc::new();
    for x in CORNERS {
        for y in CORNERS {
            for z in CORNERS {
                find(&mut crc, [x, y, z]);
            }
        }
    }
    for bit in 0..32 {
        let power = 1i32 << bit;
        for c in [power, power.wrapping_neg(), power.wrapping_sub(1), !power] {
            for v in [[c, 0, 0], [0, c, 0], [0, 0, c], [c, c, 1], [-1, c, c >> 1]] {
                find(&mut crc, v);
            }
        }
    }
    for step in STEPS {
        for shift in [0, 8, 15] {
            find(&mut crc, step.map(|c| c << shift));
        }
    }
    let mut random = Xorshift::new(0x9e37_79b9);
    for _ in 0..6000 {
        let shifts = random.u32();
        // Of one magnitude, or each of its own.
        let apart = if shifts >> 31 == 0 { 0 } else { 5 };
        let v = [0, 1, 2].map(|a| random.u32() as i32 >> (shifts >> (a * apart) & 31));
        find(&mut crc, v);
    }
    crc.value()
}

#[inline(never)]
fn find(crc: &mut Crc, v: [i32; 3]) {
    let Some((dir, norm)) = Offset(black_box(v)).normalize() else {
        crc.word(1);
        return;
    };
    for c in dir.0 {
        crc.word(c as u32);
    }
    // A long vector's length has all the bits of its square and of the root.
    crc.word(norm.length() as u32);
    let square = norm.square();
    crc.word(u32::from(square.mantissa()));
    crc.word(i32::from(square.exponent()) as u32);
}
