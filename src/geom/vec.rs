#[cfg(normalizes)]
use crate::num::{BYTE_ZEROS, ROOTS};
use crate::num::{ONE_Q16, Wide, dot_q24, dot_unit, mul_hi, mul_q16, mul_shift, mul_unit};
#[cfg(not(normalizes))]
use crate::num::{leading_zeros, mul_hi_signed, round_shift, rsqrt_of_large};

/// A place, scene units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(rectangles, derive(zerocopy::IntoBytes, zerocopy::Immutable))]
#[repr(C)]
pub struct Point(pub [i32; 3]);

/// From one place to another, scene units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Offset(pub [i32; 3]);

/// A unit vector, components Q16 (±65536). Its length is 1 to 4.6e-5.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(rectangles, derive(zerocopy::IntoBytes, zerocopy::Immutable))]
#[repr(C)]
pub struct Dir(pub [i32; 3]);

/// What normalising a vector found out: enough for its length and its square.
#[derive(Clone, Copy, Debug)]
pub struct Norm {
    /// Squared length of the vector shifted right by `shift` (left if negative); 2^28 ..= 3·2^30.
    square: u32,
    shift: i32,
    mantissa: u32,
    half: u32,
}

impl Point {
    #[inline(always)]
    pub const fn to(self, other: Point) -> Offset {
        let (a, b) = (self.0, other.0);
        Offset([
            b[0].wrapping_sub(a[0]),
            b[1].wrapping_sub(a[1]),
            b[2].wrapping_sub(a[2]),
        ])
    }

    #[inline(always)]
    pub const fn add(self, by: Offset) -> Point {
        let (a, b) = (self.0, by.0);
        Point([
            a[0].wrapping_add(b[0]),
            a[1].wrapping_add(b[1]),
            a[2].wrapping_add(b[2]),
        ])
    }

    /// The point `distance` units along `dir`, rounded down.
    #[inline]
    pub const fn along(self, dir: Dir, distance: i32) -> Point {
        self.add(dir.times(distance))
    }

    /// [`Self::along`], quicker on narrow cores where `dir` has components of −1, 0 or 1, as the sides of shapes often do.
    #[inline]
    pub const fn along_side(self, dir: Dir, distance: i32) -> Point {
        let d = dir.0;
        self.add(Offset([
            mul_unit(distance, d[0]),
            mul_unit(distance, d[1]),
            mul_unit(distance, d[2]),
        ]))
    }

    /// [`Self::along`], quicker where the distance is short: under 2^14 either way.
    #[inline]
    pub const fn along_briefly(self, dir: Dir, distance: i32) -> Point {
        if distance.wrapping_add(1 << 14) as u32 >= 1 << 15 {
            return self.along(dir, distance);
        }
        // |d| ≤ 2^16 and a little: under 2^31.
        let d = dir.0;
        self.add(Offset([
            (d[0] * distance) >> 16,
            (d[1] * distance) >> 16,
            (d[2] * distance) >> 16,
        ]))
    }
}

impl Offset {
    #[inline(always)]
    pub const fn minus(self, other: Offset) -> Offset {
        let (a, b) = (self.0, other.0);
        Offset([
            a[0].wrapping_sub(b[0]),
            a[1].wrapping_sub(b[1]),
            a[2].wrapping_sub(b[2]),
        ])
    }

    /// Length along `dir`, units: three products, each rounded down.
    ///
    /// Error in (−3, 0] units, RMS 1.45, mean −1.3 (`tests/num_error`).
    #[inline]
    pub const fn dot(self, dir: Dir) -> i32 {
        let (a, d) = (self.0, dir.0);
        mul_q16(a[0], d[0])
            .wrapping_add(mul_q16(a[1], d[1]))
            .wrapping_add(mul_q16(a[2], d[2]))
    }

    /// [`Self::dot`], the same bits, quicker on narrow cores where the direction is an axis or at right angles to one.
    #[inline(always)]
    pub const fn dot_normal(self, dir: Dir) -> i32 {
        let (a, d) = (self.0, dir.0);
        mul_unit(a[0], d[0])
            .wrapping_add(mul_unit(a[1], d[1]))
            .wrapping_add(mul_unit(a[2], d[2]))
    }

