//! The watertight triangle test, in integers.
//!
//! # Why no ray passes a shared edge
//!
//! Each vertex is sheared along the ray to a point of the plane, rounded to integers:
//! X = ⌊((v_x − o_x)·2^13 − S0·dz + 2^12) / 2^13⌋ with dz = v_k − o_k, and Y likewise. That point depends on the vertex
//! and the ray alone, so two triangles that share an edge see the same two points; the edge function of the edge is
//! exact and changes but its sign with the edge's direction; and zero counts as inside for both. So the sheared mesh
//! is a continuous image of the mesh, its triangles cover it without gaps, and the origin (the ray) lies in one of
//! them whenever it lies in the image. Silhouettes move by ½ step, nothing else does. (After Woop, Benthin and Wald,
//! "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, whose edge functions are inexact and need a fallback.)
//!
//! # Why nothing wraps
//!
//! With vertices in 0 ..= 65535 and the origin in −65536 ..= 131071 across and 0 ..= 65535 along (see [`GridRay`]):
//! the sum in X is under 2^31 ([`GridRay::across`]) and |X| < 2^17 + 2^16 < 2^18.
//! If all |X|, |Y| are at most 2^15 (one's complement magnitude under 2^15), an edge function is under 2^31; else it is
//! taken exactly in two words, see [`Edge`].

use super::grid::{DEPTH_BITS, GridRay, SLOPE_BITS};
use crate::num::{mul_hi, mul_share, recip};

/// Where a ray meets a triangle (a, b, c).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TriangleHit {
    /// Along the dominant axis, in 1/16 steps, 1 or more, within the depths of the three vertices.
    pub depth: i32,
    /// Weights of b and c, Q16, rounded to nearest; 0 or more, their sum at most 65536.
    pub b1: i32,
    pub b2: i32,
}

/// A vertex as a ray sees it: the same for all triangles that share it.
#[derive(Clone, Copy)]
pub(crate) struct Seen {
    /// Steps aside; under 2^18 in magnitude.
    at: [i32; 2],
    /// Its coordinate along the dominant axis.
    z: i32,
}

impl Seen {
    /// `K` is the ray's dominant axis.
    #[inline(always)]
    pub fn new<const K: usize>(ray: &GridRay, v: &[u16; 3]) -> Seen {
        Seen {
            at: [
                ray.across::<K, 0>(v) >> SLOPE_BITS,
                ray.across::<K, 1>(v) >> SLOPE_BITS,
            ],
            z: v[K] as i32,
        }
    }
}

/// The closed triangle against the ray ahead of its origin; a triangle the ray sees edge-on is missed.
#[cfg_attr(narrow_mul, inline(never))]
#[cfg_attr(not(narrow_mul), inline(always))]
pub(crate) fn intersect(ray: &GridRay, corners: &[Seen; 3]) -> Option<TriangleHit> {
    let [a, b, c] = corners;
    let [x, y] = [0, 1].map(|along| [a.at[along], b.at[along], c.at[along]]);
    if is_beside(x) || is_beside(y) {
        return None;
    }
    meet(ray, edges(x, y)?, [a.z, b.z, c.z])
}

/// All below zero, or all above: then the ray lies in no triangle of such corners.
///
/// Where no edge function has another sign than the rest, weights that are theirs put zero between the corners.
#[inline(always)]
pub(super) fn is_beside([a, b, c]: [i32; 3]) -> bool {
    (a & b & c) | (-a & -b & -c) < 0
}

/// The edge functions' magnitudes, up to a common factor; `None` if the ray passes by, or they are all 0.
#[inline(always)]
pub(super) fn edges(x: [i32; 3], y: [i32; 3]) -> Option<[u32; 3]> {
    // All within −2^15 ..= 2^15 − 1, or else large.
    let high = |at: [i32; 3]| at.map(|at| at.wrapping_add(1 << 15) as u32);
    let ([ax, bx, cx], [ay, by, cy]) = (high(x), high(y));
    if (ax | bx | cx | ay | by | cy) >> 16 != 0 {
        return large_edges(x, y);
    }
    let ([ax, bx, cx], [ay, by, cy]) = (x, y);
    let u = cx * by - cy * bx;
    let w = bx * ay - by * ax;
    if differ([u, w]) {
        return None;
    }
    let v = ax * cy - ay * cx;
    if differ([u, v, w]) || (u | v | w) == 0 {
        return None;
    }
    Some([u, v, w].map(i32::unsigned_abs))
}

