use super::attributes::Layers;
use super::grid::{Bounds, Grid, GridRay};
use super::mesh::{MeshHit, TriangleMesh};
#[cfg(not(target_arch = "x86_64"))]
use super::one_by_one::intersect_of;
use super::packed::PackedMesh;
#[cfg(target_arch = "x86_64")]
use super::sse2::intersect_of;
use super::triangle::{Edge, Seen, TriangleHit, intersect};
use crate::color::Albedo;
use crate::geom::{Dir, Norm, Octahedral, Offset, Point};
use crate::num::{ONE_Q16, Wide, mul_q16};
use core::ops::ControlFlow;

/// The triangles of a mesh, either as they are indexed or packed into few bytes.
///
/// A triangle is named by a number: its index, or where its bytes lie ([`PackedMesh`]). Of equal depths the lower number
/// is hit.
#[derive(Clone, Copy, Debug)]
pub enum Triangles<'a> {
    Plain(TriangleMesh<'a>),
    Packed(PackedMesh<'a>),
}

impl<'a> From<TriangleMesh<'a>> for Triangles<'a> {
    fn from(mesh: TriangleMesh<'a>) -> Self {
        Triangles::Plain(mesh)
    }
}

impl<'a> From<PackedMesh<'a>> for Triangles<'a> {
    fn from(mesh: PackedMesh<'a>) -> Self {
        Triangles::Packed(mesh)
    }
}

impl<'a> Triangles<'a> {
    #[inline]
    pub const fn grid(&self) -> &Grid {
        match self {
            Triangles::Plain(mesh) => &mesh.grid,
            Triangles::Packed(mesh) => &mesh.grid,
        }
    }

