//! The page: one file of HTML that is well-formed XML too, with all it needs inside.

mod curves;
pub(super) mod data_uri;
pub(super) mod figure;
mod judged;
mod overview;
mod scene;
mod table;
mod text;

use askama::Template;

use super::{BATCHES, Mark, Report, bar, count};
use overview::Row;
use scene::Scene;

/// The report as a page; the error is the template engine's, which knows none for text that fits into memory.
pub fn page(report: &Report) -> Result<String, askama::Error> {
    Page::new(report).render()
}

/// What the template shows. `templates/report.html` decides where and how, this decides what.
#[derive(Template)]
#[template(path = "report.html")]
struct Page {
    version: &'static str,
    verdict: Verdict,
    settings: String,
    /// Integrators, a column each.
    integrators: Vec<String>,
    rows: Vec<Row>,
    scenes: Vec<Scene>,
    spp: u32,
    batches: u32,
    batch_spp: u32,
    reference_spp: u32,
    bars: Bars,
}

/// How many checks came out how.
struct Verdict {
    ok: usize,
    noise: usize,
    off: usize,
    total: usize,
    headline: String,
    mark: Mark,
}

struct Bars {
    bias: String,
    hit_miss: String,
    p99: String,
    p9999: String,
}

impl Page {
    fn new(report: &Report) -> Page {
        let scenes: Vec<Scene> = report
            .scenes
            .iter()
            .enumerate()
            .map(|(i, found)| Scene::new(report, i, found))
            .collect();
        Page {
            version: env!("CARGO_PKG_VERSION"),
            verdict: Verdict::of(&report.marks()),
            settings: settings(report),
            integrators: report.integrators.clone(),
            rows: report
                .scenes
                .iter()
                .enumerate()
                .map(|(i, found)| Row::new(report, i, found))
                .collect(),
            scenes,
            spp: report.spp,
            batches: BATCHES,
            batch_spp: report.batch_spp,
            reference_spp: report.reference_spp,
            bars: Bars {
                bias: percent_bar(bar::BIAS),
                hit_miss: percent_bar(bar::HIT_MISS),
                p99: text::scientific(bar::HIT_P99),
                p9999: text::scientific(bar::HIT_P9999),
            },
        }
    }
}

/// Where on the page a scene is.
fn anchor(i: usize) -> String {
    format!("scene-{i}")
}

fn percent_bar(share: f64) -> String {
    format!("{} %", 100.0 * share)
}

fn settings(report: &Report) -> String {
    let number = |n: usize, one: &str, many: &str| format!("{n} {}", if n == 1 { one } else { many });
    let parts = [
        number(report.scenes.len(), "scene", "scenes"),
        number(report.integrators.len(), "integrator", "integrators"),
        number(report.samplers.len(), "sampler", "samplers"),
        format!("{} samples a pixel", report.spp),
        format!("reference 2 × {}", report.reference_spp),
        format!("seed {}", report.seed),
    ];
    parts.join(" · ")
}

impl Verdict {
    fn of(marks: &[Mark]) -> Verdict {
        let [ok, noise, off] = [Mark::Ok, Mark::Noise, Mark::Off].map(|kind| count(marks, kind));
        let (headline, mark) = match (noise, off) {
            (0, 0) => ("All within the bars".to_string(), Mark::Ok),
            (_, 0) => ("Nothing is surely off".to_string(), Mark::Noise),
            (_, 1) => ("One thing is off".to_string(), Mark::Off),
            (_, n) => (format!("{n} things are off"), Mark::Off),
        };
        Verdict {
            ok,
            noise,
            off,
            total: ok + noise + off,
            headline,
            mark,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::SceneReport;

    #[test]
    fn a_scene_that_is_not_rendered_is_told_and_counts() {
        let report = Report {
            spp: 4,
            reference_spp: 16,
            batch_spp: 2,
            seed: 0,
            integrators: vec!["path".to_string()],
            samplers: vec!["sobol".to_string()],
            scenes: vec![SceneReport {
                name: "a <b> & \"c\"".to_string(),
                outcome: Err("no <such> thing".to_string()),
            }],
        };
        let html = page(&report).unwrap();
        let allow = roxmltree::ParsingOptions {
            allow_dtd: true,
            ..roxmltree::ParsingOptions::default()
        };
        let document = roxmltree::Document::parse_with_options(&html, allow).unwrap();
        let text = |tag: &str| {
            let node = document.descendants().find(|node| node.has_tag_name(tag));
            node.and_then(|node| node.text()).unwrap().to_string()
        };
        assert_eq!(
            [text("h2"), text("strong")],
            ["a <b> & \"c\"", "One thing is off"]
        );
        assert!(html.contains("not rendered: no &"), "escaped");
        assert_eq!(crate::report::json(&report)["checks"]["off"], 1);
    }

    #[test]
    fn the_headline_is_the_worst_of_it() {
        let headline = |marks: &[Mark]| Verdict::of(marks).headline;
        assert_eq!(headline(&[Mark::Ok, Mark::Unjudged]), "All within the bars");
        assert_eq!(headline(&[Mark::Ok, Mark::Noise]), "Nothing is surely off");
        assert_eq!(headline(&[Mark::Off, Mark::Noise]), "One thing is off");
        assert_eq!(headline(&[Mark::Off, Mark::Off]), "2 things are off");
        assert_eq!(Verdict::of(&[Mark::Ok, Mark::Unjudged, Mark::Off]).total, 2);
    }
}
