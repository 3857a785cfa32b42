//! A node's four boxes at once, by SSE2, which every x86-64 has: the same bits as `one_by_one` has.
//!
//! Safe: none of these intrinsics takes a pointer.
//!
//! # Why nothing wraps
//!
//! `mul_i16_horizontal_add_m128i` adds two products of signed 16 bits: slopes are within ±2^13, planes under 2^8; grid
//! coordinates are moved down by 2^15, which the constant added after takes back. All that it makes is within ±2^29.

use super::node::Node;
use super::traverse::Order;
use crate::shape::{GridRay, Rise, SLOPE_BITS};
use safe_arch::{
    add_i32_m128i, bitandnot_m128i, cast_to_m128_from_m128i, cmp_gt_mask_i16_m128i, cmp_gt_mask_i32_m128i,
    insert_i16_from_i32_m128i, m128i, max_i16_m128i, move_mask_m128, mul_i16_horizontal_add_m128i,
    mul_widen_u32_odd_m128i, pack_i32_to_i16_m128i, set_i32_m128i, set_i32_m128i_s, set_i64_m128i,
    set_i64_m128i_s, set_splat_i16_m128i, set_splat_i32_m128i, shl_all_u32_m128i, shl_imm_u64_m128i,
    shr_all_i32_m128i, shr_all_u64_m128i, shr_imm_i32_m128i, shr_imm_u32_m128i, shr_imm_u64_m128i,
    shuffle_ai_f32_all_m128i, shuffle_ai_i16_h64all_m128i, shuffle_ai_i16_l64all_m128i, sub_i32_m128i,
    unpack_high_i8_m128i, unpack_low_i8_m128i, unpack_low_i16_m128i, unpack_low_i64_m128i, zeroed_m128i,
};

/// What is the same of a ray for all nodes.
pub struct Boxes {
    plane: i32,
    /// Factors of a node's origin, and what is added: both bounds across, the start's depth inverted, the limit's depth.
    weights: m128i,
    moved: m128i,
    /// Where the limit itself is added to those.
    limited: m128i,
    across: [Across; 2],
    /// All ones for a ray along the negative axis.
    negative: m128i,
    /// By how much low and high planes are shifted to have those that the ray comes to first.
    first: m128i,
    /// Of the node that was asked last.
    met: Met,
}

/// What is the same along an axis across.
struct Across {
    /// Factors of a plane and of one along the dominant axis.
    weights: m128i,
    /// All ones where a low plane goes with a high one.
    crossed: m128i,
    /// Factor of a plane: one step, with the slope's sign.
    step: m128i,
    rise: Rise,
}

/// Of a node: what its planes across are held against, in the lowest two of four.
#[derive(Clone, Copy)]
pub struct Met(m128i);

/// Of a node: how far off its children are.
pub struct Depths([u32; 4]);

impl Depths {
    #[inline(always)]
    pub fn of<const K: usize>(&self, slot: usize) -> u32 {
        self.0[slot & 3]
    }
}

impl Boxes {
    #[inline(always)]
    pub fn new(ray: &GridRay) -> Boxes {
        let GridRay { plane, negative, .. } = *ray;
        let across = |a: usize| {
            let slope = ray.slopes[a];
            Across {
                weights: set_splat_i32_m128i(pair(STEP, -slope)),
                crossed: ones(slope >= 0),
                step: set_splat_i32_m128i(pair(if slope < 0 { -STEP } else { STEP }, 0)),
                rise: Rise::new(slope, negative),
            }
        };
        let [s0, s1] = ray.slopes;
        let moved = |a: usize| (ray.slopes[a] - STEP) * HALF - ray.offsets[a];
        Boxes {
            plane,
            weights: set_i32_m128i(pair(-1, 0), pair(1, 0), pair(-STEP, s1), pair(-STEP, s0)),
            moved: set_i32_m128i(plane - HALF, HALF - plane - 1, moved(1), moved(0)),
            limited: set_i32_m128i(-(!negative as i32), -(negative as i32), 0, 0),
            across: [across(0), across(1)],
            negative: ones(negative),
            first: shift(negative as u32 * 32),
            met: Met(zeroed_m128i()),
        }
    }

