//! What the page says of a scene.

use super::curves::{Plot, convergence};
use super::figure::{Figure, Lights, grid, lights, rough};
use super::judged::Judged;
use super::table::{HitRow, Numbers, SamplerRow, hit_rows, numbers, sampler_rows};
use super::{anchor, text};
use crate::cli::table::grouped;
use crate::report::{Cell, Measured, Report, SceneReport, Tried, plot, primary_marks};

/// A section of the page.
pub struct Scene {
    pub anchor: String,
    pub name: String,
    pub skipped: String,
    pub facts: String,
    /// What is missing, and why.
    pub remarks: Vec<String>,
    pub groups: Vec<Lights>,
    pub numbers: Vec<Numbers>,
    pub convergence: Vec<Plot>,
    /// Integrators, a column each, of `samplers`.
    pub columns: Vec<String>,
    pub samplers: Vec<SamplerRow>,
    pub rough_title: String,
    pub rough_style: String,
    pub rough: Vec<Figure>,
    pub hits: Vec<HitRow>,
    pub hit_plot: String,
    pub hit_miss: Judged,
    pub primary_rays: String,
}

impl Scene {
    pub fn new(report: &Report, i: usize, found: &SceneReport) -> Scene {
        let mut scene = Scene {
            anchor: anchor(i),
            name: found.name.clone(),
            skipped: String::new(),
            facts: String::new(),
            remarks: Vec::new(),
            groups: Vec::new(),
            numbers: Vec::new(),
            convergence: Vec::new(),
            columns: Vec::new(),
            samplers: Vec::new(),
            rough_title: String::new(),
            rough_style: String::new(),
            rough: Vec::new(),
            hits: Vec::new(),
            hit_plot: String::new(),
            hit_miss: Judged::none(""),
            primary_rays: String::new(),
        };
        match &found.outcome {
            Err(reason) => scene.skipped = reason.clone(),
            Ok(measured) => scene.fill(report, measured),
        }
        scene
    }

    fn fill(&mut self, report: &Report, measured: &Measured) {
        self.facts = facts(measured);
        self.remarks = remarks(measured);
        let groups = measured.groups.iter().enumerate();
        self.groups = groups
            .map(|(g, group)| lights(&format!("{}-{g}", self.anchor), group, report))
            .collect();
        self.numbers = measured
            .groups
            .iter()
            .flat_map(|group| numbers(group, report))
            .collect();
        self.convergence = convergence(measured, report);
        let tried = || {
            measured
                .trials()
                .filter_map(|(_, trial)| Some((trial, trial.tried()?)))
        };
        self.columns = tried().map(|(trial, _)| trial.integrator.clone()).collect();
        let columns: Vec<&Tried> = tried().map(|(_, tried)| tried).collect();
        self.samplers = sampler_rows(report, &columns);
        if let Some((trial, tried)) = tried().next() {
            (self.rough_title, self.rough) = rough(&self.anchor, trial, tried);
        }
        self.rough_style = grid(self.rough.len());
        let primary = &measured.primary;
        let [hit_miss, p99, p9999] = primary_marks(primary);
        self.hit_miss = Judged::plain(hit_miss, text::share(primary.hit_miss_disagreement));
        self.primary_rays = grouped(primary.rays);
        self.hits = hit_rows(measured, p99, p9999);
        self.hit_plot = plot::hit_points(&primary.hit_point_error, &primary.hit_point_error_away);
    }
}

fn facts(measured: &Measured) -> String {
    let (options, info) = (&measured.options, &measured.info);
    let mut parts = vec![
        format!("{} × {} pixels", options.width, options.height),
        options
            .max_depth
            .map_or("paths of any length".to_string(), |depth| {
                format!("paths of up to {depth} segments")
            }),
        format!("{} shapes", grouped(info.shapes as u64)),
    ];
    if info.triangles > 0 {
        parts.push(format!("{} triangles", grouped(info.triangles as u64)));
    }
    parts.push(format!(
        "{} {}",
        info.lights,
        if info.lights == 1 { "light" } else { "lights" }
    ));
    parts.push(format!("{} bytes of flash", grouped(info.bytes_total() as u64)));
    parts.join(" · ")
}

fn remarks(measured: &Measured) -> Vec<String> {
    let mut remarks = Vec::new();
    for group in &measured.groups {
        if let Err(reason) = &group.truth {
            remarks.push(format!("{}: no reference: {reason}", group.title));
        }
    }
    for (_, trial) in measured.trials() {
        match &trial.outcome {
            Err(reason) => remarks.push(format!("{}: {reason}", trial.integrator)),
            Ok(tried) => {
                let left_out = |cell: &Cell| {
                    let reason = cell.outcome.as_ref().err()?;
                    Some(format!("{} with {}: {reason}", trial.integrator, cell.sampler))
                };
                remarks.extend(tried.cells.iter().filter_map(left_out));
            }
        }
        if let Some(caveat) = trial.caveat {
            remarks.push(format!(
                "{} {caveat}; it is not judged by the reference here",
                trial.integrator
            ));
        }
    }
    if let Some(reason) = &measured.elsewhere_left_out {
        remarks.push(format!("not compared with Mitsuba: {reason}"));
    }
    remarks
}
