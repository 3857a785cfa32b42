//! The page: one file of HTML that is well-formed XML too, with all it needs inside.

use askama::Template;

use super::check::{Check, checks};
use super::{
    DOMAIN, FRAMES, Kind, Method, Part, Report, STEPS, SceneReport, Summary, Tried, UNCOVERED, mean,
};
use crate::metrics::Metrics;
use crate::report::bar::Mark;
use crate::report::page::data_uri::{animated_uri, data_uri};
use crate::report::page::figure::grid;
use crate::report::plot;

/// Frames a second of clips on the page.
const FPS: u16 = 4;

/// The error is the template engine's, which knows none for text that fits into memory.
pub fn page(report: &Report) -> Result<String, askama::Error> {
    Page::new(report).render()
}

/// What the template shows. `templates/denoisers.html` decides where and how, this decides what.
#[derive(Template)]
#[template(path = "denoisers.html")]
struct Page {
    version: &'static str,
    domain: &'static str,
    settings: String,
    has_oidn: bool,
    verdict: Mark,
    headline: String,
    checks: Vec<CheckLine>,
    tables: Vec<Table>,
    scenes: Vec<Scene>,
    frames: usize,
    steps: String,
    enough: usize,
    references: String,
}

struct CheckLine {
    of: String,
    what: &'static str,
    bar: String,
    measured: String,
    mark: Mark,
}

/// Means over scenes, or the numbers of one.
struct Table {
    title: String,
    is_clip: bool,
    lines: Vec<Line>,
    /// Where nothing is remembered.
    uncovered: String,
}

struct Line {
    title: &'static str,
    is_ours: bool,
    colour: usize,
    cells: Vec<String>,
}

struct Scene {
    anchor: String,
    name: String,
    facts: String,
    skipped: String,
    parts: Vec<Shown>,
}

