//! Faces of any number of corners into triangles.
//!
//! A face is seen along the axis that its normal (Newell's) is nearest to, so that one that is not quite flat is cut as its
//! shadow is. The first way that covers the shadow is taken:
//!
//! 1. a fan about the first corner, where all corners are seen from there in their order and within half a turn;
//! 2. `earcut`'s triangles, their diagonals flipped until none is needlessly thin: a corner in line with its neighbours,
//!    where another face may end, would else be the tip of a triangle without area;
//! 3. `microlux::shape::polygon`, which makes new corners where the face crosses itself.
//!
//! That a list of triangles covers a face is proven for each one, not trusted. Turn the face's sides around and put them
//! beside the triangles' sides: where all cancel, a point lies in as many triangles (those that are turned over counted
//! negative) as the face winds about it. So where no triangle is turned over, and no two sides of the face meet, each
//! point of the inside is covered once. Where sides do meet, the triangles' area must be that of the even-odd rule, which
//! the third way finds exactly: then no point is covered twice either.

use std::collections::{BTreeMap, HashMap};

use earcut::{Earcut, Refiner};
use microlux::shape::polygon::{Corner, Fill, Polygon, PolygonError, RANGE, Step, Workspace};

use super::math::{add, cross, dot, length, scaled, sub};
use super::mesh::RawMesh;
use crate::desc::Vec3;

type Point = [f64; 2];

/// Sides that a face which crosses itself may be cut into at a time.
const ROOM: usize = 1 << 13;
/// Corners of such a face: the time that it takes grows with their third power. With more, ears that are not turned over
/// are taken unproven: what may be wrong is that where the face lies on itself, so do they.
const MOST: usize = 1 << 10;
/// Twice the area, where the longer side of the face is 2, that f64 can't tell from none.
const FLAT: f64 = 1e-12;
/// The same of a triangle that a fan shall not have.
const THIN: f64 = 1e-6;

pub(super) struct Cutter {
    earcut: Earcut<f64>,
    refiner: Refiner,
    workspace: Box<Workspace<ROOM>>,
    /// Faces that crossed themselves.
    crossed: usize,
}

impl Cutter {
    pub fn new() -> Self {
        Cutter {
            earcut: Earcut::new(),
            refiner: Refiner::new(),
            workspace: Box::default(),
            crossed: 0,
        }
    }

    /// What the user should know.
    pub fn note(&self) -> Option<String> {
        let crossed = self.crossed;
        (crossed > 0).then(|| {
            format!("{crossed} faces cross themselves: inside is what an odd number of turns encloses")
        })
    }

    /// Appends a face of at least three corners, which are indices of positions; an error names no place.
    pub fn add(&mut self, raw: &mut RawMesh, face: &[u32]) -> Result<(), String> {
        if let [a, b, c] = *face {
            raw.triangles.push([a, b, c]);
            return Ok(());
        }
        let at = |i: &u32| raw.positions[*i as usize];
        let ring = distinct(face, at);
        let Some(shadow) = Shadow::of(&ring.iter().map(at).collect::<Vec<_>>()) else {
            // Nothing of it can be seen: left to be found without area.
            raw.triangles
                .extend((2..face.len()).map(|k| [face[0], face[k - 1], face[k]]));
            return Ok(());
        };
        if let [a, b, c] = *ring {
            raw.triangles.push([a, b, c]);
            return Ok(());
        }
        if shadow.is_fan() {
            raw.triangles
                .extend((2..ring.len()).map(|k| [ring[0], ring[k - 1], ring[k]]));
            return Ok(());
        }
        let ears = self
            .ears(&shadow.points)
            .filter(|ears| shadow.is_not_turned(ears));
        if let Some(ears) = &ears
            && (ring.len() > MOST || is_simple(&shadow.points))
        {
            raw.triangles
                .extend(ears.iter().map(|t| t.map(|i| ring[i as usize])));
            return Ok(());
        }
        let cut = self.cut(&shadow.points)?;
        match ears.filter(|ears| cut.has_area_of(&shadow.points, ears)) {
            Some(ears) => raw
                .triangles
                .extend(ears.iter().map(|t| t.map(|i| ring[i as usize]))),
            None => {
                self.crossed += 1;
                cut.append(raw, &ring, &shadow);
            }
        }
        Ok(())
    }

