//! Walk and triangles in the assembly of ARMv6-M, ARMv7-M and RV32IM: [`super::traverse`] and [`crate::shape`] say what it does.

use super::mesh::{depth_within, stop_within};
use super::node::Node;
use super::traverse::{Order, Visitor, traverse};
use crate::num::RECIPS;
use crate::shape::{DEPTH_BITS, GridRay, MeshHit, PackedMesh, SLOPE_BITS, TriangleMesh, Triangles};
use core::mem::MaybeUninit;
use core::ops::ControlFlow;
use microlux_asm::{self as assembly, Corner, Facets, Walk};
use zerocopy::IntoBytes;

const _: () = assert!(3 * super::MAX_DEPTH < assembly::STACK && DEPTH_BITS == assembly::DEPTH_BITS);

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

/// What of a mesh's triangles is looked at in assembly, before `depth`.
#[inline(always)]
fn facets<'a>(mesh: &Triangles<'a>, ray: &GridRay, depth: i32, once: bool) -> Facets<'a> {
    match mesh {
        Triangles::Plain(mesh) => facets_of(mesh, ray, depth, once),
        Triangles::Packed(_) => corners(ray, depth, once),
    }
}

#[inline(always)]
fn facets_of<'a>(mesh: &TriangleMesh<'a>, ray: &GridRay, depth: i32, once: bool) -> Facets<'a> {
    Facets::new(mesh.vertices, mesh.triangles, &RECIPS, &seen(ray), depth, once)
}

#[inline(always)]
fn corners(ray: &GridRay, depth: i32, once: bool) -> Facets<'static> {
    Facets::of_corners(&RECIPS, ray.plane, ray.negative, depth, once)
}

/// [`super::closest`] of a mesh as it is indexed.
#[inline(always)]
pub fn closest(mesh: &TriangleMesh, nodes: &[Node], ray: &GridRay, t_max: i32) -> Option<MeshHit> {
    let mut facets = facets_of(mesh, ray, depth_within(ray, t_max), false);
    facets.follow(nodes.as_bytes(), nodes.len(), &seen(ray), &RECIPS);
    hit(&facets, ray, t_max)
}

/// [`super::closest`] of a packed mesh.
#[inline(always)]
pub fn closest_packed(mesh: &PackedMesh, nodes: &[Node], ray: &GridRay, t_max: i32) -> Option<MeshHit> {
    let mut facets = corners(ray, depth_within(ray, t_max), false);
    let facets = &mut facets;
    traverse(nodes, ray, &mut Nearest { mesh, facets });
    hit(facets, ray, t_max)
}

#[inline(always)]
fn hit(facets: &Facets, ray: &GridRay, t_max: i32) -> Option<MeshHit> {
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

/// [`super::occluded`].
#[inline(always)]
pub fn occluded(mesh: &Triangles, nodes: &[Node], ray: &GridRay, t_max: i32) -> bool {
    let facets = &mut facets(mesh, ray, i32::MAX, true);
    let mut way = Way {
        facets,
        limit: ray.limit(t_max),
        t_max,
        found: false,
    };
    match mesh {
        Triangles::Plain(_) => traverse(nodes, ray, &mut way),
        Triangles::Packed(mesh) => traverse(nodes, ray, &mut Any { mesh, way: &mut way }),
    }
    way.found
}

#[inline(always)]
fn see<const K: usize>(ray: &GridRay) -> impl Fn(&[u16; 3]) -> Corner + Copy {
    move |v| Corner {
        at: [
            ray.across::<K, 0>(v) >> SLOPE_BITS,
            ray.across::<K, 1>(v) >> SLOPE_BITS,
        ],
        z: v[K].into(),
    }
}

/// The nearest hit with a packed mesh.
struct Nearest<'f, 'a> {
    mesh: &'f PackedMesh<'a>,
    facets: &'f mut Facets<'a>,
}

impl Visitor for Nearest<'_, '_> {
    #[inline(always)]
    fn limit(&self) -> i32 {
        self.facets.depth() >> DEPTH_BITS
    }

    #[inline(never)]
    fn visit<const K: usize>(&mut self, ray: &GridRay, base: u32, leaf: u32) -> ControlFlow<()> {
        let (mesh, facets) = (self.mesh, &mut *self.facets);
        mesh.each_of_leaf(base, leaf, see::<K>(ray), |number, corners| {
            facets.test(corners, number);
            ControlFlow::Continue(())
        })
    }
}

/// Whether anything is in the way.
struct Way<'f, 'a> {
    facets: &'f mut Facets<'a>,
    limit: i32,
    t_max: i32,
    found: bool,
}

impl Way<'_, '_> {
    /// Breaks if what has been met is in the way. What is not keeps away only what lies farther.
    #[inline(always)]
    fn within(&mut self, ray: &GridRay) -> ControlFlow<()> {
        let met = stop_within(ray, self.facets.depth(), self.t_max);
        self.found = met.is_break();
        met
    }
}

/// Of a mesh as it is indexed.
impl Visitor for Way<'_, '_> {
    const BY_AXIS: bool = false;
    const ORDER: Order = Order::Any;

    #[inline(always)]
    fn limit(&self) -> i32 {
        self.limit
    }

    #[inline(always)]
    fn visit<const K: usize>(&mut self, ray: &GridRay, base: u32, leaf: u32) -> ControlFlow<()> {
        let mut first = base + (leaf & 15);
        let end = first + (leaf >> 4);
        while self.facets.look(first, end) {
            self.within(ray)?;
            first = self.facets.met().map_or(end, |met| met.triangle + 1);
        }
        ControlFlow::Continue(())
    }
}

/// Of a packed mesh.
struct Any<'f, 'w, 'a> {
    mesh: &'f PackedMesh<'a>,
    way: &'f mut Way<'w, 'a>,
}

impl Visitor for Any<'_, '_, '_> {
    const ORDER: Order = Order::Any;

    #[inline(always)]
    fn limit(&self) -> i32 {
        self.way.limit
    }

    #[inline(never)]
    fn visit<const K: usize>(&mut self, ray: &GridRay, base: u32, leaf: u32) -> ControlFlow<()> {
        let (mesh, way) = (self.mesh, &mut *self.way);
        mesh.each_of_leaf(base, leaf, see::<K>(ray), |number, corners| {
            if way.facets.test(corners, number) {
                way.within(ray)?;
            }
            ControlFlow::Continue(())
        })
    }
}
