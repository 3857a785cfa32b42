//! The table at the top: a line a scene.

use super::data_uri::data_uri;
use super::judged::Judged;
use super::{anchor, text};
use crate::report::{Estimate, Mark, Measured, Report, SceneReport, Trial, primary_marks};

/// A line of the overview.
pub struct Row {
    pub anchor: String,
    pub name: String,
    pub face: String,
    /// Instead of all that follows.
    pub skipped: String,
    /// For each integrator.
    pub biases: Vec<Judged>,
    pub elsewhere: Judged,
    pub primary: Vec<Judged>,
}

impl Row {
    pub fn new(report: &Report, i: usize, found: &SceneReport) -> Row {
        let mut row = Row {
            anchor: anchor(i),
            name: found.name.clone(),
            face: String::new(),
            skipped: String::new(),
            biases: Vec::new(),
            elsewhere: Judged::none("no picture by Mitsuba"),
            primary: Vec::new(),
        };
        match &found.outcome {
            Err(reason) => row.skipped = reason.clone(),
            Ok(measured) => {
                row.face = measured.face().map(data_uri).unwrap_or_default();
                row.biases = report
                    .integrators
                    .iter()
                    .map(|name| bias_of(measured, name))
                    .collect();
                row.elsewhere = worst_against(measured);
                row.primary = primary(measured);
            }
        }
        row
    }
}

fn bias_of(measured: &Measured, integrator: &str) -> Judged {
    let Some((_, trial)) = measured
        .trials()
        .find(|(_, trial)| trial.integrator == integrator)
    else {
        return Judged::none("");
    };
    match &trial.outcome {
        Err(reason) => Judged::none(reason),
        Ok(tried) => Judged::bias(trial.bias_mark(), tried.bias, trial.caveat.unwrap_or_default()),
    }
}

/// The bias against the picture made elsewhere of the integrator that fares worst.
fn worst_against(measured: &Measured) -> Judged {
    let badness = |mark: Mark| {
        [Mark::Unjudged, Mark::Ok, Mark::Noise, Mark::Off]
            .iter()
            .position(|&m| m == mark)
    };
    let compared = measured.trials().filter_map(|(_, trial)| {
        let against = trial.tried()?.against.as_ref()?;
        Some((trial, against.bias?))
    });
    let far = |trial: &Trial, bias: Estimate| (badness(trial.against_mark()), bias.value.abs());
    let worst = compared.max_by(|a, b| {
        let (a, b) = (far(a.0, a.1), far(b.0, b.1));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    match worst {
        Some((trial, bias)) => Judged::bias(
            trial.against_mark(),
            Some(bias),
            &format!("by {}", trial.integrator),
        ),
        None => Judged::none(
            measured
                .elsewhere_left_out
                .as_deref()
                .unwrap_or("no picture by Mitsuba"),
        ),
    }
}

fn primary(measured: &Measured) -> Vec<Judged> {
    let report = &measured.primary;
    let texts = [
        text::share(report.hit_miss_disagreement),
        text::scientific(report.hit_point_error.p99),
        text::scientific(report.hit_point_error_away.p9999),
    ];
    let marks = primary_marks(report);
    marks
        .into_iter()
        .zip(texts)
        .map(|(mark, text)| Judged::plain(mark, text))
        .collect()
}
