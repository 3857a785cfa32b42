//! From the root to the leaves a ray may meet, nearest child first.
//!
//! # Why no box is passed by
//!
//! What a ray sees of a point is F(p) = (p_x << 13) − S·p_k + offset ([`GridRay::across`]), along axis k + 1 and
//! likewise along k + 2, k the dominant axis. A triangle is hit if the origin lies among the points
//! X_i = ⌊F(v_i) / 2^13⌋ of its vertices: Σ b_i X_i = 0 with weights b. F is affine, so the point p = Σ b_i v_i has
//! 0 ≤ F(p) < 2^13. Moved by one step along axis k + 1, F changes by 2^13: a box that holds the triangle with one step
//! to spare holds points with F < 0 and with F ≥ 0. Along k, the depth of a hit lies within those of the vertices.
//! Hence a child may be left out if, over its box, max F < 0 or min F > 0, or if it ends before the ray starts or
//! starts beyond the limit.
//!
//! Over the box [x0, x1] × [z0, z1] the extremes of F are at x0 with one end of z and at x1 with the other, by the
//! sign of S. With planes N + (q << e), min F ≤ 0 is in units of 2^e
//!
//! (q_x0 << 13) − S·q_z ≤ −F(N) / 2^e.
//!
//! Its left side is an integer, so ⌊−F(N) / 2^e⌋ on the right decides the same; for max F ≥ 0, where the sign is ≥, it
//! is at most one too low, which lets in and never keeps out. The same holds along k: one bound is exact, the other
//! rounded down where that lets in.
//!
//! A child that waits is left out later if the ray enters its box beyond the limit. At the depth of a hit, the line is
//! less than one step from the triangle's p along each axis across, so within the box: it entered no later.
//!
//! # Why nothing wraps
//!
//! |F| < 2^31 for any grid point; (q << 13) and S·q are under 2^21.

use super::MAX_DEPTH;
use super::node::Node;
#[cfg(any(test, not(target_arch = "x86_64")))]
use super::node::Planes;
#[cfg(target_arch = "x86_64")]
use super::sse2::Boxes;
use crate::shape::GridRay;
#[cfg(any(test, not(target_arch = "x86_64")))]
use crate::shape::{Rise, SLOPE_BITS};
use core::ops::ControlFlow;
use heapless::Vec;

#[cfg(not(target_arch = "x86_64"))]
use OneByOne as Boxes;

/// Three children a level wait while the fourth is looked at.
const STACK: usize = 3 * MAX_DEPTH + 1;

/// Which of a node's children a ray goes to first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// The one whose box it enters first: for large trees.
    Entry,
    /// The one whose box begins first along the dominant axis: of few, or of large things, that is soon told.
    Face,
    /// Any: where any hit will do.
    Any,
}

/// What a traversal does at the leaves.
pub trait Visitor {
    /// Which of several children comes first.
    const ORDER: Order = Order::Entry;

    /// Depth in whole steps along the dominant axis beyond which nothing is wanted, at most 65535; negative for
    /// nothing at all. Asked again at each node, so it may shrink.
    fn limit(&self) -> i32;

    /// Look at a leaf: `leaf` / 16 primitives, the first of them `leaf` % 16 after `base` (or as a packed mesh has it);
    /// `K` is the ray's dominant axis. Break to stop.
    fn visit<const K: usize>(&mut self, ray: &GridRay, base: u32, leaf: u32) -> ControlFlow<()>;
}

/// The primitives of a leaf: what [`Visitor::visit`] is given.
#[inline(always)]
pub fn primitives(base: u32, leaf: u32) -> core::ops::Range<u32> {
    let first = base + (leaf & 15);
    first..first + (leaf >> 4)
}

/// Visit each leaf whose box the ray may meet before the visitor's limit.
///
/// The nearest child first, by its box; the others wait in no order. Each leaf at most once. Nodes that
/// [`super::check_mesh`] or [`super::check_items`] would refuse may be passed by.
#[inline]
pub fn traverse<V: Visitor>(nodes: &[Node], ray: &GridRay, visitor: &mut V) {
    match ray.axis {
        0 => walk::<0, V>(nodes, ray, visitor),
        1 => walk::<1, V>(nodes, ray, visitor),
        _ => walk::<2, V>(nodes, ray, visitor),
    }
}

