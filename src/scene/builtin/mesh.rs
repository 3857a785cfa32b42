use crate::bvh::{Node, build_mesh};
use crate::scene::{Mesh, SceneError};
use crate::shape::{Attributes, Grid, TriangleMesh, Triangles};

/// A mesh by value: `V` vertices, `T` triangles and room for `N` nodes ([`crate::bvh::max_nodes`]), with the tree built.
#[derive(Clone, Debug)]
pub struct OwnedMesh<const V: usize, const T: usize, const N: usize> {
    grid: Grid,
    vertices: [[u16; 3]; V],
    triangles: [[u16; 3]; T],
    nodes: [Node; N],
    used: usize,
}

impl<const V: usize, const T: usize, const N: usize> OwnedMesh<V, T, N> {
    /// Builds the tree, which puts the triangles into its own order.
    pub fn new(
        grid: Grid,
        vertices: [[u16; 3]; V],
        mut triangles: [[u16; 3]; T],
    ) -> Result<Self, SceneError> {
        let mut nodes = [Node::EMPTY; N];
        let used = build_mesh(&vertices, &mut triangles, &mut nodes)
            .map_err(|error| SceneError::Nodes { needed: error.needed })?;
        Ok(OwnedMesh {
            grid,
            vertices,
            triangles,
            nodes,
            used,
        })
    }

    /// As a scene borrows it.
    pub fn mesh(&self) -> Mesh<'_> {
        Mesh {
            triangles: Triangles::Plain(TriangleMesh {
                grid: self.grid,
                vertices: &self.vertices,
                triangles: &self.triangles,
                attributes: Attributes::NONE,
            }),
            nodes: self.nodes.get(..self.used).unwrap_or(&[]),
        }
    }
}
