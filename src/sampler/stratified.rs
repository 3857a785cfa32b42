//! Jittered stratified samples, for any number of samples.

use super::{Sampler, hash, hash::Keys, mix, order::Order};
use fixed::types::U0F32;

/// One sample in each of `spp` strata, at a random place in it.
///
/// Each `next_2d` divides the square into `spp` cells of equal area, and the pixel's samples 0 to `spp` − 1 fall one in
/// each: nx × ny equal cells if `spp` has divisors with ny ≤ nx ≤ 2·ny (16 = 4×4, 8 = 4×2); else about √spp rows whose
/// numbers of cells differ by at most one and whose heights are in proportion to them (7 = 3+2+2). Each `next_1d`
/// divides [0, 1) into `spp` equal parts. Which sample takes which stratum is a hashed permutation, new for each
/// dimension and pixel. Sample `spp` and after begin another pass in the same way; stopping in the middle of a pass is
/// unbiased and forfeits the strata not yet taken.
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
        let divisor = (1..=root).rev().find(|&d| n % d == 0).unwrap_or(1);
        // Cells at most twice as wide as high, or as many rows as make them nearly square.
        let rows = if n <= 2 * divisor * divisor {
            divisor
        } else {
            root + u32::from(n > root * (root + 1))
        };
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
            self.cells.start(cell - column) + scale(jitter[1], height),
        ]
    }
}

/// [0, 2³²) in `count` equal parts, 1 ≤ `count` ≤ 2¹⁵.
#[derive(Clone, Debug)]
struct Parts {
    count: u32,
    /// A part's length, rounded so that 2³² = count·step + r with 1 ≤ r ≤ count.
    step: u32,
    /// r/count in 2⁻¹⁶, rounded up: what `step` leaves out.
    excess: u32,
}

impl Parts {
    const fn new(count: u32) -> Self {
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
    const fn place(&self, i: u32, jitter: u32) -> u32 {
        self.start(i) + scale(jitter, self.step - 1)
    }

    /// Quotient and remainder of `x` by `count`.
    const fn split(&self, x: u32) -> (u32, u32) {
        // Too small by at most 4: one for `step`, three for `scale`.
        let mut quotient = scale(x, self.step);
        let mut remainder = x - quotient * self.count;
        while remainder >= self.count {
            quotient += 1;
            remainder -= self.count;
        }
        (quotient, remainder)
    }
}

/// a·b/2³² by 32-bit products: error in (−3, 0], never negative.
const fn scale(a: u32, b: u32) -> u32 {
    let [ah, al] = [a >> 16, a & 0xffff];
    let [bh, bl] = [b >> 16, b & 0xffff];
    ah * bh + (ah * bl >> 16) + (al * bh >> 16)
}
