//! Percentiles, by two definitions that differ in small samples.

/// The tail of a set of errors: each the smallest one that at least that share of the set does not exceed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Percentiles {
    pub count: usize,
    pub p50: f64,
    pub p90: f64,
    pub p99: f64,
    pub p999: f64,
    pub p9999: f64,
    pub max: f64,
}

impl Percentiles {
    /// Zero throughout for an empty set. Sorts in place.
    pub fn of(errors: &mut [f64]) -> Percentiles {
        errors.sort_by(f64::total_cmp);
        // The smallest rank with rank / count >= of / 10_000, in integers, so that no rounding moves it.
        let at = |of: usize| {
            let rank = (of * errors.len()).div_ceil(10_000).max(1);
            errors.get(rank - 1).copied().unwrap_or(0.0)
        };
        Percentiles {
            count: errors.len(),
            p50: at(5_000),
            p90: at(9_000),
            p99: at(9_900),
            p999: at(9_990),
            p9999: at(9_999),
            max: at(10_000),
        }
    }
}

/// Linear between the two nearest ranks (numpy's default; Hyndman and Fan's definition 7); 0 for an empty set.
pub fn interpolated(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return 0.0;
    };
    let place = share * last as f64;
    let (low, high) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
    low + (high - low) * place.fract()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_bad_ray_in_ten_thousand_is_allowed_two_are_not() {
        let mut errors = vec![0.0; 10_000];
        errors[17] = 1.0;
        let tail = Percentiles::of(&mut errors.clone());
        assert_eq!((tail.count, tail.p9999, tail.max), (10_000, 0.0, 1.0));
        errors[18] = 1.0;
        assert_eq!(Percentiles::of(&mut errors).p9999, 1.0);
    }

    #[test]
    fn ranks_of_a_hundred() {
        let mut errors: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        let tail = Percentiles::of(&mut errors);
        assert_eq!(
            [tail.p50, tail.p90, tail.p99, tail.p999, tail.max],
            [50.0, 90.0, 99.0, 100.0, 100.0]
        );
        assert_eq!(Percentiles::of(&mut []), Percentiles::default());
    }

    #[test]
    fn interpolation_is_numpys() {
        // numpy.percentile([1, 2, 4, 8], 95) = 7.4
        assert!((interpolated(&[1.0, 2.0, 4.0, 8.0], 0.95) - 7.4).abs() < 1e-12);
        assert_eq!(interpolated(&[3.0], 0.95), 3.0);
        assert_eq!(interpolated(&[], 0.95), 0.0);
    }
}
