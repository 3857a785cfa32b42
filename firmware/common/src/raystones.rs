//! The picture of the example `raystones`.

#[path = "../../../examples/raystones/trace/mod.rs"]
mod trace;

use trace::scene::{HEIGHT, WIDTH};

use microlux::num::Crc;

pub const PIXELS: u32 = (WIDTH * HEIGHT) as u32;

/// CRC-32 of the picture, three bytes a pixel, row by row.
pub fn run() -> u32 {
    let mut crc = Crc::new();
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            crc.bytes(&trace::pixel(x, y));
        }
    }
    crc.value()
}
