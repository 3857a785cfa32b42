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

#[cfg(assembly)]
use super::asm::walk;
use super::node::Node;
#[cfg(not(any(assembly, target_arch = "x86_64")))]
use super::one_by_one::OneByOne as Boxes;
#[cfg(target_arch = "x86_64")]
use super::sse2::Boxes;
use crate::shape::GridRay;
use core::ops::ControlFlow;

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
    /// Whether [`Visitor::visit`] makes use of `K`.
    const BY_AXIS: bool = true;

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
    if !BOXES_BY_AXIS && !V::BY_AXIS {
        return walk::<0, V>(nodes, ray, visitor);
    }
    match ray.axis {
        0 => walk::<0, V>(nodes, ray, visitor),
        1 => walk::<1, V>(nodes, ray, visitor),
        _ => walk::<2, V>(nodes, ray, visitor),
    }
}

/// Whether [`walk`] makes use of `K` itself.
const BOXES_BY_AXIS: bool = cfg!(not(assembly));

#[cfg(not(assembly))]
#[inline]
fn walk<const K: usize, V: Visitor>(nodes: &[Node], ray: &GridRay, visitor: &mut V) {
    /// Three children a level wait while the fourth is looked at.
    const STACK: usize = 3 * super::MAX_DEPTH + 1;
    /// No node waits: depth and index are the largest of all.
    const NONE: u32 = u32::MAX;
    /// Whether the core counts the zeros below a mask's lowest bit in one instruction that is worth its while.
    const COUNTED: bool = cfg!(target_arch = "x86_64");
    // A waiting node is its nearest depth in the high half, its index in the low one.
    let mut stack: heapless::Vec<u32, STACK> = heapless::Vec::new();
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
