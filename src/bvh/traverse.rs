//! From the root to the leaves a ray may meet, nearest child first.
//!
//! # Why no box is passed by
//!
//! A child's box is [x0, x1] × [y0, y1] × [z0, z1] seen from the ray's origin, z along the dominant axis. The ray
//! meets it only if z1 ≥ 0 and z0 ≤ limit, and if for some z in z0 ..= z1 the point S·z lies in x0 ..= x1: that is,
//! x0 ≤ max S·z and min S·z ≤ x1, each extreme at z0 or z1 by the sign of S; and the same for y. With planes
//! x = (N − o) + (q << e) the first of these becomes, in units of 2^e,
//!
//! (q_x0 << 13) − S·q_z ≤ B / 2^e, B = ((o_x − N_x) << 13) + S·(N_z − o_z).
//!
//! Its left side is an integer, so ⌊B / 2^e⌋ on the right decides the same; in the second inequality, whose sign is ≥,
//! ⌊B / 2^e⌋ is at most one too low, which lets in and never keeps out. The same holds for z: one bound is exact,
//! the other rounded down where that lets in. So a child is left out only if the exact ray misses the box that its
//! planes make.
//!
//! What the ray sees of a triangle lies within ½ step of the triangle (see [`crate::shape::triangle`]), so in its box
//! padded by one; its depth is held within those of its vertices. Hence no triangle that would be hit is in a box that is left out.
//!
//! # Why nothing wraps
//!
//! |o − N| < 2^17 and |N_z − o_z| < 2^16, so |B| < 2^30 + 2^29. (q << 13) and S·q are under 2^21.

use super::MAX_DEPTH;
use super::node::{Child, Node, Planes};
use crate::shape::{GridRay, SLOPE_BITS};
use core::ops::ControlFlow;
use heapless::Vec;

/// Three children a level wait while the fourth is looked at.
const STACK: usize = 3 * MAX_DEPTH + 1;

/// What a traversal does at the leaves.
pub trait Visitor {
    /// Depth in whole steps along the dominant axis beyond which nothing is wanted, at most 65535; negative for
    /// nothing at all. Asked again at each node, so it may shrink.
    fn limit(&self) -> i32;

    /// Look at the primitives `first` .. `first + count`; `K` is the ray's dominant axis. Break to stop.
    fn visit<const K: usize>(&mut self, ray: &GridRay, first: u32, count: u32) -> ControlFlow<()>;
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
    let mut at = 0u32;
    loop {
        let mut nearest = u32::MAX;
        if let Some(node) = nodes.get((at & 0xffff) as usize) {
            let origin = from_origin::<K>(node, ray);
            let mask = hit_mask::<K>(node, ray, origin, visitor.limit());
            let near_planes = &node.planes[K][ray.negative as usize];
            for (i, (&meta, &near)) in node.meta.iter().zip(near_planes).enumerate() {
                if mask >> i == 0 {
                    break;
                }
                if mask >> i & 1 == 0 {
                    continue;
                }
                match node.child(meta) {
                    Child::Node(index) => {
                        let z = origin + ((near as i32) << (node.exponent & 15));
                        let z = if ray.negative { -z } else { z };
                        let mut waiting = (z.max(0) as u32) << 16 | index as u32;
                        if waiting < nearest {
                            core::mem::swap(&mut waiting, &mut nearest);
                        }
                        if waiting != u32::MAX {
                            // It fits: the border bounds the depth.
                            let _ = stack.push(waiting);
                        }
                    }
                    Child::Leaf { first, count } => {
                        if visitor.visit::<K>(ray, first, count).is_break() {
                            return;
                        }
                    }
                    Child::None => {}
                }
            }
        }
        let limit = visitor.limit();
        at = nearest;
        while at == u32::MAX || (at >> 16) as i32 > limit {
            match stack.pop() {
                Some(waiting) => at = waiting,
                None => return,
            }
        }
    }
}

/// The node's origin along the dominant axis, seen from the ray's.
#[inline(always)]
fn from_origin<const K: usize>(node: &Node, ray: &GridRay) -> i32 {
    node.origin[K] as i32 - ray.origin[2]
}

/// Bit i: the ray may meet child i before the limit. (Slots without a child may be set.)
#[inline(always)]
fn hit_mask<const K: usize>(node: &Node, ray: &GridRay, origin: i32, limit: i32) -> u32 {
    let e = node.exponent & 15;
    let (from, to) = if ray.negative { (-limit, 0) } else { (0, limit) };
    let mask = along::<K>(&node.planes, (from - origin) >> e, (to - origin) >> e);
    if mask == 0 {
        return 0;
    }
    let bound = |a: usize, i: usize| {
        (((ray.origin[i] - node.origin[a] as i32) << SLOPE_BITS) + ray.slopes[i] * origin) >> e
    };
    let mask = across::<K, 1>(&node.planes, bound((K + 1) % 3, 0), ray.slopes[0], mask);
    if mask == 0 {
        return 0;
    }
    across::<K, 2>(&node.planes, bound((K + 2) % 3, 1), ray.slopes[1], mask)
}

/// Which children reach into `from` ..= `to` along the dominant axis.
#[cfg_attr(narrow_mul, inline(never))]
#[cfg_attr(not(narrow_mul), inline(always))]
fn along<const K: usize>(planes: &Planes, from: i32, to: i32) -> u32 {
    let [low, high] = &planes[K];
    let mut mask = 0;
    for i in 0..4 {
        mask |= ((high[i] as i32 >= from && low[i] as i32 <= to) as u32) << i;
    }
    mask
}

/// Which of `mask` the ray meets as seen along axis k + `A`.
#[inline(always)]
fn across<const K: usize, const A: usize>(planes: &Planes, bound: i32, slope: i32, mask: u32) -> u32 {
    if slope < 0 {
        lateral::<K, A, true>(planes, bound, slope, mask)
    } else {
        lateral::<K, A, false>(planes, bound, slope, mask)
    }
}

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
