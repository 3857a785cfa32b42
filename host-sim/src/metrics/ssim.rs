//! Structural similarity.

/// Side of the window, pixels, and the standard deviation of its Gaussian.
const WINDOW: usize = 11;
const SIGMA: f64 = 1.5;
/// (0.01 L)² and (0.03 L)², with L = 1.
const STABLE: [f64; 2] = [1e-4, 9e-4];

/// The mean of all windows within the picture; a picture that is smaller has smaller windows.
///
/// Wang, Bovik, Sheikh, Simoncelli, "Image quality assessment: from error visibility to structural similarity", 2004.
/// (`image-compare` 0.5 has blocks of 8 × 8 side by side instead, which see less than overlapping windows do.)
pub fn mean(a: &[f64], b: &[f64], width: usize) -> f64 {
    let height = a.len() / width.max(1);
    let [across, down] = [width, height].map(|side| (WINDOW.min(side).max(1) - 1) / 2);
    let tap = |from: usize, to: usize| (-(from.abs_diff(to).pow(2) as f64) / (2.0 * SIGMA * SIGMA)).exp();
    let (mut total, mut count) = (0.0, 0usize);
    for y in down..height.saturating_sub(down) {
        for x in across..width.saturating_sub(across) {
            let (mut weight, mut sums) = (0.0, [0.0; 5]);
            for row in y - down..=y + down {
                for column in x - across..=x + across {
                    let at = row * width + column;
                    let (tap, p, q) = (tap(x, column) * tap(y, row), a[at], b[at]);
                    weight += tap;
                    for (sum, value) in sums.iter_mut().zip([p, q, p * p, q * q, p * q]) {
                        *sum += tap * value;
                    }
                }
            }
            let [p, q, pp, qq, pq] = sums.map(|sum| sum / weight);
            let [c1, c2] = STABLE;
            total += (2.0 * p * q + c1) * (2.0 * (pq - p * q) + c2)
                / ((p * p + q * q + c1) * (pp - p * p + qq - q * q + c2));
            count += 1;
        }
    }
    total / count.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checks(width: usize, height: usize, low: f64, high: f64) -> Vec<f64> {
        let value = |i: usize| {
            if (i % width + i / width).is_multiple_of(2) {
                low
            } else {
                high
            }
        };
        (0..width * height).map(value).collect()
    }

    #[test]
    fn structure_counts_more_than_light() {
        let picture = checks(24, 16, 0.4, 0.6);
        let (brighter, flat) = (checks(24, 16, 0.45, 0.65), vec![0.5; 24 * 16]);
        let inverted = checks(24, 16, 0.6, 0.4);
        let of = |other: &[f64]| mean(&picture, other, 24);
        assert!((of(&picture) - 1.0).abs() < 1e-12);
        // Of means 0.5 and 0.55 alone: (2 · 0.275 + c) / (0.25 + 0.3025 + c).
        assert!(
            (of(&brighter) - 0.5501 / 0.5526).abs() < 1e-3,
            "{}",
            of(&brighter)
        );
        assert!(
            of(&flat) < 0.1 && of(&inverted) < -0.8,
            "{} {}",
            of(&flat),
            of(&inverted)
        );
    }

    #[test]
    fn a_picture_smaller_than_a_window_is_one() {
        for (width, height) in [(1, 1), (3, 20), (8, 8), (10, 2)] {
            let picture = checks(width, height, 0.2, 0.8);
            let other = checks(width, height, 0.8, 0.2);
            assert!((mean(&picture, &picture, width) - 1.0).abs() < 1e-12);
            assert!(mean(&picture, &other, width) < 0.5, "{width} x {height}");
        }
    }
}
