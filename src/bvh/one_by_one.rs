//! A node's four boxes in turn, on whatever core: [`super::traverse`] says why they are decided so. On x86-64 `sse2` has the
//! same at once.

use super::node::{Node, Planes};
use super::traverse::Order;
use crate::shape::{GridRay, Rise, SLOPE_BITS};

/// What is the same of a ray for all of a tree's boxes, and for all of a node's.
pub struct OneByOne<'a> {
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
pub struct Depths<'a> {
    boxes: &'a OneByOne<'a>,
    node: &'a Node,
    order: Order,
}

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
        // Backwards from −limit to 0 along the axis, else from 0 to the limit.
        let from = -limit & self.flip;
        let (mask, bounds) = hit_mask::<K>(node, self.ray, origin, from, from + limit);
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
#[inline(always)]
fn from_origin<const K: usize>(node: &Node, ray: &GridRay) -> i32 {
    node.origin[K] as i32 - ray.plane
}

/// Bit i: the ray may meet child i before the limit. (Slots without a child may be set.)
#[inline(always)]
fn hit_mask<const K: usize>(node: &Node, ray: &GridRay, origin: i32, from: i32, to: i32) -> (u32, [i32; 2]) {
    let e = node.exponent & 15;
    let first = -ray.across::<K, 0>(&node.origin) >> e;
    let mask = across::<K, 1>(&node.planes, first, ray.slopes[0], 15);
    if mask == 0 {
        return (0, [0; 2]);
    }
    let second = -ray.across::<K, 1>(&node.origin) >> e;
    let mask = across::<K, 2>(&node.planes, second, ray.slopes[1], mask);
    if mask == 0 {
        return (0, [0; 2]);
    }
    let (from, to) = ((from - origin) >> e, (to - origin) >> e);
    // Most nodes lie between where the ray starts and its limit as a whole.
    let mask = if from <= 0 && to >= 255 {
        mask
    } else {
        along::<K>(&node.planes, from, to, mask)
    };
    (mask, [first, second])
}

/// Which children reach into `from` ..= `to` along the dominant axis.
#[cfg_attr(narrow_mul, inline(never))]
#[cfg_attr(not(narrow_mul), inline(always))]
fn along<const K: usize>(planes: &Planes, from: i32, to: i32, mask: u32) -> u32 {
    let [low, high] = &planes[K];
    let mut kept = mask;
    for i in 0..4 {
        // The sign says whether it is beyond one of the two.
        if mask >> i & 1 != 0 && ((high[i] as i32 - from) | (to - low[i] as i32)) < 0 {
            kept &= !(1 << i);
        }
    }
    kept
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