    /// Direction and length; `None` for nothing.
    ///
    /// It points right to 1.3e-5 rad (RMS 5.9e-6), the rounding of its components; its length is 1 to 4.6e-5, RMS
    /// 9.6e-6, no bias, from the 15 bits that are squared (`tests/num_error`).
    #[cfg_attr(normalizes, inline(always))]
    #[cfg_attr(not(normalizes), inline)]
    pub fn normalize(self) -> Option<(Dir, Norm)> {
        #[cfg(normalizes)]
        {
            let normal = microlux_asm::normalize(self.0, &BYTE_ZEROS, &ROOTS)?;
            let norm = Norm {
                square: normal.square,
                shift: normal.shift(),
                mantissa: normal.mantissa,
                half: normal.half(),
            };
            Some((Dir(normal.dir), norm))
        }
        #[cfg(not(normalizes))]
        {
            let v = self.0;
            let m = (v[0] ^ (v[0] >> 31)) | (v[1] ^ (v[1] >> 31)) | (v[2] ^ (v[2] >> 31));
            if m == 0 && self.0 == [0; 3] {
                return None;
            }
            // All the bits there are, the largest component of 30.
            let zeros = leading_zeros(m as u32 | 1);
            let v = if zeros >= 2 {
                v.map(|c| c << (zeros - 2))
            } else {
                v.map(|c| c >> (2 - zeros))
            };
            // For the length, 15 of them: squares add up to less than 2^32.
            let short = v.map(|c| round_shift(c, 15));
            let square =
                (short[0] * short[0]) as u32 + (short[1] * short[1]) as u32 + (short[2] * short[2]) as u32;
            let (mantissa, half) = rsqrt_of_large(square);
            // 2^16 v / |v| = v · mantissa / 2^(46 − half); one bit more than wanted, to round by.
            let dir = v.map(|c| ((mul_hi_signed(c, (mantissa >> 1) as i32) >> (12 - half.min(1))) + 1) >> 1);
            let shift = 17 - zeros as i32;
            Some((
                Dir(dir),
                Norm {
                    square,
                    shift,
                    mantissa,
                    half,
                },
            ))
        }
    }
}

impl Norm {
    /// Length, units, rounded down; lengths under 2^31.
    ///
    /// Relative error 3.7e-5 at most, RMS 1.1e-5, no bias, from the 15 bits that were kept (`tests/num_error`).
    #[inline]
    pub fn length(self) -> i32 {
        // √n · 2^15 with n = square · 2^(2 half)
        let root = mul_hi(self.square << (2 * self.half), self.mantissa);
        let down = 15 + self.half as i32 - self.shift;
        if down >= 0 {
            (root >> down.min(31)) as i32
        } else {
            (root << -down) as i32
        }
    }

    /// Squared length, units²: relative error 8.4e-5 at most, RMS 1.8e-5, no bias (`tests/num_error`).
    #[inline]
    pub const fn square(self) -> Wide {
        Wide::new(self.square, 2 * self.shift)
    }
}

impl Dir {
    pub const X: Dir = Dir([ONE_Q16, 0, 0]);
    pub const Y: Dir = Dir([0, ONE_Q16, 0]);
    pub const Z: Dir = Dir([0, 0, ONE_Q16]);

    /// The way the vector (Q16 or any other common scale) points; `None` for nothing.
    pub fn new(v: [i32; 3]) -> Option<Dir> {
        Offset(v).normalize().map(|(dir, _)| dir)
    }

    /// Cosine between two directions, Q16, rounded to nearest: error ½ ulp (7.7e-6) at most, RMS 4.3e-6, no bias (mean
    /// within 2e-8; `tests/num_error`).
    #[inline]
    pub const fn dot(self, other: Dir) -> i32 {
        (self.dot_q24(other) + 128) >> 8
    }

