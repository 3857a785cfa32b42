//! Polygons of any kind into triangles: cut by the lines of their own edges into strictly convex pieces, whose corners
//! are then peeled off.
//!
//! Fuchs, Kedem and Naylor, "On Visible Surface Generation by A Priori Tree Structures", SIGGRAPH 1980, for the cuts. A
//! cell that an edge reaches into is cut along that edge's line, so that in the end no edge reaches into any cell, and
//! each lies wholly inside the polygon or wholly outside. A convex cell of n corners loses one at a time, n − 3 times,
//! until a triangle is left.
//!
//! Every decision is exact. A cell is the list of the lines around it, an edge of the polygon each (or of the box around
//! everything), never a list of rounded points: a corner is where two lines meet, and on which side of a third one it
//! lies is the sign of a 3 × 3 determinant of their coefficients. With coordinates within ±2^20 these are 22, 22 and 43
//! bits, so that a determinant has less than 93 and fits the 128 that it is computed in. Only what is handed out is
//! rounded: a corner that is no vertex of the polygon, to the nearest point of the grid.
//!
//! The triangles meet edge to edge: where a corner of one piece, or a point of the polygon, lies within a side of
//! another, that side has a corner there, too. Along the polygon's own edges there may be corners that its neighbours do not have, where a cut met the
//! edge; a simple polygon that must fit its neighbours' corners is better cut from vertex to vertex.

use core::cmp::Ordering;
use heapless::Vec;

/// Coordinates lie within ±2^20.
pub const RANGE: i32 = 1 << 20;

/// What is inside, where rings overlap or cross themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fill {
    /// What an odd number of rings goes around: a ring inside another is a hole, whichever way it turns.
    EvenOdd,
    /// What the rings go around, unless as often one way as the other.
    NonZero,
}

/// A polygon: closed rings of points, one behind the other.
#[derive(Clone, Copy, Debug)]
pub struct Polygon<'a> {
    /// Within ±[`RANGE`], on a grid of the caller's choice, y up.
    pub points: &'a [[i32; 2]],
    /// Where each ring ends in `points`; the last is their number.
    pub ends: &'a [u16],
    pub fill: Fill,
}

/// A corner of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corner {
    /// Index of a point of the polygon; the first, where several are in one place.
    Vertex(u16),
    /// A new one, where two edges or their lines cross: rounded to the nearest point of the grid.
    Crossing([i32; 2]),
}

/// What happens, in its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step<'a> {
    /// A cell is cut along the line of the polygon's edge that begins at this point. All cuts come before all pieces.
    Cut(u16),
    /// A convex piece of the inside, counter-clockwise; corners of neighbours within its sides are not listed.
    Piece(&'a [Corner]),
    /// A triangle peeled off a piece, counter-clockwise.
    Triangle([Corner; 3]),
}

/// Why a polygon can't be cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PolygonError {
    /// The point lies beyond ±[`RANGE`].
    TooFar { point: u16 },
    /// More than 2^14 points.
    TooMany { points: usize },
    /// The ring ends before the one before it, or past the points; or points are left over.
    Ring { ring: u16 },
    /// The memory for sides was too small: more than `sides` are needed.
    Room { sides: usize },
}

impl core::fmt::Display for PolygonError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooFar { point } => write!(f, "point {point}: lies beyond 2^20"),
            Self::TooMany { points } => write!(f, "{points} points are more than 16384"),
            Self::Ring { ring } => write!(f, "ring {ring}: its end is not where points end"),
            Self::Room { sides } => write!(f, "room for {sides} sides is not enough"),
        }
    }
}

impl core::error::Error for PolygonError {}

/// A line a·x + b·y + c = 0, positive to the left of its way (b, −a).
#[derive(Clone, Copy, PartialEq, Eq)]
struct Line {
    a: i64,
    b: i64,
    c: i64,
}

impl Line {
    fn through(p: [i32; 2], q: [i32; 2]) -> Line {
        let [px, py, qx, qy] = [p[0], p[1], q[0], q[1]].map(i64::from);
        let (a, b) = (py - qy, qx - px);
        Line {
            a,
            b,
            c: -(a * px + b * py),
        }
    }