    /// Triangles from corner to corner that the face's sides go around, or `None`.
    fn ears(&mut self, points: &[Point]) -> Option<Vec<[u32; 3]>> {
        let mut found: Vec<u32> = Vec::new();
        self.earcut.earcut(points.iter().copied(), &[], &mut found);
        let mut triangles: Vec<[u32; 3]> = found.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        if !closes(&triangles, points.len() as u32) {
            return None;
        }
        self.refiner.refine(triangles.as_flattened_mut(), points);
        Some(triangles)
    }

    fn cut(&mut self, points: &[Point]) -> Result<Cut, String> {
        if points.len() > MOST {
            let count = points.len();
            return Err(format!(
                "has {count} corners and crosses itself; {MOST} are possible then"
            ));
        }
        let grid = |x: f64| (x * f64::from(RANGE)).round() as i32;
        let points: Vec<[i32; 2]> = points.iter().map(|p| p.map(grid)).collect();
        let polygon = Polygon {
            points: &points,
            ends: &[points.len() as u16],
            fill: Fill::EvenOdd,
        };
        let mut triangles = Vec::new();
        let told = self.workspace.triangulate(&polygon, |step| {
            if let Step::Triangle(corners) = step {
                triangles.push(corners);
            }
        });
        told.map_err(|error: PolygonError| format!("crosses itself too often ({error}); split it"))?;
        Ok(Cut { triangles })
    }
}

/// The corners, those left out that stand where the one before stands.
fn distinct(face: &[u32], at: impl Fn(&u32) -> Vec3) -> Vec<u32> {
    let mut ring: Vec<u32> = Vec::with_capacity(face.len());
    for corner in face {
        if ring.last().is_none_or(|last| at(last) != at(corner)) {
            ring.push(*corner);
        }
    }
    while ring.len() > 1 && at(&ring[0]) == at(&ring[ring.len() - 1]) {
        ring.pop();
    }
    ring
}

/// Whether the triangles' sides and the face's, turned around, cancel.
fn closes(triangles: &[[u32; 3]], count: u32) -> bool {
    let mut open: HashMap<[u32; 2], i32> = HashMap::new();
    let mut side = |from: u32, to: u32| {
        *open.entry([from, to]).or_default() += 1;
        *open.entry([to, from]).or_default() -= 1;
    };
    for &[a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            side(from, to);
        }
    }
    (0..count).for_each(|i| side((i + 1) % count, i));
    open.values().all(|count| *count == 0)
}

/// Twice the area of a triangle, positive where it turns left.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Whether no two sides touch but neighbours where they join.
fn is_simple(points: &[Point]) -> bool {
    let n = points.len();
    let ends = |i: usize| [points[i], points[(i + 1) % n]];
    let span = |i: usize, axis: usize| {
        let [p, q] = ends(i).map(|p| p[axis]);
        (p.min(q), p.max(q))
    };
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|a, b| span(*a, 0).0.total_cmp(&span(*b, 0).0));
    let clear = |i: usize, j: usize| {
        let [a, b, c, d] = [ends(i), ends(j)].concat()[..] else {
            return false;
        };
        if (j + 1) % n == i {
            return !folds(c, d, b);
        }
        if (i + 1) % n == j {
            return !folds(a, b, d);
        }
        let parted = span(i, 1).0 > span(j, 1).1 || span(j, 1).0 > span(i, 1).1;
        parted || turn(a, b, c) * turn(a, b, d) > 0.0 || turn(c, d, a) * turn(c, d, b) > 0.0
    };
    order.iter().enumerate().all(|(at, &i)| {
        let beside = order[at + 1..]
            .iter()
            .take_while(|j| span(**j, 0).0 <= span(i, 0).1);
        beside.into_iter().all(|&j| clear(i, j))
    })
}

/// Whether the way from `a` to `b` goes on back over itself.
fn folds(a: Point, b: Point, c: Point) -> bool {
    turn(a, b, c) == 0.0 && (a[0] - b[0]) * (c[0] - b[0]) + (a[1] - b[1]) * (c[1] - b[1]) > 0.0
}

/// A face as it is seen along an axis.
struct Shadow {
    /// Within ±1, as a face that turns left.
    points: Vec<Point>,
    /// Across, up, along.
    axes: [usize; 3],
    middle: Vec3,
    half: f64,
    /// Of the face.
    normal: Vec3,
    /// A point of the plane that the face is nearest to.
    center: Vec3,
}

