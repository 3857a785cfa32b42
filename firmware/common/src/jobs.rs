//! The list that every target runs and prints, one line each: `name crc32=xxxxxxxx`.

use crate::{crc::Crc, edges, flags, random::Xorshift, tile};

/// A piece of work with one fingerprint, the same on every target.
pub struct Job {
    pub name: &'static str,
    pub run: fn() -> u32,
}

/// Jobs about the arithmetic and the memory of the machine, then the picture.
const OWN: &[Job] = &[
    Job {
        name: "edges",
        run: edges::run,
    },
    Job {
        name: "fill",
        run: fill,
    },
    Job {
        name: "picture",
        run: tile::picture,
    },
];

/// Every job, in the order in which they run. A job's place in it is also its [`crate::region`].
pub fn all() -> impl Iterator<Item = &'static Job> {
    OWN.iter().chain(flags::JOBS)
}

/// 4 KiB of random bytes, written and read back in three widths.
fn fill() -> u32 {
    let mut words = [0; 1024];
    let mut random = Xorshift::new(0x1234_5678);
    words.fill_with(|| random.u32());
    for i in 0..words.len() {
        let other = words[words[i] as usize % words.len()];
        words[i] = words[i].wrapping_mul(other | 1).rotate_left(other >> 27);
    }
    let mut crc = Crc::new();
    for pair in words.chunks_exact(2) {
        let halves = [pair[0] as u16, (pair[1] >> 16) as u16];
        crc.word(pair[0]);
        crc.bytes(&halves[0].to_be_bytes());
        crc.bytes(&halves[1].to_le_bytes());
        crc.bytes(&[pair[1] as u8]);
    }
    crc.value()
}
