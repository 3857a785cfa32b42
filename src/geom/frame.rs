use super::Dir;
use crate::num::{ONE_Q16, mul_q16, recip, short_recip};

/// −1, Q16.
const MINUS: i32 = -ONE_Q16;

/// Two tangents and a normal: an orthonormal, right-handed basis.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub s: Dir,
    pub t: Dir,
    pub n: Dir,
}

impl Frame {
    /// About a normal (Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017, listing 3).
    ///
    /// Axes are at right angles to 1.12e-4 (the cosine; RMS 1.4e-5), tangents 1 long to 4e-5, RMS 8.6e-6
    /// (`tests/num_error`); for the most part that is the error of the normal's own length.
    #[cfg_attr(narrow_mul, inline(never))]
    #[cfg_attr(not(narrow_mul), inline)]
    pub fn about(n: Dir) -> Frame {
        let [x, y, z] = n.0;
        let sign = if z < 0 { -1 } else { 1 };
        // 1/(1 + |z|), between ½ and 1
        let r = recip((ONE_Q16 + z.abs()) as u32);
        let a = (r.mantissa >> (r.shift - 32)) as i32;
        let (xa, ya) = (mul_q16(x, a), mul_q16(y, a));
        let b = -mul_q16(xa, y);
        Frame {
            s: Dir([ONE_Q16 - mul_q16(xa, x), b, -x * sign]),
            t: Dir([b * sign, (ONE_Q16 - mul_q16(ya, y)) * sign, -y]),
            n,
        }
    }

    /// `Frame::about(n).to_world(local)`, the same bits, without a product where the normal is an axis.
    #[inline]
    pub fn turn(n: Dir, local: Dir) -> Dir {
        let [s, t, h] = local.0;
        // The tangent's own component along x or y is 2^-16, since 1/(1 + 0) comes out that much short of 1.
        let short = |tangent: i32| ((tangent >> 8) + 128) >> 8;
        match n.0 {
            [ONE_Q16, 0, 0] => Dir([h + short(s), t, -s]),
            [MINUS, 0, 0] => Dir([short(s) - h, t, s]),
            [0, ONE_Q16, 0] => Dir([s, h + short(t), -t]),
            [0, MINUS, 0] => Dir([s, short(t) - h, t]),
            [0, 0, ONE_Q16] => Dir([s, t, h]),
            [0, 0, MINUS] => Dir([s, -t, -h]),
            _ => Frame::about(n).to_world(local),
        }
    }

    /// The same, roughly: components are Q14, right to 2^-11 and what `local` is worth (`tests/prospect.rs`). 10 short products.
    #[cfg_attr(narrow_mul, inline(never))]
    #[cfg_attr(not(narrow_mul), inline)]
    pub fn turn_coarsely(n: Dir, local: [i32; 3]) -> [i32; 3] {
        let [x, y, z] = n.0.map(|c| c >> 2);
        let [s, t, h] = local;
        let t = if z < 0 { -t } else { t };
        // 1/(1 + |z|), Q16, times what the tangents have of z: products of up to √2 · 2^28 and √2 · 2^30.
        let up = (x * s + y * t) >> 14;
        let share = (short_recip((0x8000 + 2 * z.unsigned_abs()).min(0xffff)) * up) >> 16;
        // 2^28 and as much again at most.
        [
            s + ((x * (h - share)) >> 14),
            t + ((y * (h - share)) >> 14),
            ((z * h) >> 14) + if z < 0 { up } else { -up },
        ]
    }

    /// From local coordinates (s, t, n) to the frame's own; components have the error of [`Dir::dot`].
    #[inline]
    pub fn to_world(&self, local: Dir) -> Dir {
        let (s, t, n) = (self.s.0, self.t.0, self.n.0);
        let mix = |i: usize| local.dot(Dir([s[i], t[i], n[i]]));
        Dir([mix(0), mix(1), mix(2)])
    }

    /// To local coordinates: the cosines to s, t and n, with the error of [`Dir::dot`].
    #[inline]
    pub fn to_local(&self, world: Dir) -> Dir {
        Dir([world.dot(self.s), world.dot(self.t), world.dot(self.n)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn about_an_axis_coordinates_are_swapped() {
        let mut s = 5u32;
        let mut r = || {
            s = s.wrapping_mul(747796405).wrapping_add(2891336453);
            ((s ^ (s >> 15)) >> 15) as i32 - ONE_Q16
        };
        for n in [Dir::X, Dir::Y, Dir::Z] {
            for n in [n, -n] {
                let frame = Frame::about(n);
                for _ in 0..10_000 {
                    let local = Dir([r(), r(), r()]);
                    assert_eq!(Frame::turn(n, local), frame.to_world(local), "{n:?}");
                }
            }
        }
        let (n, local) = (Dir([46341, 0, -46341]), Dir([100, -200, 65000]));
        assert_eq!(Frame::turn(n, local), Frame::about(n).to_world(local));
    }
}
