use super::Dir;
use crate::num::{Turn, mul_shift, sin_cos};

/// A turn about the origin: a matrix whose columns are where the axes go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rotation {
    /// Rows, Q30, each entry right to ½ ulp: at right angles to each other to 2^-29.
    rows: [[i32; 3]; 3],
}

const ONE: i32 = 1 << 30;

impl Rotation {
    pub const NONE: Rotation = Rotation {
        rows: [[ONE, 0, 0], [0, ONE, 0], [0, 0, ONE]],
    };

    /// Of a quaternion w + x i + y j + z k of any length, components under 2^30; `None` for one without any length.
    ///
    /// Hamilton's formula over the squared length, in 128 bits: for setting up, not for rendering.
    pub fn new(quaternion: [i32; 4]) -> Option<Rotation> {
        let [w, x, y, z] = quaternion.map(|c| i128::from(c.clamp(-ONE, ONE)));
        let square = w * w + x * x + y * y + z * z;
        if square == 0 {
            return None;
        }
        // 2^30 part/square, rounded to nearest; both are under 2^62.
        let entry = |part: i128| ((part << 31) / square + 1).div_euclid(2) as i32;
        let (xy, xz, yz) = (2 * x * y, 2 * x * z, 2 * y * z);
        let (wx, wy, wz) = (2 * w * x, 2 * w * y, 2 * w * z);
        let (ww, xx, yy, zz) = (w * w, x * x, y * y, z * z);
        Some(Rotation {
            rows: [
                [entry(ww + xx - yy - zz), entry(xy - wz), entry(xz + wy)],
                [entry(xy + wz), entry(ww - xx + yy - zz), entry(yz - wx)],
                [entry(xz - wy), entry(yz + wx), entry(ww - xx - yy + zz)],
            ],
        })
    }

    /// By an angle, counter-clockwise as seen from where the axis points.
    pub fn about(axis: Dir, angle: Turn) -> Rotation {
        let (sin, cos) = sin_cos(Turn::from_bits(angle.to_bits() >> 1));
        let part = |c: i32| mul_shift(sin, c, 4);
        Rotation::new([cos << 12, part(axis.0[0]), part(axis.0[1]), part(axis.0[2])])
            .unwrap_or(Rotation::NONE)
    }

    /// From [`Self::rows`]; others are refused with their scene.
    pub const fn from_rows(rows: [[i32; 3]; 3]) -> Rotation {
        Rotation { rows }
    }

    /// Rows, Q30.
    pub fn rows(&self) -> [[i32; 3]; 3] {
        self.rows
    }

    /// Whether its rows are of length 1 and at right angles, to 2^-20.
    pub fn is_valid(&self) -> bool {
        let [a, b, c] = self.rows;
        let dot = |a: [i32; 3], b: [i32; 3]| {
            (0..3)
                .map(|i| (i64::from(a[i]) * i64::from(b[i])) >> 10)
                .sum::<i64>()
        };
        let near = |found: i64, wanted: i64| (found - wanted).abs() < 1 << 30;
        let cross = |i: usize| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            (i64::from(a[j]) * i64::from(b[k]) - i64::from(a[k]) * i64::from(b[j])) >> 30
        };
        [a, b, c].into_iter().all(|row| near(dot(row, row), 1 << 50))
            && near(dot(a, b), 0)
            && (0..3).all(|i| (cross(i) - i64::from(c[i])).abs() < 1 << 10)
    }

    /// Where a vector goes: each component within 2 of it. Lengths under 2^30.
    #[inline]
    pub fn turn(&self, v: [i32; 3]) -> [i32; 3] {
        self.rows.map(|row| along(row, v))
    }

    /// Where a vector comes from, as [`Self::turn`].
    #[inline]
    pub fn back(&self, v: [i32; 3]) -> [i32; 3] {
        let [a, b, c] = self.rows;
        [0, 1, 2].map(|i| along([a[i], b[i], c[i]], v))
    }
}

/// The sum of three products, each rounded down, and one more: within 2 of it.
#[inline(always)]
fn along(row: [i32; 3], v: [i32; 3]) -> i32 {
    mul_shift(row[0], v[0], 30) + mul_shift(row[1], v[1], 30) + mul_shift(row[2], v[2], 30) + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_right_to_two_and_back() {
        let mut state = 7u32;
        for _ in 0..20_000 {
            let mut number = |bits: u32| {
                state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
                (state ^ state >> 13) as i32 >> (32 - bits)
            };
            let quaternion = [number(30), number(30), number(30), number(30)];
            let v = [number(28), number(28), number(28)];
            let Some(rotation) = Rotation::new(quaternion) else {
                continue;
            };
            assert!(rotation.is_valid(), "{quaternion:?}");
            // v + 2 u × (u × v + w v), over the squared length.
            let [w, x, y, z] = quaternion.map(f64::from);
            let cross = |a: [f64; 3], b: [f64; 3]| {
                [
                    a[1] * b[2] - a[2] * b[1],
                    a[2] * b[0] - a[0] * b[2],
                    a[0] * b[1] - a[1] * b[0],
                ]
            };
            let (u, f, square) = ([x, y, z], v.map(f64::from), w * w + x * x + y * y + z * z);
            let inner = cross(u, f);
            let outer = cross(u, [0, 1, 2].map(|i| inner[i] + w * f[i]));
            let turned = rotation.turn(v);
            for i in 0..3 {
                let exact = f[i] + 2.0 * outer[i] / square;
                assert!((f64::from(turned[i]) - exact).abs() < 2.3, "{quaternion:?} {v:?}");
            }
            let back = rotation.back(turned);
            assert!((0..3).all(|i| (back[i] - v[i]).abs() <= 6), "{v:?} {back:?}");
        }
        assert_eq!(Rotation::new([0; 4]), None);
        assert_eq!(Rotation::new([5, 0, 0, 0]), Some(Rotation::NONE));
    }

    #[test]
    fn about_an_axis() {
        let quarter = Rotation::about(Dir::Z, Turn::from_num(0.25));
        let [x, y, z] = quarter.turn([1 << 20, 0, 5]);
        assert!(
            x.abs() < 40 && (y - (1 << 20)).abs() < 40 && (z - 5).abs() <= 2,
            "{x} {y} {z}"
        );
        assert!(
            !Rotation {
                rows: [[ONE, 0, 0], [0, ONE, 0], [0, 0, -ONE]]
            }
            .is_valid()
        );
        assert!(
            !Rotation {
                rows: [[ONE, 0, 0], [0, ONE, 1 << 12], [0, 0, ONE]]
            }
            .is_valid()
        );
    }
}
