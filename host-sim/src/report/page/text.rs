//! Numbers as the page writes them.

use crate::report::{Estimate, bar};

/// Signed, in percent: `+0.012 %`; fewer digits where the number is large.
pub fn percent(share: f64) -> String {
    let value = 100.0 * share;
    let decimals = match value.abs() {
        x if x < 1.0 => 3,
        x if x < 10.0 => 2,
        x if x < 1000.0 => 1,
        _ => 0,
    };
    let text = format!("{value:+.decimals$} %");
    text.replace('-', "−")
}

/// Without a sign: `0.0034 %`, and `0` for none.
pub fn share(share: f64) -> String {
    match share {
        0.0 => "0".to_string(),
        small if small.abs() < 1e-6 => format!("{:.0e} %", 100.0 * small),
        _ => format!("{:.4} %", 100.0 * share),
    }
}

/// `+0.012 % ± 0.034`.
pub fn with_error(estimate: Estimate) -> String {
    let error = percent(estimate.standard_error);
    format!(
        "{} ± {}",
        percent(estimate.value),
        error.trim_start_matches('+').trim_end_matches(" %")
    )
}

/// `1.2e-5`.
pub fn scientific(value: f64) -> String {
    if value == 0.0 {
        "0".to_string()
    } else {
        format!("{value:.1e}").replace('-', "−")
    }
}

/// Three significant digits, plain.
pub fn plain(value: f64) -> String {
    if value == 0.0 {
        return "0".to_string();
    }
    let before = value.abs().log10().floor() as i32;
    let decimals = (2 - before).clamp(0, 7) as usize;
    format!("{value:.decimals$}")
}

/// `n^−0.50`, without the n.
pub fn exponent(slope: f64) -> String {
    format!("{slope:.2}").replace('-', "−")
}

/// A dot on a scale of twice the bar to each side, with two standard errors to each side of it; the bar is shaded.
pub fn whisker(estimate: Estimate) -> String {
    const HALF: f64 = 40.0;
    let place = |share: f64| (share / bar::BIAS / 2.0 * HALF).clamp(-HALF, HALF);
    let (at, error) = (estimate.value, 2.0 * estimate.standard_error);
    format!(
        r#"<svg class="whisker" viewBox="-44 -7 88 14" aria-hidden="true"><rect x="-20" y="-7" width="40" height="14"/><path d="M0 -7V7"/><line x1="{:.1}" x2="{:.1}" y1="0" y2="0"/><circle cx="{:.1}" cy="0" r="3"/></svg>"#,
        place(at - error),
        place(at + error),
        place(at)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_matter() {
        assert_eq!(
            [0.000_123, -0.0123, 0.5, -12.0].map(percent),
            ["+0.012 %", "−1.23 %", "+50.0 %", "−1200 %"]
        );
        assert_eq!([0.0, 3.4e-5, 2e-8].map(share), ["0", "0.0034 %", "2e-6 %"]);
        assert_eq!([0.0, 1.24e-5].map(scientific), ["0", "1.2e−5"]);
        assert_eq!(
            [0.0, 0.012_34, 1.5, 1234.0].map(plain),
            ["0", "0.0123", "1.50", "1234"]
        );
        assert_eq!(exponent(-0.503), "−0.50");
    }

    #[test]
    fn errors_stand_beside_their_value() {
        let estimate = Estimate {
            value: -0.0012,
            standard_error: 0.0005,
        };
        assert_eq!(with_error(estimate), "−0.120 % ± 0.050");
    }

    #[test]
    fn whiskers_stay_on_their_scale() {
        let far = whisker(Estimate {
            value: 3.0,
            standard_error: 9.0,
        });
        assert!(
            far.contains(r#"x1="-40.0" x2="40.0""#) && far.contains(r#"cx="40.0""#),
            "{far}"
        );
        let at_the_bar = whisker(Estimate {
            value: -0.005,
            standard_error: 0.0,
        });
        assert!(at_the_bar.contains(r#"cx="-20.0""#), "{at_the_bar}");
    }
}
