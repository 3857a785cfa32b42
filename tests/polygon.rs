//! Triangles cover what their polygon covers: the same area, every point once, edge to edge.
//!
//! `MICROLUX_POLYGONS` of each kind are cut, 300 unless said: `MICROLUX_POLYGONS=100000 cargo test --release --test polygon`.
//! So many of each of the seven kinds held on 2026-11-27, without a failure, in 44 s on two shared cores of a PC.

use earcut::Earcut;
use microlux::sampler::hash;
use microlux::shape::polygon::{Corner, Fill, Polygon, PolygonError, Step, Workspace};
use std::collections::HashMap;

type Point = [i32; 2];
type Rings = Vec<Vec<Point>>;

/// A generator of polygons.
struct Random(u32, u32);

impl Random {
    fn next(&mut self) -> u32 {
        self.1 += 1;
        hash(self.0, 0, 0, self.1)
    }

    fn unit(&mut self) -> f64 {
        f64::from(self.next()) / 4294967296.0
    }

    fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }

    /// Around the middle, by angle, with radii from `near` to `far`; even coordinates.
    fn star(&mut self, corners: usize, near: f64, far: f64) -> Vec<Point> {
        // One corner in each equal angle: a star, whatever the radii.
        let turn = std::f64::consts::TAU / corners as f64;
        let corner = |i: usize, angle: f64, r: f64| {
            let angle = (i as f64 + 0.9 * angle) * turn;
            [angle.cos(), angle.sin()].map(|c| 2 * (c * r / 2.0).round() as i32)
        };
        (0..corners)
            .map(|i| corner(i, self.unit(), near + (far - near) * self.unit()))
            .collect()
    }

    fn points(&mut self, count: usize, size: i32, step: i32) -> Vec<Point> {
        let mut one = || (self.below(2 * size as usize + 1) as i32 - size) * step;
        (0..count).map(|_| [one(), one()]).collect()
    }

    fn turned(&mut self, mut ring: Vec<Point>) -> Vec<Point> {
        if self.next() & 1 == 1 {
            ring.reverse();
        }
        ring
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Convex,
    Star,
    Simple,
    Collinear,
    Holes,
    Touching,
    Crossing,
}

fn make(kind: Kind, random: &mut Random) -> Rings {
    let n = 3 + random.below(8);
    match kind {
        Kind::Convex => {
            let ring = random.star(n, 5e5, 5e5);
            vec![random.turned(ring)]
        }
        Kind::Star => {
            let ring = random.star(n.max(5), 1e5, 1e6);
            vec![random.turned(ring)]
        }
        // Random points, edges that cross uncrossed one after the other.
        Kind::Simple => loop {
            let mut ring = random.points(n, 1000, 1000);
            if untangle(&mut ring) {
                return vec![random.turned(ring)];
            }
        },
        // Middles of edges as corners, and some of all corners again.
        Kind::Collinear => {
            let ring = random.star(n, 1e5, 1e6);
            let mut more = Vec::new();
            for (i, &[x, y]) in ring.iter().enumerate() {
                more.push([x, y]);
                if random.next() & 3 == 0 {
                    more.push([x, y]);
                }
                let [u, v] = ring[(i + 1) % n];
                if random.next() & 1 == 0 {
                    more.push([(x + u) / 2, (y + v) / 2]);
                }
            }
            vec![random.turned(more)]
        }
        Kind::Holes => {
            let outer = random.star(n.max(8), 9e5, 1e6);
            let holes = 1 + random.below(3);
            let mut rings = vec![random.turned(outer)];
            for i in 0..holes {
                let corners = 3 + random.below(4);
                let hole = random.star(corners, 5e4, 2e5);
                let [dx, dy] = [[-400_000, 0], [200_000, 350_000], [200_000, -350_000]][i];
                let moved = hole.into_iter().map(|[x, y]| [x + dx, y + dy]).collect();
                rings.push(random.turned(moved));
            }
            rings
        }
        // On a coarse grid corners meet corners and edges, and edges lie on edges.
        Kind::Touching => vec![random.points(n, 2, 100_000)],
        Kind::Crossing => vec![random.points(n, 1_000_000, 1)],
    }
}

