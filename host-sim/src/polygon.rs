//! How a polygon becomes triangles, step by step, as a picture: a frame a step, side by side.

use microlux::shape::polygon::{Corner, Fill, Polygon, PolygonError, RANGE, Step, Workspace};
use plotters::element::Polygon as Filled;
use plotters::prelude::*;
use thiserror::Error;

type Point = [f64; 2];

/// Room to cut in.
const SIDES: usize = 16_384;
/// Pixels of a frame, and frames in a row.
const FRAME: u32 = 220;
const COLUMNS: u32 = 5;
/// Most frames that are drawn one by one; of more steps only so many are shown, evenly.
const MOST: usize = 60;

const OUTLINE: RGBColor = RGBColor(30, 30, 30);
const CUT: RGBColor = RGBColor(200, 40, 40);
const INSIDE: RGBColor = RGBColor(225, 228, 235);
/// Of pieces, in turn.
const PIECES: [RGBColor; 6] = [
    RGBColor(141, 211, 199),
    RGBColor(255, 237, 111),
    RGBColor(190, 186, 218),
    RGBColor(251, 128, 114),
    RGBColor(128, 177, 211),
    RGBColor(253, 180, 98),
];

#[derive(Debug, Error)]
pub enum PolygonTrouble {
    #[error("line {line}: {what}")]
    Line { line: usize, what: String },
    #[error("no point in it; write one a line, x and y, an empty line between rings")]
    Empty,
    #[error("its points all lie in one place, or one is not finite")]
    Flat,
    #[error(transparent)]
    Cut(#[from] PolygonError),
    #[error("cannot draw it ({0})")]
    Draw(String),
}

/// Closed rings of points, y up.
#[derive(Clone, Debug, PartialEq)]
pub struct Rings(pub Vec<Vec<Point>>);

/// Polygons that need no file: their names, and what they are.
pub const BUILTIN: [(&str, &str); 5] = [
    ("convex", "a heptagon: only peeled"),
    ("comb", "concave: teeth"),
    ("hole", "a square with a hole, corners on a line"),
    ("star", "a pentagram, which crosses itself: even and odd"),
    ("spiral", "concave, cut by many lines"),
];

impl Rings {
    /// One of [`BUILTIN`].
    pub fn builtin(name: &str) -> Option<Rings> {
        let around = |n: usize, step: usize, radius: f64| -> Vec<Point> {
            (0..n)
                .map(|i| {
                    let (y, x) = (std::f64::consts::TAU * (i * step) as f64 / n as f64 + 1.571).sin_cos();
                    [radius * x, radius * y]
                })
                .collect()
        };
        let rings = match name {
            "convex" => vec![around(7, 1, 1.0)],
            "star" => vec![around(5, 2, 1.0)],
            "comb" => {
                let tooth = |i: usize| {
                    let x = i as f64;
                    [[x, 0.0], [x + 0.5, 2.0 + 0.3 * x]]
                };
                let mut ring: Vec<Point> = (0..5).flat_map(tooth).collect();
                ring.extend([[5.0, 0.0], [5.0, -1.0], [0.0, -1.0]]);
                vec![ring]
            }
            "hole" => vec![
                vec![[0.0, 0.0], [2.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]],
                vec![[1.0, 1.0], [3.0, 1.5], [2.5, 3.0], [1.2, 2.6]],
            ],
            "spiral" => {
                let arm = |i: usize, inner: f64| {
                    let turn = i as f64 * 0.45;
                    let radius = 0.3 + 0.12 * turn - inner;
                    [radius * turn.cos(), radius * turn.sin()]
                };
                let mut ring: Vec<Point> = (0..24).map(|i| arm(i, 0.0)).collect();
                ring.extend((0..24).rev().map(|i| arm(i, 0.2)));
                vec![ring]
            }
            _ => return None,
        };
        Some(Rings(rings))
    }

