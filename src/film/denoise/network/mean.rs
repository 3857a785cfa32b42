//! Means of light by what heads say of each other.

use super::{FEATURES, Head, Light};
#[cfg(neighbours)]
use crate::num::{BYTE_ZEROS, RECIPS};
#[cfg(not(neighbours))]
use crate::num::{leading_zeros, short_recip};

/// 255 exp(−i / 32).
pub static EXP: [u8; 256] = {
    // exp(−1/32), Q62: 1 − x + x²/2 − x³/6 + x⁴/24 − ... of x = 2^-5; then its powers.
    let mut step = 0i128;
    let mut term = 1i128 << 62;
    let mut n = 1;
    while n < 12 {
        step += term;
        term = -term / (32 * n);
        n += 1;
    }
    let mut table = [0; 256];
    let mut value = 255i128 << 62;
    let mut i = 0;
    while i < 256 {
        table[i] = ((value + (1 << 61)) >> 62) as u8;
        value = (value >> 31) * (step >> 31);
        i += 1;
    }
    table
};

#[cfg(neighbours)]
pub(super) static TABLES: microlux_asm::Tables = microlux_asm::Tables {
    zeros: &BYTE_ZEROS,
    recips: &RECIPS,
};

/// A mean about a centre: the weights, and the lights by weight.
pub(super) struct Mean {
    pub centre: Light,
    pub weight: u32,
    /// Under 2^31: a light is under 2^16, and all weights together are under 2^15.
    pub sum: [u32; 3],
}

impl Mean {
    pub fn new(centre: Light, weight: u32) -> Mean {
        Mean {
            centre,
            weight,
            sum: centre.map(|light| u32::from(light) * weight),
        }
    }

    #[inline(always)]
    pub fn add(&mut self, light: Light, weight: u32) {
        self.weight += weight;
        for (sum, light) in self.sum.iter_mut().zip(light) {
            *sum += u32::from(light) * weight;
        }
    }

    #[cfg(neighbours)]
    #[inline(always)]
    pub fn value(&self) -> Light {
        microlux_asm::mean(self.weight, self.sum, &self.centre, &TABLES)
    }

    /// Error: 2^-13.5 of the difference at most, and half a step.
    #[cfg(not(neighbours))]
    #[inline(always)]
    pub fn value(&self) -> Light {
        let zeros = leading_zeros(self.weight);
        let short = short_recip((self.weight << zeros) >> 16) as u32;
        let mut out = self.centre;
        for (out, sum) in out.iter_mut().zip(self.sum) {
            // The differences by weight.
            let sum = sum as i32 - (u32::from(*out) * self.weight) as i32;
            if sum != 0 {
                let change = quotient(sum.unsigned_abs(), short, zeros) as i32;
                // raw: no more than the largest difference.
                *out = (i32::from(*out) + if sum < 0 { -change } else { change }) as u16;
            }
        }
        out
    }
}

/// a / b, rounded, and at most a / b rounded up, where `short` is 2^31 over b's upper 16 bits and `zeros` those before
/// them; a ≥ 1, a / b ≤ 2^16.
#[cfg(not(neighbours))]
#[inline(always)]
fn quotient(a: u32, short: u32, zeros: u32) -> u32 {
    let before = leading_zeros(a);
    let product = ((a << before) >> 16) * (short & 0x1_ffff).min(0xffff);
    // 13 at least; a third of b has more than 31.
    let shift = 30 + before - zeros;
    if shift > 31 {
        return 0;
    }
    ((product >> shift) + 1) >> 1
}

#[inline(always)]
pub(super) fn affinity(a: Spread, b: &Head) -> u32 {
    u32::from(EXP[(a.square(b) >> 1).min(255) as usize])
}

/// The squared distance from which an affinity is 0.
const FAR: u32 = {
    let mut i = 0;
    while EXP[i] > 0 {
        i += 1;
    }
    2 * i as u32
};

/// The difference of one feature from which it is that far.
const REACH: i32 = {
    let mut apart = 0;
    while ((apart * apart) as u32) < FAR {
        apart += 1;
    }
    apart
};

/// The features in which heads of two sizes differ most, of [`TRAINED`](super::TRAINED).
const UNLIKE: [usize; 2] = [1, 5];

