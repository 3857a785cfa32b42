//! Meshes and rays for the tests of shapes and trees.

use microlux::bvh::{Node, build_mesh, check_mesh, max_nodes};
use microlux::geom::{Dir, Point, Ray};
use microlux::shape::{Attributes, Grid, TriangleMesh, Triangles};
use std::collections::HashMap;
use std::f64::consts::TAU;

/// A mesh with its tree.
pub struct Model {
    pub name: String,
    pub grid: Grid,
    pub vertices: Vec<[u16; 3]>,
    pub triangles: Vec<[u16; 3]>,
    pub nodes: Vec<Node>,
}

impl Model {
    pub fn new(name: &str, grid: Grid, vertices: Vec<[u16; 3]>, mut triangles: Vec<[u16; 3]>) -> Model {
        let mut nodes = vec![Node::EMPTY; max_nodes(triangles.len())];
        let used = build_mesh(&vertices, &mut triangles, &mut nodes).unwrap();
        nodes.truncate(used);
        let mesh = TriangleMesh {
            grid,
            vertices: &vertices,
            triangles: &triangles,
            attributes: Attributes::NONE,
        };
        let depth = check_mesh(&mesh.into(), &nodes).unwrap();
        let each = used as f64 / triangles.len() as f64;
        println!(
            "{name}: {} triangles, {used} nodes ({each:.3} each), depth {depth}",
            triangles.len()
        );
        Model {
            name: name.to_string(),
            grid,
            vertices,
            triangles,
            nodes,
        }
    }

    /// Scaled to fill the grid as far as its margin.
    fn scaled(name: &str, shift: u8, vertices: &[[f64; 3]], triangles: Vec<[u16; 3]>) -> Model {
        let fold = |a: usize, f: fn(f64, f64) -> f64| vertices.iter().map(|v| v[a]).reduce(f).unwrap();
        let low = [0, 1, 2].map(|a| fold(a, f64::min));
        let extent = (0..3)
            .map(|a| fold(a, f64::max) - low[a])
            .reduce(f64::max)
            .unwrap();
        let margin = Grid::MARGIN as f64;
        let scale = (65535.0 - 2.0 * margin) / extent;
        let vertices = vertices
            .iter()
            .map(|v| [0, 1, 2].map(|a| (margin + (v[a] - low[a]) * scale).round() as u16))
            .collect();
        let corner = -(32768 << shift);
        let grid = Grid::new(Point([corner + 12345, corner - 777, corner]), shift).unwrap();
        Model::new(name, grid, vertices, triangles)
    }

    pub fn plain(&self) -> TriangleMesh<'_> {
        TriangleMesh {
            grid: self.grid,
            vertices: &self.vertices,
            triangles: &self.triangles,
            attributes: Attributes::NONE,
        }
    }

    pub fn mesh(&self) -> Triangles<'_> {
        self.plain().into()
    }
}

/// pcg-rxs-m-xs-32.
pub struct Random(pub u32);

impl Random {
    pub fn bits(&mut self) -> u32 {
        let o = self.0;
        self.0 = o.wrapping_mul(747796405).wrapping_add(2891336453);
        let w = ((o >> ((o >> 28) + 4)) ^ o).wrapping_mul(277803737);
        (w >> 22) ^ w
    }

    pub fn below(&mut self, n: u32) -> u32 {
        ((self.bits() as u64 * n as u64) >> 32) as u32
    }

    pub fn unit(&mut self) -> f64 {
        self.bits() as f64 / 4294967296.0
    }

    pub fn dir(&mut self) -> Dir {
        let z = 2.0 * self.unit() - 1.0;
        let (s, c) = (self.unit() * TAU).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Dir([r * c, r * s, z].map(|x| (x * 65536.0).round() as i32))
    }

