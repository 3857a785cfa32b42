use crate::num::{leading_zeros, mul_hi, mul_hi_signed, rsqrt};

/// Length of a vector of up to three components, each under 2^25 in magnitude, in their own unit.
///
/// Error at most 0.75 units for lengths under 2^24, RMS 0.29, no bias (mean within 0.07). The squares of the components' upper 15 bits are
/// exact, the lower bits enter to first order.
#[inline]
pub(super) fn length<const N: usize>(v: [i32; N]) -> i32 {
    let size = v.iter().fold(0, |size, c| size | (c ^ (c >> 31)));
    let shift = (32 - leading_zeros(size as u32)).saturating_sub(15);
    // c = high·2^shift + low: Σ high² ≤ 3·2^30, and Σ high·low < 3·2^25.
    let (mut square, mut cross) = (0u32, 0i32);
    for c in v {
        let high = c >> shift;
        square = square.wrapping_add((high * high) as u32);
        cross = cross.wrapping_add(high * (c - (high << shift)));
    }
    let (mantissa, half) = rsqrt(square);
    // √square · 2^(15 + half)
    let root = mul_hi(square << (2 * half), mantissa);
    let down = 15 + half - shift;
    let whole = (root >> (down - 4)) as i32;
    if shift == 0 {
        return (whole + 8) >> 4;
    }
    // cross/√square = cross · mantissa / 2^(47 − half), and half is at most 1: the square has 29 bits or more.
    let part = mul_hi_signed(cross, (mantissa >> 1) as i32) >> (10 - half.min(1));
    (whole + part + 8) >> 4
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_right_to_a_unit() {
        let mut s = 1u32;
        let mut r = || {
            s = s.wrapping_mul(747796405).wrapping_add(2891336453);
            (s ^ (s >> 15)) as i32
        };
        let (mut max, mut sum, mut squares, mut count) = (0.0f64, 0.0, 0.0, 0.0);
        for _ in 0..300_000 {
            let bits = 8 + (r() & 15) as u32;
            let v = [r() >> bits, r() >> bits, r() >> (bits + (r() & 7) as u32)];
            let exact = v.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt();
            if exact >= f64::from(1 << 24) {
                continue;
            }
            let error = f64::from(length(v)) - exact;
            max = max.max(error.abs());
            sum += error;
            squares += error * error;
            count += 1.0;
            let flat = f64::from(v[0]).hypot(f64::from(v[1]));
            assert!((f64::from(length([v[0], v[1]])) - flat).abs() <= 0.75, "{v:?}");
        }
        let (rms, mean) = (f64::sqrt(squares / count), sum / count);
        assert!((0.5..=0.75).contains(&max), "{max}");
        assert!(
            (0.2..=0.3).contains(&rms) && (-0.1..=0.0).contains(&mean),
            "{rms} {mean}"
        );
        assert_eq!(length([0, 0, 0]), 0);
        assert_eq!(length([-3, 4]), 5);
    }
}
