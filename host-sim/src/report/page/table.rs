//! The tables of a scene.

use super::judged::Judged;
use super::text;
use crate::cli::table::{grouped, short};
use crate::report::{Against, Group, Mark, Measured, Measurement, Report, Tried};

/// A line of the table of numbers.
pub struct Numbers {
    pub name: String,
    pub bias: Judged,
    pub metrics: [String; 4],
    pub elsewhere: Judged,
    pub elsewhere_flip: String,
    pub rays: String,
    pub rays_per_sample: String,
    pub ram: String,
}

pub struct SamplerRow {
    pub colour: usize,
    pub name: String,
    pub cells: Vec<SamplerCell>,
}

pub struct SamplerCell {
    pub rmse: String,
    /// Beside the worst of its column.
    pub share: String,
    /// Percent of a bar behind the number.
    pub fill: u32,
    pub hint: String,
}

pub struct HitRow {
    pub colour: usize,
    pub name: &'static str,
    pub rays: String,
    pub cells: Vec<Judged>,
}

pub fn numbers(group: &Group, report: &Report) -> Vec<Numbers> {
    let mut lines = Vec::new();
    let flip =
        |against: Option<&Against>| against.map_or("–".to_string(), |a| format!("{:.4}", a.metrics.flip));
    for trial in &group.trials {
        let Ok(tried) = &trial.outcome else { continue };
        let main = tried.cells.iter().find(|cell| cell.sampler == tried.sampler);
        let measurement = main.and_then(|cell| cell.outcome.as_ref().ok());
        let metrics = measurement.and_then(|m| m.metrics.as_ref());
        let against = tried.against.as_ref();
        lines.push(Numbers {
            name: trial.integrator.clone(),
            bias: Judged::bias(trial.bias_mark(), tried.bias, trial.caveat.unwrap_or_default()),
            metrics: metrics.map_or(["–"; 4].map(String::from), |m| {
                [
                    text::percent(m.bias),
                    text::plain(m.rmse),
                    format!("{:.1} dB", m.psnr_db),
                    format!("{:.4}", m.flip),
                ]
            }),
            elsewhere: Judged::bias(trial.against_mark(), against.and_then(|a| a.bias), ""),
            elsewhere_flip: flip(against),
            rays: measurement.map_or("–".to_string(), |m| short(m.stats.rays_per_second())),
            rays_per_sample: measurement.map_or("–".to_string(), |m| rays_per_sample(m, group, report)),
            ram: grouped(tried.ram_bytes as u64),
        });
    }
    if let Ok(truth) = &group.truth {
        lines.push(Numbers {
            name: "f64 reference".to_string(),
            bias: Judged::none("it is what the others are compared with"),
            metrics: ["–"; 4].map(String::from),
            elsewhere: Judged::bias(Mark::Unjudged, truth.against.as_ref().and_then(|a| a.bias), ""),
            elsewhere_flip: flip(truth.against.as_ref()),
            rays: short(truth.stats.rays_per_second()),
            rays_per_sample: {
                let samples = truth.shot.pixels.len() as f64 * f64::from(report.reference_spp);
                format!("{:.1}", truth.stats.rays as f64 / samples.max(1.0))
            },
            ram: "–".to_string(),
        });
    }
    lines
}

fn rays_per_sample(measurement: &Measurement, group: &Group, report: &Report) -> String {
    let pixels = group
        .trials
        .iter()
        .find_map(|trial| trial.tried())
        .map_or(1, |tried| tried.shot.pixels.len());
    let samples = pixels as f64 * f64::from(report.spp);
    format!("{:.1}", measurement.stats.rays as f64 / samples.max(1.0))
}

/// Errors at equal samples: a row for each sampler, a column for each integrator.
pub fn sampler_rows(report: &Report, columns: &[&Tried]) -> Vec<SamplerRow> {
    let last = |tried: &Tried, sampler: &str| -> Option<Option<f64>> {
        let cell = tried.cells.iter().find(|cell| cell.sampler == sampler)?;
        let measurement = cell.outcome.as_ref().ok()?;
        Some(measurement.levels.last()?.rmse)
    };
    let worst: Vec<f64> = columns
        .iter()
        .map(|tried| {
            let all = report.samplers.iter().filter_map(|sampler| last(tried, sampler)?);
            all.fold(0.0, f64::max)
        })
        .collect();
    let rows = report
        .samplers
        .iter()
        .enumerate()
        .map(|(colour, sampler)| SamplerRow {
            colour,
            name: sampler.clone(),
            cells: columns
                .iter()
                .zip(&worst)
                .map(|(tried, &worst)| match last(tried, sampler) {
                    Some(Some(rmse)) => SamplerCell {
                        rmse: text::plain(rmse),
                        share: format!("{:.0} %", 100.0 * rmse / worst.max(f64::MIN_POSITIVE)),
                        fill: (100.0 * rmse / worst.max(f64::MIN_POSITIVE)).round() as u32,
                        hint: String::new(),
                    },
                    Some(None) => SamplerCell::nothing("below the reference's own noise"),
                    None => SamplerCell::nothing("not rendered"),
                })
                .collect(),
        });
    rows.collect()
}

impl SamplerCell {
    fn nothing(hint: &str) -> SamplerCell {
        SamplerCell {
            rmse: "–".to_string(),
            share: String::new(),
            fill: 0,
            hint: hint.to_string(),
        }
    }
}

pub fn hit_rows(measured: &Measured, p99: Mark, p9999: Mark) -> Vec<HitRow> {
    let primary = &measured.primary;
    let rows = [
        ("where both hit", &primary.hit_point_error, [p99, Mark::Unjudged]),
        (
            "away from silhouettes",
            &primary.hit_point_error_away,
            [Mark::Unjudged, p9999],
        ),
    ];
    let of = rows
        .into_iter()
        .enumerate()
        .map(|(colour, (name, tail, [p99, p9999]))| HitRow {
            colour,
            name,
            rays: grouped(tail.count as u64),
            cells: [
                (Mark::Unjudged, tail.p50),
                (Mark::Unjudged, tail.p90),
                (p99, tail.p99),
                (Mark::Unjudged, tail.p999),
                (p9999, tail.p9999),
                (Mark::Unjudged, tail.max),
            ]
            .into_iter()
            .map(|(mark, value)| Judged::plain(mark, text::scientific(value)))
            .collect(),
        });
    of.collect()
}
