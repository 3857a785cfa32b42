use super::attributes::Attributes;
use super::grid::{Bounds, Grid};

/// Triangles by index over vertices of 3×u16, borrowed as they lie (in flash).
///
/// Nothing here panics for a wrong index: such a triangle is never hit. [`TriangleMesh::check`] is the border.
#[derive(Clone, Copy, Debug)]
pub struct TriangleMesh<'a> {
    pub grid: Grid,
    /// Grid coordinates, each in [`Grid::MARGIN`] ..= 65535 − [`Grid::MARGIN`].
    pub vertices: &'a [[u16; 3]],
    pub triangles: &'a [[u16; 3]],
    pub attributes: Attributes<'a>,
}

/// Where a ray meets a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshHit {
    /// Distance along the ray, scene units, 1 or more.
    pub t: i32,
    /// Its index, or its number in a packed mesh.
    pub triangle: u32,
    /// Weights of the second and third vertex, Q16; 0 or more, their sum at most 65536.
    pub b1: i32,
    pub b2: i32,
}

/// What is wrong with a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshError {
    /// This vertex lies within [`Grid::MARGIN`] steps of the cube's faces.
    Margin { vertex: u32 },
    /// There are normals, colours or places in a texture, but not one for each vertex.
    Attributes,
    /// This triangle (in a packed mesh: this leaf, by its first triangle) names a vertex there is not.
    Index { triangle: u32 },
    /// This triangle has a corner within [`Grid::MARGIN`] steps of the cube's faces.
    Corner { triangle: u32 },
    /// This triangle sticks out of the mesh's bounds.
    Bounds { triangle: u32 },
    /// The leaf that begins with this triangle names a treelet there is not.
    Treelet { triangle: u32 },
    /// The leaf that begins with this triangle is not all there.
    Cut { triangle: u32 },
    /// A distance of this treelet's vertices is wider than 16 bits, or the bit above the widths is set.
    Width { treelet: u16 },
    /// The vertices of this treelet are not all there.
    Vertices { treelet: u16 },
}

impl core::fmt::Display for MeshError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Margin { vertex } => write!(f, "vertex {vertex} lies too near a face of its cube"),
            Self::Attributes => f.write_str("its normals, colours or uvs are not one for each vertex"),
            Self::Index { triangle } => write!(f, "triangle {triangle} names a vertex there is not"),
            Self::Corner { triangle } => {
                write!(f, "triangle {triangle} has a corner too near a face of its cube")
            }
            Self::Bounds { triangle } => write!(f, "triangle {triangle} sticks out of the mesh's bounds"),
            Self::Treelet { triangle } => {
                write!(f, "the leaf of triangle {triangle} names a treelet there is not")
            }
            Self::Cut { triangle } => write!(f, "the leaf of triangle {triangle} is cut off"),
            Self::Width { treelet } => write!(f, "the widths of treelet {treelet} are not three of 0 to 16"),
            Self::Vertices { treelet } => write!(f, "the vertices of treelet {treelet} are cut off"),
        }
    }
}

impl<'a> TriangleMesh<'a> {
    /// Whether all vertices keep the margin and all indices are in range.
    pub fn check(&self) -> Result<(), MeshError> {
        let inner = Grid::MARGIN..=u16::MAX - Grid::MARGIN;
        if let Some(i) = self
            .vertices
            .iter()
            .position(|v| !v.iter().all(|c| inner.contains(c)))
        {
            return Err(MeshError::Margin { vertex: i as u32 });
        }
        if !self.attributes.fit(self.vertices.len()) {
            return Err(MeshError::Attributes);
        }
        match self
            .triangles
            .iter()
            .position(|t| !t.iter().all(|&i| (i as usize) < self.vertices.len()))
        {
            Some(i) => Err(MeshError::Index { triangle: i as u32 }),
            None => Ok(()),
        }
    }

    /// The three vertices of a triangle, grid coordinates.
    #[inline]
    pub fn corners(&self, triangle: u32) -> Option<[[u16; 3]; 3]> {
        Some(self.vertices_of(triangle)?.map(|v| *v))
    }

    #[inline(always)]
    pub(crate) fn vertices_of(&self, triangle: u32) -> Option<[&[u16; 3]; 3]> {
        corners(self.vertices, *self.triangles.get(triangle as usize)?)
    }

    /// Of all triangles, grid coordinates.
    pub fn bounds(&self) -> Bounds {
        (0..self.triangles.len() as u32)
            .filter_map(|t| self.corners(t))
            .fold(Bounds::EMPTY, |b, c| b.union(Bounds::of(&c)))
    }
}

/// The vertices a triangle names.
#[inline(always)]
pub(crate) fn corners(vertices: &[[u16; 3]], [a, b, c]: [u16; 3]) -> Option<[&[u16; 3]; 3]> {
    Some([
        vertices.get(a as usize)?,
        vertices.get(b as usize)?,
        vertices.get(c as usize)?,
    ])
}
