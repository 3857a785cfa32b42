use crate::num::{Uniform, Wide, mul_hi, ratio};

/// Two uniform numbers of one dimension: an index below `count`, and what is left as a new uniform number.
///
/// If there is nothing to choose from, index 0, and all of the number is left.
#[inline]
pub fn choose(u: Uniform, count: u32) -> (u32, Uniform) {
    if count <= 1 {
        return (0, u);
    }
    let bits = u.to_bits();
    let index = mul_hi(bits, count);
    (index, Uniform::from_bits(bits.wrapping_mul(count)))
}

/// Where one choice's numbers end and the next one's begin: in 2^-32, or in 2^-16.
pub trait Bound: Copy {
    /// In 2^-32.
    fn bits(self) -> u32;
}

impl Bound for u32 {
    #[inline(always)]
    fn bits(self) -> u32 {
        self
    }
}

impl Bound for u16 {
    #[inline(always)]
    fn bits(self) -> u32 {
        (self as u32) << 16
    }
}

/// An index by a table of rising bounds, and what is left of the number: n bounds part n + 1 choices.
///
/// Index i has the numbers from bound i − 1 (or 0) up to bound i (or 1).
#[inline]
pub fn choose_by(u: Uniform, bounds: &[impl Bound]) -> (u32, Uniform) {
    let bits = u.to_bits();
    let index = bounds.partition_point(|bound| bound.bits() <= bits);
    let (from, length) = range(bounds, index);
    // A single choice has all numbers, 2^32: its length wraps to 0.
    let rest = if length == 0 {
        bits
    } else {
        ratio(bits.wrapping_sub(from), length)
    };
    (index as u32, Uniform::from_bits(rest))
}

/// The chance of an index in [`choose_by`]; 0 past the last.
#[inline]
pub fn chance_by(index: usize, bounds: &[impl Bound]) -> Wide {
    match range(bounds, index) {
        _ if index > bounds.len() => Wide::ZERO,
        (_, 0) => Wide::ONE,
        (_, length) => Wide::new(length, -32),
    }
}

/// Where a choice's numbers begin, and how many they are (0 for 2^32).
#[inline]
fn range(bounds: &[impl Bound], index: usize) -> (u32, u32) {
    let before = |i: usize| {
        i.checked_sub(1)
            .and_then(|i| bounds.get(i))
            .map_or(0, |b| b.bits())
    };
    let from = before(index);
    let to = bounds.get(index).map_or(0, |b| b.bits());
    (from, to.wrapping_sub(from))
}

/// Fills a table of bounds for [`choose_by`] by what each choice weighs; as many bounds as choices less one.
///
/// An eighth of all numbers is shared out evenly, so that nothing is left out and what is dim but near is not found too
/// seldom; all of them if nothing weighs anything. Of 1/128 more, what rounding leaves falls to the last. Bounds are
/// rounded and chances with them: what is drawn is exactly what [`chance_by`] says.
pub fn share_out(weights: impl Iterator<Item = Wide> + Clone, bounds: &mut [u32]) {
    let count = bounds.len() as u32 + 1;
    let total = weights.clone().fold(Wide::ZERO, |sum, weight| sum + weight);
    // An even share of all numbers, and of an eighth.
    let even = u32::MAX / count;
    let mut at = 0u32;
    for (bound, weight) in bounds.iter_mut().zip(weights) {
        let share = if total.is_zero() {
            even
        } else {
            // 111/128: shares are known to 2^-14, and their sum must not reach past the last choice.
            (even >> 3) + ((weight / total).to_fixed(32) >> 7) * 111
        };
        at = at.saturating_add(share);
        *bound = at;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_drawn_from_as_it_says() {
        let weights = [3u32, 0, 4, 1].map(|w| Wide::new(w, 0));
        let mut bounds = [0; 3];
        share_out(weights.into_iter(), &mut bounds);
        // 1/32 + 111/128 · weight/8; of the last, what is left.
        let shares: [f64; 4] = [0.356445, 0.03125, 0.464844, 0.147461];
        let mut from = 0.0;
        for (index, share) in shares.into_iter().enumerate() {
            let chance = chance_by(index, &bounds);
            let held = f64::from(chance.to_fixed(31)) / 2f64.powi(31);
            assert!((held - share).abs() < 1e-4, "{index}: {held}");
            for part in [0.01, 0.5, 0.99] {
                let u = Uniform::from_num(from + part * share);
                let (found, rest) = choose_by(u, &bounds);
                assert_eq!(found as usize, index);
                assert!((rest.to_num::<f64>() - part).abs() < 1e-3, "{rest}");
            }
            from += share;
        }
        assert_eq!(chance_by(4, &bounds), Wide::ZERO);
    }

    #[test]
    fn one_choice_leaves_the_number_as_it_is() {
        for bits in [0, 1, 77, u32::MAX] {
            assert_eq!(
                choose_by(Uniform::from_bits(bits), &[0u32; 0]),
                (0, Uniform::from_bits(bits))
            );
        }
        assert_eq!(chance_by(0, &[0u16; 0]), Wide::ONE);
    }

    #[test]
    fn bounds_rise_whatever_the_weights() {
        let extremes = [Wide::ZERO, Wide::ONE, Wide::new(1, -30_000), Wide::new(1, 30_000)];
        for n in 0..256 {
            let weights = [0, 1, 2, 3].map(|i| extremes[n >> (2 * i) & 3]);
            let mut bounds = [0; 3];
            share_out(weights.into_iter(), &mut bounds);
            assert!(0 < bounds[0] && bounds[0] < bounds[1] && bounds[1] < bounds[2] && bounds[2] < u32::MAX);
        }
    }
}
