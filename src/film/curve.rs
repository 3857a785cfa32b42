//! Tone curves with the sRGB transfer function in them, tabulated at compile time from integer roots.

use crate::num::leading_zeros;

/// Segments an octave, as a power of two.
const SEGMENT_BITS: u32 = 4;
const SEGMENTS: usize = 1 << SEGMENT_BITS;

/// A curve from 0 ..= 1 to 0 ..= 65535: straight up to `2^-octaves`, then straight on each sixteenth of an octave.
pub(super) struct Curve {
    /// Its values at `(16 + i)/16 · 2^(j − octaves)`, entry 16 j + i; the last one stands for 1.
    table: &'static [u16],
    octaves: i32,
}

/// Linear up to 1, then sRGB; below 2^-9 sRGB itself is straight.
pub(super) static CLAMP: Curve = Curve {
    table: &CLAMP_TABLE,
    octaves: 9,
};
/// Hable's curve of `x / white`, then sRGB.
pub(super) static FILMIC: Curve = Curve {
    table: &FILMIC_TABLE,
    octaves: 11,
};

static CLAMP_TABLE: [u16; 9 * SEGMENTS + 1] = tabulate(9, false);
static FILMIC_TABLE: [u16; 11 * SEGMENTS + 1] = tabulate(11, true);

impl Curve {
    /// The curve at `bits · 2^exponent`; 65535 from 1 on. Monotone, 0 at 0.
    #[inline]
    pub(super) fn at(&self, bits: u32, exponent: i32) -> u16 {
        if bits == 0 {
            return 0;
        }
        let zeros = leading_zeros(bits);
        let n = bits << zeros;
        // The value is n/2^31 · 2^above.
        let above = exponent + 31 - zeros as i32;
        if above >= 0 {
            return u16::MAX;
        }
        let octave = above + self.octaves;
        if octave < 0 {
            // Straight from 0: raw: table[0] < 2^13 and n >> 16 < 2^16, half of the divisor at most 2^30.
            let shift = (15 - octave).min(31) as u32;
            return ((self.table[0] as u32 * (n >> 16) + (1 << (shift - 1))) >> shift) as u16;
        }
        let i = octave as usize * SEGMENTS + ((n << 1) >> (32 - SEGMENT_BITS)) as usize;
        let fraction = ((n << 1) << SEGMENT_BITS) >> 16;
        let (low, high) = (self.table[i] as u32, self.table[i + 1] as u32);
        // raw: high − low < 2^15, fraction < 2^16
        (low + (((high - low) * fraction + (1 << 15)) >> 16)) as u16
    }
}

const fn tabulate<const N: usize>(octaves: u32, filmic: bool) -> [u16; N] {
    let mut table = [0; N];
    let mut i = 0;
    while i < N {
        // Q20: 11 octaves and 4 bits for the segment are exact.
        let y = ((SEGMENTS + i % SEGMENTS) as u128) << (i / SEGMENTS) << (20 - SEGMENT_BITS - octaves);
        table[i] = srgb(if filmic { hable(y) } else { y << 20 });
        i += 1;
    }
    table
}

/// Hable's curve at x = 11.2 y over its value at 11.2, Q20 to Q40.
///
/// f(x) = (x (A x + C B) + D E)/(x (A x + B) + D F) − E/F with A = 0.15, B = 0.5, C = 0.1, D = 0.2, E = 0.02,
/// F = 0.3 is x (0.042 x + 0.005)/(0.15 x² + 0.5 x + 0.06) but for a constant factor; below times 25000, with
/// x = 56 y/5.
const fn hable(y: u128) -> u128 {
    let up = 56 * y * (2352 * y + (25 << 20));
    let down = 470_400 * y * y + ((140_000 * y) << 20) + (1500 << 40);
    // Both Q40. raw: up < 2^57, its factor at y = 1 < 2^20
    ((up * 611_900) << 40) / (down * 133_112)
}

/// IEC 61966-2-1: Q40 (0 ..= 1) to 0 ..= 65535, rounded to nearest.
const fn srgb(t: u128) -> u16 {
    if t * 10_000_000 <= 31_308 << 40 {
        return ((t * 1292 * 65535 / 100 + (1 << 39)) >> 40) as u16;
    }
    // t^(1/2.4) = t^(1/3) · t^(1/12): Q40 · Q60
    let third = cube_root(t << 80);
    let twelfth = ((third << 80).isqrt() << 60).isqrt();
    let power = (third * twelfth) >> 40;
    (((1055 * power - (55 << 60)) * 65535 / 1000 + (1 << 59)) >> 60) as u16
}

/// ⌊∛x⌋ for x ≤ 2^120.
const fn cube_root(x: u128) -> u128 {
    let mut root = 0u128;
    let mut bit = 1 << 40;
    while bit > 0 {
        let next = root + bit;
        if next * next * next <= x {
            root = next;
        }
        bit >>= 1;
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knots_are_on_the_curve() {
        assert_eq!(CLAMP.at(1, -9), 1654); // 12.92/512 · 65535 = 1653.7
        assert_eq!(CLAMP.at(1, -1), 48192); // (1.055 · 0.5^(1/2.4) − 0.055) · 65535 = 48192.4
        assert_eq!(CLAMP.at(3, -2), 57725); // 0.75
        assert_eq!(CLAMP.at(1, 0), 65535);
    }

    #[test]
    fn ends_are_exact_and_nothing_beyond_them_matters() {
        for curve in [&CLAMP, &FILMIC] {
            assert_eq!(curve.at(0, 1000), 0);
            assert_eq!(curve.at(1, -100_000), 0);
            assert_eq!(curve.at(u32::MAX, 100_000), 65535);
            assert_eq!(*curve.table.last().unwrap(), 65535);
        }
    }

    #[test]
    fn cube_roots_round_down() {
        for (x, root) in [
            (0, 0),
            (1, 1),
            (26, 2),
            (27, 3),
            (28, 3),
            (1 << 120, 1 << 40),
            ((1 << 120) - 1, (1 << 40) - 1),
        ] {
            assert_eq!(cube_root(x), root);
        }
    }
}