    fn turned(self) -> Line {
        Line {
            a: -self.a,
            b: -self.b,
            c: -self.c,
        }
    }

    fn is_nothing(self) -> bool {
        self.a == 0 && self.b == 0
    }

    /// Positive on the left; |·| < 2^45.
    fn at(self, [x, y]: [i32; 2]) -> i64 {
        self.a * i64::from(x) + self.b * i64::from(y) + self.c
    }

    /// Which side of this line a place is.
    fn side_of(self, place: Place) -> i32 {
        let [a, b, c] = [self.a, self.b, self.c].map(i128::from);
        sign(a * place.x + b * place.y + c * place.w)
    }
}

fn sign(x: i128) -> i32 {
    x.signum() as i32
}

/// Where two lines cross: (x/w, y/w), w > 0.
#[derive(Clone, Copy)]
struct Place {
    x: i128,
    y: i128,
    w: i128,
}

impl Place {
    /// Of a line and the next around a convex cell, which turns left.
    fn between(l: Line, m: Line) -> Place {
        let [la, lb, lc] = [l.a, l.b, l.c].map(i128::from);
        let [ma, mb, mc] = [m.a, m.b, m.c].map(i128::from);
        Place {
            x: lb * mc - mb * lc,
            y: lc * ma - mc * la,
            w: la * mb - ma * lb,
        }
    }

    fn of([x, y]: [i32; 2]) -> Place {
        let [x, y] = [x, y].map(i128::from);
        Place { x, y, w: 1 }
    }

    /// Which of two is further along an axis.
    fn compare(self, other: Place, axis: usize) -> Ordering {
        // 67 and 46 bits make 113.
        let (a, b) = if axis == 0 {
            (self.x, other.x)
        } else {
            (self.y, other.y)
        };
        (a * other.w).cmp(&(b * self.w))
    }

    fn rounded(self) -> [i32; 2] {
        let round = |x: i128| (2 * x + self.w).div_euclid(2 * self.w) as i32;
        [round(self.x), round(self.y)]
    }
}

/// A line around a cell: its number, doubled, plus 1 if it goes the other way.
type Side = u16;

/// Memory to cut polygons in, for up to `N` sides of cells (all of them together, and their ends).
///
/// A polygon of n corners that does not cross itself needs about 8 n; each crossing adds 20 or so.
#[derive(Debug, Default)]
pub struct Workspace<const N: usize> {
    /// Cells to look at, each its sides and then their number.
    pending: Vec<Side, N>,
    /// Cells that are pieces of the inside, in the same form.
    pieces: Vec<Side, N>,
    cell: Vec<Side, N>,
    corners: Vec<Corner, N>,
    /// Of the side that begins at each corner.
    sides: Vec<Side, N>,
}

impl<const N: usize> Workspace<N> {
    pub const fn new() -> Self {
        Workspace {
            pending: Vec::new(),
            pieces: Vec::new(),
            cell: Vec::new(),
            corners: Vec::new(),
            sides: Vec::new(),
        }
    }

    /// Cuts a polygon and tells each step.
    pub fn triangulate(&mut self, polygon: &Polygon, mut step: impl FnMut(Step)) -> Result<(), PolygonError> {
        let edges = Edges::new(polygon)?;
        self.pieces.clear();
        self.cut(&edges, &mut step)?;
        let mut end = self.pieces.len();
        while let Some(cell) = last(&self.pieces[..end]) {
            self.cell.clear();
            room::<N, _>(self.cell.extend_from_slice(cell).ok())?;
            end -= cell.len() + 1;
            self.tell_piece(&edges, &mut step)?;
            self.tell_triangles(&edges, &mut step)?;
        }
        Ok(())
    }

