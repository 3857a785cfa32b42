//! Jittered stratified samples, for any number of samples.

use super::{Sampler, hash, hash::Keys, mix, order::Order};
use crate::num::mul_hi;
use fixed::types::U0F32;

/// One sample in each of `spp` strata, at a random place in it.
///
/// Each `next_2d` divides the square into `spp` cells of equal area, and the pixel's samples 0 to `spp` − 1
/// fall one in each: nx × ny equal cells if `spp` has divisors with ny ≤ nx ≤ 2·ny (16 = 4×4, 8 = 4×2); else
/// about √spp rows whose numbers of cells differ by at most one and whose heights are in proportion to them
/// (7 = 3+2+2). Each `next_1d` divides [0, 1) into `spp` equal parts. Which sample takes which stratum is a
/// hashed permutation, new for each dimension and pixel. Sample `spp` and after begin another pass in the
/// same way; stopping in the middle of a pass is unbiased and forfeits the strata not yet taken.
///
/// Above [`MAX_STRATA`](Self::MAX_STRATA) samples, a pass has that many.
#[derive(Clone, Debug)]
pub struct Stratified {
    seed: u32,
    shape: Shape,
    /// Place in the pass, below the number of strata.
    position: u32,
    /// Keys that all samples of this pixel and pass share: one permutation a draw.
    shared: Keys,
    /// Keys of this sample alone: its jitter.
    own: Keys,
}

impl Stratified {
    /// Strata a pass has at most: keeps every product here within 32 bits.
    pub const MAX_STRATA: u32 = 1 << 15;

    /// A sampler for `spp` samples a pixel (at least 1), at the first sample of pixel (0, 0).
    #[must_use]
    pub fn new(seed: u32, spp: u32) -> Self {
        let mut sampler = Self {
            seed,
            shape: Shape::new(spp.clamp(1, Self::MAX_STRATA)),
            position: 0,
            shared: Keys::new(0),
            own: Keys::new(0),
        };
        sampler.start(0, 0, 0);
        sampler
    }

    /// This sample's stratum in a new dimension.
    fn stratum(&mut self) -> u32 {
        let keys = [self.shared.draw(), self.shared.draw()];
        self.shape.order.permute(self.position, keys)
    }
}

impl Sampler for Stratified {
    fn start(&mut self, x: u16, y: u16, index: u32) {
        let (pass, position) = self.shape.cells.split(index);
        self.position = position;
        let key = hash(self.seed, x, y, pass);
        self.shared = Keys::new(key);
        self.own = Keys::new(mix(key ^ position));
    }

    fn next_1d(&mut self) -> U0F32 {
        let stratum = self.stratum();
        U0F32::from_bits(self.shape.cells.place(stratum, self.own.draw()))
    }

    fn next_2d(&mut self) -> [U0F32; 2] {
        let cell = self.stratum();
        let jitter = [self.own.draw(), self.own.draw()];
        self.shape.place(cell, jitter).map(U0F32::from_bits)
    }
}

/// How the square is divided: constant once made.
#[derive(Clone, Debug)]
struct Shape {
    /// All strata, of equal size.
    cells: Parts,
    order: Order,
    /// Rows with one cell more than the others come first; cells in them.
    cells_in_long_rows: u32,
    long_row: Parts,
    short_row: Parts,
}

impl Shape {
    /// Divides the square into `n` cells, 1 ≤ `n` ≤ 2¹⁵.
    fn new(n: u32) -> Self {
        let root = n.isqrt();
        let divisor = (1..=root).rev().find(|&d| n.is_multiple_of(d)).unwrap_or(1);
        // Cells at most twice as wide as high, or as many rows as make them nearly square.
        let rows = if n <= 2 * divisor * divisor {
            divisor
        } else {
            root + u32::from(n > root * (root + 1))
        };
        // Never 0, and `max` says so: division by it cannot panic.
        let rows = rows.max(1);
        let (in_short_row, long_rows) = (n / rows, n % rows);
        Self {
            cells: Parts::new(n),
            order: Order::new(n),
            cells_in_long_rows: long_rows * (in_short_row + 1),
            long_row: Parts::new(in_short_row + 1),
            short_row: Parts::new(in_short_row),
        }
    }

    /// The point of `cell` that `jitter` selects.
    fn place(&self, cell: u32, jitter: [u32; 2]) -> [u32; 2] {
        let (row, cell_of_kind) = if cell < self.cells_in_long_rows {
            (&self.long_row, cell)
        } else {
            (&self.short_row, cell - self.cells_in_long_rows)
        };
        let column = row.split(cell_of_kind).1;
        // A row is as high as its cells' share of the area.
        let height = row.count * self.cells.step - 1;
        [
            row.place(column, jitter[0]),
            self.cells.start(cell - column) + mul_hi(jitter[1], height),
        ]
    }
}

