//! How far many renders are, as one.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::{BATCHES, Request, Subject};
use crate::run::Progress;

/// A sample of the f64 reference takes as long as this many of fixed point, about.
const REFERENCE: usize = 4;
/// The comparison of primary rays, in samples, about.
const PRIMARY: usize = 500_000;

/// Work in units of fixed-point samples.
pub struct Work<'a> {
    out: &'a dyn Progress,
    total: usize,
    done: AtomicUsize,
}

impl<'a> Work<'a> {
    pub fn new(request: &Request, groups: usize, out: &'a dyn Progress) -> Work<'a> {
        let scenes = request.scenes.iter();
        Work::of(
            scenes.map(|subject| of_scene(request, subject, groups)).sum(),
            out,
        )
    }

    /// So many samples.
    pub fn of(total: usize, out: &'a dyn Progress) -> Work<'a> {
        Work {
            out,
            total,
            done: AtomicUsize::new(0),
        }
    }

    /// Counts so many more as done.
    pub fn add(&self, size: usize) {
        let done = self.done.fetch_add(size, Ordering::Relaxed) + size;
        self.out.advance(done, self.total, 0);
    }

    /// A piece of the work; it counts as done when it is dropped.
    pub fn part(&self, size: usize) -> Part<'_> {
        Part { work: self, size }
    }

    pub fn fixed(&self, subject: &Subject, spp: u32) -> Part<'_> {
        self.part(samples(subject, spp))
    }

    pub fn reference(&self, subject: &Subject, spp: u32) -> Part<'_> {
        self.part(REFERENCE * samples(subject, spp))
    }

    pub fn primary(&self) -> Part<'_> {
        self.part(PRIMARY)
    }

    /// Counts a scene of which `began` was done before as done, whatever was left out of it.
    pub fn skip_rest(&self, request: &Request, subject: &Subject, groups: usize, began: usize) {
        self.skip_to(began + of_scene(request, subject, groups));
    }

    /// Counts all up to here as done.
    pub fn skip_to(&self, done: usize) {
        self.done.store(done, Ordering::Relaxed);
        self.out.advance(done, self.total, 0);
    }

    pub fn done(&self) -> usize {
        self.done.load(Ordering::Relaxed)
    }
}

/// Numbers of samples at which the error is looked at: powers of two up to the last, which is asked for.
pub fn levels(spp: u32) -> Vec<u32> {
    let powers = (0..).map(|i| 1 << i).take_while(|&n| n < spp);
    powers.chain([spp]).collect()
}

fn samples(subject: &Subject, spp: u32) -> usize {
    let options = &subject.options;
    options.width as usize * options.height as usize * spp as usize
}

fn of_scene(request: &Request, subject: &Subject, groups: usize) -> usize {
    let of_cell: u32 = levels(request.spp).iter().sum();
    let of_integrator = of_cell * request.samplers.len() as u32 + BATCHES * request.batch_spp();
    let fixed = samples(subject, of_integrator) * request.integrators.len();
    PRIMARY + fixed + groups * 2 * REFERENCE * samples(subject, request.reference_spp)
}

pub struct Part<'a> {
    work: &'a Work<'a>,
    size: usize,
}

impl Progress for Part<'_> {
    fn advance(&self, done: usize, total: usize, _rays: u64) {
        let share = self.size * done / total.max(1);
        self.work
            .out
            .advance(self.work.done() + share, self.work.total, 0);
    }
}

impl Drop for Part<'_> {
    fn drop(&mut self) {
        self.work.done.fetch_add(self.size, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn levels_end_with_what_is_asked_for() {
        assert_eq!(levels(1), [1]);
        assert_eq!(levels(16), [1, 2, 4, 8, 16]);
        assert_eq!(levels(12), [1, 2, 4, 8, 12]);
    }

    struct Heard(Mutex<Vec<(usize, usize)>>);

    impl Progress for Heard {
        fn advance(&self, done: usize, total: usize, _rays: u64) {
            self.0.lock().unwrap().push((done, total));
        }
    }

    #[test]
    fn parts_add_up() {
        let heard = Heard(Mutex::new(Vec::new()));
        let work = Work {
            out: &heard,
            total: 100,
            done: AtomicUsize::new(0),
        };
        for size in [40, 60] {
            let part = work.part(size);
            part.advance(1, 2, 0);
            part.advance(2, 2, 0);
        }
        assert_eq!(
            *heard.0.lock().unwrap(),
            [(20, 100), (40, 100), (70, 100), (100, 100)]
        );
    }
}
