//! Meshes in grids of their own, with what their vertices say.

use std::collections::HashMap;

use microlux::bvh::Node;
use microlux::geom::{Octahedral, Point};
use microlux::scene::Mesh;
use microlux::shape::{Attributes, Grid, TriangleMesh, Triangles};

use super::QuantiseError;
use super::rounding::{Rounding, dir};
use crate::bake;
use crate::desc::{MeshDesc, TintDesc, Vec3};
use crate::import::math::{cross, dot, length, sub};
use crate::picture::srgb;

/// A mesh in its own grid, with the tree over it.
#[derive(Debug)]
pub struct OwnedMesh {
    /// Of the first shape that is made of it.
    pub name: String,
    /// By how far rounding moved a vertex, metres: at most, and as root of the mean square.
    pub displacement: [f64; 2],
    /// Longest side, metres.
    pub extent: f64,
    grid: Grid,
    vertices: Vec<[u16; 3]>,
    triangles: Vec<[u16; 3]>,
    /// One of each a vertex, or none.
    normals: Vec<Octahedral>,
    colors: Vec<[u8; 3]>,
    uvs: Vec<[i16; 2]>,
    nodes: Vec<Node>,
}

impl OwnedMesh {
    pub fn borrow(&self) -> Mesh<'_> {
        let triangles = TriangleMesh {
            grid: self.grid,
            vertices: &self.vertices,
            triangles: &self.triangles,
            attributes: Attributes {
                normals: &self.normals,
                colors: &self.colors,
                uvs: &self.uvs,
            },
        };
        Mesh {
            triangles: triangles.into(),
            nodes: &self.nodes,
        }
    }
}

impl Rounding {
    /// Into the finest cube around it; triangles that lose their area there are left out.
    pub fn mesh(
        &self,
        name: &str,
        mesh: &MeshDesc,
        tint: Option<&TintDesc>,
    ) -> Result<OwnedMesh, QuantiseError> {
        let error = |what: String| QuantiseError::Unsupported {
            name: name.to_string(),
            what,
        };
        let points: Vec<Point> = mesh.vertices.iter().map(|v| self.point(*v)).collect();
        let (low, high) = points
            .iter()
            .fold(([i32::MAX; 3], [i32::MIN; 3]), |(low, high), p| {
                (
                    [0, 1, 2].map(|i| low[i].min(p.0[i])),
                    [0, 1, 2].map(|i| high[i].max(p.0[i])),
                )
            });
        let grid = Grid::around(Point(low), Point(high), Grid::MARGIN);
        let grid = grid.ok_or_else(|| error("reaches too far, or has no vertices".into()))?;
        let step = f64::from(grid.shift()).exp2();
        let to_grid = |v: &Vec3| {
            [0, 1, 2].map(|i| {
                let units = (v[i] - self.origin[i]) * self.scale - f64::from(grid.origin().0[i]);
                (units / step)
                    .round()
                    .clamp(f64::from(Grid::MARGIN), f64::from(u16::MAX - Grid::MARGIN)) as u16
            })
        };
        let vertices: Vec<_> = mesh.vertices.iter().map(to_grid).collect();
        let said = Said {
            normals: normals(mesh),
            colors: match tint {
                Some(TintDesc::Vertices) => mesh.colors.iter().map(|color| color.map(signal)).collect(),
                _ => Vec::new(),
            },
            uvs: match tint {
                Some(TintDesc::Texture { to_uv, .. }) => uvs(mesh, to_uv).map_err(error)?,
                _ => Vec::new(),
            },
        };
        let after = vertices.iter().map(|&vertex| {
            let point = grid.to_scene(vertex).0;
            [0, 1, 2].map(|i| self.origin[i] + f64::from(point[i]) / self.scale)
        });
        let (displacement, extent) = moved(&mesh.vertices, after);
        let (vertices, said, places) = said.joined(&vertices);
        if vertices.len() > 1 << 16 {
            let count = vertices.len();
            return Err(error(format!(
                "has {count} vertices; a mesh can have 65536: split it"
            )));
        }
        let place = |i: u32| places[i as usize] as u16;
        let mut triangles: Vec<_> = mesh.triangles.iter().map(|t| t.map(place)).collect();
        let whole = Triangles::Plain(TriangleMesh {
            grid,
            vertices: &vertices,
            triangles: &triangles,
            attributes: Attributes::NONE,
        });
        let kept: Vec<bool> = (0..triangles.len())
            .map(|i| whole.normal(i as u32).is_some())
            .collect();
        let mut kept = kept.into_iter();
        triangles.retain(|_| kept.next().unwrap_or(false));
        if triangles.is_empty() {
            return Err(error("has no triangle with an area".into()));
        }
        let nodes = bake::build(&vertices, &mut triangles).map_err(|e| {
            error(format!(
                "needs {} nodes; a mesh can have 65536: split it",
                e.needed
            ))
        })?;
        Ok(OwnedMesh {
            name: name.to_string(),
            displacement,
            extent,
            grid,
            vertices,
            triangles,
            normals: said.normals,
            colors: said.colors,
            uvs: said.uvs,
            nodes,
        })
    }
}

