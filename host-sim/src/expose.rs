//! A whole picture that every thread adds to.

use std::sync::atomic::{AtomicU64, Ordering};

use microlux::color::Radiance;
use microlux::film::Exposure;
use microlux::integrator::SplatSink;

/// The sums of [`Exposure`], shared: integers, so that the order in which threads add cannot change a bit.
pub struct SharedExposure {
    width: u16,
    sums: Vec<[AtomicU64; 3]>,
}

impl SharedExposure {
    pub fn new(width: u16, height: u16) -> SharedExposure {
        let count = usize::from(width) * usize::from(height);
        let zero = || [const { AtomicU64::new(0) }; 3];
        SharedExposure {
            width,
            sums: std::iter::repeat_with(zero).take(count).collect(),
        }
    }

    /// The means over `spp` samples of every pixel, of `count` pixels from number `from` on.
    pub fn means(&self, from: usize, count: usize, spp: u32) -> Vec<Radiance> {
        let part = self.sums.iter().skip(from).take(count);
        let mut sums: Vec<[u64; 3]> = part
            .map(|sum| sum.each_ref().map(|c| c.load(Ordering::Relaxed)))
            .collect();
        let width = sums.len().min(usize::from(self.width));
        let height = sums.len().checked_div(width).unwrap_or(0);
        let mut strip = vec![Radiance::BLACK; sums.len()];
        if let Some(exposure) = Exposure::new(width as u16, height as u16, &mut sums) {
            exposure.rows(0, spp, &mut strip);
        }
        strip
    }
}

impl SplatSink for &SharedExposure {
    const EXISTS: bool = true;

    fn add(&mut self, x: u16, y: u16, light: Radiance) {
        let place = usize::from(y) * usize::from(self.width) + usize::from(x);
        if let Some(sum) = self.sums.get(place).filter(|_| x < self.width) {
            for (channel, more) in sum.iter().zip(light.to_q32()) {
                // As `Exposure` adds: a sum stays at the largest.
                let add = |sum: u64| Some(sum.saturating_add(more));
                let _ = channel.fetch_update(Ordering::Relaxed, Ordering::Relaxed, add);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_add_what_one_adds() {
        let shared = SharedExposure::new(3, 2);
        let mut sums = [[0; 3]; 6];
        let mut alone = Exposure::new(3, 2, &mut sums).unwrap();
        let splats: Vec<(u16, u16, Radiance)> = (0..600u16)
            .map(|i| {
                (
                    i % 4,
                    i / 7 % 3,
                    Radiance::from_bits([i.into(), 77, 5 * u32::from(i)], i32::from(i % 9) - 4),
                )
            })
            .collect();
        for (x, y, light) in &splats {
            alone.add(*x, *y, *light);
        }
        std::thread::scope(|scope| {
            for part in splats.chunks(150).rev() {
                let mut shared = &shared;
                scope.spawn(move || part.iter().for_each(|(x, y, light)| shared.add(*x, *y, *light)));
            }
        });
        let mut strip = [Radiance::BLACK; 6];
        alone.rows(0, 5, &mut strip);
        assert_eq!(shared.means(0, 6, 5), strip);
        assert_eq!(shared.means(3, 3, 5), strip[3..]);
        assert!(strip.iter().all(|pixel| !pixel.is_black()));
    }
}
