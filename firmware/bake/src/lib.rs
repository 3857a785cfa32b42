//! Turns a mesh into what lies in a chip's flash: vertices in a 16-bit cube, the tree, packed, and a scene about it.
//!
//! The cube stands for 2 m: x and z from -1 m to 1 m, y from 0 to 2 m. A mesh stands on its floor, in the middle.

mod knot;
mod obj;
mod pedestal;
mod room;

use microlux::bvh::{Node, max_nodes};
use microlux::geom::{Point, Unit};
use microlux::integrator::AmbientOcclusion;
use microlux::scene::{SceneError, Shot, Technique};
use microlux::shape::{Attributes, Grid, TriangleMesh};
use microlux_bake::{Packed, scene_blob};

pub use microlux_bake::Aligned;

pub use knot::knot;
pub use obj::obj;
use pedestal::pedestal;
pub use room::Room;

/// A mesh in the cube, and as it lies in flash.
#[derive(Clone, Debug)]
pub struct Baked {
    pub vertices: Vec<[u16; 3]>,
    pub triangles: Vec<[u16; 3]>,
    /// The tree over the triangles as they are indexed.
    pub nodes: Vec<Node>,
    pub packed: Packed,
}

/// Steps of the cube that the mesh's longest side takes: 1.7 m.
const LONGEST: f64 = 55_700.0;
/// Steps between the floor and the mesh.
const LIFT: f64 = 64.0;

impl Baked {
    /// Scales the mesh to the cube and builds the tree over it; triangles that the rounding makes empty are left out.
    pub fn new(points: &[[f64; 3]], faces: &[[usize; 3]]) -> Result<Baked, String> {
        if points.len() > 1 << 16 {
            return Err(format!("{} vertices; 65,536 can be numbered", points.len()));
        }
        let end = |axis: usize, pick: fn(f64, f64) -> f64| {
            points
                .iter()
                .map(|p| p[axis])
                .reduce(pick)
                .ok_or("the mesh has no vertices")
        };
        let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            (low[axis], high[axis]) = (end(axis, f64::min)?, end(axis, f64::max)?);
        }
        let longest = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
        if !(longest > 0.0 && longest.is_finite()) {
            return Err("the mesh has no extent".to_owned());
        }
        let scale = LONGEST / longest;
        let place = |p: &[f64; 3]| {
            let middle = |axis: usize| 32_768.0 + (p[axis] - (low[axis] + high[axis]) / 2.0) * scale;
            [middle(0), LIFT + (p[1] - low[1]) * scale, middle(2)].map(|c| c.round() as u16)
        };
        let vertices: Vec<_> = points.iter().map(place).collect();
        let mut triangles = Vec::new();
        for face in faces {
            if face.iter().any(|&corner| corner >= vertices.len()) {
                return Err(format!("triangle {face:?} names a vertex that is not there"));
            }
            if !is_empty(face.map(|corner| vertices[corner])) {
                triangles.push(face.map(|corner| corner as u16));
            }
        }
        let nodes = microlux_bake::build(&vertices, &mut triangles).map_err(|error| format!("{error:?}"))?;
        let mesh = TriangleMesh {
            grid: grid(),
            vertices: &vertices,
            triangles: &triangles,
            attributes: Attributes::NONE,
        };
        let packed = Packed::new(&mesh, &nodes).map_err(|error| error.to_string())?;
        Ok(Baked {
            vertices,
            triangles,
            nodes,
            packed,
        })
    }

    /// What lies in flash, for `microlux::scene::Baked` to open: the whole scene.
    pub fn blob(&self) -> Result<Vec<u8>, String> {
        let refused = |error: SceneError| error.to_string();
        let (mut builder, camera) = pedestal().map_err(refused)?;
        let (meshes, mut nodes) = ([self.packed.mesh()], [Node::EMPTY; max_nodes(3)]);
        let scene = builder.build_with(&meshes, &mut nodes).map_err(refused)?;
        let shot = Shot {
            camera,
            width: 240,
            height: 240,
            spp: 1,
            technique: Technique::Path,
            max_depth: 8,
            rr_depth: 5,
            hide_emitters: false,
            ao_radius: AmbientOcclusion::FULL,
        };
        let packed = std::slice::from_ref(&self.packed);
        scene_blob(packed, scene.parts(), &shot).map_err(|error| error.to_string())
    }
}

/// 2 m: 65,536 steps of two units, from (-1, 0, -1) m.
fn grid() -> Grid {
    let metre = 1 << Unit::DEFAULT.fraction_bits();
    Grid::new(Point([-metre, 0, -metre]), 1).unwrap_or(Grid::UNIT)
}

/// Whether the corners lie in a line.
fn is_empty([a, b, c]: [[u16; 3]; 3]) -> bool {
    let to = |p: [u16; 3]| [0, 1, 2].map(|axis| i64::from(p[axis]) - i64::from(a[axis]));
    let (u, v) = (to(b), to(c));
    [(1, 2), (2, 0), (0, 1)]
        .iter()
        .all(|&(i, j)| u[i] * v[j] == u[j] * v[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stands_on_the_floor_in_the_middle() {
        let points = [[1.0, 5.0, 1.0], [3.0, 5.0, 1.0], [3.0, 6.0, 2.0], [2.0, 5.0, 1.0]];
        let baked = Baked::new(&points, &[[0, 1, 2], [0, 1, 3]]).unwrap();
        assert_eq!(baked.vertices[0], [32_768 - 27_850, 64, 32_768 - 13_925]);
        assert_eq!(baked.vertices[2][1], 64 + 27_850);
        assert_eq!(baked.triangles, [[0, 1, 2]], "the other one is a line");
    }

    #[test]
    fn refuses_what_it_cannot_number() {
        assert!(Baked::new(&[[0.0; 3], [1.0; 3]], &[[0, 1, 2]]).is_err());
        assert!(Baked::new(&[], &[]).is_err());
    }
}
