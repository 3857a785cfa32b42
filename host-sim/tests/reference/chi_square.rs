//! Whether samples are as dense as their density says: Pearson's chi-square test over cells of the sphere.

use std::f64::consts::TAU;

use super::*;

const ROWS: usize = 20;
const COLUMNS: usize = 40;
/// Points a side at which a density is integrated over a cell.
const FINE: usize = 20;
const SAMPLES: usize = 40_000;

/// PCG-like numbers of the test's own (O'Neill 2014: RXS M XS 64).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x1234_5678_9abc_def1)
    }

    pub fn uniform(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        let word = ((self.0 >> ((self.0 >> 59) + 5)) ^ self.0).wrapping_mul(12605985483714917081);
        ((word >> 43 ^ word) >> 11) as f64 * 2f64.powi(-53)
    }
}

/// The poles are on the y axis, so that no lobe around z or in the plane xz is cut up there; columns begin at z = 0.
fn point(row: f64, column: f64) -> Vec3 {
    let y = 1.0 - 2.0 * row / ROWS as f64;
    let r = (1.0 - y * y).max(0.0).sqrt();
    let (sin, cos) = (column / COLUMNS as f64 * TAU).sin_cos();
    vec3(r * cos, y, r * sin)
}

fn cell(w: Vec3) -> usize {
    let row = ((1.0 - w.y) / 2.0 * ROWS as f64) as usize;
    let column = (w.z.atan2(w.x) / TAU).rem_euclid(1.0) * COLUMNS as f64;
    row.min(ROWS - 1) * COLUMNS + (column as usize).min(COLUMNS - 1)
}

/// ∫ f dω over each cell.
fn cell_integrals(f: impl Fn(Vec3) -> f64) -> Vec<f64> {
    let area = 2.0 * TAU / (ROWS * COLUMNS * FINE * FINE) as f64;
    let mut integrals = Vec::new();
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let fine = |i: usize| (i as f64 + 0.5) / FINE as f64;
            let points =
                (0..FINE * FINE).map(|i| point(row as f64 + fine(i / FINE), column as f64 + fine(i % FINE)));
            integrals.push(points.map(&f).sum::<f64>() * area);
        }
    }
    integrals
}

/// ∫ f dω over the sphere.
pub fn sphere_integral(f: impl Fn(Vec3) -> f64) -> f64 {
    cell_integrals(f).iter().sum()
}

/// Draws many samples (`None` counts as one more place to be) and compares with `pdf`.
#[track_caller]
pub fn assert_samples_follow(
    name: &str,
    pdf: impl Fn(Vec3) -> f64,
    mut sample: impl FnMut() -> Option<Vec3>,
) {
    let mut expected = cell_integrals(pdf);
    let total: f64 = expected.iter().sum();
    assert!(total < 1.0 + 2e-3, "{name}: the density integrates to {total}");
    expected.push((1.0 - total).max(0.0));
    let mut counts = vec![0u32; expected.len()];
    for _ in 0..SAMPLES {
        let place = sample().map_or(counts.len() - 1, cell);
        counts[place] += 1;
    }
    // Cells where few are expected are taken together.
    let (mut statistic, mut used) = (0.0, 0);
    let (mut few_expected, mut few_counted) = (0.0, 0.0);
    let mut add = |counted: f64, expected: f64| {
        statistic += (counted - expected).powi(2) / expected;
        used += 1;
    };
    for (&counted, share) in counts.iter().zip(expected) {
        let expected = share * SAMPLES as f64;
        if expected < 8.0 {
            few_expected += expected;
            few_counted += f64::from(counted);
        } else {
            add(f64::from(counted), expected);
        }
    }
    if few_expected >= 8.0 {
        add(few_counted, few_expected);
    } else {
        assert!(
            few_counted < 30.0,
            "{name}: {few_counted} samples where {few_expected} are expected"
        );
    }
    // Wilson and Hilferty (1931): the cube root of chi-square over its degrees of freedom is nearly normal.
    let freedom = f64::from(used - 1);
    let spread = 2.0 / (9.0 * freedom);
    let z = ((statistic / freedom).cbrt() - (1.0 - spread)) / spread.sqrt();
    assert!(
        z < 4.0,
        "{name}: chi-square {statistic:.0} of {freedom} degrees, z {z:.1}"
    );
}
