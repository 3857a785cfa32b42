//! Top-down, by the binned surface area heuristic, in place: primitives are reordered, nodes written where they stay.
//!
//! A node splits the part where that spares most until there are four, or only leaves that are well as they are. Its
//! leaves then move to the front
//! of its range, so that all primitives of a subtree are neighbours and, taken depth first, leaves before nodes,
//! their order is that of the array ([`super::check_mesh`] relies on it). Near the last level parts are halved by
//! count instead, which bounds the depth.

use super::node::Node;
use super::{MAX_DEPTH, MESH_PAD};
use crate::shape::{Bounds, corners};
use heapless::Vec;

/// Most primitives in a leaf.
pub(crate) const LEAF: u32 = 4;
const BINS: usize = 32;
/// 16-bit indices but for the last, by which a traversal says "none".
const MAX_NODES: u32 = u16::MAX as u32;
/// Pending nodes: three a level beside the one at hand.
const JOBS: usize = 3 * MAX_DEPTH + 1;

/// The memory was too little.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildError {
    /// Nodes that are enough for so many primitives. (At most 65535 can be used, whatever the memory.)
    pub needed: usize,
}

/// Nodes that are enough for `primitives`.
///
/// A node that has inner children has four children, and a leaf beside them holds one primitive at least; a node
/// that has none holds five primitives at least (but for the root). So L nodes of the second kind and M of the first hold
/// 5 L + 4 M − (L + M − 1) primitives or more, which is 3 (L + M) + 2 or more.
pub const fn max_nodes(primitives: usize) -> usize {
    if primitives < 8 { 1 } else { (primitives - 2) / 3 }
}

/// Something with a box in a grid.
pub trait Item {
    fn bounds(&self) -> Bounds;
}

impl Item for Bounds {
    fn bounds(&self) -> Bounds {
        *self
    }
}

/// Build a tree over the triangles of a mesh, reordering them; answers how many nodes it took.
///
/// The tree refers to the order the triangles have afterwards. Deterministic.
pub fn build_mesh(
    vertices: &[[u16; 3]],
    triangles: &mut [[u16; 3]],
    nodes: &mut [Node],
) -> Result<usize, BuildError> {
    build(&mut Triangles { vertices, triangles }, MESH_PAD, nodes)
}

/// Build a tree over items with boxes, reordering them; answers how many nodes it took.
///
/// Boxes grow by `pad` steps and should keep as much from the cube's faces: what goes beyond is cut off.
pub fn build_items<T: Item>(items: &mut [T], pad: u16, nodes: &mut [Node]) -> Result<usize, BuildError> {
    build(&mut Items(items), pad, nodes)
}

/// Primitives that can be looked at and swapped.
trait Primitives {
    fn count(&self) -> usize;
    fn bounds(&self, i: u32) -> Bounds;
    fn swap(&mut self, i: u32, j: u32);
}

struct Triangles<'a> {
    vertices: &'a [[u16; 3]],
    triangles: &'a mut [[u16; 3]],
}

impl Primitives for Triangles<'_> {
    fn count(&self) -> usize {
        self.triangles.len()
    }

    fn bounds(&self, i: u32) -> Bounds {
        let triangle = self.triangles.get(i as usize);
        triangle
            .and_then(|&t| corners(self.vertices, t))
            .map_or(Bounds::EMPTY, |c| Bounds::of(&c.map(|v| *v)))
    }

    fn swap(&mut self, i: u32, j: u32) {
        swap(self.triangles, i, j);
    }
}

struct Items<'a, T>(&'a mut [T]);

impl<T: Item> Primitives for Items<'_, T> {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn bounds(&self, i: u32) -> Bounds {
        self.0.get(i as usize).map_or(Bounds::EMPTY, Item::bounds)
    }

    fn swap(&mut self, i: u32, j: u32) {
        swap(self.0, i, j);
    }
}

fn swap<T>(slice: &mut [T], i: u32, j: u32) {
    if (i as usize) < slice.len() && (j as usize) < slice.len() {
        slice.swap(i as usize, j as usize);
    }
}