fn orientation(a: Point, b: Point, c: Point) -> i64 {
    let [ax, ay, bx, by, cx, cy] = [a[0], a[1], b[0], b[1], c[0], c[1]].map(i64::from);
    (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
}

/// Turns parts of the ring round until no two edges cross; false if they touch, or never end.
fn untangle(ring: &mut [Point]) -> bool {
    let n = ring.len();
    for _ in 0..200 {
        let mut crossed = false;
        for i in 0..n {
            for j in i + 2..n {
                if i == 0 && j == n - 1 {
                    continue;
                }
                let (a, b, c, d) = (ring[i], ring[i + 1], ring[j], ring[(j + 1) % n]);
                let signs = [
                    orientation(a, b, c),
                    orientation(a, b, d),
                    orientation(c, d, a),
                    orientation(c, d, b),
                ];
                if signs.contains(&0) {
                    return false;
                }
                if (signs[0] > 0) != (signs[1] > 0) && (signs[2] > 0) != (signs[3] > 0) {
                    ring[i + 1..=j].reverse();
                    crossed = true;
                }
            }
        }
        if !crossed {
            return true;
        }
    }
    false
}

fn edges(rings: &Rings) -> impl Iterator<Item = [Point; 2]> + '_ {
    rings
        .iter()
        .flat_map(|ring| (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]))
}

/// Area by slabs between the heights of all corners and crossings, where inside and outside only change at edges.
fn area(rings: &Rings) -> f64 {
    let float = |p: Point| p.map(f64::from);
    let edges: Vec<_> = edges(rings).map(|e| e.map(float)).collect();
    let mut heights: Vec<f64> = edges.iter().map(|[p, _]| p[1]).collect();
    for (i, [p, q]) in edges.iter().enumerate() {
        for [r, s] in &edges[..i] {
            let (d, e) = ([q[0] - p[0], q[1] - p[1]], [s[0] - r[0], s[1] - r[1]]);
            let det = d[0] * e[1] - d[1] * e[0];
            let t = ((r[0] - p[0]) * e[1] - (r[1] - p[1]) * e[0]) / det;
            if det != 0.0 && (0.0..=1.0).contains(&t) {
                heights.push(p[1] + t * d[1]);
            }
        }
    }
    heights.sort_by(f64::total_cmp);
    let slab = |pair: &[f64]| {
        let middle = (pair[0] + pair[1]) / 2.0;
        let mut met: Vec<f64> = edges
            .iter()
            .filter(|[p, q]| (p[1] > middle) != (q[1] > middle))
            .map(|[p, q]| p[0] + (middle - p[1]) / (q[1] - p[1]) * (q[0] - p[0]))
            .collect();
        met.sort_by(f64::total_cmp);
        let width: f64 = met.chunks(2).map(|pair| pair[1] - pair[0]).sum();
        width * (pair[1] - pair[0])
    };
    heights.windows(2).map(slab).sum()
}

fn is_inside(rings: &Rings, [x, y]: Point) -> bool {
    let is_left =
        |[p, q]: &[Point; 2]| (p[1] > y) != (q[1] > y) && (orientation(*p, *q, [x, y]) > 0) == (q[1] > p[1]);
    edges(rings).filter(is_left).count() % 2 == 1
}

