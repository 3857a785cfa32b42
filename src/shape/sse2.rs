//! A triangle's corners and edges at once, by SSE2, which every x86-64 has: the same bits as [`super::triangle`] has them
//! one by one.
//!
//! # Why nothing wraps
//!
//! `mul_i16_horizontal_add_m128i` adds two products of signed 16 bits. Coordinates are moved down by 2^15 and slopes are
//! within ±2^13, which makes 2^29 at most; what is added after takes that back. An edge function c_x·b_y − c_y·b_x is
//! c_x·b_y + c_y·¬b_x + c_y, since −b_x of −2^15 has no 16 bits.

use super::grid::{GridRay, SLOPE_BITS};
use super::mesh::TriangleMesh;
use super::triangle::{self, Seen, TriangleHit, meet};
use safe_arch::{
    add_i32_m128i, cmp_eq_mask_i32_m128i, insert_i16_from_i32_m128i, m128i, move_mask_i8_m128i,
    mul_i16_horizontal_add_m128i, pack_i32_to_i16_m128i, set_i32_m128i, set_i32_m128i_s, set_splat_i16_m128i,
    set_splat_i32_m128i, shr_imm_i32_m128i, shr_imm_u32_m128i, shuffle_ai_f32_all_m128i,
    shuffle_ai_i16_h64all_m128i, shuffle_ai_i16_l64all_m128i, sub_i32_m128i, unpack_low_i64_m128i,
    zeroed_m128i,
};

/// See `one_by_one`, which has the same with one product after the other.
#[inline(always)]
pub(super) fn intersect_of<const K: usize>(
    ray: &GridRay,
    mesh: &TriangleMesh,
    number: u32,
) -> Option<TriangleHit> {
    intersect_corners::<K>(ray, mesh.vertices_of(number)?)
}

/// [`triangle::intersect`] of vertices; `K` is the ray's dominant axis.
#[inline(always)]
fn intersect_corners<const K: usize>(ray: &GridRay, corners: [&[u16; 3]; 3]) -> Option<TriangleHit> {
    let [a, b, c] = corners.map(load);
    let ab = across::<K>(ray, unpack_low_i64_m128i(a, b));
    let cc = across::<K>(ray, unpack_low_i64_m128i(c, c));
    // Within ±2^15 steps all of them, or else one by one.
    let far = |at: m128i| shr_imm_u32_m128i::<29>(add_i32_m128i(at, set_splat_i32_m128i(1 << 28)));
    let far = cmp_eq_mask_i32_m128i(far(ab) | far(cc), zeroed_m128i());
    if move_mask_i8_m128i(far) != 0xffff {
        return apart::<K>(ray, corners);
    }
    let steps = shr_imm_i32_m128i::<{ SLOPE_BITS as i32 }>;
    // (x, y) of a, b, c and c; each with the corner before it.
    let seen = pack_i32_to_i16_m128i(steps(ab), steps(cc));
    let left = shuffle_ai_f32_all_m128i::<0b01_01_00_10>(seen);
    let right = shuffle_ai_f32_all_m128i::<0b00_00_10_01>(seen);
    let right =
        shuffle_ai_i16_l64all_m128i::<0b10_11_00_01>(shuffle_ai_i16_h64all_m128i::<0b10_11_00_01>(right));
    let right = right ^ set_splat_i32_m128i(!0xffff);
    let edges = add_i32_m128i(
        mul_i16_horizontal_add_m128i(left, right),
        shr_imm_i32_m128i::<16>(left),
    );
    // Signs of the three, and of the three inverted: one of the two has none, the other some.
    let signs = pack_i32_to_i16_m128i(edges, sub_i32_m128i(zeroed_m128i(), edges));
    let signs = move_mask_i8_m128i(signs);
    if (signs & 0x00aa == 0) == (signs & 0xaa00 == 0) {
        return None;
    }
    let [u, v, w, _]: [i32; 4] = edges.into();
    meet(
        ray,
        [u, v, w].map(i32::unsigned_abs),
        corners.map(|corner| i32::from(corner[K])),
    )
}

/// A triangle of which the ray sees more than 2^15 steps.
#[cold]
#[inline(never)]
fn apart<const K: usize>(ray: &GridRay, corners: [&[u16; 3]; 3]) -> Option<TriangleHit> {
    triangle::intersect(ray, &corners.map(|corner| Seen::new::<K>(ray, corner)))
}

/// Three words.
#[inline(always)]
fn load(&[x, y, z]: &[u16; 3]) -> m128i {
    let low = set_i32_m128i_s((u32::from(x) | u32::from(y) << 16) as i32);
    insert_i16_from_i32_m128i::<2>(low, i32::from(z))
}