/// A stretch of primitives and the box around them, not yet padded.
#[derive(Clone, Copy)]
struct Part {
    first: u32,
    count: u32,
    bounds: Bounds,
}

impl Part {
    fn new(p: &impl Primitives, first: u32, count: u32) -> Part {
        let bounds = (first..first + count).fold(Bounds::EMPTY, |b, i| b.union(p.bounds(i)));
        Part { first, count, bounds }
    }

    fn is_leaf(&self) -> bool {
        self.count <= LEAF
    }
}

struct Job {
    node: u16,
    level: usize,
    first: u32,
    count: u32,
}

fn build<P: Primitives>(p: &mut P, pad: u16, nodes: &mut [Node]) -> Result<usize, BuildError> {
    let needed = max_nodes(p.count());
    let small = BuildError { needed };
    if p.count() >= 1 << 24 {
        return Err(small);
    }
    let count = p.count() as u32;
    if count == 0 {
        return Ok(0);
    }
    let mut used = 1u32;
    let mut jobs: Vec<Job, JOBS> = Vec::new();
    let mut next = Some(Job {
        node: 0,
        level: 1,
        first: 0,
        count,
    });
    while let Some(job) = next {
        let parts = divide(p, &job);
        let all = parts
            .iter()
            .fold(Bounds::EMPTY, |b, part| b.union(part.bounds))
            .pad(pad);
        let base = used;
        let mut node = Node::around(all, base as u16, job.first);
        for (slot, part) in parts.iter().enumerate() {
            let meta = if part.is_leaf() {
                (part.count << 4 | (part.first - job.first)) as u8
            } else {
                used += 1;
                0x80 | (used - 1 - base) as u8
            };
            node.set(slot, part.bounds.pad(pad), meta);
        }
        if used > MAX_NODES || used as usize > nodes.len() {
            return Err(small);
        }
        *nodes.get_mut(job.node as usize).ok_or(small)? = node;
        // The last pushed is the first inner child.
        let mut child = used;
        for part in parts.iter().rev().filter(|part| !part.is_leaf()) {
            child -= 1;
            let job = Job {
                node: child as u16,
                level: job.level + 1,
                first: part.first,
                count: part.count,
            };
            jobs.push(job).map_err(|_| small)?;
        }
        next = jobs.pop();
    }
    Ok(used as usize)
}

/// The parts of a node, leaves first.
fn divide<P: Primitives>(p: &mut P, job: &Job) -> Vec<Part, 4> {
    // What a child's subtree can hold if it is halved by count from there: 16 · 4^(levels below it).
    let levels = MAX_DEPTH.saturating_sub(job.level + 1).min(10);
    let room = 16u32 << (2 * levels);
    let by_count = job.count > room;
    let whole = Part::new(p, job.first, job.count);
    let mut parts: Vec<Part, 4> = Vec::new();
    parts.extend([whole]);
    while parts.len() < 4 {
        let choice = |part| {
            if by_count {
                Choice::by_count(part)
            } else {
                Choice::new(p, part, area(whole.bounds))
            }
        };
        let Some(best) = parts
            .iter_mut()
            .filter_map(choice)
            .max_by_key(|choice| choice.gain)
        else {
            break;
        };
        let middle = match best.split {
            Some(split) => split.apply(p, best.part),
            None => halve(p, best.part),
        };
        let right = cut(p, best.part, middle);
        parts.extend([right]);
    }
    leaves_first(p, &mut parts);
    parts
}

/// A part that may be split next.
struct Choice<'a> {
    part: &'a mut Part,
    /// In halves by count if there is none.
    split: Option<Split>,
    gain: u64,
}