#[inline]
fn walk<const K: usize, V: Visitor>(nodes: &[Node], ray: &GridRay, visitor: &mut V) {
    // A waiting node is its nearest depth in the high half, its index in the low one.
    let mut stack: Vec<u32, STACK> = Vec::new();
    let mut boxes = Boxes::new(ray);
    let mut at = 0u32;
    loop {
        let mut nearest = NONE;
        if let Some(node) = nodes.get((at & 0xffff) as usize) {
            let mut mask = boxes.hit_mask::<K>(node, visitor.limit());
            let few = mask & mask.wrapping_sub(1) == 0;
            // Straight on to a single inner child; what follows does the same with more ado.
            if COUNTED && few && mask != 0 {
                let meta = node.meta[mask.trailing_zeros() as usize & 3];
                if meta & 0x80 != 0 {
                    at = u32::from(node.node(meta));
                    continue;
                }
            }
            // With nothing to choose from, or to fall behind of, it does not matter where a child begins.
            let order = if few { Order::Any } else { V::ORDER };
            let depths = boxes.depths::<K>(node, order);
            let mut slot = 0;
            while mask != 0 {
                let skipped = if COUNTED { mask.trailing_zeros() } else { 0 };
                slot += skipped as usize;
                mask >>= skipped;
                if COUNTED || mask & 1 != 0 {
                    let meta = node.meta[slot & 3];
                    if meta & 0x80 != 0 {
                        let waiting = depths.of::<K>(slot) << 16 | node.node(meta) as u32;
                        let farther = waiting.max(nearest);
                        nearest = waiting.min(nearest);
                        if farther != NONE {
                            // It fits: the border bounds the depth.
                            let _ = stack.push(farther);
                        }
                    } else if visitor.visit::<K>(ray, node.primitives(), meta as u32).is_break() {
                        return;
                    }
                }
                mask >>= 1;
                slot += 1;
            }
        }
        let limit = visitor.limit();
        at = nearest;
        while at == NONE || (at >> 16) as i32 > limit {
            match stack.pop() {
                Some(waiting) => at = waiting,
                None => return,
            }
        }
    }
}

/// No node waits: depth and index are the largest of all.
const NONE: u32 = u32::MAX;

/// Whether the core counts the zeros below a mask's lowest bit in one instruction that is worth its while.
const COUNTED: bool = cfg!(target_arch = "x86_64");

/// A node's four boxes in turn: what is the same of a ray for all of a tree's, and for all of a node's.
/// [`super::sse2`] has the same at once.
#[cfg(any(test, not(target_arch = "x86_64")))]
pub(super) struct OneByOne<'a> {
    ray: &'a GridRay,
    /// What the ray passes on its way aside.
    across: [Rise; 2],
    /// All ones for a ray that goes down its dominant axis: places along it, so flipped, rise along the ray.
    flip: i32,
    /// The node's origin along the dominant axis, seen from the ray's.
    origin: i32,
    /// As [`hit_mask`] has them.
    bounds: [i32; 2],
}

/// Of a node: how far off its children are.
#[cfg(any(test, not(target_arch = "x86_64")))]
pub(super) struct Depths<'a> {
    boxes: &'a OneByOne<'a>,
    node: &'a Node,
    order: Order,
}

#[cfg(any(test, not(target_arch = "x86_64")))]
impl<'a> OneByOne<'a> {
    #[inline(always)]
    pub fn new(ray: &'a GridRay) -> OneByOne<'a> {
        OneByOne {
            ray,
            across: ray.slopes.map(|slope| Rise::new(slope, ray.negative)),
            flip: -(ray.negative as i32),
            origin: 0,
            bounds: [0; 2],
        }
    }

    /// Bit i: the ray may meet child i before the limit. (Slots without a child may be set.)
    #[inline(always)]
    pub fn hit_mask<const K: usize>(&mut self, node: &Node, limit: i32) -> u32 {
        let origin = from_origin::<K>(node, self.ray);
        let (mask, bounds) = hit_mask::<K>(node, self.ray, origin, limit);
        (self.origin, self.bounds) = (origin, bounds);
        mask
    }

    /// Of the node that was asked last.
    #[inline(always)]
    pub fn depths<const K: usize>(&'a self, node: &'a Node, order: Order) -> Depths<'a> {
        Depths {
            boxes: self,
            node,
            order,
        }
    }

    /// The child's face along the dominant axis that the ray comes to first, flipped.
    #[inline(always)]
    fn face<const K: usize>(&self, node: &Node, slot: usize) -> i32 {
        node.planes[K][(self.flip & 1) as usize][slot & 3] as i32 ^ self.flip
    }

    /// How far away a flipped plane of the node is, steps along the dominant axis: 0 ..= 65535.
    #[inline(always)]
    fn along(&self, plane: i32, node: &Node) -> u32 {
        let z = self.origin + ((plane ^ self.flip) << (node.exponent & 15));
        ((z ^ self.flip) - self.flip).max(0) as u32
    }
}

#[cfg(any(test, not(target_arch = "x86_64")))]
impl Depths<'_> {
    /// By the order; 0 for any.
    #[inline(always)]
    pub fn of<const K: usize>(&self, slot: usize) -> u32 {
        let Depths { boxes, node, order } = *self;
        match order {
            Order::Any => 0,
            Order::Entry => depth::<K>(node, boxes, slot),
            Order::Face => boxes.along(boxes.face::<K>(node, slot), node),
        }
    }
}

