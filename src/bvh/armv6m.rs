//! Walk and triangles in the assembly of an ARMv6-M core: [`super::traverse`] and [`crate::shape`] say what it does.

use super::node::Node;
use super::traverse::{Order, Visitor, traverse};
use crate::num::RECIPS;
use crate::shape::{GridRay, MeshHit, TriangleMesh};
use core::mem::MaybeUninit;
use core::ops::ControlFlow;
use microlux_armv6m::{self as assembly, Facets, Walk};
use zerocopy::IntoBytes;

/// At the root of a tree.
#[inline(always)]
fn begin<'w, 'a>(
    place: &'w mut MaybeUninit<Walk<'a>>,
    nodes: &'a [Node],
    ray: &GridRay,
    order: Order,
) -> Option<&'w mut Walk<'a>> {
    let order = match order {
        Order::Any => assembly::Order::Any,
        Order::Face => assembly::Order::Face,
        Order::Entry => assembly::Order::Entry,
    };
    Walk::begin(place, nodes.as_bytes(), nodes.len(), &seen(ray), order, &RECIPS)
}

/// The walk of [`traverse`], to the same leaves in the same order.
#[inline]
pub fn walk<const K: usize, V: Visitor>(nodes: &[Node], ray: &GridRay, visitor: &mut V) {
    let mut place = MaybeUninit::uninit();
    let Some(walk) = begin(&mut place, nodes, ray, V::ORDER) else {
        return;
    };
    while let Some(leaves) = walk.leaves(visitor.limit()) {
        let mut metas = leaves.metas();
        while metas != 0 {
            if visitor.visit::<K>(ray, leaves.base(), metas & 0xff).is_break() {
                return;
            }
            metas >>= 8;
        }
        if leaves.is_last() {
            return;
        }
    }
}

#[inline(always)]
fn seen(ray: &GridRay) -> assembly::Ray {
    let GridRay {
        plane,
        slopes,
        offsets,
        negative,
        axis,
        ..
    } = *ray;
    assembly::Ray {
        plane,
        slopes,
        offsets,
        negative,
        axis,
    }
}

/// [`super::closest`] of a mesh as it is indexed.
#[inline(always)]
pub fn closest(
    mesh: &TriangleMesh,
    nodes: &[Node],
    ray: &GridRay,
    depth: i32,
    t_max: i32,
) -> Option<MeshHit> {
    let mut facets = Facets::new(mesh.vertices, mesh.triangles, &RECIPS, &seen(ray), depth, false);
    begin(&mut MaybeUninit::uninit(), nodes, ray, Order::Entry)?.look(&mut facets);
    let met = facets.met()?;
    let t = ray.distance(met.depth);
    let [b1, b2] = met.weights;
    (t < t_max).then_some(MeshHit {
        t,
        triangle: met.triangle,
        b1,
        b2,
    })
}

/// [`super::occluded`] by one.
#[inline(always)]
pub fn occluded(mesh: &TriangleMesh, nodes: &[Node], ray: &GridRay, t_max: i32) -> bool {
    let mut any = Any {
        facets: Facets::new(mesh.vertices, mesh.triangles, &RECIPS, &seen(ray), i32::MAX, true),
        limit: ray.limit(t_max),
        t_max,
        found: false,
    };
    traverse(nodes, ray, &mut any);
    any.found
}

struct Any<'a> {
    facets: Facets<'a>,
    limit: i32,
    t_max: i32,
    found: bool,
}

impl Visitor for Any<'_> {
    const BY_AXIS: bool = false;
    const ORDER: Order = Order::Any;

    #[inline(always)]
    fn limit(&self) -> i32 {
        self.limit
    }

    /// One that is not in the way keeps away only what lies farther.
    #[inline(always)]
    fn visit<const K: usize>(&mut self, ray: &GridRay, base: u32, leaf: u32) -> ControlFlow<()> {
        let mut first = base + (leaf & 15);
        let end = first + (leaf >> 4);
        while self.facets.look(first, end) {
            let Some(met) = self.facets.met() else { break };
            if ray.distance(met.depth) < self.t_max {
                self.found = true;
                return ControlFlow::Break(());
            }
            first = met.triangle + 1;
        }
        ControlFlow::Continue(())
    }
}