/// [`GridRay::across`] of two vertices.
#[inline(always)]
fn across<const K: usize>(ray: &GridRay, two: m128i) -> m128i {
    let two = match K {
        0 => shuffle_ai_i16_h64all_m128i::<0b00_10_00_01>(shuffle_ai_i16_l64all_m128i::<0b00_10_00_01>(two)),
        1 => shuffle_ai_i16_h64all_m128i::<0b01_00_01_10>(shuffle_ai_i16_l64all_m128i::<0b01_00_01_10>(two)),
        _ => shuffle_ai_i16_h64all_m128i::<0b10_01_10_00>(shuffle_ai_i16_l64all_m128i::<0b10_01_10_00>(two)),
    };
    let half = 1 << 15;
    let one = 1 << SLOPE_BITS;
    let [w0, w1] = ray.slopes.map(|slope| one | -slope << 16);
    let [o0, o1] = [0, 1].map(|a| ray.offsets[a] + (one - ray.slopes[a]) * half);
    let moved = two ^ set_splat_i16_m128i(i16::MIN);
    add_i32_m128i(
        mul_i16_horizontal_add_m128i(moved, set_i32_m128i(w1, w0, w1, w0)),
        set_i32_m128i(o1, o0, o1, o0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Dir, Point, Ray};
    use crate::shape::one_by_one;
    use crate::shape::{Attributes, Grid, Slopes};

    /// Triangles of all sizes, at the ray, at its very corners and edges, and far from it: bit for bit what one product
    /// after the other gives.
    #[test]
    fn at_once_is_one_by_one() {
        let mut s = 9u32;
        let mut r = || {
            s = s.wrapping_mul(747796405).wrapping_add(2891336453);
            (s ^ (s >> 15)) as i32
        };
        let (mut hits, mut far, mut rays) = (0, 0, 0);
        while rays < 200_000 {
            let steep = [(); 3].map(|()| r() & r() & 31);
            let Some(dir) = Dir::new([0, 1, 2].map(|a| r() >> steep[a])) else {
                continue;
            };
            let beyond = (r() & 3) + 14;
            let origin = [(); 3].map(|()| (r() >> beyond) + (1 << 15));
            let grid = Grid::new(Point([0; 3]), 0).unwrap();
            let ray = Ray {
                origin: Point(origin),
                dir,
            };
            let Some(ray) = GridRay::enter(&grid, &ray, &Slopes::new(dir)) else {
                continue;
            };
            rays += 1;
            // Around a place that the ray comes by.
            let along = (r() & 65535) >> (r() & 3);
            let size = r() & 15;
            let middle =
                [0, 1, 2].map(|a| origin[a] + ((i64::from(dir.0[a]) * i64::from(along)) >> 16) as i32);
            let corner = |r: &mut dyn FnMut() -> i32| {
                middle.map(|c| (c + (r() >> (31 - size))).clamp(0, 65535) as u16)
            };
            let mut corners = [(); 3].map(|()| corner(&mut r));
            match r() & 15 {
                0 => corners[1] = corners[0],
                1 => corners[2] = middle.map(|c| c.clamp(0, 65535) as u16),
                2 => corners = [(); 3].map(|()| [(); 3].map(|()| r() as u16)),
                3 => corners = [(); 3].map(|()| [(); 3].map(|()| if r() & 1 == 0 { 0 } else { 65535 })),
                _ => {}
            }
            let (at_once, one_by_one, large) = match ray.axis {
                0 => both::<0>(&ray, &corners),
                1 => both::<1>(&ray, &corners),
                _ => both::<2>(&ray, &corners),
            };
            assert_eq!(at_once, one_by_one, "{ray:?} {corners:?}");
            hits += at_once.is_some() as u32;
            far += large as u32;
        }
        assert!(hits > 10_000 && far > 10_000, "{hits} {far}");
    }

    fn both<const K: usize>(
        ray: &GridRay,
        [a, b, c]: &[[u16; 3]; 3],
    ) -> (Option<TriangleHit>, Option<TriangleHit>, bool) {
        let corners = [a, b, c];
        let seen = corners.map(|corner| Seen::new::<K>(ray, corner));
        let at_once = [corners, [b, c, a], [c, b, a]].map(|corners| intersect_corners::<K>(ray, corners));
        assert!(at_once.iter().all(|hit| hit.is_some() == at_once[0].is_some()));
        let large = corners.iter().any(|corner| {
            [ray.across::<K, 0>(corner), ray.across::<K, 1>(corner)]
                .iter()
                .any(|aside| !(-1 << 28..1 << 28).contains(aside))
        });
        let mesh = TriangleMesh {
            grid: Grid::new(Point([0; 3]), 0).unwrap(),
            vertices: &[*a, *b, *c],
            triangles: &[[0, 1, 2]],
            attributes: Attributes::NONE,
        };
        let one_by_one = one_by_one::intersect_of::<K>(ray, &mesh, 0);
        assert_eq!(one_by_one, triangle::intersect(ray, &seen));
        (at_once[0], one_by_one, large)
    }
}
