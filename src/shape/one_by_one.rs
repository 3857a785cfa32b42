//! A mesh's triangle, one product after the other, on whatever core. On x86-64 `sse2` has the same, its corners at once.

use super::grid::{GridRay, SLOPE_BITS};
use super::mesh::TriangleMesh;
use super::triangle::{TriangleHit, edges, is_beside, meet};

/// [`super::triangle::intersect`] of a mesh's triangle, which nothing hits if the mesh has not got it; `K` is the ray's
/// dominant axis.
///
/// Its corners are seen along the second axis only where the first does not tell that the ray passes by.
#[cfg_attr(narrow_mul, inline(never))]
#[cfg_attr(not(narrow_mul), inline(always))]
pub(super) fn intersect_of<const K: usize>(
    ray: &GridRay,
    mesh: &TriangleMesh,
    number: u32,
) -> Option<TriangleHit> {
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