impl Shadow {
    /// `None` for what has no side to be seen from.
    fn of(corners: &[Vec3]) -> Option<Shadow> {
        let n = corners.len();
        let low = corners
            .iter()
            .copied()
            .reduce(|a, b| [0, 1, 2].map(|i| a[i].min(b[i])))?;
        let high = corners
            .iter()
            .copied()
            .reduce(|a, b| [0, 1, 2].map(|i| a[i].max(b[i])))?;
        let half = (0..3).map(|i| high[i] / 2.0 - low[i] / 2.0).fold(0.0, f64::max);
        let middle = [0, 1, 2].map(|i| low[i] / 2.0 + high[i] / 2.0);
        if !(half > 0.0 && half.is_finite()) {
            return None;
        }
        let near: Vec<Vec3> = corners
            .iter()
            .map(|&p| sub(p, middle).map(|x| x / half))
            .collect();
        let newell = (0..n).fold([0.0; 3], |sum, i| add(sum, cross(near[i], near[(i + 1) % n])));
        // A face that goes as far one way round as the other has no normal, but corners that turn.
        let corner = |i: usize| {
            let [p, q, r] = [i, (i + 1) % n, (i + 2) % n].map(|i| near[i]);
            cross(sub(q, p), sub(r, q))
        };
        let sharpest = (0..n)
            .map(corner)
            .max_by(|a, b| length(*a).total_cmp(&length(*b)))?;
        let normal = if length(newell) > THIN * length(sharpest) {
            newell
        } else {
            sharpest
        };
        let along = (0..3).max_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs()))?;
        if normal[along].abs() <= FLAT {
            return None;
        }
        let (across, up) = if normal[along] > 0.0 { (1, 2) } else { (2, 1) };
        let axes = [(along + across) % 3, (along + up) % 3, along];
        Some(Shadow {
            points: near.iter().map(|p| [p[axes[0]], p[axes[1]]]).collect(),
            axes,
            middle,
            half,
            normal,
            center: scaled(near.iter().copied().fold([0.0; 3], add), 1.0 / n as f64),
        })
    }

    fn is_fan(&self) -> bool {
        let [first, second, rest @ ..] = &self.points[..] else {
            return false;
        };
        let within = rest.iter().all(|p| turn(*first, *second, *p) > THIN);
        within
            && self.points[1..]
                .windows(2)
                .all(|pair| turn(*first, pair[0], pair[1]) > THIN)
    }

    fn is_not_turned(&self, triangles: &[[u32; 3]]) -> bool {
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| self.points[i as usize]);
            turn(a, b, c)
        };
        triangles.iter().all(|t| area(t) > -FLAT)
    }

    /// The point of the face's plane above a point of the shadow.
    fn lifted(&self, [x, y]: Point) -> Vec3 {
        let [across, up, along] = self.axes;
        let mut p = self.center;
        (p[across], p[up]) = (x, y);
        p[along] -= dot(self.normal, sub(p, self.center)) / self.normal[along];
        add(scaled(p, self.half), self.middle)
    }
}

/// What the third way found.
struct Cut {
    triangles: Vec<[Corner; 3]>,
}

impl Cut {
    fn place(corner: Corner, points: &[Point]) -> Point {
        match corner {
            Corner::Vertex(index) => points[index as usize],
            Corner::Crossing(place) => place.map(|x| f64::from(x) / f64::from(RANGE)),
        }
    }

    /// But for what the grid moves: two sides of at most 3 with each corner, by a step.
    fn has_area_of(&self, points: &[Point], ears: &[[u32; 3]]) -> bool {
        let area = |[a, b, c]: [Point; 3]| turn(a, b, c);
        let ours: f64 = self
            .triangles
            .iter()
            .map(|t| area(t.map(|c| Self::place(c, points))))
            .sum();
        let theirs: f64 = ears.iter().map(|t| area(t.map(|i| points[i as usize]))).sum();
        let moved = points.len() + 3 * self.triangles.len();
        (ours - theirs).abs() <= 6.0 * moved as f64 / f64::from(RANGE)
    }