    /// The mesh whose triangles are numbered without gaps, if it is one.
    #[inline]
    pub const fn plain(&self) -> Option<&TriangleMesh<'a>> {
        match self {
            Triangles::Plain(mesh) => Some(mesh),
            Triangles::Packed(_) => None,
        }
    }

    /// How many there are; a packed mesh is walked through.
    pub fn count(&self) -> usize {
        match self {
            Triangles::Plain(mesh) => mesh.triangles.len(),
            Triangles::Packed(mesh) => mesh.each_leaf().map(|leaf| leaf.count as usize).sum(),
        }
    }

    /// Bytes of flash, without the tree.
    pub fn bytes(&self) -> usize {
        match self {
            Triangles::Plain(mesh) => {
                size_of_val(mesh.vertices) + size_of_val(mesh.triangles) + mesh.attributes.bytes()
            }
            Triangles::Packed(mesh) => size_of_val(mesh.treelets) + mesh.vertices.len() + mesh.leaves.len(),
        }
    }

    /// The numbers of all, rising.
    pub fn numbers(&self) -> impl Iterator<Item = u32> + use<'a> {
        let (plain, packed) = match self {
            Triangles::Plain(mesh) => (0..mesh.triangles.len() as u32, None),
            Triangles::Packed(mesh) => (0..0, Some(mesh.each_leaf())),
        };
        let leaf = |leaf: super::packed::Leaf| leaf.first()..leaf.first() + leaf.count;
        plain.chain(packed.into_iter().flatten().flat_map(leaf))
    }

    /// The three vertices of a triangle, grid coordinates.
    #[inline]
    pub fn corners(&self, triangle: u32) -> Option<[[u16; 3]; 3]> {
        match self {
            Triangles::Plain(mesh) => mesh.corners(triangle),
            Triangles::Packed(mesh) => mesh.corners(triangle),
        }
    }

    /// Of all triangles, grid coordinates.
    pub fn bounds(&self) -> Bounds {
        match self {
            Triangles::Plain(mesh) => mesh.bounds(),
            Triangles::Packed(mesh) => mesh.bounds,
        }
    }

    /// Unit normal by the right-hand rule over (a, b, c); `None` for a triangle without area.
    ///
    /// From the exact cross product, or its top 24 bits or more.
    #[inline]
    pub fn normal(&self, triangle: u32) -> Option<Dir> {
        Some(cross(self.corners(triangle)?).0.normalize()?.0)
    }

    /// [`Self::point`] and [`Self::normal`] of a hit, by one look at its triangle.
    #[inline]
    pub(crate) fn place(&self, hit: &MeshHit) -> Option<(Point, Dir)> {
        let corners = self.corners(hit.triangle)?;
        Some((self.between(corners, hit), cross(corners).0.normalize()?.0))
    }

    /// What its vertices say beside where they are.
    #[inline]
    pub fn layers(&self) -> Layers {
        match self {
            Triangles::Plain(mesh) => mesh.attributes.layers(),
            Triangles::Packed(mesh) => mesh.layers,
        }
    }

    /// Whether it has normals for smooth shading.
    #[inline]
    pub const fn is_smooth(&self) -> bool {
        match self {
            Triangles::Plain(mesh) => !mesh.attributes.normals.is_empty(),
            Triangles::Packed(mesh) => mesh.layers.has(Layers::NORMALS),
        }
    }

    /// The corners' normals; `None` for flat faces.
    pub fn normals(&self, triangle: u32) -> Option<[Octahedral; 3]> {
        match self {
            Triangles::Plain(mesh) => of_corners(mesh, mesh.attributes.normals, triangle),
            Triangles::Packed(mesh) => mesh.normals(triangle),
        }
    }

    /// The corners' colours, sRGB; `None` if they have none.
    pub fn colors(&self, triangle: u32) -> Option<[[u8; 3]; 3]> {
        match self {
            Triangles::Plain(mesh) => of_corners(mesh, mesh.attributes.colors, triangle),
            Triangles::Packed(mesh) => mesh.colors(triangle),
        }
    }

    /// The corners' places in a texture, in steps of 2^-12; `None` if they have none.
    pub fn uvs(&self, triangle: u32) -> Option<[[i16; 2]; 3]> {
        match self {
            Triangles::Plain(mesh) => of_corners(mesh, mesh.attributes.uvs, triangle),
            Triangles::Packed(mesh) => mesh.uvs(triangle),
        }
    }

    /// The colour between the corners' colours, by the weights of a hit: of light, not of signals; each share right to 2
    /// steps.
    #[inline(never)]
    pub fn color(&self, hit: &MeshHit) -> Option<Albedo> {
        let [a, b, c] = self.colors(hit.triangle)?.map(Albedo::from_srgb);
        let first = ONE_Q16 - hit.b1 - hit.b2;
        Some(Albedo::from_bits([0, 1, 2].map(|i| {
            let part = |of: Albedo, weight: i32| of.0[i].to_bits() as u32 * weight as u32;
            // Shares of 2^15 and weights of 2^16 together: 2^31 at most.
            let sum = part(a, first) + part(b, hit.b1) + part(c, hit.b2) + (1 << 15);
            (sum >> 16) as u16
        })))
    }

    /// The place in a texture between the corners', by the weights of a hit: Q16, right to 2 steps.
    #[inline(never)]
    pub fn uv(&self, hit: &MeshHit) -> Option<[i32; 2]> {
        let [a, b, c] = self
            .uvs(hit.triangle)?
            .map(|uv| uv.map(|part| i32::from(part) << 4));
        Some([0, 1].map(|i| a[i] + mul_q16(b[i] - a[i], hit.b1) + mul_q16(c[i] - a[i], hit.b2)))
    }

    /// The normal for shading between the corners' normals, by the weights of a hit (Phong 1975); `None` for flat faces,
    /// and where they cancel.
    #[inline(never)]
    pub fn shading_normal(&self, hit: &MeshHit) -> Option<Dir> {
        let [a, b, c] = self.normals(hit.triangle)?.map(Octahedral::decode);
        let first = ONE_Q16 - hit.b1 - hit.b2;
        // Q16, under 2^18.
        let mix = |i: usize| mul_q16(a.0[i], first) + mul_q16(b.0[i], hit.b1) + mul_q16(c.0[i], hit.b2);
        let sum = [mix(0), mix(1), mix(2)];
        // Nearly opposite normals: rounding would choose.
        if sum.iter().all(|part| part.abs() < 1 << 8) {
            return None;
        }
        Dir::new(sum)
    }

    /// Twice the area, scene units²; 0 for a triangle without area. Relative error 2^-14 at most.
    #[inline]
    pub fn double_area(&self, triangle: u32) -> Wide {
        let area = |(cross, shift): (Offset, i32)| -> Option<Wide> {
            let norm: Norm = cross.normalize()?.1;
            Some(norm.square().sqrt().shl(shift + 2 * self.grid().shift() as i32))
        };
        self.corners(triangle)
            .map(cross)
            .and_then(area)
            .unwrap_or(Wide::ZERO)
    }

    /// Where the weights put a hit, scene units: each coordinate rounded to nearest, error ¾ unit at most.
    ///
    /// Weights that are rounded move the point within the triangle's plane, never off it.
    #[inline]
    pub fn point(&self, hit: &MeshHit) -> Option<Point> {
        Some(self.between(self.corners(hit.triangle)?, hit))
    }

    #[inline]
    fn between(&self, [a, b, c]: [[u16; 3]; 3], hit: &MeshHit) -> Point {
        let base = self.grid().to_scene(a).0;
        let shift = self.grid().shift() + 4;
        Point([0, 1, 2].map(|i| {
            // |b − a| < 2^16 and shift ≤ 12: under 2^28, four bits of it below the point.
            let b = mul_q16((b[i] as i32 - a[i] as i32) << shift, hit.b1);
            let c = mul_q16((c[i] as i32 - a[i] as i32) << shift, hit.b2);
            base[i] + ((b + c + 8) >> 4)
        }))
    }

    /// How far along the normal a ray that leaves this mesh must start, scene units: three steps.
    ///
    /// The triangle as the next ray sees it lies within ½ step of the true one in both coordinates across (the shear
    /// rounds), so within ½√2 of its plane. The ray's origin is off by the same ½√2 (it rounds too), and by ½√3 units
    /// from [`Triangles::point`]: 2.28 steps at worst, with steps of one unit. From three steps outside, a ray that
    /// leaves starts ¾ step beyond all it might see of its own triangle. Depth errors of 0.4 step, |d_k| times that,
    /// come from weights of 16 bits on triangles up to 2^14 steps; on larger ones the margin is measured
    /// (`tests/shape_watertight.rs`), not proven.
    #[inline]
    pub fn offset(&self) -> i32 {
        3 << self.grid().shift()
    }
}