    /// Bit i: the ray may meet child i before the limit. (Slots without a child may be set.)
    #[inline(always)]
    pub fn hit_mask<const K: usize>(&mut self, node: &Node, limit: i32) -> u32 {
        let zero = zeroed_m128i();
        // The node's origin across, twice along: what is bound, in steps of its planes.
        let [x, y, z] = node.origin.map(i32::from);
        let origin = insert_i16_from_i32_m128i::<2>(set_i32_m128i_s(x | y << 16), z);
        let (sides, along) = match K {
            0 => (words::<0b00_10_00_01>(origin), words::<0b00_00_00_00>(origin)),
            1 => (words::<0b01_00_01_10>(origin), words::<0b01_01_01_01>(origin)),
            _ => (words::<0b10_01_10_00>(origin), words::<0b10_10_10_10>(origin)),
        };
        let origin = unpack_low_i64_m128i(sides, along) ^ set_splat_i16_m128i(i16::MIN);
        let moved = add_i32_m128i(self.moved, set_splat_i32_m128i(limit) & self.limited);
        let bounds = add_i32_m128i(mul_i16_horizontal_add_m128i(origin, self.weights), moved);
        let bounds = shr_all_i32_m128i(bounds, exponent(node));
        // Along: low planes beyond the limit; high ones, inverted, beyond the start, inverted.
        let depths = ends(&node.planes[K]);
        let planes = unpack_low_i8_m128i(depths, zero) ^ set_i64_m128i(-1, 0);
        let bound = pack_i32_to_i16_m128i(bounds, bounds);
        let bound = shuffle_ai_i16_h64all_m128i::<0b10_10_10_10>(words::<0b11_11_11_11>(bound));
        let beyond = cmp_gt_mask_i16_m128i(planes, bound);
        // Across: the one end above the bound, or the other below it.
        let turned = depths ^ shuffle_ai_f32_all_m128i::<0b11_10_00_01>(depths);
        let aside = |a: usize, bound: m128i| {
            let Across { weights, crossed, .. } = self.across[a];
            let planes = ends(&node.planes[(K + 1 + a) % 3]);
            let both = unpack_low_i8_m128i(planes, depths ^ turned & crossed);
            let most = mul_i16_horizontal_add_m128i(unpack_low_i8_m128i(both, zero), weights);
            let least = mul_i16_horizontal_add_m128i(unpack_high_i8_m128i(both, zero), weights);
            (
                cmp_gt_mask_i32_m128i(most, bound),
                cmp_gt_mask_i32_m128i(bound, least),
            )
        };
        let met = Met(bounds);
        let [(above, below), (over, under)] = [aside(0, met.bound::<0>()), aside(1, met.bound::<1>())];
        // Words of 16 bits to those of 32 for each child.
        let beyond = beyond | shuffle_ai_f32_all_m128i::<0b01_00_11_10>(beyond);
        let beyond = unpack_low_i16_m128i(beyond, beyond);
        let missed = above | over | below | under | beyond;
        self.met = met;
        !move_mask_m128(cast_to_m128_from_m128i(missed)) as u32 & 15
    }

    /// How far off the children of the node that was asked last are, as `one_by_one` has it.
    #[inline(always)]
    pub fn depths<const K: usize>(&self, node: &Node, order: Order) -> Depths {
        if order == Order::Any {
            return Depths([0; 4]);
        }
        // Counted from the other end for a ray along the negative axis, so that of several planes the largest counts.
        let turned = set_splat_i32_m128i(255) & self.negative;
        let mut planes = wide(shr_all_u64_m128i(ends(&node.planes[K]), self.first)) ^ turned;
        if order == Order::Entry {
            let last = [self.last::<K, 0>(node), self.last::<K, 1>(node)];
            planes = max_i16_m128i(max_i16_m128i(planes, last[0]), last[1]);
        }
        let origin = set_splat_i32_m128i(i32::from(node.origin[K]) - self.plane);
        let z = add_i32_m128i(origin, shl_all_u32_m128i(planes ^ turned, exponent(node)));
        let z = sub_i32_m128i(z ^ self.negative, self.negative);
        Depths((z & cmp_gt_mask_i32_m128i(z, zeroed_m128i())).into())
    }