    /// Cosine between two directions, Q24, of the directions as they stand.
    ///
    /// Error in (−1, 0] ulp, RMS 0.57, mean −0.48 (`tests/num_error`).
    /// For planes seen at grazing angles, where the quotient by it matters.
    #[inline]
    pub const fn dot_q24(self, other: Dir) -> i32 {
        dot_q24(self.0, other.0)
    }

    /// [`Self::dot_q24`], the same bits, quicker on narrow cores where `normal` is an axis, as most are.
    #[inline(always)]
    pub const fn dot_q24_normal(self, normal: Dir) -> i32 {
        dot_unit(self.0, normal.0)
    }

    /// [`Self::dot`], the same bits, as [`Self::dot_q24_normal`].
    #[inline]
    pub const fn dot_normal(self, normal: Dir) -> i32 {
        (self.dot_q24_normal(normal) + 128) >> 8
    }

    /// The direction at right angles to both, self × other; `None` if they are (nearly) parallel, sine under 2^-10 or so.
    ///
    /// It points right to 1.3e-5 rad, as [`Offset::normalize`] (`tests/num_error`).
    pub fn cross(self, other: Dir) -> Option<Dir> {
        // Q16 × Q16 → Q30: each product is at most 2^30, and so is a component of the result.
        let (a, b) = (self.0, other.0);
        let minor = |i: usize, j: usize| mul_shift(a[i], b[j], 2).wrapping_sub(mul_shift(a[j], b[i], 2));
        let v = [minor(1, 2), minor(2, 0), minor(0, 1)];
        // Below 2^-10 the rounded factors decide where it points.
        if v.iter().all(|c| c.abs() < 1 << 20) {
            None
        } else {
            Dir::new(v)
        }
    }

    /// The offset of `distance` units this way, rounded down.
    #[inline]
    pub const fn times(self, distance: i32) -> Offset {
        let d = self.0;
        Offset([
            mul_q16(distance, d[0]),
            mul_q16(distance, d[1]),
            mul_q16(distance, d[2]),
        ])
    }

    /// The mirror image of a direction that points away from the surface, about the normal: 2 (w·n) n − w.
    ///
    /// Turned wrong by 3.4e-5 rad at most, RMS 1.25e-5; its length is 1 to 1.75e-4, RMS 2.2e-5, mostly the normal's own
    /// error (`tests/num_error`).
    #[inline]
    pub fn reflect(self, normal: Dir) -> Dir {
        let twice = (self.dot_q24(normal) + (1 << 6)) >> 7;
        let (w, n) = (self.0, normal.0);
        Dir([
            mul_q16(twice, n[0]) - w[0],
            mul_q16(twice, n[1]) - w[1],
            mul_q16(twice, n[2]) - w[2],
        ])
    }
}

impl core::ops::Neg for Dir {
    type Output = Dir;
    #[inline(always)]
    fn neg(self) -> Dir {
        Dir(self.0.map(|c| -c))
    }
}

/// a × b of components under 2^15 in magnitude: each result is under 2^31.
#[inline]
pub const fn cross(a: [i32; 3], b: [i32; 3]) -> [i32; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The quick forms are the others' bits: along axes, along anything, near and far.
    #[test]
    fn quick_forms_are_the_same() {
        let mut s = 3u32;
        let mut r = |bits: u32| {
            s = s.wrapping_mul(747796405).wrapping_add(2891336453);
            ((s ^ (s >> 15)) as i32) >> (32 - bits)
        };
        for round in 0..100_000 {
            let point = Point([r(24), r(24), r(24)]);
            let Some((any, _)) = Offset([r(20), r(20), r(20)]).normalize() else {
                continue;
            };
            let dir = [Dir::X, -Dir::Y, Dir([0, 46341, -46341]), any][round & 3];
            for distance in [r(15), r(24), -16384, 16383, 16384] {
                let there = point.along(dir, distance);
                assert_eq!(point.along_briefly(dir, distance), there);
                assert_eq!(point.along_side(dir, distance), there);
            }
            assert_eq!(any.dot_q24_normal(dir), any.dot_q24(dir));
            assert_eq!(any.dot_normal(dir), any.dot(dir));
        }
    }
}
