//! Jittered strata for the first few decisions of each path of a pixel (Cook, Porter and Carpenter, 1984).

use super::rng::Rng;

/// One jittered grid of pairs a slot, in random order, so that the slots are independent of each other.
pub struct Strata {
    slots: Vec<Vec<[f64; 2]>>,
    columns: usize,
}

impl Strata {
    pub fn new(slots: usize, samples: usize) -> Strata {
        let columns = (1..)
            .take_while(|c| c * c <= samples)
            .filter(|c| samples.is_multiple_of(*c))
            .last();
        Strata {
            slots: vec![vec![[0.0; 2]; samples]; slots],
            columns: columns.unwrap_or(1),
        }
    }

    /// New points in every slot: as many cells as samples, one point in each.
    pub fn refill(&mut self, rng: &mut Rng) {
        for points in &mut self.slots {
            let rows = points.len() / self.columns;
            for (cell, point) in points.iter_mut().enumerate() {
                *point = [
                    jitter(cell % self.columns, self.columns, rng),
                    jitter(cell / self.columns, rows, rng),
                ];
            }
            for last in (1..points.len()).rev() {
                points.swap(last, rng.below(last + 1));
            }
        }
    }
}

fn jitter(cell: usize, cells: usize, rng: &mut Rng) -> f64 {
    // The sum may round up to `cells`.
    ((cell as f64 + rng.uniform()) / cells as f64).min(1.0 - f64::EPSILON / 2.0)
}

/// The numbers of one path.
pub struct Sampler<'a> {
    pub rng: &'a mut Rng,
    strata: &'a Strata,
    sample: usize,
}

impl<'a> Sampler<'a> {
    pub fn new(rng: &'a mut Rng, strata: &'a Strata, sample: usize) -> Sampler<'a> {
        Sampler { rng, strata, sample }
    }

    /// The pair of a slot; each slot may be asked for once a path. Plain random beyond the slots there are.
    pub fn slot(&mut self, slot: usize) -> [f64; 2] {
        match self.strata.slots.get(slot) {
            Some(points) => points[self.sample],
            None => self.rng.pair(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_holds_one_point() {
        for (samples, columns) in [(12, 3), (7, 1), (64, 8)] {
            let mut strata = Strata::new(2, samples);
            strata.refill(&mut Rng::new(1, 2));
            let rows = samples / columns;
            for points in &strata.slots {
                let mut counts = vec![0; samples];
                for [u, v] in points {
                    counts[(v * rows as f64) as usize * columns + (u * columns as f64) as usize] += 1;
                }
                assert_eq!(counts, vec![1; samples]);
            }
        }
    }
}