/// Distance of a point from a segment.
fn distance([p, q]: [Point; 2], at: Point) -> f64 {
    let [dx, dy] = [0, 1].map(|i| f64::from(q[i] - p[i]));
    let [ax, ay] = [0, 1].map(|i| f64::from(at[i] - p[i]));
    let length = dx * dx + dy * dy;
    let t = if length > 0.0 {
        ((ax * dx + ay * dy) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (ax - t * dx).hypot(ay - t * dy)
}

fn cut(rings: &Rings, fill: Fill) -> (Vec<Vec<Corner>>, Vec<[Corner; 3]>) {
    let points: Vec<Point> = rings.concat();
    let ends: Vec<u16> = rings
        .iter()
        .scan(0, |end, ring| {
            *end += ring.len() as u16;
            Some(*end)
        })
        .collect();
    let (mut pieces, mut triangles) = (Vec::new(), Vec::new());
    let polygon = Polygon {
        points: &points,
        ends: &ends,
        fill,
    };
    Workspace::<4096>::new()
        .triangulate(&polygon, |step| match step {
            Step::Cut(edge) => assert!((edge as usize) < points.len() && pieces.is_empty()),
            Step::Piece(corners) => pieces.push(corners.to_vec()),
            Step::Triangle(triangle) => triangles.push(triangle),
        })
        .unwrap();
    (pieces, triangles)
}

/// Every random point is in as many triangles as it should be: one inside, none outside.
fn check_cover(rings: &Rings, triangles: &[[Point; 3]], random: &mut Random, tell: &str) {
    let [low, high] = [i32::min, i32::max].map(|pick| {
        let points = rings.iter().flatten().copied();
        points
            .reduce(|a, b| [pick(a[0], b[0]), pick(a[1], b[1])])
            .unwrap()
    });
    let sides = |t: &[Point; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    for _ in 0..20 {
        let at = [0, 1].map(|i| low[i] + (random.unit() * f64::from(high[i] - low[i])) as i32);
        // Rounded crossings move what begins or ends there by less than 2 units.
        let near = |edge: [Point; 2]| distance(edge, at) < 2.0;
        if edges(rings).any(near) || triangles.iter().flat_map(sides).any(near) {
            continue;
        }
        let covers = |t: &&[Point; 3]| {
            // A triangle whose corners were all rounded to one place has no side, and covers nothing.
            let signs = sides(t).map(|[p, q]| orientation(p, q, at).signum());
            signs == [1; 3] || signs == [-1; 3]
        };
        let count = triangles.iter().filter(covers).count();
        assert_eq!(count, usize::from(is_inside(rings, at)), "{at:?} of {tell}");
    }
}

/// Sides that no other triangle has lie on the polygon's edges.
fn check_joints(rings: &Rings, triangles: &[[Point; 3]], tell: &str) {
    let mut sides: HashMap<[Point; 2], i32> = HashMap::new();
    for t in triangles {
        for [p, q] in [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]] {
            if p != q {
                *sides.entry([p, q]).or_default() += 1;
                *sides.entry([q, p]).or_default() -= 1;
            }
        }
    }
    for ([p, q], _) in sides.into_iter().filter(|(_, count)| *count > 0) {
        let on = |e: [Point; 2]| distance(e, p) < 2.0 && distance(e, q) < 2.0;
        assert!(edges(rings).any(on), "{p:?} {q:?} alone in {tell}");
    }
}

fn check(kind: Kind) {
    let count = std::env::var("MICROLUX_POLYGONS").map_or(300, |n| n.parse().unwrap());
    let mut random = Random(kind as u32 + 1, 0);
    for case in 0..count {
        let rings = make(kind, &mut random);
        let points: Vec<Point> = rings.concat();
        let tell = format!("{kind:?} {case}: {rings:?}");
        let (pieces, corners) = cut(&rings, Fill::EvenOdd);
        let place = |corner: Corner| match corner {
            Corner::Vertex(vertex) => points[vertex as usize],
            Corner::Crossing(place) => place,
        };
        let triangles: Vec<_> = corners.iter().map(|t| t.map(place)).collect();
        let crossings = corners
            .iter()
            .flatten()
            .filter(|c| matches!(c, Corner::Crossing(_)));
        let twice: i64 = triangles.iter().map(|[a, b, c]| orientation(*a, *b, *c)).sum();
        let (area, wanted) = (twice as f64 / 2.0, area(&rings));
        // A crossing moves by less than a unit, and with it at most two edges of the polygon. What is wanted is itself
        // a sum of f64 terms of up to 1e12, of which nothing may be left in the end.
        let reach = 4e6 * crossings.count() as f64;
        assert!(
            (area - wanted).abs() <= reach + 1e-9 * wanted + 1e-3,
            "{area} of {wanted}: {tell}"
        );
        check_cover(&rings, &triangles, &mut random, &tell);
        check_joints(&rings, &triangles, &tell);
        for t in corners
            .iter()
            .filter(|t| t.iter().all(|c| matches!(c, Corner::Vertex(_))))
        {
            let [a, b, c] = t.map(place);
            assert!(orientation(a, b, c) > 0, "{t:?} has no area or is turned: {tell}");
        }
        for piece in &pieces {
            let exact = piece.iter().all(|c| matches!(c, Corner::Vertex(_)));
            let n = piece.len();
            let turns = (0..n).map(|i| [i, (i + 1) % n, (i + 2) % n].map(|i| place(piece[i])));
            for [a, b, c] in turns.filter(|_| exact) {
                assert!(
                    orientation(a, b, c) > 0,
                    "{piece:?} is not strictly convex: {tell}"
                );
            }
        }
        if kind == Kind::Convex {
            assert_eq!((pieces.len(), triangles.len()), (1, points.len() - 2), "{tell}");
        }
        if matches!(kind, Kind::Convex | Kind::Star | Kind::Simple | Kind::Holes) {
            check_earcut(&rings, wanted, &mut random, &tell);
        }
    }
}

/// Another program's triangles have the same area, and cover by the same measure.
fn check_earcut(rings: &Rings, wanted: f64, random: &mut Random, tell: &str) {
    let points: Vec<Point> = rings.concat();
    let mut found: Vec<usize> = Vec::new();
    let holes: Vec<usize> = rings
        .iter()
        .scan(0, |end, ring| {
            *end += ring.len();
            Some(*end)
        })
        .take(rings.len() - 1)
        .collect();
    Earcut::new().earcut(points.iter().map(|p| p.map(f64::from)), &holes, &mut found);
    let triangles: Vec<_> = found.chunks(3).map(|t| [0, 1, 2].map(|i| points[t[i]])).collect();
    let area: f64 = triangles
        .iter()
        .map(|[a, b, c]| orientation(*a, *b, *c).abs() as f64 / 2.0)
        .sum();
    assert!(
        (area - wanted).abs() <= 1e-9 * wanted,
        "earcut: {area} of {wanted}: {tell}"
    );
    check_cover(rings, &triangles, random, tell);
}

#[test]
fn convex() {
    check(Kind::Convex);
}

#[test]
fn concave() {
    check(Kind::Star);
}

#[test]
fn any_simple_one() {
    check(Kind::Simple);
}

#[test]
fn collinear_and_repeated_points() {
    check(Kind::Collinear);
}

#[test]
fn holes() {
    check(Kind::Holes);
}

#[test]
fn touching_itself() {
    check(Kind::Touching);
}

#[test]
fn crossing_itself() {
    check(Kind::Crossing);
}

#[test]
fn winding_decides_where_it_is_asked() {
    // A square gone around twice, and a pentagram: the middle is inside by winding, outside by parity.
    let square = vec![[0, 0], [10, 0], [10, 10], [0, 10]];
    let rings = vec![[square.clone(), square].concat()];
    let area = |fill| {
        let (_, triangles) = cut(&rings, fill);
        triangles.len()
    };
    assert_eq!((area(Fill::EvenOdd), area(Fill::NonZero)), (0, 2));
    let star = vec![vec![
        [0, 1000],
        [588, -809],
        [-951, 309],
        [951, 309],
        [-588, -809],
    ]];
    let pieces = |fill| cut(&star, fill).0.len();
    assert!(pieces(Fill::NonZero) > pieces(Fill::EvenOdd));
}

#[test]
fn what_is_wrong_is_named() {
    let points = [[0, 0], [1 << 21, 0], [0, 1]];
    let cut = |points: &[Point], ends: &[u16]| {
        Workspace::<16>::new().triangulate(
            &Polygon {
                points,
                ends,
                fill: Fill::EvenOdd,
            },
            |_| {},
        )
    };
    assert_eq!(cut(&points, &[3]), Err(PolygonError::TooFar { point: 1 }));
    assert_eq!(cut(&points[..1], &[2]), Err(PolygonError::Ring { ring: 0 }));
    assert_eq!(cut(&points[..1], &[]), Err(PolygonError::Ring { ring: 0 }));
    let many: Vec<Point> = (0..16).map(|i| [i, i * i]).collect();
    assert_eq!(cut(&many, &[16]), Err(PolygonError::Room { sides: 16 }));
    assert_eq!(cut(&[], &[]), Ok(()));
}