/// Where the ray comes into the child's box, steps along the dominant axis, or a little before: 0 ..= 65535.
///
/// Of three planes it passes the last: the box's face along the axis, and those across it, which lie as far along as they
/// lie aside over the slope. That is cut off to a whole plane's step, and one more is taken off, since a triangle's depth is
/// rounded, too.
#[cfg(any(test, not(target_arch = "x86_64")))]
#[cfg_attr(target_pointer_width = "32", inline(never))]
#[cfg_attr(not(target_pointer_width = "32"), inline(always))]
fn depth<const K: usize>(node: &Node, boxes: &OneByOne, slot: usize) -> u32 {
    let mut plane = boxes.face::<K>(node, slot);
    for a in 0..2 {
        let rise = &boxes.across[a];
        let face = node.planes[(K + 1 + a) % 3][rise.face()][slot & 3] as i32;
        if let Some(steps) = rise.steps((face << SLOPE_BITS) - boxes.bounds[a]) {
            // Up to 1.4 too few: one less, or three more where it is flipped.
            plane = plane.max((steps - 1 - (boxes.flip << 2)) ^ boxes.flip);
        }
    }
    boxes.along(plane, node)
}

/// The node's origin along the dominant axis, seen from the ray's.
#[cfg(any(test, not(target_arch = "x86_64")))]
#[inline(always)]
fn from_origin<const K: usize>(node: &Node, ray: &GridRay) -> i32 {
    node.origin[K] as i32 - ray.plane
}

/// Bit i: the ray may meet child i before the limit. (Slots without a child may be set.)
#[cfg(any(test, not(target_arch = "x86_64")))]
#[inline(always)]
fn hit_mask<const K: usize>(node: &Node, ray: &GridRay, origin: i32, limit: i32) -> (u32, [i32; 2]) {
    let e = node.exponent & 15;
    let (from, to) = if ray.negative { (-limit, 0) } else { (0, limit) };
    let (from, to) = ((from - origin) >> e, (to - origin) >> e);
    // Most nodes lie between where the ray starts and its limit as a whole.
    let mask = if from <= 0 && to >= 255 {
        15
    } else {
        along::<K>(&node.planes, from, to)
    };
    if mask == 0 {
        return (0, [0; 2]);
    }
    let first = -ray.across::<K, 0>(&node.origin) >> e;
    let mask = across::<K, 1>(&node.planes, first, ray.slopes[0], mask);
    if mask == 0 {
        return (0, [0; 2]);
    }
    let second = -ray.across::<K, 1>(&node.origin) >> e;
    let mask = across::<K, 2>(&node.planes, second, ray.slopes[1], mask);
    if mask == 0 {
        return (0, [0; 2]);
    }
    let bounds = [first, second];
    (mask, bounds)
}

/// Which children reach into `from` ..= `to` along the dominant axis.
#[cfg(any(test, not(target_arch = "x86_64")))]
#[cfg_attr(narrow_mul, inline(never))]
#[cfg_attr(not(narrow_mul), inline(always))]
fn along<const K: usize>(planes: &Planes, from: i32, to: i32) -> u32 {
    let [low, high] = &planes[K];
    let mut mask = 0;
    for i in 0..4 {
        // The sign says whether it is beyond one of the two.
        mask |= ((((high[i] as i32 - from) | (to - low[i] as i32)) as u32 >> 31) ^ 1) << i;
    }
    mask
}

/// Which of `mask` the ray meets as seen along axis k + `A`.
#[cfg(any(test, not(target_arch = "x86_64")))]
#[inline(always)]
fn across<const K: usize, const A: usize>(planes: &Planes, bound: i32, slope: i32, mask: u32) -> u32 {
    if slope < 0 {
        lateral::<K, A, true>(planes, bound, slope, mask)
    } else {
        lateral::<K, A, false>(planes, bound, slope, mask)
    }
}

#[cfg(any(test, not(target_arch = "x86_64")))]
#[cfg_attr(narrow_mul, inline(never))]
#[cfg_attr(not(narrow_mul), inline(always))]
fn lateral<const K: usize, const A: usize, const N: bool>(
    planes: &Planes,
    bound: i32,
    slope: i32,
    mask: u32,
) -> u32 {
    let [low, high] = &planes[(K + A) % 3];
    let (z_most, z_least) = (&planes[K][!N as usize], &planes[K][N as usize]);
    let mut kept = mask;
    for i in 0..4 {
        if mask >> i & 1 != 0 {
            let most = ((low[i] as i32) << SLOPE_BITS) - z_most[i] as i32 * slope;
            if most > bound || (((high[i] as i32) << SLOPE_BITS) - z_least[i] as i32 * slope) < bound {
                kept &= !(1 << i);
            }
        }
    }
    kept
}