    /// Where the ray passes the faces across axis `A`, planes along the dominant one; 0 or less where it does not.
    #[inline(always)]
    fn last<const K: usize, const A: i32>(&self, node: &Node) -> m128i {
        let Across { step, rise, .. } = &self.across[A as usize & 1];
        let falls = set_splat_i32_m128i(rise.fall);
        let faces = wide(shr_all_u64_m128i(
            ends(&node.planes[(K + 1 + A as usize) % 3]),
            shift(rise.face() as u32 * 32),
        ));
        let bound = sub_i32_m128i(self.met.bound::<A>() ^ falls, falls);
        let aside = sub_i32_m128i(mul_i16_horizontal_add_m128i(faces, *step), bound);
        let near = cmp_gt_mask_i32_m128i(set_splat_i32_m128i(rise.beyond as i32), aside);
        let near = bitandnot_m128i(shr_imm_i32_m128i::<31>(aside), near);
        // Products of 32 bits, two at once.
        let aside = shr_imm_u32_m128i::<5>(aside & near);
        let recip = set_splat_i32_m128i(rise.recip as i32);
        let even = mul_widen_u32_odd_m128i(aside, recip);
        let odd = mul_widen_u32_odd_m128i(shr_imm_u64_m128i::<32>(aside), recip);
        let steps = shr_imm_u32_m128i::<18>(even | shl_imm_u64_m128i::<32>(odd));
        // steps − 1, or 255 − (steps + 3).
        let before = sub_i32_m128i(steps, set_splat_i32_m128i(1)) ^ self.negative;
        add_i32_m128i(before, set_splat_i32_m128i(252) & self.negative) & near
    }
}

impl Met {
    #[inline(always)]
    fn bound<const A: i32>(self) -> m128i {
        if A == 0 {
            shuffle_ai_f32_all_m128i::<0b00_00_00_00>(self.0)
        } else {
            shuffle_ai_f32_all_m128i::<0b01_01_01_01>(self.0)
        }
    }
}

const STEP: i32 = 1 << SLOPE_BITS;
/// By how much coordinates are moved down, to be signed.
const HALF: i32 = 1 << 15;

/// Two words of 16 bits.
#[inline(always)]
fn pair(low: i32, high: i32) -> i32 {
    low & 0xffff | high << 16
}

#[inline(always)]
fn ones(whether: bool) -> m128i {
    set_splat_i32_m128i(-(whether as i32))
}

#[inline(always)]
fn shift(bits: u32) -> m128i {
    set_i32_m128i_s(bits as i32)
}

#[inline(always)]
fn exponent(node: &Node) -> m128i {
    shift(u32::from(node.exponent & 15))
}

/// Four low planes and four high ones.
#[inline(always)]
fn ends(planes: &[[u8; 4]; 2]) -> m128i {
    let &[[a, b, c, d], [e, f, g, h]] = planes;
    set_i64_m128i_s(i64::from_le_bytes([a, b, c, d, e, f, g, h]))
}

/// The lowest four bytes in 32 bits each.
#[inline(always)]
fn wide(bytes: m128i) -> m128i {
    let zero = zeroed_m128i();
    unpack_low_i16_m128i(unpack_low_i8_m128i(bytes, zero), zero)
}

/// The lowest four words in another order.
#[inline(always)]
fn words<const ORDER: i32>(words: m128i) -> m128i {
    shuffle_ai_i16_l64all_m128i::<ORDER>(words)
}

#[cfg(test)]
mod tests {
    use super::super::one_by_one::OneByOne;
    use super::*;
    use crate::geom::{Dir, Point, Ray};
    use crate::shape::{Grid, Slopes};

