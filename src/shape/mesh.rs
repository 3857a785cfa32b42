use super::grid::{Bounds, Grid};
use super::triangle::Edge;
use crate::geom::{Dir, Norm, Offset, Point};
use crate::num::{Wide, mul_q16};

/// Triangles by index over vertices of 3×u16, borrowed as they lie (in flash).
///
/// Nothing here panics for a wrong index: such a triangle is never hit. [`TriangleMesh::check`] is the border.
#[derive(Clone, Copy, Debug)]
pub struct TriangleMesh<'a> {
    pub grid: Grid,
    /// Grid coordinates, each in [`Grid::MARGIN`] ..= 65535 − [`Grid::MARGIN`].
    pub vertices: &'a [[u16; 3]],
    pub triangles: &'a [[u16; 3]],
}

/// Where a ray meets a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshHit {
    /// Distance along the ray, scene units, 1 or more.
    pub t: i32,
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
    /// This triangle names a vertex there is not.
    Index { triangle: u32 },
}

impl core::fmt::Display for MeshError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Margin { vertex } => write!(f, "vertex {vertex} lies too near a face of its cube"),
            Self::Index { triangle } => write!(f, "triangle {triangle} names a vertex there is not"),
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
        Some(corners(self.vertices, *self.triangles.get(triangle as usize)?)?.map(|v| *v))
    }

    /// Of all triangles, grid coordinates.
    pub fn bounds(&self) -> Bounds {
        (0..self.triangles.len() as u32)
            .filter_map(|t| self.corners(t))
            .fold(Bounds::EMPTY, |b, c| b.union(Bounds::of(&c)))
    }

    /// Unit normal by the right-hand rule over (a, b, c); `None` for a triangle without area.
    ///
    /// From the exact cross product, or its top 24 bits or more.
    #[inline]
    pub fn normal(&self, triangle: u32) -> Option<Dir> {
        let (cross, _) = self.cross(triangle)?;
        Some(cross.normalize()?.0)
    }

    /// Twice the area, scene units²; 0 for a triangle without area. Relative error 2^-14 at most.
    #[inline]
    pub fn double_area(&self, triangle: u32) -> Wide {
        let area = |(cross, shift): (Offset, i32)| -> Option<Wide> {
            let norm: Norm = cross.normalize()?.1;
            Some(norm.square().sqrt().shl(shift + 2 * self.grid.shift() as i32))
        };
        self.cross(triangle).and_then(area).unwrap_or(Wide::ZERO)
    }

    /// Where the weights put a hit, scene units: each coordinate rounded to nearest, error ¾ unit at most.
    ///
    /// Weights that are rounded move the point within the triangle's plane, never off it.
    #[inline]
    pub fn point(&self, hit: &MeshHit) -> Option<Point> {
        let [a, b, c] = self.corners(hit.triangle)?;
        let base = self.grid.to_scene(a).0;
        let shift = self.grid.shift() + 4;
        Some(Point([0, 1, 2].map(|i| {
            // |b − a| < 2^16 and shift ≤ 12: under 2^28, four bits of it below the point.
            let b = mul_q16((b[i] as i32 - a[i] as i32) << shift, hit.b1);
            let c = mul_q16((c[i] as i32 - a[i] as i32) << shift, hit.b2);
            base[i] + ((b + c + 8) >> 4)
        })))
    }

    /// How far along the normal a ray that leaves this mesh must start, scene units: three steps.
    ///
    /// The triangle as the next ray sees it lies within ½ step of the true one in both coordinates across (the shear
    /// rounds), so within ½√2 of its plane. The ray's origin is off by the same ½√2 (it rounds too), and by ½√3 units
    /// from [`TriangleMesh::point`]: 2.28 steps at worst, with steps of one unit. From three steps outside, a ray that
    /// leaves starts ¾ step beyond all it might see of its own triangle. Depth errors of 0.4 step, |d_k| times that,
    /// come from weights of 16 bits on triangles up to 2^14 steps; on larger ones the margin is measured
    /// (`tests/shape_watertight.rs`), not proven.
    #[inline]
    pub const fn offset(&self) -> i32 {
        3 << self.grid.shift()
    }

    /// (b − a) × (c − a), steps², shifted right by the second number.
    fn cross(&self, triangle: u32) -> Option<(Offset, i32)> {
        let [a, b, c] = self.corners(triangle)?;
        let edge = |to: [u16; 3]| [0, 1, 2].map(|i| to[i] as i32 - a[i] as i32);
        let ([ex, ey, ez], [fx, fy, fz]) = (edge(b), edge(c));
        let parts = [
            Edge::new(ey, fz, ez, fy),
            Edge::new(ez, fx, ex, fz),
            Edge::new(ex, fy, ey, fx),
        ];
        let (cross, shift) = Edge::shorten(parts);
        Some((Offset(cross), shift))
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

#[cfg(test)]
mod tests {
    use super::*;

    const MESH: TriangleMesh = TriangleMesh {
        grid: Grid::new(Point([100, 200, 300]), 2).unwrap(),
        vertices: &[[10, 10, 10], [50010, 10, 10], [10, 40010, 10], [10, 40011, 10]],
        triangles: &[[0, 1, 2], [0, 3, 1], [0, 2, 3]],
    };

    #[test]
    fn a_large_triangle() {
        assert_eq!(MESH.check(), Ok(()));
        // Right to one ulp, as `Offset::normalize` is.
        let [x, y, z] = MESH.normal(0).unwrap().0;
        assert!(x == 0 && y == 0 && z >= 65535);
        assert!(MESH.normal(1).unwrap().0[2] <= -65535);
        let area = MESH.double_area(0).to_fixed(-10) as f64 * 1024.0;
        assert!((area / (16.0 * 50000.0 * 40000.0) - 1.0).abs() < 1e-4);
        let middle = MeshHit {
            t: 1,
            triangle: 0,
            b1: 1 << 15,
            b2: 1 << 14,
        };
        assert_eq!(MESH.point(&middle), Some(Point([140 + 100000, 240 + 40000, 340])));
    }

    #[test]
    fn a_triangle_without_area() {
        assert_eq!(MESH.normal(2), None);
        assert!(MESH.double_area(2).is_zero());
        let wrong = TriangleMesh {
            triangles: &[[0, 1, 4]],
            ..MESH
        };
        assert_eq!(wrong.check(), Err(MeshError::Index { triangle: 0 }));
        assert_eq!(wrong.normal(0), None);
    }
}
