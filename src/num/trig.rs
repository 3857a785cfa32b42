use super::Turn;

/// Sine and cosine of an angle in turns, both Q16 in −65536 ..= 65536.
///
/// Error: see `tests/num_error.rs`. Reduced to ±1/8 turn; polynomials of degree 5 and 6 (minimax on that interval).
#[inline]
pub fn sin_cos(angle: Turn) -> (i32, i32) {
    let phase = angle.to_bits();
    let quadrant = phase.wrapping_add(1 << 29) >> 30;
    // x in ±2^15, for ±π/4
    let x = (phase.wrapping_sub(quadrant << 30) as i32 + (1 << 13)) >> 14;
    let x2 = (x * x) >> 15;
    let s = 51472 + (((((159 * x2) >> 15) - 5290) * x2 + (1 << 14)) >> 15);
    let s = (s * x + (1 << 14)) >> 15;
    let c = ((1039 + ((-21 * x2) >> 15)) * x2 + (1 << 14)) >> 15;
    let c = (1 << 16) + (((c - 20213) * x2 + (1 << 14)) >> 15);
    match quadrant & 3 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}