/// Whether one lies below zero and one above. (−2^31 is not among them.)
#[inline(always)]
fn differ<const N: usize>(parts: [i32; N]) -> bool {
    let below = parts.iter().fold(0, |all, part| all | part);
    let above = parts.iter().fold(0, |all, part| all | -part);
    below & above < 0
}

/// [`edges`] of a triangle of which the ray sees more than 2^15 steps.
#[inline(always)]
fn large_edges(x: [i32; 3], y: [i32; 3]) -> Option<[u32; 3]> {
    #[cfg(narrow_mul)]
    return narrow_edges(x, y);
    #[cfg(not(narrow_mul))]
    return wide_edges(x, y);
}

/// [`large_edges`] where products have 64 bits.
#[cfg(any(not(narrow_mul), test))]
#[inline(always)]
fn wide_edges(x: [i32; 3], y: [i32; 3]) -> Option<[u32; 3]> {
    let ([ax, bx, cx], [ay, by, cy]) = (x.map(i64::from), y.map(i64::from));
    // Each under 2^37.
    let [u, v, w] = [cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax];
    // If none has another sign than the rest, it is that of their sum.
    let sign = (u + v + w) >> 63;
    let [u, v, w] = [u, v, w].map(|part| (part ^ sign) - sign);
    let all = u | v | w;
    if all <= 0 {
        return None;
    }
    Some(if all < 1 << 30 {
        [u, v, w].map(|part| part as u32)
    } else {
        [u, v, w].map(|part| (part >> 7) as u32)
    })
}

/// One below and one above zero.
#[cfg(any(narrow_mul, test))]
#[inline(always)]
fn opposite(a: i32, b: i32) -> bool {
    (a ^ b) < 0 && a != 0 && b != 0
}

/// [`large_edges`] in products of 32 bits.
#[cfg(any(narrow_mul, test))]
#[inline(never)]
fn narrow_edges([ax, bx, cx]: [i32; 3], [ay, by, cy]: [i32; 3]) -> Option<[u32; 3]> {
    let u = Edge::new(cx, by, cy, bx);
    let w = Edge::new(bx, ay, by, ax);
    let (su, sw) = (u.sign(), w.sign());
    if opposite(su, sw) {
        return None;
    }
    let v = Edge::new(ax, cy, ay, cx);
    let sv = v.sign();
    if opposite(su, sv) || opposite(sv, sw) || (su | sv | sw) == 0 {
        return None;
    }
    Some(
        Edge::shorten([u.abs(), v.abs(), w.abs()])
            .0
            .map(|part| part as u32),
    )
}

/// p·q − r·t as 256·high + low, exactly, with 0 ≤ low < 256.
#[derive(Clone, Copy)]
pub(crate) struct Edge {
    high: i32,
    low: i32,
}

impl Edge {
    /// Factors under 2^18 in magnitude: p = 256 p_h + p_l with |p_h| ≤ 2^10 and 0 ≤ p_l < 2^8, so that each product is
    /// under 2^28. The value is under 2^37, `high` under 2^29.
    #[inline]
    pub fn new(p: i32, q: i32, r: i32, t: i32) -> Edge {
        let low = (p & 255) * q - (r & 255) * t;
        Edge {
            high: (p >> 8) * q - (r >> 8) * t + (low >> 8),
            low: low & 255,
        }
    }

    /// Negative, zero or positive as the value is.
    #[cfg(any(narrow_mul, test))]
    #[inline]
    fn sign(self) -> i32 {
        self.high | (self.low != 0) as i32
    }

    #[cfg(any(narrow_mul, test))]
    #[inline]
    fn abs(self) -> Edge {
        if self.high >= 0 {
            self
        } else {
            Edge {
                high: -self.high - (self.low != 0) as i32,
                low: -self.low & 255,
            }
        }
    }

    /// Three values as i32, and the right shift (rounding down) they took: 0 if all are within ±2^30, else 7.
    ///
    /// Shifted ones are under 2^30, the largest at least 2^23.
    #[inline]
    pub fn shorten(edges: [Edge; 3]) -> ([i32; 3], i32) {
        let size = edges.iter().fold(0, |m, e| m | (e.high ^ (e.high >> 31)));
        if size < 1 << 22 {
            (edges.map(|e| (e.high << 8) | e.low), 0)
        } else {
            (edges.map(|e| (e.high << 1) | (e.low >> 7)), 7)
        }
    }
}