impl<'a> Choice<'a> {
    /// Surface times primitives that the best split spares, for each leaf's worth of primitives (the work a subtree
    /// causes grows far slower than its size). Leaves only where a box more costs less than it spares: it is tested
    /// for each ray that meets the node, a primitive (five times the work) for each that meets the leaf.
    fn new(p: &impl Primitives, part: &'a mut Part, node_area: u64) -> Option<Choice<'a>> {
        let split = Split::best(p, part);
        let before = area(part.bounds) * part.count as u64;
        let spared = split.map_or(0, |split| before.saturating_sub(split.cost));
        let gain = spared * LEAF as u64 / part.count.max(LEAF) as u64;
        (!part.is_leaf() || 5 * gain > node_area).then_some(Choice { part, split, gain })
    }

    /// The largest first, no leaves.
    fn by_count(part: &'a mut Part) -> Option<Choice<'a>> {
        let gain = part.count as u64;
        (!part.is_leaf()).then_some(Choice {
            part,
            split: None,
            gain,
        })
    }
}

/// Keep what is before `middle`, answer the rest.
fn cut(p: &impl Primitives, part: &mut Part, middle: u32) -> Part {
    let right = Part::new(p, middle, part.first + part.count - middle);
    *part = Part::new(p, part.first, middle - part.first);
    right
}

/// Order the parts as the array has them, leaves before the others, moving primitives as needed.
fn leaves_first<P: Primitives>(p: &mut P, parts: &mut Vec<Part, 4>) {
    // Four at most: `core`'s sort would bring a recursion, and 1 KiB of stack for each of its levels.
    for _ in 1..parts.len() {
        for i in 1..parts.len() {
            if let Some([a, b]) = parts.get_mut(i - 1..=i)
                && b.first < a.first
            {
                core::mem::swap(a, b);
            }
        }
    }
    for _ in 1..parts.len() {
        for i in 1..parts.len() {
            if let Some([a, b]) = parts.get_mut(i - 1..=i)
                && !a.is_leaf()
                && b.is_leaf()
            {
                // b is smaller: exchange it with the front of a, whose others keep their places.
                for k in 0..b.count {
                    p.swap(a.first + k, b.first + k);
                }
                b.first = a.first;
                a.first += b.count;
                core::mem::swap(a, b);
            }
        }
    }
}

/// Half the surface of a box grown by one step, steps²: under 2^34. 0 for none.
fn area(b: Bounds) -> u64 {
    let [x, y, z] = [0, 1, 2].map(|a| (b.high[a] as u64 + 2).saturating_sub(b.low[a] as u64));
    if b.low[0] > b.high[0] {
        0
    } else {
        x * y + y * z + z * x
    }
}

/// Twice the centre of a box along an axis.
fn centre_2x(b: Bounds, axis: usize) -> u32 {
    b.low[axis] as u32 + b.high[axis] as u32
}

/// Smallest and largest doubled centre along an axis.
fn spread(p: &impl Primitives, part: &Part, axis: usize) -> (u32, u32) {
    (part.first..part.first + part.count).fold((u32::MAX, 0), |(low, high), i| {
        let c = centre_2x(p.bounds(i), axis);
        (low.min(c), high.max(c))
    })
}

/// A plane between two bins of an axis.
#[derive(Clone, Copy)]
struct Split {
    axis: usize,
    low: u32,
    width: u32,
    /// The last bin of the left side.
    bin: usize,
    /// Areas times counts of both sides.
    cost: u64,
}

impl Split {
    /// The cheapest; `None` if all centres coincide.
    fn best(p: &impl Primitives, part: &Part) -> Option<Split> {
        (0..3)
            .filter_map(|axis| Split::along(p, part, axis))
            .min_by_key(|split| split.cost)
    }

    fn along(p: &impl Primitives, part: &Part, axis: usize) -> Option<Split> {
        let (low, high) = spread(p, part, axis);
        let width = (high > low).then(|| high - low + 1)?;
        let mut split = Split {
            axis,
            low,
            width,
            bin: 0,
            cost: u64::MAX,
        };
        let mut bins = [(Bounds::EMPTY, 0u32); BINS];
        for i in part.first..part.first + part.count {
            let bounds = p.bounds(i);
            if let Some((b, n)) = bins.get_mut(split.bin_of(bounds)) {
                (*b, *n) = (b.union(bounds), *n + 1);
            }
        }
        let cost = |(b, n): (Bounds, u32)| area(b) * n as u64;
        let join = |(a, n): (Bounds, u32), &(b, m): &(Bounds, u32)| (a.union(b), n + m);
        // Left to right the cost of the left side, then right to left that of the right.
        let mut left_costs = [0; BINS];
        let mut left = (Bounds::EMPTY, 0);
        for (at, bin) in left_costs.iter_mut().zip(&bins) {
            left = join(left, bin);
            *at = cost(left);
        }
        let mut right = (Bounds::EMPTY, 0);
        for (bin, &left_cost) in left_costs.iter().enumerate().take(BINS - 1).rev() {
            right = join(right, bins.get(bin + 1)?);
            let sum = left_cost + cost(right);
            if sum < split.cost {
                (split.cost, split.bin) = (sum, bin);
            }
        }
        Some(split)
    }

    fn bin_of(&self, b: Bounds) -> usize {
        ((centre_2x(b, self.axis).saturating_sub(self.low)) * BINS as u32 / self.width) as usize
    }

    /// Move the left side to the front; answers where the right one begins, with something on both sides.
    fn apply(&self, p: &mut impl Primitives, part: &Part) -> u32 {
        to_front(p, part, |b| self.bin_of(b) <= self.bin)
    }
}

/// Move those of a kind to the front; answers where they end.
fn to_front(p: &mut impl Primitives, part: &Part, kind: impl Fn(Bounds) -> bool) -> u32 {
    let (mut i, mut j) = (part.first, part.first + part.count);
    while i < j {
        if kind(p.bounds(i)) {
            i += 1;
        } else {
            j -= 1;
            p.swap(i, j);
        }
    }
    i
}

/// Move the lower half along the widest axis to the front; answers where the upper one begins.
fn halve(p: &mut impl Primitives, part: &Part) -> u32 {
    let half = part.count / 2;
    let width = |axis: &usize| {
        let (low, high) = spread(p, part, *axis);
        high.saturating_sub(low)
    };
    let axis = (0..3).max_by_key(width).unwrap_or(0);
    // The largest value with at most half of the centres below it.
    let below = |value: u32| {
        (part.first..part.first + part.count)
            .filter(|&i| centre_2x(p.bounds(i), axis) < value)
            .count() as u32
    };
    let value = (0..17).rev().fold(0, |value, bit| {
        if below(value | 1 << bit) <= half {
            value | 1 << bit
        } else {
            value
        }
    });
    let middle = to_front(p, part, |b| centre_2x(b, axis) < value);
    // Those at the value itself may go either way.
    let rest = Part {
        first: middle,
        count: part.first + part.count - middle,
        ..*part
    };
    to_front(p, &rest, |b| centre_2x(b, axis) == value);
    part.first + half
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::check_items;

    fn boxes(n: u16, at: impl Fn(u16) -> u16) -> std::vec::Vec<Bounds> {
        (0..n)
            .map(|i| Bounds {
                low: [at(i), 1000, 1000],
                high: [at(i) + 10, 1010, 1010],
            })
            .collect()
    }

    #[test]
    fn enough_nodes_are_enough() {
        for n in 0..200 {
            for at in [|i: u16| 100 + 20 * i, |_| 500, |i| 100 + i * i] {
                let mut items = boxes(n, at);
                let mut nodes = std::vec![Node::EMPTY; max_nodes(n as usize)];
                let used = build_items(&mut items, 16, &mut nodes).unwrap();
                check_items(&items, 16, &nodes[..used]).unwrap();
                if used > 1 {
                    let too_few = &mut nodes[..used - 1];
                    assert_eq!(
                        build_items(&mut items, 16, too_few),
                        Err(BuildError {
                            needed: max_nodes(n as usize)
                        })
                    );
                }
            }
        }
    }

    #[test]
    fn doubling_distances_do_not_deepen_the_tree() {
        // Each split of the surface heuristic takes a few off the end; the bound must hold by count.
        let mut items: std::vec::Vec<Bounds> = (0..4000u32)
            .map(|i| {
                let at = 60000u32 >> (i / 250);
                Bounds {
                    low: [at as u16; 3],
                    high: [at as u16 + 1; 3],
                }
            })
            .collect();
        let mut nodes = std::vec![Node::EMPTY; max_nodes(items.len())];
        let used = build_items(&mut items, 16, &mut nodes).unwrap();
        assert!(check_items(&items, 16, &nodes[..used]).unwrap() <= MAX_DEPTH);
    }
}