/// What vertices say beside their places: one of each, or none.
#[derive(Default)]
struct Said {
    normals: Vec<Octahedral>,
    colors: Vec<[u8; 3]>,
    uvs: Vec<[i16; 2]>,
}

impl Said {
    /// Vertices that are alike in everything become one; and for each of before which that is.
    fn joined(&self, vertices: &[[u16; 3]]) -> (Vec<[u16; 3]>, Said, Vec<usize>) {
        let (mut joined, mut said) = (Vec::new(), Said::default());
        let mut known = HashMap::new();
        let mut places = Vec::with_capacity(vertices.len());
        for (i, &vertex) in vertices.iter().enumerate() {
            let (normal, color, uv) = (self.normals.get(i), self.colors.get(i), self.uvs.get(i));
            places.push(*known.entry((vertex, normal, color, uv)).or_insert_with(|| {
                joined.push(vertex);
                said.normals.extend(normal);
                said.colors.extend(color);
                said.uvs.extend(uv);
                joined.len() - 1
            }));
        }
        (joined, said, places)
    }
}

/// The nearest sRGB byte.
pub(super) fn signal(light: f64) -> u8 {
    (srgb(light) * 255.0).round() as u8
}

/// Places in a texture in steps of 2^-12, moved by whole turns so that they lie about 0.
fn uvs(mesh: &MeshDesc, to_uv: &[[f64; 3]; 2]) -> Result<Vec<[i16; 2]>, String> {
    let moved: Vec<[f64; 2]> = mesh
        .uvs
        .iter()
        .map(|[u, v]| to_uv.map(|row| row[0] * u + row[1] * v + row[2]))
        .collect();
    let turns = [0, 1].map(|i| {
        let along = moved.iter().map(|uv| uv[i]);
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| {
            (low.min(c), high.max(c))
        });
        ((low + high) / 2.0).floor()
    });
    let step = |uv: &[f64; 2]| {
        let steps = [0, 1].map(|i| ((uv[i] - turns[i]) * 4096.0).round());
        let fits = steps.iter().all(|c| (-32768.0..=32767.0).contains(c));
        fits.then(|| steps.map(|c| c as i16))
    };
    let steps: Option<Vec<_>> = moved.iter().map(step).collect();
    steps.ok_or_else(|| {
        "repeats its texture more than 16 times, or its uvs are not finite; split it, or scale them"
            .to_string()
    })
}

/// Largest and root mean square distance between two lists of points, and the longest side of the first.
fn moved(before: &[Vec3], after: impl Iterator<Item = Vec3>) -> ([f64; 2], f64) {
    let (mut worst, mut sum) = (0f64, 0.0);
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for (a, b) in before.iter().zip(after) {
        let square: f64 = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum();
        (worst, sum) = (worst.max(square), sum + square);
        low = [0, 1, 2].map(|i| low[i].min(a[i]));
        high = [0, 1, 2].map(|i| high[i].max(a[i]));
    }
    let extent = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
    let mean = sum / before.len().max(1) as f64;
    ([worst.sqrt(), mean.sqrt()], extent)
}

/// Smooth normals in two bytes each; none for a mesh whose vertices all have their faces' own, to half a degree.
fn normals(mesh: &MeshDesc) -> Vec<Octahedral> {
    const FLAT: f64 = 0.99996;
    let is_flat = |triangle: &[u32; 3]| {
        let corner = |i: usize| mesh.vertices[triangle[i] as usize];
        let (e, f) = (sub(corner(1), corner(0)), sub(corner(2), corner(0)));
        let face = cross(e, f);
        let along = |&index: &u32| dot(mesh.normals[index as usize], face) >= FLAT * length(face);
        triangle.iter().all(along)
    };
    if mesh.normals.is_empty() || mesh.triangles.iter().all(is_flat) {
        return Vec::new();
    }
    mesh.normals
        .iter()
        .map(|&normal| Octahedral::encode(dir(normal)))
        .collect()
}