    /// Within the grid's cube, or a few times around it.
    pub fn point(&mut self, grid: &Grid, times: f64) -> Point {
        let size = (65536u32 << grid.shift()) as f64;
        let mut coordinate = |o: i32| o + ((0.5 + (self.unit() - 0.5) * times) * size) as i32;
        let [x, y, z] = grid.origin().0;
        Point([coordinate(x), coordinate(y), coordinate(z)])
    }

    /// One of all kinds: from in and out of the cube and from vertices; random, along axes, along diagonals; towards
    /// vertices, edges and centres of triangles.
    pub fn ray(&mut self, model: &Model) -> Ray {
        let grid = &model.grid;
        let origin = match self.below(8) {
            0..=3 => self.point(grid, 1.0),
            4 | 5 => self.point(grid, 3.0),
            6 => self.point(grid, 100.0),
            _ => grid.to_scene(model.vertices[self.below(model.vertices.len() as u32) as usize]),
        };
        let dir = match self.below(8) {
            0..=2 => Some(self.dir()),
            3 => {
                let mut c = || self.below(3) as i32 - 1;
                Dir::new([c(), c(), c()])
            }
            kind => {
                let triangle = model.triangles[self.below(model.triangles.len() as u32) as usize];
                let corners = triangle.map(|i| grid.to_scene(model.vertices[i as usize]).0);
                let weights = match kind {
                    4 => [1, 0, 0],
                    5 => [1, 1, 0],
                    6 => [1, 1, 1],
                    _ => [1, self.below(100) as i64, 0],
                };
                let sum: i64 = weights.iter().sum();
                let at = [0, 1, 2]
                    .map(|a| ((0..3).map(|i| corners[i][a] as i64 * weights[i]).sum::<i64>() / sum) as i32);
                origin.to(Point(at)).normalize().map(|(dir, _)| dir)
            }
        };
        Ray {
            origin,
            dir: dir.unwrap_or(Dir::Z),
        }
    }
}

