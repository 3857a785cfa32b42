//! Meshes in our grid: from a file, or a tube along a torus knot.

use std::f64::consts::TAU;

use microlux::bvh::Node;
use microlux::geom::{Point, Ray};
use microlux::shape::{Attributes, Grid, TriangleMesh};

/// In the unit grid, so that coordinates are integers of 16 bits for everybody; with our tree over it.
pub struct Model {
    pub vertices: Vec<[u16; 3]>,
    pub triangles: Vec<[u16; 3]>,
    pub nodes: Vec<Node>,
    pub low: [i32; 3],
    pub high: [i32; 3],
}

impl Model {
    pub fn new(name: &str) -> Result<Model, String> {
        let (points, faces) = match name.strip_prefix("knot:").and_then(|size| size.split_once('x')) {
            Some((along, around)) => {
                let number = |text: &str| text.parse().map_err(|_| format!("{name}?"));
                knot(number(along)?, number(around)?)
            }
            None => obj(&std::fs::read_to_string(name).map_err(|error| format!("{name}: {error}"))?)?,
        };
        if points.len() > 1 << 16 {
            return Err(format!("{} vertices; 65,536 can be numbered", points.len()));
        }
        let end = |axis: usize, pick: fn(f64, f64) -> f64| {
            points.iter().map(|p| p[axis]).reduce(pick).unwrap_or(0.0)
        };
        let low = [0, 1, 2].map(|axis| end(axis, f64::min));
        let extent = (0..3)
            .map(|axis| end(axis, f64::max) - low[axis])
            .fold(1e-9, f64::max);
        let margin = f64::from(Grid::MARGIN);
        let scale = (65_535.0 - 2.0 * margin) / extent;
        let place =
            |p: &[f64; 3]| [0, 1, 2].map(|axis| (margin + (p[axis] - low[axis]) * scale).round() as u16);
        let vertices: Vec<[u16; 3]> = points.iter().map(place).collect();
        let mut triangles: Vec<[u16; 3]> = faces
            .iter()
            .map(|face| face.map(|corner| corner as u16))
            .filter(|face| !is_line(face.map(|corner| vertices[corner as usize])))
            .collect();
        let nodes = microlux_bake::build(&vertices, &mut triangles).map_err(|error| format!("{error:?}"))?;
        let coordinate = |axis: usize| vertices.iter().map(move |v| i32::from(v[axis]));
        Ok(Model {
            low: [0, 1, 2].map(|axis| coordinate(axis).min().unwrap_or(0)),
            high: [0, 1, 2].map(|axis| coordinate(axis).max().unwrap_or(0)),
            vertices,
            triangles,
            nodes,
        })
    }

    pub fn plain(&self) -> TriangleMesh<'_> {
        TriangleMesh {
            grid: Grid::UNIT,
            vertices: &self.vertices,
            triangles: &self.triangles,
            attributes: Attributes::NONE,
        }
    }

    /// Corners in f32, exactly.
    pub fn corners(&self, triangle: usize) -> [[f32; 3]; 3] {
        self.triangles[triangle].map(|corner| self.vertices[corner as usize].map(f32::from))
    }

    /// Whether a ray passes within `rounding` of an edge of a triangle.
    pub fn is_at_rim(&self, ray: &Ray, triangle: u32, rounding: f32) -> bool {
        let Some(corners) = self.triangles.get(triangle as usize) else {
            return false;
        };
        let corners = corners.map(|corner| self.vertices[corner as usize].map(f64::from));
        (0..3).any(|at| distance(ray, corners[at], corners[(at + 1) % 3]) <= f64::from(rounding))
    }
}

/// Between a ray's line and an edge.
fn distance(ray: &Ray, a: [f64; 3], b: [f64; 3]) -> f64 {
    let Point(origin) = ray.origin;
    let dir = ray.dir.0.map(|c| f64::from(c) / 65_536.0);
    let sub = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|axis| a[axis] - b[axis]);
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|axis| a[axis] * b[axis]).sum::<f64>();
    // Both without what lies along the ray.
    let aside = |v: [f64; 3]| {
        let along = dot(v, dir) / dot(dir, dir);
        [0, 1, 2].map(|axis| v[axis] - along * dir[axis])
    };
    let (a, edge) = (aside(sub(a, origin.map(f64::from))), aside(sub(b, a)));
    let along = (-dot(a, edge) / dot(edge, edge).max(1e-12)).clamp(0.0, 1.0);
    let nearest = [0, 1, 2].map(|axis| a[axis] + along * edge[axis]);
    dot(nearest, nearest).sqrt()
}

fn is_line([a, b, c]: [[u16; 3]; 3]) -> bool {
    let to = |p: [u16; 3]| [0, 1, 2].map(|axis| i64::from(p[axis]) - i64::from(a[axis]));
    let (u, v) = (to(b), to(c));
    [(1, 2), (2, 0), (0, 1)]
        .iter()
        .all(|&(i, j)| u[i] * v[j] == u[j] * v[i])
}

type Shape = (Vec<[f64; 3]>, Vec<[usize; 3]>);

fn obj(text: &str) -> Result<Shape, String> {
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for (number, line) in (1..).zip(text.lines()) {
        let wrong = || format!("line {number}: {line:?}");
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let mut next = || {
                    words
                        .next()
                        .and_then(|word| word.parse::<f64>().ok())
                        .ok_or_else(wrong)
                };
                points.push([next()?, next()?, next()?]);
            }
            Some("f") => {
                let corner = |word: &str| word.split('/').next()?.parse::<usize>().ok()?.checked_sub(1);
                let corners = words.map(corner).collect::<Option<Vec<_>>>().ok_or_else(wrong)?;
                for pair in corners.get(1..).unwrap_or(&[]).windows(2) {
                    faces.push([corners[0], pair[0], pair[1]]);
                }
            }
            _ => {}
        }
    }
    match faces.as_flattened().iter().all(|&corner| corner < points.len()) {
        true => Ok((points, faces)),
        false => Err("a face names a vertex that is not there".to_owned()),
    }
}

/// A tube along the (2, 3) torus knot, 2 · along · around triangles.
fn knot(along: usize, around: usize) -> Shape {
    let at = |t: f64| {
        let r = 0.62 + 0.27 * (3.0 * t).cos();
        [r * (2.0 * t).cos(), r * (2.0 * t).sin(), 0.27 * (3.0 * t).sin()]
    };
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
    };
    let unit = |v: [f64; 3]| {
        let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
        v.map(|c| c / length)
    };
    let mut points = Vec::new();
    for i in 0..along {
        let t = TAU * i as f64 / along as f64;
        let (before, here, after) = (at(t - 1e-4), at(t), at(t + 1e-4));
        let tangent = unit([0, 1, 2].map(|axis| after[axis] - before[axis]));
        let side = unit(cross(tangent, [0.3, 0.5, 0.81]));
        let up = cross(tangent, side);
        for j in 0..around {
            let (sin, cos) = (TAU * j as f64 / around as f64).sin_cos();
            points.push([0, 1, 2].map(|axis| here[axis] + 0.15 * (cos * side[axis] + sin * up[axis])));
        }
    }
    let vertex = |i: usize, j: usize| (i % along) * around + j % around;
    let mut faces = Vec::new();
    for i in 0..along {
        for j in 0..around {
            let [a, b, c, d] = [
                vertex(i, j),
                vertex(i, j + 1),
                vertex(i + 1, j + 1),
                vertex(i + 1, j),
            ];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    (points, faces)
}
