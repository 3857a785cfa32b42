//! Wide integer arithmetic at its edges: where compilers' run-time libraries and emulators go wrong.

use core::hint::black_box;

use crate::random::Xorshift;
use microlux::num::Crc;

const CORNERS: [i64; 14] = [
    0,
    1,
    -1,
    2,
    i64::MAX,
    i64::MAX - 1,
    i64::MIN,
    i64::MIN + 1,
    i32::MAX as i64,
    i32::MIN as i64,
    u32::MAX as i64,
    1 << 32,
    -(1 << 32),
    0x7fff_ffff_0000_0000,
];

/// All pairs of corners, then 800 random pairs of every magnitude.
pub(crate) fn run() -> u32 {
    let mut crc = Crc::new();
    for a in CORNERS {
        for b in CORNERS {
            pair(&mut crc, black_box(a), black_box(b));
        }
    }
    let mut random = Xorshift::new(0x2545_f491);
    for _ in 0..800 {
        let a = random.i64() >> (random.u32() & 63);
        let b = random.i64() >> (random.u32() & 63);
        pair(&mut crc, black_box(a), black_box(b));
    }
    crc.value()
}

fn pair(crc: &mut Crc, a: i64, b: i64) {
    let shift = b as u32 & 63;
    let (narrow_a, narrow_b) = (a as i32, b as i32);
    let wide = [
        a.wrapping_add(b),
        a.wrapping_sub(b),
        a.wrapping_mul(b),
        a.saturating_add(b),
        a.saturating_sub(b),
        a.checked_div(b).unwrap_or(77),
        a.checked_rem(b).unwrap_or(78),
        (a as u64).checked_div(b as u64).unwrap_or(79) as i64,
        a << shift,
        a >> shift,
        (a as u64 >> shift) as i64,
        a.min(b),
        a.max(b),
    ];
    let narrow = [
        narrow_a.saturating_add(narrow_b),
        narrow_a.saturating_sub(narrow_b),
        narrow_a.checked_div(narrow_b).unwrap_or(80),
        narrow_a.checked_rem(narrow_b).unwrap_or(81),
        narrow_a.rotate_left(shift),
        ((i64::from(narrow_a) * i64::from(narrow_b)) >> 16) as i32,
    ];
    let facts = [
        a < b,
        a <= b,
        (a as u64) < b as u64,
        narrow_a < narrow_b,
        (narrow_a as u32) < narrow_b as u32,
        a.checked_add(b).is_some(),
        a.checked_sub(b).is_some(),
        a.checked_mul(b).is_some(),
        narrow_a.checked_add(narrow_b).is_some(),
        narrow_a.checked_mul(narrow_b).is_some(),
    ];
    for value in wide {
        crc.bytes(&value.to_le_bytes());
    }
    for value in narrow {
        crc.bytes(&value.to_le_bytes());
    }
    crc.word(facts.iter().fold(0, |bits, &fact| bits << 1 | u32::from(fact)));
    crc.word(a.leading_zeros() << 16 | b.trailing_zeros() << 8 | b.count_ones());
}