/// An icosahedron whose faces are split `levels` times, pushed out to a sphere: closed, 20·4^levels triangles.
pub fn icosphere(levels: u32, shift: u8) -> Model {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut vertices: Vec<[f64; 3]> = Vec::new();
    for (a, b) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
        vertices.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]]);
    }
    let length = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let near = |a: [f64; 3], b: [f64; 3]| length([0, 1, 2].map(|i| a[i] - b[i])) < 2.1;
    let mut triangles: Vec<[u16; 3]> = Vec::new();
    for i in 0..12 {
        for j in 0..i {
            for k in 0..j {
                let (a, b, c) = (vertices[i], vertices[j], vertices[k]);
                if near(a, b) && near(b, c) && near(c, a) {
                    triangles.push([i, j, k].map(|i| i as u16));
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |a: u16, b: u16| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    vertices.push([0, 1, 2].map(|i| vertices[a as usize][i] + vertices[b as usize][i]));
                    (vertices.len() - 1) as u16
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
        vertices = vertices.iter().map(|&v| v.map(|c| c / length(v))).collect();
    }
    Model::scaled(&format!("icosphere {levels}"), shift, &vertices, triangles)
}

/// A tube along a (2, 3) torus knot: closed, 2·`around`·`along` triangles.
pub fn torus_knot(along: u32, around: u32, shift: u8) -> Model {
    let curve = |t: f64| {
        let r = 2.0 + (3.0 * t).cos();
        [r * (2.0 * t).cos(), r * (2.0 * t).sin(), (3.0 * t).sin()]
    };
    let mut vertices = Vec::new();
    for i in 0..along {
        let t = i as f64 / along as f64 * TAU;
        let (p, q) = (curve(t), curve(t + 1e-3));
        // Two directions across the curve: outwards from the axis, and up.
        let out = [p[0], p[1], 0.0];
        let ahead = [0, 1, 2].map(|a| (q[a] - p[a]) * 1e3);
        let up = [
            out[1] * ahead[2] - out[2] * ahead[1],
            out[2] * ahead[0] - out[0] * ahead[2],
            out[0] * ahead[1] - out[1] * ahead[0],
        ];
        let length = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
        for j in 0..around {
            let (s, c) = (j as f64 / around as f64 * TAU).sin_cos();
            vertices
                .push([0, 1, 2].map(|a| p[a] + 0.4 * (c * out[a] / length(out) + s * up[a] / length(up))));
        }
    }
    let index = |i: u32, j: u32| ((i % along) * around + j % around) as u16;
    let quad = |(i, j): (u32, u32)| {
        let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..along)
        .flat_map(|i| (0..around).map(move |j| (i, j)))
        .flat_map(quad)
        .collect();
    Model::scaled("torus knot", shift, &vertices, triangles)
}

/// Twelve triangles that fill the cube.
pub fn room(shift: u8) -> Model {
    let vertices: Vec<[f64; 3]> = (0..8)
        .map(|i| [i & 1, i >> 1 & 1, i >> 2].map(|b| b as f64))
        .collect();
    let quads = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ];
    let triangles = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    Model::scaled("room", shift, &vertices, triangles)
}

/// Triangles of all sizes, slivers, flat ones, some twice.
pub fn soup(count: u32, shift: u8) -> Model {
    let mut random = Random(count);
    let (low, high) = (Grid::MARGIN as i32, 65535 - Grid::MARGIN as i32);
    let mut vertices: Vec<[u16; 3]> = Vec::new();
    let mut triangles = Vec::new();
    for _ in 0..count {
        let size = 1 << random.below(18);
        let centre = [0; 3].map(|_| random.below(65536) as i32);
        let flat = random.below(8) as usize;
        let base = vertices.len() as u16;
        for i in 0..3 {
            let mut v = [0, 1, 2].map(|a| {
                let around = if a == flat {
                    0
                } else {
                    random.below(2 * size + 1) as i32 - size as i32
                };
                (centre[a] + around).clamp(low, high) as u16
            });
            // One in eight is a sliver: its last corner next to its first.
            if i == 2 && random.below(8) == 0 {
                v = vertices[base as usize].map(|c| (c + random.below(2) as u16).min(high as u16));
            }
            vertices.push(v);
        }
        triangles.push([base, base + 1, base + 2]);
        if random.below(16) == 0 {
            triangles.push([base + 1, base, base + 2]);
        }
    }
    let corner = -(32768 << shift);
    Model::new(
        "soup",
        Grid::new(Point([corner; 3]), shift).unwrap(),
        vertices,
        triangles,
    )
}

/// The OBJ files beside the repository, by name; none where they are not.
pub fn files() -> Vec<Model> {
    // From the core's folder, or from that of a package within it.
    let here = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = ["../shared/meshes", "../../shared/meshes"].map(|folder| here.join(folder));
    let Some(entries) = folders.iter().find_map(|folder| std::fs::read_dir(folder).ok()) else {
        println!("no meshes in {folders:?}: only the generated ones are tested");
        return Vec::new();
    };
    let mut paths: Vec<_> = entries
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "obj"))
        .collect();
    paths.sort();
    paths.iter().map(|path| obj(path, 6)).collect()
}

/// Positions and faces (fans) of an OBJ file.
fn obj(path: &std::path::Path, shift: u8) -> Model {
    let text = std::fs::read_to_string(path).unwrap();
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let c: Vec<f64> = words.map(|w| w.parse().unwrap()).collect();
                vertices.push([c[0], c[1], c[2]]);
            }
            Some("f") => {
                let index = |w: &str| (w.split('/').next().unwrap().parse::<usize>().unwrap() - 1) as u16;
                let face: Vec<u16> = words.map(index).collect();
                triangles.extend(face.windows(2).skip(1).map(|w| [face[0], w[0], w[1]]));
            }
            _ => {}
        }
    }
    let name = path.file_stem().unwrap().to_string_lossy();
    Model::scaled(&name, shift, &vertices, triangles)
}
