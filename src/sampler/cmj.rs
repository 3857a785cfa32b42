//! Correlated multi-jittered samples, for any number of samples.

use super::stratified::Parts;
use super::{Sampler, hash, hash::Keys, mix, order::Order};
use fixed::types::U0F32;

/// One sample in each of `spp` cells, and at the same time one in each of `spp` columns and of `spp` rows.
///
/// Each `next_2d` divides the square into m × n cells, m·n = `spp`, of which a cell's sample has its own column
/// of 1/n of the cell's width, and its own row of 1/m of its height: so both coordinates alone are as well
/// stratified as a `next_1d`. Where in the cells the columns lie is one order for all cells of a row, and the order
/// of a row's cells is the same in all rows: "correlated", which keeps samples of neighbouring cells apart.
/// If `spp` has no divisors m ≤ 2·n ≤ 4·m, there are a few cells more than samples: rows still hold one each,
/// columns at most one. Which sample takes which cell is a hashed permutation, as all orders are, new for each draw
/// and pixel. Sample `spp` and after begin another pass; stopping in the middle of a pass is unbiased.
///
/// Above [`MAX_STRATA`](Self::MAX_STRATA) samples, a pass has that many.
///
/// Kensler, "Correlated multi-jittered sampling" (Pixar 13-01, 2013), with the permutations of `Order`.
#[derive(Clone, Debug)]
pub struct Cmj {
    seed: u32,
    shape: Shape,
    /// Place in the pass, below the number of strata.
    position: u32,
    /// Keys that all samples of this pixel and pass share: the orders.
    shared: Keys,
    /// Keys of this sample alone: its jitter.
    own: Keys,
}

/// How the square is divided: constant once made.
#[derive(Clone, Debug)]
struct Shape {
    /// The rows, as many as samples, and the parts of a `next_1d`.
    rows: Parts,
    /// All columns of all cells side by side, at least as many.
    columns: Parts,
    /// Cells beside each other.
    across: Parts,
    /// Cells above each other.
    down: u32,
    samples: Order,
    cells: Order,
    columns_in_cell: Order,
}

impl Shape {
    /// 1 ≤ `n` ≤ 2¹⁴.
    fn new(n: u32) -> Self {
        let root = n.isqrt();
        let divisor = (1..=root).rev().find(|&d| n.is_multiple_of(d)).unwrap_or(1);
        let across = if n <= 2 * divisor * divisor {
            n / divisor
        } else {
            root
        };
        let down = n.div_ceil(across.max(1));
        Self {
            rows: Parts::new(n),
            columns: Parts::new(across * down),
            across: Parts::new(across),
            down,
            samples: Order::new(n),
            cells: Order::new(across),
            columns_in_cell: Order::new(down),
        }
    }
}

impl Cmj {
    /// Strata a pass has at most: keeps every product here within 32 bits.
    pub const MAX_STRATA: u32 = 1 << 14;

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

    fn keys(&mut self) -> [u32; 2] {
        [self.shared.draw(), self.shared.draw()]
    }
}

impl Sampler for Cmj {
    fn start(&mut self, x: u16, y: u16, index: u32) {
        let (pass, position) = self.shape.rows.split(index);
        self.position = position;
        let key = hash(self.seed, x, y, pass);
        self.shared = Keys::new(key);
        self.own = Keys::new(mix(key ^ position));
    }

    fn next_1d(&mut self) -> U0F32 {
        let keys = self.keys();
        let stratum = self.shape.samples.permute(self.position, keys);
        U0F32::from_bits(self.shape.rows.place(stratum, self.own.draw()))
    }

    fn next_2d(&mut self) -> [U0F32; 2] {
        let keys = [self.keys(), self.keys(), self.keys()];
        let jitter = [self.own.draw(), self.own.draw()];
        let shape = &self.shape;
        let row = shape.samples.permute(self.position, keys[0]);
        let (of_cells, place) = shape.across.split(row);
        let cell = shape.cells.permute(place, keys[1]);
        let within = shape.columns_in_cell.permute(of_cells, keys[2]);
        let column = cell * shape.down + within;
        [
            U0F32::from_bits(shape.columns.place(column, jitter[0])),
            U0F32::from_bits(shape.rows.place(row, jitter[1])),
        ]
    }
}
