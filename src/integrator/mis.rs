use crate::num::Wide;

/// The power heuristic with exponent 2 for one sample of each kind: a² / (a² + b²) (Veach 1997, equation 9.13).
#[inline]
pub fn power_heuristic(a: Wide, b: Wide) -> Wide {
    if a.is_zero() {
        return Wide::ZERO;
    }
    let ratio = b / a;
    (Wide::ONE + ratio * ratio).recip()
}

/// [`power_heuristic`] over the density `a` of the sample itself, a / (a² + b²), with one division; `a` is not 0.
///
/// Densities up to 2^16383 have squares.
#[inline]
pub fn weight_over_density(a: Wide, b: Wide) -> Wide {
    a / (a * a + b * b)
}
