//! A mesh's triangles in turn, on whatever core. On x86-64 `sse2` has the same, a triangle's corners at once.

use super::grid::{GridRay, SLOPE_BITS};
use super::mesh::TriangleMesh;
use super::triangle::{TriangleHit, edges, is_beside, meet};
use core::ops::ControlFlow;

/// [`super::triangle::intersect`] of a mesh's triangle, which nothing hits if the mesh has not got it; `K` is the ray's
/// dominant axis.
///
/// Its corners are seen along the second axis only where the first does not tell that the ray passes by.
#[cfg_attr(narrow_mul, inline(never))]
#[cfg_attr(not(narrow_mul), inline(always))]
fn intersect_of<const K: usize>(ray: &GridRay, mesh: &TriangleMesh, number: u32) -> Option<TriangleHit> {
    let corners = mesh.vertices_of(number)?;
    let x = corners.map(|v| ray.across::<K, 0>(v) >> SLOPE_BITS);
    if is_beside(x) {
        return None;
    }
    let y = corners.map(|v| ray.across::<K, 1>(v) >> SLOPE_BITS);
    if is_beside(y) {
        return None;
    }
    meet(ray, edges(x, y)?, corners.map(|v| v[K] as i32))
}

/// Where the ray meets each triangle of a leaf that it does meet, with its number, until `met` breaks: the leaf as
/// [`crate::bvh::Visitor::visit`] has it. `K` is the ray's dominant axis.
#[inline(always)]
pub(super) fn of_leaf<const K: usize>(
    mesh: &TriangleMesh,
    ray: &GridRay,
    base: u32,
    leaf: u32,
    mut met: impl FnMut(u32, TriangleHit) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let first = base + (leaf & 15);
    for number in first..first + (leaf >> 4) {
        if let Some(hit) = intersect_of::<K>(ray, mesh, number) {
            met(number, hit)?;
        }
    }
    ControlFlow::Continue(())
}
