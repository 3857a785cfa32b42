//! One page that says what is right and what is not: all scenes × integrators × samplers, measured, judged, drawn.
//!
//! [`measure`] renders and takes the numbers, `bar` judges them, `json` and `page` write them down.

mod bar;
pub mod denoisers;
mod group;
mod json;
mod measure;
mod page;
mod plot;
mod stat;
mod work;

pub use json::json;
pub use measure::measure;
pub use page::page;
pub use stat::Estimate;

use crate::desc::{IntegratorKind, SamplerKind, SceneDesc};
use crate::metrics::Metrics;
use crate::picture::Picture;
use crate::run::{Info, Options, PrimaryReport, Stats};
use bar::Mark;

/// Renders with other seeds by which the bias and its error are known.
pub const BATCHES: u32 = 8;

/// What the page is to be about.
pub struct Request {
    pub scenes: Vec<Subject>,
    /// With the names the command line has for them.
    pub integrators: Vec<(String, IntegratorKind)>,
    pub samplers: Vec<(String, SamplerKind)>,
    /// Samples a pixel of each picture that is judged.
    pub spp: u32,
    /// Of the f64 reference, which is rendered twice.
    pub reference_spp: u32,
}

impl Request {
    /// Samples a pixel of each of the [`BATCHES`].
    pub fn batch_spp(&self) -> u32 {
        self.spp.div_ceil(2)
    }
}

/// A scene to be looked at.
pub struct Subject {
    pub desc: SceneDesc,
    /// Size, depth, seed, threads. The sampler is the one to look at most closely, if it is asked for.
    pub options: Options,
    /// A picture of it made elsewhere, of the light that its own integrator looks for.
    pub elsewhere: Option<Elsewhere>,
}

/// A picture that another renderer made (Mitsuba 3), linear.
pub struct Elsewhere {
    pub file: String,
    pub picture: Picture,
}

/// All that was found.
pub struct Report {
    pub spp: u32,
    pub reference_spp: u32,
    pub batch_spp: u32,
    pub seed: u32,
    pub integrators: Vec<String>,
    pub samplers: Vec<String>,
    pub scenes: Vec<SceneReport>,
}

pub struct SceneReport {
    pub name: String,
    /// Or why there is no picture of it.
    pub outcome: Result<Box<Measured>, String>,
}

pub struct Measured {
    pub options: Options,
    pub info: Info,
    pub primary: PrimaryReport,
    /// One for each kind of light that integrators look for.
    pub groups: Vec<Group>,
    /// Why the picture made elsewhere is not compared with, if there is one.
    pub elsewhere_left_out: Option<String>,
}

/// Integrators that have one picture in the mean.
pub struct Group {
    pub title: String,
    /// What the f64 reference says, or why it says nothing.
    pub truth: Result<Truth, String>,
    /// The picture made elsewhere, where it is of this light.
    pub elsewhere: Option<Shot>,
    /// By which the pictures are brighter than the light.
    pub stops: f64,
    pub trials: Vec<Trial>,
}

/// Two renders of the f64 reference.
pub struct Truth {
    /// The mean of both.
    pub shot: Shot,
    pub light: Estimate,
    /// Root of the mean squared noise of the mean of both.
    pub noise: f64,
    pub stats: Stats,
    pub against: Option<Against>,
}

/// An integrator.
pub struct Trial {
    pub integrator: String,
    /// What it cannot see, so that it is not to be judged by the whole picture.
    pub caveat: Option<&'static str>,
    /// Or why it does not render this scene.
    pub outcome: Result<Tried, String>,
}

pub struct Tried {
    pub ram_bytes: usize,
    /// The sampler that `shot` and `bias` are by.
    pub sampler: String,
    /// The mean of the batches and of the picture that is judged.
    pub shot: Shot,
    pub shot_spp: u32,
    pub difference: Option<Shot>,
    /// Mean light of the batches over the reference's, less 1.
    pub bias: Option<Estimate>,
    pub against: Option<Against>,
    pub cells: Vec<Cell>,
}

