//! A ray against a mesh: the nearest hit, or any; with a tree, or through the list.

use super::node::Node;
use super::traverse::{Visitor, traverse};
use crate::geom::Ray;
use crate::shape::triangle::{TriangleHit, intersect};
use crate::shape::{DEPTH_BITS, GridRay, MeshHit, Slopes, TriangleMesh, corners};
use core::ops::ControlFlow;

/// The nearest hit at a distance under `t_max`; of equal depths (1/16 step) that of the lowest index.
///
/// `nodes` is the mesh's tree, of [`super::build_mesh`] or past [`super::check_mesh`].
pub fn closest(mesh: &TriangleMesh, nodes: &[Node], ray: &Ray, slopes: &Slopes, t_max: i32) -> Option<MeshHit> {
    let ray = GridRay::enter(&mesh.grid, ray, slopes)?;
    // The limit has whole steps: take all sixteenths of the last.
    let depth = ((ray.limit(t_max) + 1) << DEPTH_BITS) - 1;
    let mut nearest = Nearest::within(mesh, depth);
    traverse(nodes, &ray, &mut nearest);
    nearest.hit(&ray, t_max)
}

/// The same answer from all triangles in turn.
pub fn closest_linear(mesh: &TriangleMesh, ray: &Ray, slopes: &Slopes, t_max: i32) -> Option<MeshHit> {
    let ray = GridRay::enter(&mesh.grid, ray, slopes)?;
    let mut nearest = Nearest::within(mesh, i32::MAX);
    let _ = visit_all(mesh, &ray, &mut nearest);
    nearest.hit(&ray, t_max)
}

/// Whether anything is hit at a distance under `t_max`: exactly where [`closest`] answers something.
pub fn occluded(mesh: &TriangleMesh, nodes: &[Node], ray: &Ray, slopes: &Slopes, t_max: i32) -> bool {
    let Some(ray) = GridRay::enter(&mesh.grid, ray, slopes) else {
        return false;
    };
    let mut any = Any { mesh, limit: ray.limit(t_max), t_max, found: false };
    traverse(nodes, &ray, &mut any);
    any.found
}

/// The same answer from all triangles in turn.
pub fn occluded_linear(mesh: &TriangleMesh, ray: &Ray, slopes: &Slopes, t_max: i32) -> bool {
    let Some(ray) = GridRay::enter(&mesh.grid, ray, slopes) else {
        return false;
    };
    visit_all(mesh, &ray, &mut Any { mesh, limit: i32::MAX, t_max, found: false }).is_break()
}

fn visit_all(mesh: &TriangleMesh, ray: &GridRay, visitor: &mut impl Visitor) -> ControlFlow<()> {
    let count = mesh.triangles.len() as u32;
    match ray.axis {
        0 => visitor.visit::<0>(ray, 0, count),
        1 => visitor.visit::<1>(ray, 0, count),
        _ => visitor.visit::<2>(ray, 0, count),
    }
}

/// The nearest hit so far, by depth and then by index.
struct Nearest<'a> {
    mesh: &'a TriangleMesh<'a>,
    hit: TriangleHit,
    triangle: u32,
}

impl<'a> Nearest<'a> {
    const NONE: u32 = u32::MAX;

    /// Nothing yet, and nothing beyond a depth.
    fn within(mesh: &'a TriangleMesh<'a>, depth: i32) -> Nearest<'a> {
        Nearest { mesh, hit: TriangleHit { depth, b1: 0, b2: 0 }, triangle: Nearest::NONE }
    }

    fn hit(&self, ray: &GridRay, t_max: i32) -> Option<MeshHit> {
        let t = (self.triangle != Nearest::NONE).then(|| ray.distance(self.hit.depth)).filter(|&t| t < t_max)?;
        Some(MeshHit { t, triangle: self.triangle, b1: self.hit.b1, b2: self.hit.b2 })
    }
}

impl Visitor for Nearest<'_> {
    #[inline(always)]
    fn limit(&self) -> i32 {
        self.hit.depth >> DEPTH_BITS
    }

    #[inline(always)]
    fn visit<const K: usize>(&mut self, ray: &GridRay, first: u32, count: u32) -> ControlFlow<()> {
        for (&triangle, index) in triangles(self.mesh, first, count).iter().zip(first..) {
            let met = corners(self.mesh.vertices, triangle).and_then(|c| intersect::<K>(ray, c));
            if let Some(hit) = met
                && (hit.depth < self.hit.depth || (hit.depth == self.hit.depth && index < self.triangle))
            {
                (self.hit, self.triangle) = (hit, index);
            }
        }
        ControlFlow::Continue(())
    }
}

/// Whether anything is in the way.
struct Any<'a> {
    mesh: &'a TriangleMesh<'a>,
    limit: i32,
    t_max: i32,
    found: bool,
}

impl Visitor for Any<'_> {
    #[inline(always)]
    fn limit(&self) -> i32 {
        self.limit
    }

    #[inline(always)]
    fn visit<const K: usize>(&mut self, ray: &GridRay, first: u32, count: u32) -> ControlFlow<()> {
        for &triangle in triangles(self.mesh, first, count) {
            let met = corners(self.mesh.vertices, triangle).and_then(|c| intersect::<K>(ray, c));
            if met.is_some_and(|hit| ray.distance(hit.depth) < self.t_max) {
                self.found = true;
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(())
    }
}

/// The triangles of a leaf; none if the mesh has not got them all.
#[inline(always)]
fn triangles<'a>(mesh: &TriangleMesh<'a>, first: u32, count: u32) -> &'a [[u16; 3]] {
    let first = first as usize;
    mesh.triangles.get(first..first + count as usize).unwrap_or(&[])
}