    /// Cuts cells until no edge reaches into any; those inside are left in `pieces`.
    fn cut(&mut self, edges: &Edges, step: &mut impl FnMut(Step)) -> Result<(), PolygonError> {
        self.pending.clear();
        let first = edges.count();
        room::<N, _>(push_cell(
            &mut self.pending,
            (first..first + 4).map(|line| line << 1),
        ))?;
        while let Some(cell) = last(&self.pending) {
            self.cell.clear();
            room::<N, _>(self.cell.extend_from_slice(cell).ok())?;
            self.pending.truncate(self.pending.len() - self.cell.len() - 1);
            match (0..first).find(|edge| edges.reaches_into(*edge, &self.cell)) {
                Some(edge) => {
                    step(Step::Cut(edge));
                    for side in [edge << 1, edge << 1 | 1] {
                        room::<N, _>(push_cell(&mut self.pending, edges.part(&self.cell, side)))?;
                    }
                }
                None if edges.is_inside(&self.cell) => {
                    room::<N, _>(push_cell(&mut self.pieces, self.cell.iter().copied()))?;
                }
                None => {}
            }
        }
        Ok(())
    }

    fn tell_piece(&mut self, edges: &Edges, step: &mut impl FnMut(Step)) -> Result<(), PolygonError> {
        self.corners.clear();
        for (before, after) in around(&self.cell) {
            room::<N, _>(self.corners.push(edges.corner(before, after)).ok())?;
        }
        step(Step::Piece(&self.corners));
        Ok(())
    }

    /// Peels a piece, with the corners that its neighbours have within its sides.
    fn tell_triangles(&mut self, edges: &Edges, step: &mut impl FnMut(Step)) -> Result<(), PolygonError> {
        self.corners.clear();
        self.sides.clear();
        for (before, side) in around(&self.cell) {
            room::<N, _>(self.corners.push(edges.corner(before, side)).ok())?;
            room::<N, _>(self.sides.push(side).ok())?;
            let after = next_side(&self.cell, side);
            let line = edges.side(side);
            // Along the axis that the side runs along more.
            let axis = usize::from(line.b.abs() < line.a.abs());
            let forth = if axis == 0 { line.b > 0 } else { line.a < 0 };
            let along = |from: Place, to: Place| {
                let order = from.compare(to, axis);
                if forth { order.is_lt() } else { order.is_gt() }
            };
            let end = edges.place(side, after);
            let mut at = edges.place(before, side);
            // The nearest one ahead, until there is none before the end.
            loop {
                let mut nearest: Option<(Place, Corner)> = None;
                let corners = all_corners(&self.pieces).map(|(l, m)| (edges.place(l, m), None));
                let vertices = (0..edges.count()).map(|v| (Place::of(edges.point(v)), Some(v)));
                for (place, vertex) in vertices.chain(corners) {
                    if line.side_of(place) == 0
                        && along(at, place)
                        && along(place, nearest.map_or(end, |(place, _)| place))
                    {
                        let corner = vertex.map_or(Corner::Crossing(place.rounded()), Corner::Vertex);
                        nearest = Some((place, corner));
                    }
                }
                let Some((place, corner)) = nearest else { break };
                room::<N, _>(self.corners.push(corner).ok())?;
                room::<N, _>(self.sides.push(side).ok())?;
                at = place;
            }
        }
        while self.corners.len() > 3 {
            let Some(at) = self.peelable() else { break };
            let n = self.corners.len();
            let (before, after) = ((at + n - 1) % n, (at + 1) % n);
            step(Step::Triangle([before, at, after].map(|i| self.corners[i])));
            // The chord is a side like no other.
            self.sides[before] = CHORD | at as u16;
            self.corners.remove(at);
            self.sides.remove(at);
        }
        if let [a, b, c] = *self.corners {
            step(Step::Triangle([a, b, c]));
        }
        Ok(())
    }

    /// A corner that turns, without which the others still do not all lie on one line.
    fn peelable(&self) -> Option<usize> {
        let n = self.corners.len();
        (0..n).find(|&at| {
            let before = (at + n - 1) % n;
            let rest = (0..n).filter(|i| *i != at && *i != before).map(|i| self.sides[i]);
            let first = self.sides[(at + 1) % n];
            self.sides[at] != self.sides[before] && rest.into_iter().any(|side| side != first)
        })
    }
}

