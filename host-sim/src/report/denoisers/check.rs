//! The bars that the denoiser has, and what was measured against them.

use super::{Kind, Method, Report, Row, Summary};
use crate::report::bar::Mark;

/// A bar, and where we are.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    pub kind: Kind,
    /// What is compared with what.
    pub what: &'static str,
    pub limit: Limit,
    /// `None` where a peer is missing.
    pub value: Option<f64>,
}

/// What a value has to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// A difference in dB, so much at least.
    Above(f64),
    /// A difference of SSIM, so much at least.
    Alike(f64),
    /// A ratio, so much at most.
    Times(f64),
}

impl Check {
    pub fn mark(&self) -> Mark {
        match (self.value, self.limit) {
            (None, _) => Mark::Unjudged,
            (Some(value), Limit::Above(bar) | Limit::Alike(bar)) if value >= bar => Mark::Ok,
            (Some(value), Limit::Times(bar)) if value <= bar => Mark::Ok,
            _ => Mark::Off,
        }
    }

    pub fn bar(&self) -> String {
        match self.limit {
            Limit::Above(_) | Limit::Alike(_) => format!("≥ {}", self.limit.text()),
            Limit::Times(_) => format!("≤ {}", self.limit.text()),
        }
    }

    pub fn measured(&self) -> String {
        self.value
            .map_or("not measured".to_string(), |value| self.limit.with(value).text())
    }
}

impl Limit {
    fn with(self, value: f64) -> Limit {
        match self {
            Limit::Above(_) => Limit::Above(value),
            Limit::Alike(_) => Limit::Alike(value),
            Limit::Times(_) => Limit::Times(value),
        }
    }

    fn text(self) -> String {
        match self {
            Limit::Above(value) => format!("{value:+.2} dB"),
            Limit::Alike(value) => format!("{value:+.4}"),
            Limit::Times(value) => format!("{value:.2} ×"),
        }
    }
}

/// All bars, in the order of [`Kind::ALL`].
pub fn checks(report: &Report) -> Vec<Check> {
    let summaries = report.summaries();
    let row = |kind: Kind, method: Method| -> Option<Row> {
        let summary: &Summary = summaries.iter().find(|summary| summary.kind == kind)?;
        summary.rows.iter().copied().find(|row| row.method == method)
    };
    // Ours against one of them.
    let against = |kind, what, limit, peer: Method, compare: &dyn Fn(&Row, &Row) -> f64| Check {
        kind,
        what,
        limit,
        value: row(kind, Method::Ours)
            .zip(row(kind, peer))
            .map(|(ours, peer)| compare(&ours, &peer)),
    };
    let psnr =
        |kind, what, bar, peer| against(kind, what, Limit::Above(bar), peer, &|a, b| a.psnr_db - b.psnr_db);
    let flip = |kind, what, bar, peer| against(kind, what, Limit::Times(bar), peer, &|a, b| a.flip / b.flip);
    let ssim = |kind, what, peer| against(kind, what, Limit::Alike(0.0), peer, &|a, b| a.ssim - b.ssim);
    let flicker = |kind, what, bar, peer| {
        against(kind, what, Limit::Times(bar), peer, &|a, b| {
            a.flicker.unwrap_or(f64::NAN) / b.flicker.unwrap_or(f64::NAN)
        })
    };
    use Kind::{Double, Frame, Moving, Still};
    use Method::{Atrous, Bilateral, OidnBilinear, OidnFull, OidnHigh, OidnUpsampled};
    let uncovered = summaries
        .iter()
        .find(|summary| summary.kind == Moving)
        .and_then(|summary| summary.uncovered);
    vec![
        psnr(Frame(1), "PSNR over OIDN high", -2.2, OidnHigh),
        ssim(Frame(1), "SSIM over à-trous", Atrous),
        ssim(Frame(1), "SSIM over joint bilateral", Bilateral),
        flip(Frame(1), "FLIP of à-trous", 1.0, Atrous),
        flip(Frame(1), "FLIP of joint bilateral", 1.0, Bilateral),
        psnr(Frame(4), "PSNR over OIDN high", -1.5, OidnHigh),
        flip(Frame(4), "FLIP of OIDN high", 1.15, OidnHigh),
        psnr(Frame(4), "PSNR over à-trous", 2.0, Atrous),
        psnr(Frame(4), "PSNR over joint bilateral", 1.0, Bilateral),
        flip(Frame(4), "FLIP of à-trous", 1.0, Atrous),
        flip(Frame(4), "FLIP of joint bilateral", 1.0, Bilateral),
        psnr(Still, "PSNR over OIDN high of each frame", 0.5, OidnHigh),
        flip(Still, "FLIP of OIDN high of each frame", 0.85, OidnHigh),
        flicker(Still, "flicker of OIDN high", 1.0 / 3.0, OidnHigh),
        psnr(Moving, "PSNR over OIDN high of each frame", -0.5, OidnHigh),
        Check {
            kind: Moving,
            what: "PSNR where nothing is remembered, over no history at all",
            limit: Limit::Above(-0.3),
            value: uncovered.map(|found| found.with_history - found.without),
        },
        flicker(Moving, "flicker of OIDN high", 0.5, OidnHigh),
        psnr(Double, "PSNR over OIDN high and bilinear", 1.5, OidnBilinear),
        psnr(
            Double,
            "PSNR over OIDN high before albedo and joint bilateral upsampling",
            -0.5,
            OidnUpsampled,
        ),
        flip(Double, "FLIP of OIDN high at full size", 1.0, OidnFull),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_can_be_reached_and_missed() {
        let mark = |limit, value| {
            Check {
                kind: Kind::Still,
                what: "",
                limit,
                value,
            }
            .mark()
        };
        assert_eq!(mark(Limit::Above(-0.5), Some(-0.5)), Mark::Ok);
        assert_eq!(mark(Limit::Above(-0.5), Some(-0.51)), Mark::Off);
        assert_eq!(mark(Limit::Times(0.85), Some(0.85)), Mark::Ok);
        assert_eq!(mark(Limit::Times(0.85), Some(0.86)), Mark::Off);
        assert_eq!(mark(Limit::Times(0.85), Some(f64::NAN)), Mark::Off);
        assert_eq!(mark(Limit::Alike(0.0), Some(-1e-6)), Mark::Off);
        assert_eq!(mark(Limit::Alike(0.0), None), Mark::Unjudged);
    }

    #[test]
    fn values_are_written_as_bars_are() {
        let check = |limit, value| Check {
            kind: Kind::Double,
            what: "",
            limit,
            value,
        };
        let one = check(Limit::Above(1.5), Some(0.126));
        assert_eq!([one.bar(), one.measured()], ["≥ +1.50 dB", "+0.13 dB"]);
        let one = check(Limit::Times(1.0 / 3.0), None);
        assert_eq!([one.bar(), one.measured()], ["≤ 0.33 ×", "not measured"]);
    }
}
