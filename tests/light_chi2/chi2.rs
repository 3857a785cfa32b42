//! Pearson's χ² over a patch of the sphere, in cells of equal solid angle.

use microlux::geom::Dir;
use microlux::num::{Uniform, Wide};

/// Cells of a patch: in 1 − cos of the angle to its axis, and around.
const ROWS: usize = 16;
const COLUMNS: usize = 32;
/// Points a side at which a cell's density is asked for.
const FINE: usize = 24;
pub const SAMPLES: usize = 200_000;

pub struct Random(pub u64);

impl Random {
    /// SplitMix64.
    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as u32
    }

    pub fn point(&mut self) -> [Uniform; 2] {
        [(); 2].map(|()| Uniform::from_bits(self.bits()))
    }
}

pub fn wide(x: Wide) -> f64 {
    f64::from(x.mantissa()) * 2f64.powi(i32::from(x.exponent()) - 15)
}

/// All directions within `angle` (radians) of `axis`.
pub struct Patch {
    s: [f64; 3],
    t: [f64; 3],
    axis: [f64; 3],
    versine: f64,
}

impl Patch {
    pub fn new(axis: [f64; 3], angle: f64) -> Patch {
        let unit = |v: [f64; 3]| {
            let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
            v.map(|c| c / length)
        };
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
        };
        let axis = unit(axis);
        let aside = if axis[0].abs() < 0.6 {
            [1.0, 0.0, 0.0]
        } else {
            [0.0, 1.0, 0.0]
        };
        let s = unit(cross(aside, axis));
        Patch {
            s,
            t: cross(axis, s),
            axis,
            versine: 1.0 - angle.cos(),
        }
    }

    /// The cell that a direction lies in; none outside.
    fn cell(&self, dir: Dir) -> Option<usize> {
        let d = dir.0.map(|c| f64::from(c) / 65536.0);
        let length = d.iter().map(|c| c * c).sum::<f64>().sqrt();
        let along = |axis: [f64; 3]| (0..3).map(|i| d[i] * axis[i]).sum::<f64>() / length;
        let away = [0, 1, 2].map(|i| d[i] / length - self.axis[i]);
        let versine = away.iter().map(|c| c * c).sum::<f64>() / 2.0;
        let row = (versine / self.versine * ROWS as f64) as usize;
        let turn = along(self.t).atan2(along(self.s)) / std::f64::consts::TAU;
        let column = (turn.rem_euclid(1.0) * COLUMNS as f64) as usize % COLUMNS;
        (row < ROWS).then_some(row * COLUMNS + column)
    }

    /// The direction at a place of the patch, both coordinates in 0 ..= 1.
    fn dir(&self, down: f64, around: f64) -> Dir {
        let versine = down * self.versine;
        let sine = (versine * (2.0 - versine)).sqrt();
        let (sin, cos) = (around * std::f64::consts::TAU).sin_cos();
        Dir([0, 1, 2].map(|i| {
            let c = sine * (cos * self.s[i] + sin * self.t[i]) + (1.0 - versine) * self.axis[i];
            (c * 65536.0).round() as i32
        }))
    }

    /// Asserts that `sample` draws by `pdf`: each cell of the patch, and what is outside together. A density may be
    /// known a little wrong only where `edges` says, a share of all samples: at edges, where it jumps.
    pub fn assert(
        &self,
        what: &str,
        edges: f64,
        mut sample: impl FnMut([Uniform; 2]) -> Option<(Dir, Wide)>,
        mut pdf: impl FnMut(Dir) -> Wide,
    ) {
        let mut random = Random(7);
        // One more cell for what is outside, one for what is not drawn at all.
        let mut found = vec![0.0; ROWS * COLUMNS + 1];
        let mut apart = 0;
        for _ in 0..SAMPLES {
            let Some((dir, said)) = sample(random.point()) else {
                *found.last_mut().unwrap() += 1.0;
                continue;
            };
            assert!(!said.is_zero(), "{what}: {dir:?} has no density");
            let ratio = wide(pdf(dir)) / wide(said);
            apart += usize::from(!(0.998..1.002).contains(&ratio));
            found[self.cell(dir).unwrap_or(ROWS * COLUMNS)] += 1.0;
        }
        let apart = apart as f64 / SAMPLES as f64;
        let solid_angle = std::f64::consts::TAU * self.versine / (ROWS * COLUMNS) as f64;
        let mut mean = |cell: usize| {
            let mut sum = 0.0;
            for point in 0..FINE * FINE {
                // One point somewhere in each of a grid: what jumps is not met at the same places all along.
                let [x, y] = random.point().map(|u| u.to_num::<f64>());
                let down = (cell / COLUMNS) as f64 + ((point / FINE) as f64 + x) / FINE as f64;
                let around = (cell % COLUMNS) as f64 + ((point % FINE) as f64 + y) / FINE as f64;
                sum += wide(pdf(self.dir(down / ROWS as f64, around / COLUMNS as f64)));
            }
            sum / (FINE * FINE) as f64
        };
        let mut expected: Vec<f64> = (0..ROWS * COLUMNS)
            .map(|cell| mean(cell) * solid_angle * SAMPLES as f64)
            .collect();
        let inside: f64 = expected.iter().sum();
        expected.push(SAMPLES as f64 - inside);
        println!(
            "{what}: density adds up to {:.4} here, {apart:.5} apart",
            inside / SAMPLES as f64
        );
        assert!(
            apart <= edges,
            "{what}: {apart} of all densities differ from what was said"
        );
        assert!(
            inside < 1.004 * SAMPLES as f64,
            "{what}: densities add up to {}",
            inside / SAMPLES as f64
        );
        assert_chi2(what, &found, &expected);
    }
}

/// Asserts that counts are what chance makes of `expected`; few to be expected are taken together.
pub fn assert_chi2(what: &str, found: &[f64], expected: &[f64]) {
    let (mut chi2, mut freedom) = (0.0, -1.0);
    let (mut rest_found, mut rest_expected) = (0.0, 0.0);
    for (found, expected) in found.iter().zip(expected) {
        if *expected < 20.0 {
            rest_found += found;
            rest_expected += expected;
            continue;
        }
        chi2 += (found - expected).powi(2) / expected;
        freedom += 1.0;
    }
    // What was hardly to be expected at all: a share of the cells that chance or an edge explains.
    assert!(
        rest_found < rest_expected.max(0.0) + 6.0 * rest_expected.max(0.0).sqrt() + 1e-3 * SAMPLES as f64,
        "{what}: {rest_found} where {rest_expected} were expected"
    );
    if freedom < 1.0 {
        return;
    }
    // Wilson and Hilferty, 1931: the cube root of χ² over its freedom is all but normal.
    let spread = 2.0 / (9.0 * freedom);
    let z = ((chi2 / freedom).cbrt() - (1.0 - spread)) / spread.sqrt();
    println!("{what}: chi2 {chi2:.0} of {freedom}, {z:+.2} standard deviations");
    assert!(
        z < 4.0,
        "{what}: chi2 {chi2:.1} of {freedom}: {z} standard deviations"
    );
}
