//! What every mesh goes through between its file and the scene: placement, degenerate faces, normals, welding.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use super::math::{Affine, add, cross, dot, length, scaled, sub, unit};
use crate::desc::{GeometryDesc, InstanceDesc, MeshDesc, Vec3};

/// A mesh as its file says it.
#[derive(Clone, Debug, Default)]
pub(super) struct RawMesh {
    pub positions: Vec<Vec3>,
    /// Indices into `positions`, all in range.
    pub triangles: Vec<[u32; 3]>,
    /// One a position, of any length; or empty.
    pub normals: Vec<Vec3>,
    /// One a position, linear, 0 to 1; or empty.
    pub colors: Vec<Vec3>,
    /// One a position, v down from the picture's first row; or empty.
    pub uvs: Vec<[f64; 2]>,
    /// What the user should know, without the file name.
    pub notes: Vec<String>,
}

/// How a scene uses a mesh file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    pub to_world: Affine,
    pub face_normals: bool,
    pub flip_normals: bool,
}

impl RawMesh {
    /// The mesh in the world, and the number of triangles without area that were left out.
    ///
    /// As in Mitsuba 3: normals from the file, else smooth ones weighted by angle, unless `face_normals`. Where a
    /// triangle's winding contradicts its vertices' normals the normals decide, as they do there.
    pub fn place(&self, placement: Placement) -> (MeshDesc, usize) {
        let (mut parts, dropped) = self.place_parts(placement, &vec![0; self.triangles.len()]);
        (parts.remove(&0).unwrap_or_default(), dropped)
    }

    /// The same, in as many meshes as `part`, which has one number a triangle, has numbers: normals are those of the whole.
    pub fn place_parts(&self, placement: Placement, part: &[usize]) -> (BTreeMap<usize, MeshDesc>, usize) {
        let to_world = placement.to_world;
        let vertices: Vec<Vec3> = self.positions.iter().map(|&p| to_world.point(p)).collect();
        let whole = self.triangles.iter().copied().zip(part.iter().copied());
        let (mut triangles, part): (Vec<[u32; 3]>, Vec<usize>) =
            whole.filter(|&(t, _)| has_area(corners(&vertices, t))).unzip();
        let dropped = self.triangles.len() - triangles.len();

        let mut normals = Vec::new();
        if !placement.face_normals {
            normals = smooth_normals(&vertices, &triangles);
            for (normal, &given) in normals.iter_mut().zip(&self.normals) {
                *normal = unit(to_world.normal(given)).unwrap_or(*normal);
            }
            if !self.normals.is_empty() {
                triangles
                    .iter_mut()
                    .for_each(|t| wind_by_normals(t, &vertices, &normals));
            }
        }
        if placement.flip_normals {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
            normals.iter_mut().for_each(|n| *n = scaled(*n, -1.0));
        }
        let mut parts: BTreeMap<usize, MeshDesc> = BTreeMap::new();
        for (triangle, part) in triangles.into_iter().zip(part) {
            parts.entry(part).or_default().triangles.push(triangle);
        }
        for mesh in parts.values_mut() {
            *mesh = weld(&mesh.triangles, &vertices, &normals, self);
        }
        (parts, dropped)
    }
}

/// A mesh that stands in several places, in one of them; one of its own where the transform mirrors, shears or scales
/// unevenly.
pub(super) fn placed(mesh: &Arc<MeshDesc>, to_world: &Affine) -> GeometryDesc {
    match to_world.similarity() {
        Some((scale, axes)) => GeometryDesc::Instance(InstanceDesc {
            mesh: Arc::clone(mesh),
            at: to_world.translation,
            scale,
            axes,
        }),
        None => GeometryDesc::Mesh(to_world.mesh(mesh)),
    }
}

fn corners(vertices: &[Vec3], triangle: [u32; 3]) -> [Vec3; 3] {
    triangle.map(|i| vertices[i as usize])
}

/// More than a line: its height is over 1e-12 of its longest edge.
fn has_area([a, b, c]: [Vec3; 3]) -> bool {
    let longest = [sub(b, a), sub(c, b), sub(a, c)]
        .map(length)
        .into_iter()
        .fold(0.0, f64::max);
    length(cross(sub(b, a), sub(c, a))) > 1e-12 * longest * longest
}

fn wind_by_normals(triangle: &mut [u32; 3], vertices: &[Vec3], normals: &[Vec3]) {
    let [a, b, c] = corners(vertices, *triangle);
    let mean = corners(normals, *triangle).into_iter().fold([0.0; 3], add);
    if dot(mean, cross(sub(b, a), sub(c, a))) < 0.0 {
        triangle.swap(1, 2);
    }
}

/// One unit normal a vertex: the faces' normals weighted by their angles there.
///
/// Thürmer and Wüthrich, "Computing Vertex Normals from Polygonal Facets", JGT 3(1), 1998. A vertex whose faces cancel
/// takes the normal of one of them; one without faces (it is dropped later) points along z.
fn smooth_normals(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![[0.0; 3]; vertices.len()];
    let mut any = vec![[0.0, 0.0, 1.0]; vertices.len()];
    for &triangle in triangles {
        let p = corners(vertices, triangle);
        let Some(face) = unit(cross(sub(p[1], p[0]), sub(p[2], p[0]))) else {
            continue;
        };
        for (k, &index) in triangle.iter().enumerate() {
            let (to_next, to_last) = (sub(p[(k + 1) % 3], p[k]), sub(p[(k + 2) % 3], p[k]));
            let angle = length(cross(to_next, to_last)).atan2(dot(to_next, to_last));
            sums[index as usize] = add(sums[index as usize], scaled(face, angle));
            any[index as usize] = face;
        }
    }
    sums.into_iter()
        .zip(any)
        .map(|(sum, face)| unit(sum).filter(|_| length(sum) > 1e-9).unwrap_or(face))
        .collect()
}

