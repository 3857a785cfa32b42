//! Pictures, and the grids they stand in.

use super::data_uri::data_uri;
use super::text;
use crate::report::{Against, Estimate, Group, Mark, Report, Shot, Trial, Tried, Truth};

/// Pixels of the page that a picture is wide at most, and that are between two.
const SIDE: usize = 216;
const GAP: usize = 12;

pub struct Figure {
    /// Not a picture but what its colours mean.
    pub is_key: bool,
    pub id: String,
    /// The figure that takes its place while the pointer is on it.
    pub flip: String,
    /// Empty for an empty place of the grid.
    pub uri: String,
    pub title: String,
    pub detail: String,
    pub mark: Mark,
    pub width: usize,
    pub height: usize,
}

impl Figure {
    fn nothing() -> Figure {
        Figure {
            is_key: false,
            id: String::new(),
            flip: String::new(),
            uri: String::new(),
            title: String::new(),
            detail: String::new(),
            mark: Mark::Unjudged,
            width: 0,
            height: 0,
        }
    }

    fn key() -> Figure {
        Figure {
            is_key: true,
            ..Figure::nothing()
        }
    }

    fn new(id: String, shot: &Shot, title: &str, detail: String) -> Figure {
        Figure {
            id,
            uri: data_uri(shot),
            title: title.to_string(),
            detail,
            width: shot.width,
            height: shot.height,
            ..Figure::nothing()
        }
    }
}

/// So many pictures beside each other, smaller where there is no room.
pub fn grid(columns: usize) -> String {
    let width = columns * (SIDE + GAP) - GAP.min(columns * GAP);
    format!("width: {width}px; grid-template-columns: repeat({columns}, minmax(0, 1fr))")
}

/// Pictures of one kind of light.
pub struct Lights {
    pub title: String,
    pub columns: usize,
    pub style: String,
    pub figures: Vec<Figure>,
}

/// Keys of the two pictures that others are compared with.
const F64: &str = "f64";
const MITSUBA: &str = "mitsuba";

/// Up to three rows: pictures, their differences to the reference below, and to the picture made elsewhere.
pub fn lights(anchor: &str, group: &Group, report: &Report) -> Lights {
    let tried = |trial| Some((trial, Trial::tried(trial)?));
    let wall = Wall {
        anchor,
        group,
        truth: group.truth.as_ref().ok(),
        tried: group.trials.iter().filter_map(tried).collect(),
    };
    let mut figures = wall.pictures(report.reference_spp);
    let columns = figures.len();
    if wall.truth.is_some() {
        figures.extend(wall.differences(columns));
    }
    if group.elsewhere.is_some() {
        figures.extend(wall.differences_elsewhere(columns));
    }
    Lights {
        title: title(group),
        columns,
        style: grid(columns),
        figures,
    }
}

fn title(group: &Group) -> String {
    let stops = group.stops.abs();
    let plural = if stops == 1.0 { "" } else { "s" };
    match group.stops {
        0.0 => group.title.clone(),
        n if n > 0.0 => format!("{}, shown {stops:.0} stop{plural} brighter", group.title),
        _ => format!("{}, shown {stops:.0} stop{plural} darker", group.title),
    }
}

/// What hangs in a grid.
struct Wall<'a> {
    anchor: &'a str,
    group: &'a Group,
    truth: Option<&'a Truth>,
    tried: Vec<(&'a Trial, &'a Tried)>,
}

impl Wall<'_> {
    fn figure(&self, key: &str, shot: &Shot, title: &str, detail: String) -> Figure {
        Figure::new(format!("{}-{key}", self.anchor), shot, title, detail)
    }

    /// The address of the first of these pictures that is there.
    fn first_of(&self, keys: [&str; 2]) -> String {
        let there = |key: &&str| match *key {
            F64 => self.truth.is_some(),
            _ => self.group.elsewhere.is_some(),
        };
        let key = keys.into_iter().find(there);
        key.map_or(String::new(), |key| format!("{}-{key}", self.anchor))
    }

    fn pictures(&self, reference_spp: u32) -> Vec<Figure> {
        let truth = self.truth.map(|truth| {
            let detail = format!("{} spp", 2 * reference_spp);
            Figure {
                flip: self.first_of([MITSUBA, MITSUBA]),
                ..self.figure(F64, &truth.shot, "f64 reference", detail)
            }
        });
        let elsewhere = self.group.elsewhere.as_ref().map(|shot| Figure {
            flip: self.first_of([F64, F64]),
            ..self.figure(MITSUBA, shot, "Mitsuba", String::new())
        });
        let tried = self.tried.iter().map(|(trial, tried)| {
            let detail = format!("{} spp", tried.shot_spp);
            Figure {
                flip: self.first_of([F64, MITSUBA]),
                ..self.figure(&trial.integrator, &tried.shot, &trial.integrator, detail)
            }
        });
        truth.into_iter().chain(elsewhere).chain(tried).collect()
    }

    fn differences(&self, columns: usize) -> Vec<Figure> {
        let of = |(trial, tried): &(&Trial, &Tried)| {
            let Some(shot) = &tried.difference else {
                return Figure::nothing();
            };
            let (key, title) = (
                format!("{}-d", trial.integrator),
                format!("{} − f64", trial.integrator),
            );
            Figure {
                mark: trial.bias_mark(),
                ..self.figure(&key, shot, &title, detail(tried.bias))
            }
        };
        self.below(vec![Figure::key()], self.tried.iter().map(of).collect(), columns)
    }

    fn differences_elsewhere(&self, columns: usize) -> Vec<Figure> {
        let figure = |name: &str, against: &Against| {
            let (key, title) = (format!("{name}-m"), format!("{name} − Mitsuba"));
            self.figure(&key, &against.difference, &title, detail(against.bias))
        };
        let of = |(trial, tried): &(&Trial, &Tried)| match &tried.against {
            None => Figure::nothing(),
            Some(against) => Figure {
                mark: trial.against_mark(),
                ..figure(&trial.integrator, against)
            },
        };
        let truth = self.truth.and_then(|truth| truth.against.as_ref());
        let first = truth.map_or(Figure::key(), |against| figure(F64, against));
        self.below(vec![first], self.tried.iter().map(of).collect(), columns)
    }

    /// A row that starts with some figures and ends with others, which stand below the pictures they are of.
    fn below(&self, mut start: Vec<Figure>, end: Vec<Figure>, columns: usize) -> Vec<Figure> {
        let between = columns.saturating_sub(start.len() + end.len());
        start.extend((0..between).map(|_| Figure::nothing()));
        start.extend(end);
        start
    }
}

fn detail(estimate: Option<Estimate>) -> String {
    estimate.map_or(String::new(), text::with_error)
}

/// An integrator at few samples, a picture for each sampler, and what stands above them.
pub fn rough(anchor: &str, trial: &Trial, tried: &Tried) -> (String, Vec<Figure>) {
    let mut at = 0;
    let mut figures = Vec::new();
    for cell in &tried.cells {
        let rough = cell
            .outcome
            .as_ref()
            .ok()
            .and_then(|measured| measured.rough.as_ref());
        if let Some((spp, shot)) = rough {
            at = *spp;
            let id = format!("{anchor}-rough-{}", cell.sampler);
            figures.push(Figure::new(id, shot, &cell.sampler, String::new()));
        }
    }
    let plural = if at == 1 { "" } else { "s" };
    let title = format!("{} at {at} sample{plural} a pixel, by sampler", trial.integrator);
    (title, figures)
}