    /// Planes, origins and limits of any kind, those of no real tree among them: bit for bit what one box after the other
    /// gives.
    #[test]
    fn at_once_is_one_by_one() {
        let mut s = 5u32;
        let mut r = || {
            s = s.wrapping_mul(747796405).wrapping_add(2891336453);
            (s ^ (s >> 15)) as i32
        };
        let (mut rays, mut some, mut apart) = (0, 0, [0; 2]);
        while rays < 20_000 {
            let steep = r() & 31;
            let Some(dir) = Dir::new([r() >> steep, r() >> (r() & 31), r() >> (r() & 15)]) else {
                continue;
            };
            let (shift, far) = (r() & 7, (r() & 3) + 14);
            let start = [(); 3].map(|()| (r() >> far) + (1 << 15));
            let grid = Grid::new(Point([0; 3]), shift as u8).unwrap();
            let origin = Point(start.map(|c| c << shift));
            let Some(ray) = GridRay::enter(&grid, &Ray { origin, dir }, &Slopes::new(dir)) else {
                continue;
            };
            rays += 1;
            for _ in 0..20 {
                let mut bytes = [(); 40].map(|()| r() as u8);
                // Mostly boxes that are some, in nodes around the ray's start.
                if r() & 7 != 0 {
                    for at in (0..24).filter(|at| at & 4 == 0) {
                        let [low, high] = [bytes[at].min(bytes[at + 4]), bytes[at].max(bytes[at + 4])];
                        (bytes[at], bytes[at + 4]) = (low, high);
                    }
                }
                let mut node = Node::from_le_bytes(bytes);
                if r() & 3 != 0 {
                    let e = node.exponent & 15;
                    node.origin = start.map(|c| (c - ((r() & 255) << e)).clamp(0, 65535) as u16);
                }
                let limit = match r() & 7 {
                    0 => -1,
                    1 => 65535,
                    2 => 0,
                    _ => r() & 65535,
                };
                let counts = match ray.axis {
                    0 => same::<0>(&ray, &node, limit),
                    1 => same::<1>(&ray, &node, limit),
                    _ => same::<2>(&ray, &node, limit),
                };
                some += (counts.0 != 0) as u32;
                apart[0] += counts.1;
                apart[1] += counts.2;
            }
        }
        // Neither are all boxes missed, nor is a face along the axis always the last.
        assert!(
            some > 20_000 && apart[0] > 30_000 && apart[1] > 5_000,
            "{some} {apart:?}"
        );
    }

    /// The mask, how many depths are not 0, and in how many the faces across have a say.
    fn same<const K: usize>(ray: &GridRay, node: &Node, limit: i32) -> (u32, u32, u32) {
        let depths = [Order::Entry, Order::Face].map(|order| {
            let (mut at_once, mut one_by_one) = (Boxes::new(ray), OneByOne::new(ray));
            let mask = at_once.hit_mask::<K>(node, limit);
            let wanted = one_by_one.hit_mask::<K>(node, limit);
            assert_eq!(mask, wanted, "{ray:?} {node:?} {limit}");
            let depths = [order, Order::Any].map(|order| {
                let at_once = at_once.depths::<K>(node, order);
                let one_by_one = one_by_one.depths::<K>(node, order);
                // Where nothing is met, nothing is known of the bounds.
                [0, 1, 2, 3].map(|slot| {
                    let depth = at_once.of::<K>(slot);
                    assert!(
                        wanted == 0 || depth == one_by_one.of::<K>(slot),
                        "{ray:?} {node:?} {slot}: {depth}"
                    );
                    depth
                })
            });
            assert_eq!(depths[1], [0; 4]);
            (mask, depths[0])
        });
        let [(mask, entry), (_, face)] = depths;
        let count =
            |which: &dyn Fn(usize) -> bool| (0..4).filter(|&slot| mask != 0 && which(slot)).count() as u32;
        (
            mask,
            count(&|slot| entry[slot] != 0),
            count(&|slot| entry[slot] != face[slot]),
        )
    }
}
