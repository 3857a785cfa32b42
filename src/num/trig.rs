use super::{ONE_Q16, Turn, mul_hi, mul_shift, ratio, rsqrt};

/// Sine and cosine of an angle in turns, both Q16 in −65536 ..= 65536.
///
/// Error: max 8.6e-6 (0.56 ulp), RMS 4.5e-6, no bias (mean within 1e-7, away from 0 counted as positive); the two as a
/// vector are 1 long to 1.15e-5 (`tests/num_error`). Reduced to ±1/8 turn; polynomials of degree 5 and 6, minimax on
/// that interval. Three wide products, four of 32 bits.
#[inline]
pub const fn sin_cos(angle: Turn) -> (i32, i32) {
    let phase = angle.to_bits();
    let quadrant = phase.wrapping_add(1 << 29) >> 30;
    // x in ±2^31 stands for ±π/4, Q31 = 1 at the end; its square Q30, and again in 15 bits for the small terms.
    let rest = phase.wrapping_sub(quadrant << 30) as i32;
    let x = rest.unsigned_abs() << 2;
    let x2 = mul_hi(x, x);
    let short = (x2 + (1 << 14)) >> 15;
    // sin = x (0.78539 − x² (1/16 + 0.018214 − 0.0024271 x²)): Q31 · Q32
    let third = 76_395 - ((10_180 * short) >> 15);
    let s = mul_hi(x, 3_373_242_552 - (x2 >> 2) - ((third * short) >> 5));
    let s = ((s + (1 << 14)) >> 15) as i32;
    let s = if rest < 0 { -s } else { s };
    // 1 − cos = x² (0.308424 − x² (0.015850 − 0.00031916 x²)): Q30 · Q32
    let fourth = 66_481 - ((1339 * short) >> 15);
    let c = (1 << 30) - mul_hi(x2, 1_324_673_091 - (((fourth * short) >> 15) << 10));
    let c = ((c + (1 << 13)) >> 14) as i32;
    match quadrant & 3 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// Angle of a cosine (Q16, 0 ..= 65536; others count as the nearest), in quarter turns, Q16: 0 ..= 65536.
///
/// Error against the angle of `cos` as it stands: max 1.8e-5 quarter turns (1.2 ulp), RMS 5.9e-6, mean 2.5e-6
/// (`tests/num_error`). √(1 − x) times a polynomial of degree 4, minimax (the form of Abramowitz and Stegun, 4.4.45).
#[inline]
pub fn acos(cos: i32) -> i32 {
    let x = cos.clamp(0, ONE_Q16);
    let rest = (ONE_Q16 - x) as u32;
    if rest == 0 {
        return 0;
    }
    // √rest · 2^(half + 15), 31 bits, is √(1 − x) · 2^(half + 23).
    let (mantissa, half) = rsqrt(rest);
    let root = mul_hi(rest << (2 * half), mantissa) as i32;
    // Q17; x in Q16 and factors under 2^14.2 stay under 2^31.
    let step = |sum: i32, next: i32| ((sum * x + (1 << 15)) >> 16) + next;
    let series = [-3139, 7146, -17_880, 131_072].into_iter().fold(812, step);
    (mul_shift(root, series, half + 23) + 1) >> 1
}

/// The angle of (`x`, `y`) from the x axis towards the y axis; 0 for nothing.
///
/// Error: max 3.0e-7 turns (1.9e-6 rad), RMS 1.9e-7, no bias (mean within 2e-9; `tests/num_error`). Reduced to 1/8 turn;
/// a polynomial of degree 11 in the ratio, minimax on that interval. One reciprocal, eight wide products.
#[inline]
pub fn atan2(y: i32, x: i32) -> Turn {
    let (across, up) = (x.unsigned_abs(), y.unsigned_abs());
    let t = ratio(across.min(up), across.max(up));
    // In turns, Q32: t (0.159151 − t² (0.052939 − t² (0.030803 − ...))); each bracket lies between 0 and its first term.
    let square = mul_hi(t, t);
    let mut bracket = 8_010_783;
    let mut i = 0;
    while i < 5 {
        bracket = COEFFICIENTS[i] - mul_hi(bracket, square);
        i += 1;
    }
    let eighth = mul_hi(t, bracket);
    let quarter = if up > across { (1 << 30) - eighth } else { eighth };
    let half = if x < 0 { (1 << 31) - quarter } else { quarter };
    Turn::from_bits(if y < 0 { half.wrapping_neg() } else { half })
}

/// Of [`atan2`], the last but one first, Q32.
static COEFFICIENTS: [u32; 5] = [35_987_874, 79_585_077, 132_297_472, 227_369_414, 683_549_703];