/// Marks sides that were made by peeling.
const CHORD: u16 = 1 << 15;

/// The polygon's edges as lines, and behind them the four of a box around everything.
struct Edges<'a> {
    polygon: Polygon<'a>,
    low: [i32; 2],
    high: [i32; 2],
}

impl<'a> Edges<'a> {
    fn new(polygon: &Polygon<'a>) -> Result<Edges<'a>, PolygonError> {
        let (mut low, mut high) = ([i32::MAX; 2], [i32::MIN; 2]);
        let count = polygon.points.len();
        if count >= 1 << 14 {
            return Err(PolygonError::TooMany { points: count });
        }
        for (index, point) in polygon.points.iter().enumerate() {
            if point.iter().any(|c| !(-RANGE..=RANGE).contains(c)) {
                return Err(PolygonError::TooFar { point: index as u16 });
            }
            low = [low[0].min(point[0]), low[1].min(point[1])];
            high = [high[0].max(point[0]), high[1].max(point[1])];
        }
        if count == 0 {
            (low, high) = ([0; 2], [0; 2]);
        }
        let mut from = 0;
        for (ring, &end) in polygon.ends.iter().enumerate() {
            if end < from || end as usize > count {
                return Err(PolygonError::Ring { ring: ring as u16 });
            }
            from = end;
        }
        if from as usize != count {
            return Err(PolygonError::Ring {
                ring: polygon.ends.len() as u16,
            });
        }
        Ok(Edges {
            polygon: *polygon,
            low,
            high,
        })
    }

    fn count(&self) -> u16 {
        self.polygon.points.len() as u16
    }

    fn point(&self, index: u16) -> [i32; 2] {
        self.polygon
            .points
            .get(index as usize)
            .copied()
            .unwrap_or_default()
    }

    /// Both ends of an edge.
    fn ends(&self, edge: u16) -> [[i32; 2]; 2] {
        let mut start = 0;
        let mut next = edge + 1;
        for &end in self.polygon.ends {
            if edge < end {
                if next == end {
                    next = start;
                }
                break;
            }
            start = end;
        }
        [self.point(edge), self.point(next)]
    }

    fn line(&self, number: u16) -> Line {
        let line = |a, b, c: i32| Line {
            a,
            b,
            c: i64::from(c),
        };
        match number.checked_sub(self.count()) {
            None => {
                let [p, q] = self.ends(number);
                Line::through(p, q)
            }
            Some(0) => line(0, 1, 1 - self.low[1]),
            Some(1) => line(-1, 0, self.high[0] + 1),
            Some(2) => line(0, -1, self.high[1] + 1),
            Some(_) => line(1, 0, 1 - self.low[0]),
        }
    }

    fn side(&self, side: Side) -> Line {
        let line = self.line(side >> 1);
        if side & 1 == 0 { line } else { line.turned() }
    }

    fn place(&self, before: Side, after: Side) -> Place {
        Place::between(self.side(before), self.side(after))
    }

    /// A cell's corner as it is handed out.
    fn corner(&self, before: Side, after: Side) -> Corner {
        let (l, m) = (self.side(before), self.side(after));
        let is_here = |p: &[i32; 2]| l.at(*p) == 0 && m.at(*p) == 0;
        match self.polygon.points.iter().position(is_here) {
            Some(vertex) => Corner::Vertex(vertex as u16),
            None => Corner::Crossing(Place::between(l, m).rounded()),
        }
    }

    /// Whether an edge has a point in the open cell: unless the edge's line or one of the cell's parts them.
    fn reaches_into(&self, edge: u16, cell: &[Side]) -> bool {
        let line = self.line(edge);
        if line.is_nothing() {
            return false;
        }
        let [p, q] = self.ends(edge);
        let is_outside = |side: &Side| {
            let side = self.side(*side);
            side.at(p) <= 0 && side.at(q) <= 0
        };
        if cell.iter().any(is_outside) {
            return false;
        }
        let (mut left, mut right) = (false, false);
        for (before, after) in around(cell) {
            let side = line.side_of(self.place(before, after));
            left |= side > 0;
            right |= side < 0;
        }
        left && right
    }

    /// The sides of the part of a cell to the left of `cut`, which crosses it.
    fn part(&self, cell: &[Side], cut: Side) -> impl Iterator<Item = Side> {
        let line = self.side(cut);
        let is_left = move |(before, after): (Side, Side)| line.side_of(self.place(before, after)) > 0;
        around(cell).flat_map(move |(before, side)| {
            let starts = is_left((before, side));
            let ends = is_left((side, next_side(cell, side)));
            let kept = (starts || ends).then_some(side);
            let turn = (starts && !ends).then_some(cut);
            kept.into_iter().chain(turn)
        })
    }

    /// Whether a cell that no edge reaches into lies inside: by the winding number of a point next to a corner.
    fn is_inside(&self, cell: &[Side]) -> bool {
        let [before, after, ..] = *cell else { return false };
        let (l, m) = (self.side(before), self.side(after));
        let corner = Place::between(l, m);
        // Into the cell by the smallest step along (back, on), and by one smaller still along the side that goes on.
        let on = [m.b, -m.a];
        let into = [on[0] - l.b, on[1] + l.a];
        let (mut winding, mut crossings) = (0, 0);
        for edge in 0..self.count() {
            let line = self.line(edge);
            let is_above = |end: [i32; 2]| {
                let above = sign(corner.y - i128::from(end[1]) * corner.w);
                first_sign([above, into[1].signum() as i32, on[1].signum() as i32]) > 0
            };
            let along = |step: [i64; 2]| sign(i128::from(line.a * step[0] + line.b * step[1]));
            let side = first_sign([line.side_of(corner), along(into), along(on)]);
            match self.ends(edge).map(is_above) {
                [true, false] if side > 0 => (winding, crossings) = (winding + 1, crossings + 1),
                [false, true] if side < 0 => (winding, crossings) = (winding - 1, crossings + 1),
                _ => {}
            }
        }
        match self.polygon.fill {
            Fill::EvenOdd => crossings % 2 != 0,
            Fill::NonZero => winding != 0,
        }
    }
}

fn first_sign(signs: [i32; 3]) -> i32 {
    signs.into_iter().find(|s| *s != 0).unwrap_or(0)
}

/// Each side with the one before it: a corner each.
fn around(cell: &[Side]) -> impl Iterator<Item = (Side, Side)> {
    let before = cell.iter().copied().cycle().skip(cell.len().saturating_sub(1));
    before.zip(cell.iter().copied())
}

/// The side after `side`; no two of a cell are on one line.
fn next_side(cell: &[Side], side: Side) -> Side {
    let mut sides = cell.iter().copied().cycle().skip_while(|s| *s != side);
    sides.nth(1).unwrap_or(side)
}

/// The last cell of a list.
fn last(cells: &[Side]) -> Option<&[Side]> {
    let (count, sides) = cells.split_last()?;
    sides.get(sides.len().checked_sub(*count as usize)?..)
}

/// The corners of all cells of a list.
fn all_corners(cells: &[Side]) -> impl Iterator<Item = (Side, Side)> {
    let mut rest = cells;
    core::iter::from_fn(move || {
        let cell = last(rest)?;
        rest = &rest[..rest.len() - cell.len() - 1];
        Some(cell)
    })
    .flat_map(around)
}

/// Appends a cell; `None` if there is no room.
fn push_cell<const N: usize>(cells: &mut Vec<Side, N>, sides: impl Iterator<Item = Side>) -> Option<()> {
    let mut count = 0;
    for side in sides {
        cells.push(side).ok()?;
        count += 1;
    }
    cells.push(count).ok()
}

/// What a vector says that is full.
fn room<const N: usize, T>(done: Option<T>) -> Result<T, PolygonError> {
    done.ok_or(PolygonError::Room { sides: N })
}