/// How far something is from the picture made elsewhere.
pub struct Against {
    pub metrics: Metrics,
    /// Mean light over that picture's, less 1; its own noise is not known and not in the error.
    pub bias: Option<Estimate>,
    pub difference: Shot,
}

/// An integrator with a sampler.
pub struct Cell {
    pub sampler: String,
    pub outcome: Result<Measurement, String>,
}

pub struct Measurement {
    pub stats: Stats,
    /// As `compare` has them: one picture against the first render of the reference.
    pub metrics: Option<Metrics>,
    pub levels: Vec<Level>,
    /// Power of the number of samples with which the error falls.
    pub slope: Option<f64>,
    /// At few samples.
    pub rough: Option<(u32, Shot)>,
}

/// The error at a number of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    pub spp: u32,
    /// Against the mean of both references, their noise taken out; `None` where that noise is most of it.
    pub rmse: Option<f64>,
}

/// A picture as it is shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shot {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<[u8; 3]>,
}

impl Measured {
    pub fn trials(&self) -> impl Iterator<Item = (&Group, &Trial)> {
        self.groups
            .iter()
            .flat_map(|group| group.trials.iter().map(move |trial| (group, trial)))
    }

    /// The picture that stands for the scene: the reference's, else any.
    fn face(&self) -> Option<&Shot> {
        let truth = self.groups.iter().find_map(|group| group.truth.as_ref().ok());
        let tried = || self.trials().find_map(|(_, trial)| trial.tried());
        truth
            .map(|truth| &truth.shot)
            .or_else(|| tried().map(|tried| &tried.shot))
    }
}

impl Trial {
    fn tried(&self) -> Option<&Tried> {
        self.outcome.as_ref().ok()
    }

    fn judged(&self, estimate: Option<Estimate>) -> Mark {
        match (estimate, self.caveat) {
            (Some(estimate), None) => Mark::of_estimate(estimate, bar::BIAS),
            _ => Mark::Unjudged,
        }
    }

    /// Of the bias against the f64 reference.
    pub(crate) fn bias_mark(&self) -> Mark {
        self.judged(self.tried().and_then(|tried| tried.bias))
    }

    /// Of the bias against the picture made elsewhere.
    pub(crate) fn against_mark(&self) -> Mark {
        let against = self
            .outcome
            .as_ref()
            .ok()
            .and_then(|tried| tried.against.as_ref());
        self.judged(against.and_then(|against| against.bias))
    }
}

/// What primary rays are against their bars: hit or miss, 99th percentile, 99.99th.
pub(crate) fn primary_marks(primary: &PrimaryReport) -> [Mark; 3] {
    [
        Mark::of(primary.hit_miss_disagreement, bar::HIT_MISS),
        Mark::of(primary.hit_point_error.p99, bar::HIT_P99),
        Mark::of(primary.hit_point_error_away.p9999, bar::HIT_P9999),
    ]
}

impl Report {
    /// How many checks are within their bars, beyond them by chance perhaps, and beyond them.
    pub fn tally(&self) -> [usize; 3] {
        let marks = self.marks();
        [Mark::Ok, Mark::Noise, Mark::Off].map(|kind| count(&marks, kind))
    }

    /// Scenes that are not rendered, and why.
    pub fn skipped(&self) -> impl Iterator<Item = (&str, &str)> {
        self.scenes.iter().filter_map(|scene| {
            let reason = scene.outcome.as_ref().err()?;
            Some((scene.name.as_str(), reason.as_str()))
        })
    }

    /// Every mark of every scene; a scene that is not rendered is off.
    pub(crate) fn marks(&self) -> Vec<Mark> {
        let of_scene = |scene: &SceneReport| match &scene.outcome {
            Err(_) => vec![Mark::Off],
            Ok(measured) => {
                let of_trials = measured
                    .trials()
                    .flat_map(|(_, trial)| [trial.bias_mark(), trial.against_mark()]);
                of_trials.chain(primary_marks(&measured.primary)).collect()
            }
        };
        self.scenes.iter().flat_map(of_scene).collect()
    }
}

/// How many marks there are of a kind.
pub(crate) fn count(marks: &[Mark], kind: Mark) -> usize {
    marks.iter().filter(|&&mark| mark == kind).count()
}