/// Joins vertices that are equal bit for bit in all they say, and drops those no triangle uses.
fn weld(triangles: &[[u32; 3]], vertices: &[Vec3], normals: &[Vec3], raw: &RawMesh) -> MeshDesc {
    // Adding zero makes -0 into +0.
    let bits = |x: f64| (x + 0.0).to_bits();
    let mut seen = HashMap::new();
    let mut welded = MeshDesc::default();
    for &triangle in triangles {
        welded.triangles.push(triangle.map(|index| {
            let index = index as usize;
            let (vertex, normal) = (vertices[index], normals.get(index).copied());
            let (color, uv) = (raw.colors.get(index).copied(), raw.uvs.get(index).copied());
            let key = (
                vertex.map(bits),
                normal.map(|v| v.map(bits)),
                color.map(|c| c.map(bits)),
                uv.map(|uv| uv.map(bits)),
            );
            *seen.entry(key).or_insert_with(|| {
                welded.vertices.push(vertex);
                welded.normals.extend(normal);
                welded.colors.extend(color);
                welded.uvs.extend(uv);
                (welded.vertices.len() - 1) as u32
            })
        }));
    }
    welded
}

#[cfg(test)]
mod tests {
    use super::*;

    const AS_IS: Placement = Placement {
        to_world: Affine::IDENTITY,
        face_normals: false,
        flip_normals: false,
    };

    fn fold() -> RawMesh {
        RawMesh {
            positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 1.0]],
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            ..RawMesh::default()
        }
    }

    fn assert_near(a: Vec3, b: Vec3) {
        assert!(length(sub(a, b)) < 1e-6, "{a:?} is not {b:?}");
    }

    /// Against Mitsuba 3.9.1: `mi.traverse(shape)['vertex_normals']` of an OBJ with these vertices and faces.
    #[test]
    fn smooth_normals_are_mitsubas() {
        let (mesh, dropped) = fold().place(AS_IS);
        assert_eq!(dropped, 0);
        let at = |p: Vec3| mesh.normals[mesh.vertices.iter().position(|&v| v == p).unwrap()];
        assert_near(at([0.0, 0.0, 0.0]), [0.0, 0.0, 1.0]);
        assert_near(at([1.0, 0.0, 0.0]), [-0.37048277, -0.37048277, 0.85175407]);
        assert_near(at([1.0, 1.0, 1.0]), [-0.57735026, -0.57735026, 0.57735026]);
    }

    #[test]
    fn faces_without_area_are_dropped_and_counted() {
        let mut raw = fold();
        raw.positions.push([0.5, 0.0, 0.0]);
        raw.triangles.extend([[0, 0, 1], [0, 4, 1]]);
        let (mesh, dropped) = raw.place(AS_IS);
        assert_eq!((mesh.triangles.len(), mesh.vertices.len(), dropped), (2, 4, 2));
    }

    #[test]
    fn flat_vertices_are_joined_where_they_meet() {
        let mut raw = fold();
        raw.positions.extend([[1.0, 0.0, 0.0], [0.0, 1.0, -0.0]]);
        raw.triangles[1] = [4, 3, 5];
        let (mesh, _) = raw.place(Placement {
            face_normals: true,
            ..AS_IS
        });
        assert_eq!(mesh.vertices.len(), 4);
        assert!(mesh.normals.is_empty());
    }

    #[test]
    fn flipping_turns_winding_and_normals() {
        let (mesh, _) = fold().place(Placement {
            flip_normals: true,
            ..AS_IS
        });
        let [a, b, c] = corners(&mesh.vertices, mesh.triangles[0]);
        assert!(cross(sub(b, a), sub(c, a))[2] < 0.0);
        assert!(mesh.normals[0][2] < 0.0);
    }

    /// Mitsuba 3.9.1 under `<scale x="-1"/>`: the file's normals decide the side; without any, the winding does.
    #[test]
    fn a_mirrored_mesh_keeps_the_side_of_its_normals() {
        let mirror = Placement {
            to_world: Affine::scale([-1.0, 1.0, 1.0]),
            ..AS_IS
        };
        let mut raw = fold();
        raw.triangles.truncate(1);
        let side = |mesh: &MeshDesc| {
            let [a, b, c] = corners(&mesh.vertices, mesh.triangles[0]);
            cross(sub(b, a), sub(c, a))[2].signum()
        };
        let (wound, _) = raw.place(mirror);
        assert_eq!((side(&wound), wound.normals[0][2]), (-1.0, -1.0));
        raw.normals = vec![[0.0, 0.0, 2.0]; 4];
        let (given, _) = raw.place(mirror);
        assert_eq!((side(&given), given.normals[0][2]), (1.0, 1.0));
    }
}