    /// New corners stand in the face's plane, with the mean of what its corners say.
    fn append(&self, raw: &mut RawMesh, ring: &[u32], shadow: &Shadow) {
        let mut made: BTreeMap<[i32; 2], u32> = BTreeMap::new();
        let given = ring.iter().filter_map(|i| raw.normals.get(*i as usize));
        let mean = given.copied().fold([0.0; 3], add);
        let share = 1.0 / ring.len() as f64;
        let color = ring.iter().filter_map(|i| raw.colors.get(*i as usize));
        let color = scaled(color.copied().fold([0.0; 3], add), share);
        let uv = ring.iter().filter_map(|i| raw.uvs.get(*i as usize));
        let uv = uv.fold([0.0; 2], |sum, uv| [0, 1].map(|i| sum[i] + share * uv[i]));
        for triangle in &self.triangles {
            let corners = triangle.map(|corner| match corner {
                Corner::Vertex(index) => ring[index as usize],
                Corner::Crossing(place) => *made.entry(place).or_insert_with(|| {
                    if !raw.normals.is_empty() {
                        raw.normals.push(mean);
                    }
                    if !raw.colors.is_empty() {
                        raw.colors.push(color);
                    }
                    if !raw.uvs.is_empty() {
                        raw.uvs.push(uv);
                    }
                    raw.positions
                        .push(shadow.lifted(Self::place(corner, &shadow.points)));
                    (raw.positions.len() - 1) as u32
                }),
            });
            raw.triangles.push(corners);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn face(positions: &[Vec3]) -> (RawMesh, usize) {
        let mut raw = RawMesh {
            positions: positions.to_vec(),
            normals: vec![[0.0, 0.0, 1.0]; positions.len()],
            ..RawMesh::default()
        };
        let mut cutter = Cutter::new();
        let all: Vec<u32> = (0..positions.len() as u32).collect();
        cutter.add(&mut raw, &all).unwrap();
        assert_eq!(raw.normals.len(), raw.positions.len());
        (raw, cutter.crossed)
    }

    fn flat(points: &[[i32; 2]]) -> Vec<Vec3> {
        points
            .iter()
            .map(|&[x, y]| [f64::from(x) / 10.0, f64::from(y) / 10.0, 0.5])
            .collect()
    }

    /// Twice their areas, seen from above.
    fn areas(raw: &RawMesh) -> Vec<f64> {
        let seen = |i: u32| [raw.positions[i as usize][0], raw.positions[i as usize][1]];
        raw.triangles
            .iter()
            .map(|t| t.map(seen))
            .map(|[a, b, c]| turn(a, b, c))
            .collect()
    }

    /// From corner to corner: each side of the face is one of one triangle, and none of them is thin.
    fn assert_joined(raw: &RawMesh, twice: f64, thinnest: f64) {
        let n = raw.positions.len() as u32;
        let sides: Vec<[u32; 2]> = raw
            .triangles
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .collect();
        for i in 0..n {
            let side = [i, (i + 1) % n];
            assert_eq!(
                sides.iter().filter(|s| **s == side).count(),
                1,
                "{side:?} in {:?}",
                raw.triangles
            );
        }
        assert_eq!(raw.triangles.len() as u32, n - 2);
        let areas = areas(raw);
        assert!(
            (areas.iter().sum::<f64>() - twice).abs() < 1e-9,
            "{areas:?} are not {twice}"
        );
        assert!(areas.iter().all(|area| *area > thinnest), "{areas:?}");
    }

    #[test]
    fn what_is_convex_is_a_fan() {
        let (raw, _) = face(&flat(&[[0, 0], [20, 0], [30, 20], [10, 30], [0, 20]]));
        assert_eq!(raw.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    }

    #[test]
    fn what_is_concave_is_covered_whichever_corner_is_first() {
        let mut l = flat(&[[0, 0], [20, 0], [20, 10], [10, 10], [10, 30], [0, 30]]);
        for _ in 0..6 {
            assert_joined(&face(&l).0, 8.0, 0.5);
            l.rotate_left(1);
        }
    }

    #[test]
    fn corners_in_line_stay_corners() {
        // Not in line by a rounding each, as decimals are.
        for points in [
            &[[0, 0], [1, 0], [2, 0], [3, 0], [3, 3], [2, 3], [0, 3], [0, 1]][..],
            &[[0, 0], [3, 3], [6, 6], [7, 7], [7, 20]],
            &[[0, 0], [30, 0], [30, 30], [20, 20], [10, 10]],
            &[
                [0, 0],
                [20, 0],
                [20, 10],
                [15, 10],
                [10, 10],
                [10, 20],
                [10, 30],
                [0, 30],
            ],
        ] {
            let mut ring = flat(points);
            for _ in 0..points.len() {
                let shadow = Shadow::of(&ring).unwrap();
                let twice: f64 = (2..ring.len())
                    .map(|k| turn(shadow.points[0], shadow.points[k - 1], shadow.points[k]))
                    .sum();
                assert_joined(&face(&ring).0, twice * shadow.half * shadow.half, 1e-3);
                ring.rotate_left(1);
            }
        }
    }

    #[test]
    fn what_crosses_itself_gets_a_corner_there() {
        let (raw, crossed) = face(&flat(&[[0, 0], [20, 10], [20, 0], [0, 10]]));
        assert_eq!((raw.triangles.len(), crossed), (2, 1));
        assert!(
            length(sub(raw.positions[4], [1.0, 0.5, 0.5])) < 1e-5,
            "{:?}",
            raw.positions
        );
        let whole: f64 = areas(&raw).iter().map(|area| area.abs()).sum();
        assert!((whole - 2.0).abs() < 1e-5, "{whole}");
        // Around twice: no point is inside by the even-odd rule.
        let square = [[0, 0], [20, 0], [20, 20], [0, 20]];
        let (raw, crossed) = face(&flat(&[square, square].concat()));
        assert_eq!((raw.triangles.len(), crossed), (0, 1));
    }

    #[test]
    fn a_hole_with_a_cut_to_it_needs_no_new_corner() {
        let ring = [
            [0, 0],
            [30, 0],
            [30, 30],
            [0, 30],
            [0, 0],
            [10, 10],
            [10, 20],
            [20, 20],
            [20, 10],
            [10, 10],
        ];
        let (raw, crossed) = face(&flat(&ring));
        assert_eq!((raw.positions.len(), crossed), (10, 0));
        let areas = areas(&raw);
        assert!(
            (areas.iter().sum::<f64>() - 16.0).abs() < 1e-9 && areas.iter().all(|a| *a > 0.0),
            "{areas:?}"
        );
    }

    #[test]
    fn faces_stand_any_way_and_need_not_be_flat() {
        // An arrow's head, its tip to each side in turn, its notch first; bent by a tenth.
        for axis in 0..3 {
            for back in [false, true] {
                let point = |x: f64, y: f64, z: f64| {
                    let mut p = [0.0; 3];
                    [p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]] = [z, x, y];
                    p
                };
                let mut ring = vec![
                    point(1.0, 1.0, 0.1),
                    point(0.0, 0.0, 0.0),
                    point(4.0, 1.0, 0.0),
                    point(0.0, 2.0, 0.0),
                ];
                if back {
                    ring.reverse();
                }
                let (raw, _) = face(&ring);
                assert_eq!(raw.triangles.len(), 2);
                for t in &raw.triangles {
                    let [a, b, c] = t.map(|i| raw.positions[i as usize]);
                    let normal = cross(sub(b, a), sub(c, a))[axis];
                    assert!(
                        if back { normal < -1.0 } else { normal > 1.0 },
                        "{axis} {back} {t:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_has_no_area_is_left_to_be_counted() {
        for points in [
            &[[1, 1]; 5][..],
            &[[0, 0], [10, 10], [20, 20], [5, 5]],
            &[[0, 0], [1, 0], [0, 0], [1, 0]],
        ] {
            let (raw, crossed) = face(&flat(points));
            assert_eq!((raw.triangles.len(), crossed), (points.len() - 2, 0));
            assert!(areas(&raw).iter().all(|area| area.abs() < 1e-12));
        }
        // A repeated corner is one; what is left is a triangle.
        let (raw, _) = face(&flat(&[[0, 0], [0, 0], [10, 0], [10, 0], [0, 10], [0, 0]]));
        assert_eq!(raw.triangles.len(), 1);
    }

    #[test]
    fn many_corners_are_cut_from_corner_to_corner() {
        // A comb of 2000 teeth.
        let n = 2000;
        let mut ring: Vec<Vec3> = (0..n)
            .map(|i| [f64::from(i), if i % 2 == 0 { 0.0 } else { 40.0 }, 7.0])
            .collect();
        ring.extend([[f64::from(n), 50.0, 7.0], [-1.0, 50.0, 7.0]]);
        let (raw, crossed) = face(&ring);
        let turned: f64 = (2..ring.len())
            .map(|k| [ring[0], ring[k - 1], ring[k]].map(|p| [p[0], p[1]]))
            .map(|[a, b, c]| turn(a, b, c))
            .sum();
        assert_eq!((raw.triangles.len(), crossed), (n as usize, 0));
        let areas = areas(&raw);
        assert!((areas.iter().sum::<f64>() - turned).abs() < 1e-6 && areas.iter().all(|a| *a > 0.0));
    }
}