/// A part of a scene.
struct Shown {
    title: String,
    style: String,
    figures: Vec<Figure>,
    /// Empty where there is one frame.
    plot: String,
    legend: Vec<(usize, &'static str)>,
    uncovered: String,
}

struct Figure {
    id: String,
    /// The figure that takes its place while the pointer is on it.
    flip: String,
    uri: String,
    title: &'static str,
    detail: String,
    width: usize,
    height: usize,
}

impl Page {
    fn new(report: &Report) -> Page {
        let checks = checks(report);
        let scenes = report.scenes.iter().enumerate();
        Page {
            version: env!("CARGO_PKG_VERSION"),
            domain: DOMAIN,
            settings: settings(report),
            has_oidn: report.has_oidn,
            verdict: verdict(&checks),
            headline: headline(&checks),
            checks: checks.iter().map(CheckLine::new).collect(),
            tables: report.summaries().iter().map(Table::new).collect(),
            scenes: scenes.map(|(i, scene)| Scene::new(i, scene)).collect(),
            frames: FRAMES,
            steps: STEPS.map(|step| step.to_string()).join(", "),
            enough: UNCOVERED,
            references: report.references(),
        }
    }
}

fn settings(report: &Report) -> String {
    let rendered = report.scenes.len() - report.skipped().count();
    format!(
        "{rendered} scene{} · references of {} · seed {}",
        if rendered == 1 { "" } else { "s" },
        report.references(),
        report.seed
    )
}

fn verdict(checks: &[Check]) -> Mark {
    let has = |mark| checks.iter().any(|check| check.mark() == mark);
    match (has(Mark::Off), has(Mark::Ok)) {
        (true, _) => Mark::Off,
        (false, true) => Mark::Ok,
        (false, false) => Mark::Unjudged,
    }
}

fn headline(checks: &[Check]) -> String {
    let count = |mark| checks.iter().filter(|check| check.mark() == mark).count();
    let (ok, open) = (count(Mark::Ok), count(Mark::Unjudged));
    let judged = checks.len() - open;
    match open {
        0 => format!("{ok} of {judged} bars are met"),
        _ => format!("{ok} of {judged} bars are met, {open} not measured"),
    }
}

impl CheckLine {
    fn new(check: &Check) -> CheckLine {
        CheckLine {
            of: check.kind.short(),
            what: check.what,
            bar: check.bar(),
            measured: check.measured(),
            mark: check.mark(),
        }
    }
}

impl Table {
    fn new(summary: &Summary) -> Table {
        let lines = summary.rows.iter().map(|row| {
            let mut cells = vec![
                format!("{:.2}", row.psnr_db),
                format!("{:.4}", row.ssim),
                format!("{:.4}", row.flip),
            ];
            if let Some(flicker) = row.flicker {
                cells.extend([format!("{:.2}", row.last_db), format!("{flicker:.4}")]);
            }
            Line {
                title: row.method.title(),
                is_ours: row.method == Method::Ours,
                colour: colour(row.method),
                cells,
            }
        });
        Table {
            title: summary.kind.title(),
            is_clip: summary.kind.is_clip(),
            lines: lines.collect(),
            uncovered: summary.uncovered.map_or(String::new(), |found| uncovered(&found)),
        }
    }
}

fn uncovered(found: &super::Uncovered) -> String {
    format!(
        "{:.1} % of the pixels had no history: {:.2} dB there, {:.2} dB if no pixel has any.",
        100.0 * found.share,
        found.with_history,
        found.without
    )
}

/// The number of a method's colour.
fn colour(method: Method) -> usize {
    match method {
        Method::Ours => 0,
        Method::OidnHigh | Method::OidnFull => 1,
        Method::Atrous => 2,
        Method::OidnGathered | Method::OidnUpsampled => 3,
        Method::OursAlone => 5,
        Method::OursUnsteady | Method::Bilateral | Method::OidnBilinear => 6,
        Method::OidnFast | Method::OidnClean => 4,
        Method::Noisy => 7,
    }
}

impl Scene {
    fn new(number: usize, scene: &SceneReport) -> Scene {
        let anchor = format!("scene-{number}");
        let parts = scene.outcome.as_ref().map_or(&[][..], Vec::as_slice);
        let noise = mean(parts.iter().map(|part| part.reference_db));
        Scene {
            name: scene.name.clone(),
            facts: format!(
                "{} × {} pixels; references are right to {noise:.1} dB, as far as their own noise goes",
                scene.width, scene.height
            ),
            skipped: scene.outcome.as_ref().err().cloned().unwrap_or_default(),
            parts: parts.iter().map(|part| Shown::new(&anchor, part)).collect(),
            anchor,
        }
    }
}

impl Shown {
    fn new(anchor: &str, part: &Part) -> Shown {
        let prefix = format!("{anchor}-{}", part.kind.key());
        let truth = format!("{prefix}-reference");
        let uri = |shots: &[super::Shot]| match shots {
            [one] => data_uri(one),
            clip => animated_uri(clip, FPS),
        };
        let figure = |tried: &Tried| Figure {
            id: format!("{prefix}-{}", tried.method.key()),
            flip: truth.clone(),
            uri: uri(&tried.shots),
            title: tried.method.title(),
            detail: detail(tried),
            width: tried.shots.first().map_or(0, |shot| shot.width),
            height: tried.shots.first().map_or(0, |shot| shot.height),
        };
        let mut figures: Vec<Figure> = part.tried.iter().map(figure).collect();
        figures.push(Figure {
            id: truth.clone(),
            flip: String::new(),
            // A camera that stands still has one reference.
            uri: uri(if part.kind == Kind::Still {
                &part.reference[..1]
            } else {
                &part.reference
            }),
            title: "reference",
            detail: format!("{:.1} dB", part.reference_db),
            width: part.reference.first().map_or(0, |shot| shot.width),
            height: part.reference.first().map_or(0, |shot| shot.height),
        });
        let curve = |tried: &Tried| {
            let values = tried.metrics.iter().map(|m| m.psnr_db).collect();
            (colour(tried.method), values)
        };
        let curves: Vec<(usize, Vec<f64>)> = part.tried.iter().map(curve).collect();
        let is_clip = part.kind.is_clip();
        let names = part
            .tried
            .iter()
            .map(|tried| (colour(tried.method), tried.method.title()));
        Shown {
            title: part.kind.title(),
            style: grid(figures.len()),
            figures,
            plot: if is_clip {
                plot::frames(&curves, "PSNR, dB")
            } else {
                String::new()
            },
            legend: if is_clip { names.collect() } else { Vec::new() },
            uncovered: part.uncovered.map_or(String::new(), |found| uncovered(&found)),
        }
    }
}

fn detail(tried: &Tried) -> String {
    let of = |value: fn(&Metrics) -> f64| mean(tried.metrics.iter().map(value));
    let (psnr, ssim, flip) = (of(|m| m.psnr_db), of(|m| m.ssim), of(|m| m.flip));
    let all = format!("{psnr:.2} dB · {ssim:.3} · {flip:.3}");
    match tried.flicker {
        Some(flicker) => format!("{all} · {flicker:.4}"),
        None => all,
    }
}