/// (b − a) × (c − a), steps², shifted right by the second number.
fn cross([a, b, c]: [[u16; 3]; 3]) -> (Offset, i32) {
    let edge = |to: [u16; 3]| [0, 1, 2].map(|i| to[i] as i32 - a[i] as i32);
    let ([ex, ey, ez], [fx, fy, fz]) = (edge(b), edge(c));
    let parts = [
        Edge::new(ey, fz, ez, fy),
        Edge::new(ez, fx, ex, fz),
        Edge::new(ex, fy, ey, fx),
    ];
    let (cross, shift) = Edge::shorten(parts);
    (Offset(cross), shift)
}

/// What the corners of a triangle have in a list with one for each vertex.
fn of_corners<T: Copy>(mesh: &TriangleMesh, list: &[T], triangle: u32) -> Option<[T; 3]> {
    let [a, b, c] = mesh.triangles.get(triangle as usize)?.map(usize::from);
    Some([*list.get(a)?, *list.get(b)?, *list.get(c)?])
}

impl Triangles<'_> {
    /// Where the ray meets each triangle of a leaf that it does meet, with its number, until `met` breaks.
    ///
    /// Of a node's primitive base, and the leaf's count · 16 + offset from it; what of them the mesh has not got is met by
    /// nothing. `K` is the ray's dominant axis.
    #[inline(always)]
    pub(crate) fn of_leaf<const K: usize>(
        &self,
        ray: &GridRay,
        base: u32,
        leaf: u32,
        mut met: impl FnMut(u32, TriangleHit) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        match self {
            Triangles::Plain(mesh) => {
                let first = base + (leaf & 15);
                for number in first..first + (leaf >> 4) {
                    if let Some(hit) = intersect_of::<K>(ray, mesh, number) {
                        met(number, hit)?;
                    }
                }
                ControlFlow::Continue(())
            }
            Triangles::Packed(mesh) => {
                let see = |vertex: &[u16; 3]| Seen::new::<K>(ray, vertex);
                mesh.each_of_leaf(base, leaf, see, |number, corners| {
                    intersect(ray, corners).map_or(ControlFlow::Continue(()), |hit| met(number, hit))
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Attributes, MeshError};

    const PLAIN: TriangleMesh = TriangleMesh {
        grid: Grid::new(Point([100, 200, 300]), 2).unwrap(),
        vertices: &[[10, 10, 10], [50010, 10, 10], [10, 40010, 10], [10, 40011, 10]],
        triangles: &[[0, 1, 2], [0, 3, 1], [0, 2, 3]],
        attributes: Attributes::NONE,
    };

    fn mesh() -> Triangles<'static> {
        PLAIN.into()
    }

    #[test]
    fn a_large_triangle() {
        assert_eq!(PLAIN.check(), Ok(()));
        // Right to one ulp, as `Offset::normalize` is.
        let [x, y, z] = mesh().normal(0).unwrap().0;
        assert!(x == 0 && y == 0 && z >= 65535);
        assert!(mesh().normal(1).unwrap().0[2] <= -65535);
        let area = mesh().double_area(0).to_fixed(-10) as f64 * 1024.0;
        assert!((area / (16.0 * 50000.0 * 40000.0) - 1.0).abs() < 1e-4);
        let middle = MeshHit {
            t: 1,
            triangle: 0,
            b1: 1 << 15,
            b2: 1 << 14,
        };
        assert_eq!(
            mesh().point(&middle),
            Some(Point([140 + 100000, 240 + 40000, 340]))
        );
    }

    #[test]
    fn a_triangle_without_area() {
        assert_eq!(mesh().normal(2), None);
        assert!(mesh().double_area(2).is_zero());
        let wrong = TriangleMesh {
            triangles: &[[0, 1, 4]],
            ..PLAIN
        };
        assert_eq!(wrong.check(), Err(MeshError::Index { triangle: 0 }));
        assert_eq!(Triangles::from(wrong).normal(0), None);
    }
}
