//! What a denoiser is told, and what it makes of it.

mod features;
mod filters;
mod golden;
mod motion;
mod network;
mod outline;
mod taa;
mod twin;

use microlux::color::{Radiance, Rgb9e5};
use microlux::film::Feature;
use microlux::film::denoise::{Before, Denoiser, Memory, Pair, ROWS, Reproject, Size};

fn value(light: Radiance) -> [f64; 3] {
    let (m, e) = light.to_parts();
    m.map(|m| f64::from(m) * f64::from(i32::from(e) - 15).exp2())
}

/// PCG, 32 bits.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u32 {
        let old = self.0;
        self.0 = old
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let word = (((old >> 18) ^ old) >> 27) as u32;
        word.rotate_right((old >> 59) as u32)
    }

    fn below(&mut self, n: u32) -> u32 {
        ((u64::from(self.bits()) * u64::from(n)) >> 32) as u32
    }
}

/// Everything was this far to the right and down, sixteenths.
struct Shift([i32; 2]);

impl Reproject for Shift {
    fn before(&self, x: u16, y: u16, depth: u8) -> Option<Before> {
        let place = [
            16 * i32::from(x) + 8 + self.0[0],
            16 * i32::from(y) + 8 + self.0[1],
        ];
        Some(Before { place, depth })
    }
}

/// Two threads.
struct Threads;

impl Pair for Threads {
    fn both(&self, one: impl FnOnce() + Send, other: impl FnOnce() + Send) {
        std::thread::scope(|scope| {
            scope.spawn(other);
            one();
        });
    }
}

/// What is second done first.
struct Backwards;

impl Pair for Backwards {
    fn both(&self, one: impl FnOnce() + Send, other: impl FnOnce() + Send) {
        other();
        one();
    }
}

/// A denoiser in memory of its own.
fn with_denoiser<R>(size: Size, spp: u32, work: impl FnOnce(&mut Denoiser) -> R) -> R {
    let count = size.pixels();
    let mut frames = [vec![Feature::default(); count], vec![Feature::default(); count]];
    let mut lengths = [vec![0; count], vec![0; count]];
    let mut rows = vec![Rgb9e5::BLACK; ROWS * usize::from(size.width)];
    let [a, b] = &mut frames;
    let [c, d] = &mut lengths;
    let memory = Memory {
        frames: [a, b],
        lengths: [c, d],
        rows: &mut rows,
    };
    work(&mut Denoiser::new(size, spp, memory).unwrap())
}
