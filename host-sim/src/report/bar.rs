//! The bars the project sets itself, and what a measured value is against one.

use super::stat::Estimate;

/// |bias| of the mean light, as a share.
pub const BIAS: f64 = 0.005;
/// Share of primary rays that hit on one side alone.
pub const HIT_MISS: f64 = 1e-3;
/// 99th percentile of the hit points' error, share of the extent.
pub const HIT_P99: f64 = 1e-3;
/// 99.99th percentile of the hit points' error away from silhouettes, share of the extent.
pub const HIT_P9999: f64 = 1e-2;
/// Standard errors that a value must be beyond its bar before that is said to be no chance: one in 700 for a bell
/// curve, more often for the few renders that the error is known by.
pub const SURE: f64 = 3.0;

/// What a value is against its bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mark {
    /// Within.
    Ok,
    /// Beyond, but chance may do that: more samples would tell.
    Noise,
    /// Beyond.
    Off,
    /// Not judged.
    Unjudged,
}

impl Mark {
    /// A value without noise.
    pub fn of(value: f64, bar: f64) -> Mark {
        if value.abs() <= bar { Mark::Ok } else { Mark::Off }
    }

    /// A value with noise.
    pub fn of_estimate(estimate: Estimate, bar: f64) -> Mark {
        let beyond = estimate.value.abs() - bar;
        if beyond <= 0.0 {
            Mark::Ok
        } else if beyond <= SURE * estimate.standard_error {
            Mark::Noise
        } else {
            Mark::Off
        }
    }

    /// As JSON and style sheet say it.
    pub fn name(self) -> &'static str {
        match self {
            Mark::Ok => "ok",
            Mark::Noise => "noise",
            Mark::Off => "off",
            Mark::Unjudged => "unjudged",
        }
    }

    pub fn sign(self) -> &'static str {
        match self {
            Mark::Ok => "✓",
            Mark::Noise => "≈",
            Mark::Off => "✗",
            Mark::Unjudged => "",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_no_fault_and_no_excuse() {
        let mark = |value, standard_error| {
            let estimate = Estimate {
                value,
                standard_error,
            };
            Mark::of_estimate(estimate, BIAS)
        };
        assert_eq!(mark(-0.004, 0.01), Mark::Ok);
        assert_eq!(mark(-0.008, 0.002), Mark::Noise);
        assert_eq!(mark(-0.008, 0.0005), Mark::Off);
        assert_eq!(mark(0.9, 0.0), Mark::Off);
    }

    #[test]
    fn a_bar_can_be_reached() {
        assert_eq!(
            [Mark::of(HIT_P99, HIT_P99), Mark::of(1.1e-3, HIT_P99)],
            [Mark::Ok, Mark::Off]
        );
        assert_eq!(Mark::of(f64::NAN, 1.0), Mark::Off);
    }
}