    /// Of a text: a point a line, an empty line between rings, `#` before what is no point.
    pub fn parse(text: &str) -> Result<Rings, PolygonTrouble> {
        let mut rings: Vec<Vec<Point>> = vec![Vec::new()];
        for (line, content) in (1..).zip(text.lines()) {
            let content = content.split('#').next().unwrap_or("").trim();
            if content.is_empty() {
                rings.push(Vec::new());
                continue;
            }
            let words = content.split([' ', ',', '\t']).filter(|word| !word.is_empty());
            let numbers: Result<Vec<f64>, _> = words.map(str::parse).collect();
            match numbers.as_deref() {
                Ok(&[x, y]) => rings.last_mut().into_iter().for_each(|ring| ring.push([x, y])),
                _ => {
                    let what = format!("\"{content}\" is not x and y; correct it");
                    return Err(PolygonTrouble::Line { line, what });
                }
            }
        }
        rings.retain(|ring| !ring.is_empty());
        match rings.is_empty() {
            true => Err(PolygonTrouble::Empty),
            false => Ok(Rings(rings)),
        }
    }
}

/// What happened to a polygon.
#[derive(Clone, Debug)]
pub struct Steps {
    rings: Vec<Vec<Point>>,
    /// In their order.
    all: Vec<Made>,
}

#[derive(Clone, Debug)]
enum Made {
    Cut([Point; 2]),
    Piece(Vec<Point>),
    Triangle([Point; 3]),
}

impl Steps {
    /// Cuts the polygon as the core does, on its grid.
    pub fn new(rings: &Rings) -> Result<Steps, PolygonTrouble> {
        let all = || rings.0.iter().flatten();
        let fold = |i: usize, pick: fn(f64, f64) -> f64| all().map(|p| p[i]).reduce(pick).unwrap_or(0.0);
        let (low, high) = (
            [fold(0, f64::min), fold(1, f64::min)],
            [fold(0, f64::max), fold(1, f64::max)],
        );
        let extent = (high[0] - low[0]).max(high[1] - low[1]);
        if !(extent > 0.0 && extent.is_finite()) {
            return Err(PolygonTrouble::Flat);
        }
        let middle = [0, 1].map(|i| (low[i] + high[i]) / 2.0);
        let scale = 1.8 * f64::from(RANGE) / extent;
        let onto = |p: &Point| [0, 1].map(|i| ((p[i] - middle[i]) * scale).round() as i32);
        let points: Vec<[i32; 2]> = all().map(onto).collect();
        let mut end = 0;
        let ends: Vec<u16> = rings
            .0
            .iter()
            .map(|ring| {
                end += ring.len();
                end as u16
            })
            .collect();
        let polygon = Polygon {
            points: &points,
            ends: &ends,
            fill: Fill::EvenOdd,
        };
        let unit = |p: [i32; 2]| p.map(|c| f64::from(c) / f64::from(RANGE));
        let place = |corner: Corner| match corner {
            Corner::Vertex(index) => unit(points[usize::from(index)]),
            Corner::Crossing(point) => unit(point),
        };
        let edge = |from: u16| {
            let begin = ends.iter().rev().find(|end| **end <= from).map_or(0, |end| *end);
            let end = ends.iter().find(|end| **end > from).map_or(0, |end| *end);
            let to = if from + 1 == end { begin } else { from + 1 };
            [from, to].map(|index| unit(points[usize::from(index)]))
        };
        let mut made = Vec::new();
        Workspace::<SIDES>::new().triangulate(&polygon, |step| {
            made.push(match step {
                Step::Cut(from) => Made::Cut(edge(from)),
                Step::Piece(corners) => Made::Piece(corners.iter().copied().map(place).collect()),
                Step::Triangle(corners) => Made::Triangle(corners.map(place)),
            });
        })?;
        let mut rest = points.iter().copied().map(unit);
        let rings = rings
            .0
            .iter()
            .map(|ring| rest.by_ref().take(ring.len()).collect());
        Ok(Steps {
            rings: rings.collect(),
            all: made,
        })
    }

    /// Cuts, pieces, triangles.
    pub fn counts(&self) -> [usize; 3] {
        counts(&self.all)
    }

    /// The frames, as SVG.
    pub fn svg(&self) -> Result<String, PolygonTrouble> {
        let shown: Vec<usize> = match self.all.len() {
            few if few <= MOST => (0..=few).collect(),
            many => (0..=MOST).map(|i| i * many / MOST).collect(),
        };
        let rows = (shown.len() as u32).div_ceil(COLUMNS);
        let mut svg = String::new();
        {
            let wrong = |error: &dyn std::fmt::Display| PolygonTrouble::Draw(error.to_string());
            let root = SVGBackend::with_string(&mut svg, (COLUMNS * FRAME, rows * FRAME)).into_drawing_area();
            root.fill(&WHITE).map_err(|error| wrong(&error))?;
            for (area, &steps) in root
                .split_evenly((rows as usize, COLUMNS as usize))
                .iter()
                .zip(&shown)
            {
                self.frame(area, steps).map_err(|error| wrong(&error))?;
            }
            root.present().map_err(|error| wrong(&error))?;
        }
        Ok(svg)
    }