/// Depth and weights from the edge functions' magnitudes, which are not all 0 and whose sum is under 2^32.
///
/// (It is: twice the area of a triangle in a square of side 2^16 − 1; or three numbers of at most 2^30.)
#[inline(never)]
pub(super) fn meet(ray: &GridRay, [u, v, w]: [u32; 3], z: [i32; 3]) -> Option<TriangleHit> {
    // n = det·2^up is normalised and 1/n = mantissa/2^63, so v·2^up·mantissa/2^32 is the share, Q31.
    let r = recip(u + v + w);
    let up = 63 - r.shift;
    let share = |part: u32| ((mul_hi(part << up, r.mantissa) + (1 << 14)) >> 15) as i32;
    let b1 = share(v).min(1 << 16);
    let b2 = share(w).min((1 << 16) - b1);
    let ahead = |z: i32| {
        if ray.negative {
            ray.plane - z
        } else {
            z - ray.plane
        }
    };
    let [za, zb, zc] = z.map(ahead);
    // |zb − za| < 2^16, eight bits below the point; their sum rounded to four. The weights are 0 or more and at most
    // 1 together, so the true sum lies within the vertices' depths, which every box around the triangle covers; the
    // floors take less than 2 of it, an integer 256 m becomes 256 m − 1 at worst, and that rounds to 16 m again.
    let rise = mul_share(zb - za, b1) + mul_share(zc - za, b2);
    let depth = (za << DEPTH_BITS) + ((rise + 8) >> 4);
    (depth > 0).then_some(TriangleHit { depth, b1, b2 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Small and large triangles, many of them with corners on an axis or at the origin.
    fn corners() -> impl Iterator<Item = [[i32; 3]; 2]> {
        let mut s = 3u32;
        let mut r = move || {
            s = s.wrapping_mul(747796405).wrapping_add(2891336453);
            ((s ^ (s >> 15)) as i32) >> (14 + (s & 15))
        };
        (0..200_000).map(move |round| {
            let mut some = || [0; 3].map(|_| if r() & 15 == 0 { 0 } else { r() >> (round & 7) });
            [some(), some()]
        })
    }

    #[test]
    fn edges_in_one_word_in_two_and_in_64_bits_are_the_same() {
        let mut met = [0; 2];
        for [x, y] in corners() {
            let narrow = narrow_edges(x, y);
            assert_eq!(wide_edges(x, y), narrow, "{x:?} {y:?}");
            let is_small = x.iter().chain(&y).all(|at| (-1 << 15..1 << 15).contains(at));
            let found = edges(x, y);
            assert_eq!(found.is_some(), narrow.is_some());
            if is_small {
                let exact = |a: usize, b: usize| (x[a] * y[b] - y[a] * x[b]).unsigned_abs();
                assert!(found.is_none_or(|found| found == [exact(2, 1), exact(0, 2), exact(1, 0)]));
            } else {
                assert_eq!(found, narrow);
            }
            met[is_small as usize] += found.is_some() as u32;
        }
        assert!(met.iter().all(|&met| met > 3_000), "{met:?}");
    }

    #[test]
    fn what_lies_beside_is_met_by_no_ray() {
        let mut beside = 0;
        for [x, y] in corners().filter(|&[x, y]| is_beside(x) || is_beside(y)) {
            assert_eq!(narrow_edges(x, y), None, "{x:?} {y:?}");
            beside += 1;
        }
        assert!(beside > 50_000, "{beside}");
        assert!(
            !is_beside([0, 5, 9])
                && !is_beside([-1, 0, -1])
                && is_beside([1, 1, 1])
                && is_beside([-1, -9, -1])
        );
    }

    #[test]
    fn edges_in_two_words_are_exact() {
        let mut s = 7u32;
        let mut r = || {
            s = s.wrapping_mul(747796405).wrapping_add(2891336453);
            ((s ^ (s >> 15)) as i32) >> (13 + (s & 15))
        };
        for _ in 0..100_000 {
            let (p, q, r, t) = (r(), r(), r(), r());
            let exact = p as i64 * q as i64 - r as i64 * t as i64;
            let edge = Edge::new(p, q, r, t);
            let value = |e: Edge| e.high as i64 * 256 + e.low as i64;
            assert_eq!(value(edge), exact);
            assert_eq!(edge.sign().signum() as i64, exact.signum());
            assert_eq!(value(edge.abs()), exact.abs());
            let (short, shift) = Edge::shorten([edge, edge.abs(), edge]);
            assert_eq!(
                [short[0] as i64, short[1] as i64],
                [exact >> shift, exact.abs() >> shift]
            );
        }
    }
}