/// Whether one of two features alone says that two heads have no affinity; most of two sizes have none.
#[inline(always)]
pub(super) fn is_far(a: &Head, b: &Head) -> bool {
    let apart = |i: usize| i32::from(a[i] as i8) - i32::from(b[i] as i8);
    UNLIKE.iter().any(|&i| apart(i).abs() >= REACH)
}

/// The mean of four lights that weigh 1 each.
#[inline(always)]
pub(super) fn mean_of_alike(centre: Light, others: [Light; 3]) -> Light {
    let mut mean = Mean::new(centre, 1);
    for light in others {
        mean.add(light, 1);
    }
    // What [`Mean::value`] makes of it, which takes longer to say so.
    let mut out = centre;
    for (out, sum) in out.iter_mut().zip(mean.sum) {
        let sum = sum as i32 - 4 * i32::from(*out);
        if sum.unsigned_abs() >> 16 != 0 {
            return mean.value();
        }
        *out = (i32::from(*out)
            + if sum < 0 {
                -((1 - sum) >> 2)
            } else {
                (1 + sum) >> 2
            }) as u16;
    }
    out
}

#[cfg(gathers)]
pub(super) use microlux_asm::Spread;

/// A head's features.
#[cfg(not(gathers))]
#[derive(Clone, Copy)]
pub(super) struct Spread([i32; FEATURES]);

#[cfg(not(gathers))]
impl Spread {
    #[inline(always)]
    pub fn of(head: &Head) -> Spread {
        Spread(core::array::from_fn(|i| i32::from(head[i] as i8)))
    }

    /// The squared distance to another head's.
    #[inline(always)]
    pub fn square(self, other: &Head) -> u32 {
        let apart = |(own, other): (&i32, &u8)| own - i32::from(*other as i8);
        self.0.iter().zip(other).map(apart).map(|d| (d * d) as u32).sum()
    }
}

/// 1 ..= 256.
#[inline(always)]
pub(super) fn confidence(head: &Head) -> u32 {
    u32::from(head[FEATURES]) + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_alike_are_what_their_weights_say() {
        let value = |centre: u16, other: u16| {
            let mut mean = Mean::new([centre; 3], 1);
            for light in [other, other, centre] {
                mean.add([light; 3], 1);
            }
            mean.value()
        };
        for apart in 0..=u16::MAX {
            for other in [apart, apart / 2, 65_535 - apart] {
                let four = mean_of_alike([apart; 3], [[other; 3], [other; 3], [apart; 3]]);
                assert_eq!(four, value(apart, other), "{apart} {other}");
                let [one, ..] = mean_of_alike([7; 3], [[apart; 3], [7; 3], [7; 3]]);
                let mut mean = Mean::new([7; 3], 1);
                for light in [apart, 7, 7] {
                    mean.add([light; 3], 1);
                }
                assert_eq!(one, mean.value()[0], "{apart}");
            }
        }
    }

    /// So that a mean is not beyond its lights, and wraps nowhere. Quotients grow with what is divided: in between, too.
    #[test]
    fn a_quotient_is_not_more_than_it_should_be() {
        for weight in 1..0x8000 {
            let zeros = leading_zeros(weight);
            let short = short_recip((weight << zeros) >> 16) as u32;
            let ends = (0..16).flat_map(|bit| [1 << bit, (2 << bit) - 1]);
            for difference in ends.chain((0..64).map(|i| (i * 1021 + weight) & 0xffff)) {
                if difference > 0 {
                    let off = difference as i32 - quotient(difference * weight, short, zeros) as i32;
                    // Half a step and 2^-13.5 of the difference: 6.2 of the largest.
                    assert!((0..=6).contains(&off), "{difference}, {weight}: {off} too few");
                }
            }
        }
    }

    #[test]
    fn what_one_feature_says_is_far_has_no_affinity() {
        for (a, b) in (0..=255).flat_map(|a| (0..=255).map(move |b| (a, b))) {
            for feature in UNLIKE {
                let (mut one, mut two) = ([0; 8], [0; 8]);
                (one[feature], two[feature]) = (a, b);
                let far = affinity(Spread::of(&one), &two) == 0;
                assert_eq!(is_far(&one, &two), far, "{feature}: {a} {b}");
            }
        }
    }
}