    /// After so many steps.
    fn frame<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, plotters::coord::Shift>,
        steps: usize,
    ) -> Result<(), DrawingAreaErrorKind<DB::ErrorType>> {
        let half = f64::from(FRAME) / 2.0;
        let at = |[x, y]: Point| {
            (
                (half + 0.92 * half * x) as i32,
                (half - 0.85 * half * y) as i32 + 6,
            )
        };
        let done = &self.all[..steps];
        let [cuts, pieces, triangles] = counts(done);
        let label = match steps {
            0 => "the polygon".to_string(),
            _ => format!("{cuts} cuts, {pieces} pieces, {triangles} triangles"),
        };
        let mut piece = 0;
        for made in done {
            match made {
                Made::Cut(_) => {}
                Made::Piece(corners) => {
                    let corners: Vec<_> = corners.iter().map(|&c| at(c)).collect();
                    area.draw(&Filled::new(corners, INSIDE.filled()))?;
                    piece += 1;
                }
                Made::Triangle(corners) => {
                    let corners: Vec<_> = corners.iter().map(|&c| at(c)).collect();
                    let color = PIECES[(piece + PIECES.len() - 1) % PIECES.len()];
                    area.draw(&Filled::new(corners.clone(), color.filled()))?;
                    let closed: Vec<_> = corners.iter().chain(corners.first()).copied().collect();
                    area.draw(&PathElement::new(closed, WHITE.stroke_width(1)))?;
                }
            }
        }
        for (i, made) in done.iter().enumerate() {
            // A cut's line is drawn as far as the frame goes while there are only cuts.
            if let Made::Cut([from, to]) = made
                && pieces == 0
            {
                let way = [to[0] - from[0], to[1] - from[1]];
                let length = way[0].hypot(way[1]).max(1e-9);
                let far =
                    |sign: f64| [0, 1].map(|i| (from[i] + sign * 3.0 * way[i] / length).clamp(-3.0, 3.0));
                let last = i + 1 == done.len();
                let style = if last {
                    CUT.stroke_width(2)
                } else {
                    CUT.mix(0.35).stroke_width(1)
                };
                area.draw(&PathElement::new(vec![at(far(-1.0)), at(far(1.0))], style))?;
            }
        }
        for ring in &self.rings {
            let closed: Vec<_> = ring.iter().chain(ring.first()).map(|&p| at(p)).collect();
            area.draw(&PathElement::new(closed, OUTLINE.stroke_width(2)))?;
        }
        area.draw(&Text::new(
            label,
            (8, 4),
            ("sans-serif", 12).into_font().color(&OUTLINE),
        ))
    }
}

/// Cuts, pieces, triangles.
fn counts(made: &[Made]) -> [usize; 3] {
    let mut counts = [0; 3];
    for made in made {
        counts[match made {
            Made::Cut(_) => 0,
            Made::Piece(_) => 1,
            Made::Triangle(_) => 2,
        }] += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_as_many_as_the_papers_say() {
        let counts = |name: &str| Steps::new(&Rings::builtin(name).unwrap()).unwrap().counts();
        let [_, pieces, triangles] = counts("convex");
        assert_eq!((pieces, triangles), (1, 5), "n - 2 triangles of a convex n-gon");
        // Five tips and the ring about the pentagon in the middle, which is outside by even and odd.
        let [_, pieces, triangles] = counts("star");
        assert!(pieces >= 5 && triangles >= 5, "{pieces} {triangles}");
        for (name, _) in BUILTIN {
            let [cuts, pieces, triangles] = counts(name);
            assert!(cuts > 0 && triangles >= pieces && pieces > 0, "{name}");
        }
    }

    #[test]
    fn frames_are_drawn() {
        let steps = Steps::new(&Rings::builtin("hole").unwrap()).unwrap();
        let svg = steps.svg().unwrap();
        let [cuts, pieces, triangles] = steps.counts();
        let last = format!("{cuts} cuts, {pieces} pieces, {triangles} triangles");
        assert!(svg.contains("the polygon") && svg.contains(&last), "{last}");
        assert!(svg.matches("<polygon").count() > triangles);
    }

    #[test]
    fn a_text_is_read_or_its_line_named() {
        let rings = Rings::parse("# a\n0 0\n1,0\n0 1 # b\n\n\n.2 .2\n.3 .2\n.2 .3\n").unwrap();
        assert_eq!(rings.0.iter().map(Vec::len).collect::<Vec<_>>(), [3, 3]);
        let wrong = Rings::parse("0 0\n1 x\n").unwrap_err().to_string();
        assert!(wrong.starts_with("line 2: \"1 x\""), "{wrong}");
        assert!(matches!(Rings::parse("\n#\n"), Err(PolygonTrouble::Empty)));
        let flat = Rings(vec![vec![[1.0, 1.0]; 3]]);
        assert!(matches!(Steps::new(&flat), Err(PolygonTrouble::Flat)));
    }
}