/// [0, 2³²) in `count` equal parts, 1 ≤ `count` ≤ 2¹⁵.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    count: u32,
    /// A part's length, rounded so that 2³² = count·step + r with 1 ≤ r ≤ count.
    step: u32,
    /// r/count in 2⁻¹⁶, rounded up: what `step` leaves out.
    excess: u32,
}

impl Parts {
    /// A `count` of 0 is taken as 1.
    pub(super) fn new(count: u32) -> Self {
        let count = count.max(1);
        let step = u32::MAX / count;
        let rest = u32::MAX % count + 1;
        Self {
            count,
            step,
            excess: (rest << 16).div_ceil(count),
        }
    }

    /// The first number inside part `i`, or the one after: in [b, b + 2) for the exact bound b = i·2³²/count.
    ///
    /// `excess` is less than 2⁻¹⁶ too large, so i times it less than 1/2; rounding up adds less than 1.
    const fn start(&self, i: u32) -> u32 {
        i * self.step + ((i * self.excess + 0xffff) >> 16)
    }

    /// The number of part `i` at `jitter`/2³² of its length. Never outside; the last two may be left out.
    pub(super) const fn place(&self, i: u32, jitter: u32) -> u32 {
        self.start(i) + mul_hi(jitter, self.step - 1)
    }

    /// Quotient and remainder of `x` by `count`.
    pub(super) const fn split(&self, x: u32) -> (u32, u32) {
        // `step` is at most 1 less than 2³²/count, so the estimate is at most 1 too small.
        let quotient = mul_hi(x, self.step);
        let remainder = x - quotient * self.count;
        if remainder < self.count {
            (quotient, remainder)
        } else {
            (quotient + 1, remainder - self.count)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNTS: [u32; 12] = [1, 2, 3, 4, 5, 7, 100, 181, 257, 32_749, 32_767, 32_768];

    /// Which of `count` equal parts of [0, 2³²) holds `x`.
    fn part(x: u32, count: u32) -> u32 {
        ((u64::from(x) * u64::from(count)) >> 32) as u32
    }

    #[test]
    fn a_part_holds_its_ends_and_all_but_four_between() {
        for count in COUNTS {
            let parts = Parts::new(count);
            for i in 0..count {
                let [first, last] = [0, u32::MAX].map(|jitter| parts.place(i, jitter));
                assert_eq!([part(first, count), part(last, count)], [i, i], "{i} of {count}");
                assert!(first < 2 || part(first - 2, count) != i, "{i} of {count}");
                assert!(
                    last > u32::MAX - 4 || part(last + 4, count) != i,
                    "{i} of {count}"
                );
            }
        }
    }

    #[test]
    fn split_divides() {
        for count in COUNTS {
            for x in [
                0,
                1,
                count - 1,
                count,
                2 * count - 1,
                1 << 31,
                u32::MAX - 1,
                u32::MAX,
            ] {
                assert_eq!(
                    Parts::new(count).split(x),
                    (x / count, x % count),
                    "{x} by {count}"
                );
            }
        }
    }

    #[test]
    fn cells_of_any_count_share_no_corner() {
        for count in (1..400).chain([32_749, 32_768]) {
            let shape = Shape::new(count);
            let (mut row_start, mut row_end) = (0, 0);
            for cell in 0..count {
                let width = shape.short_row.count + u32::from(cell < shape.cells_in_long_rows);
                if cell == row_end {
                    (row_start, row_end) = (cell, cell + width);
                }
                for jitter in [[0, 0], [u32::MAX, 0], [0, u32::MAX], [u32::MAX; 2]] {
                    let [x, y] = shape.place(cell, jitter);
                    assert_eq!(part(x, width), cell - row_start, "{cell} of {count}");
                    let in_row = row_start..row_end;
                    assert!(in_row.contains(&part(y, count)), "{cell} of {count}");
                }
            }
            let widest = shape.short_row.count + u32::from(shape.cells_in_long_rows > 0);
            assert!(widest * widest <= 2 * count, "{count}: {widest} wide");
        }
    }

    #[test]
    fn rows_are_as_the_docs_say() {
        for (count, long_rows, short_rows) in [
            (1, [0, 2], [1, 1]),
            (3, [1, 2], [1, 1]),
            (7, [1, 3], [2, 2]),
            (8, [0, 5], [2, 4]),
            (16, [0, 5], [4, 4]),
            (17, [1, 5], [3, 4]),
        ] {
            let shape = Shape::new(count);
            let [rows, cells] = long_rows;
            assert_eq!(
                [shape.cells_in_long_rows, shape.long_row.count],
                [rows * cells, cells]
            );
            let [rows, cells] = short_rows;
            let rest = count - shape.cells_in_long_rows;
            assert_eq!([rest, shape.short_row.count], [rows * cells, cells]);
        }
    }
}
