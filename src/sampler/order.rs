//! Random orders: permutations of 0..n that a key chooses, computed one element at a time.

/// Permutations of the numbers below `count`, 1 ≤ `count` ≤ 2¹⁵.
///
/// Position i goes to c·(i + a)³ + b in the field of `prime` elements, again until the result is below
/// `count` (cycle-walking: prime/count turns on average, 1.06 for 16, 1.004 for 256, 1.8 at worst above 2,
/// and 3 for 1), and is then rotated by d; a, b, c, d are scaled from the keys. Cubing permutes the field
/// since 3 does not divide `prime` − 1 (Lidl and Niederreiter, *Finite fields*, theorem 7.8), and without it
/// two orders would be points of a lattice. If `count` is `prime`, two positions go to any two places equally
/// often; else nearly so, and one position to any place equally often.
///
/// Kensler's hash, which is the usual choice ("Correlated multi-jittered sampling", 2013), reaches 8 of the
/// 24 permutations of four, and never half of the pairs of places; see `two_positions_go_to_any_two_places`.
#[derive(Clone, Debug)]
pub(super) struct Order {
    count: u32,
    /// The least odd prime at or above `count` that is 3 or 2 modulo 3.
    prime: u32,
    /// −1/`prime` modulo 2¹⁶.
    inverse: u32,
}

impl Order {
    pub(super) const fn new(count: u32) -> Self {
        let mut prime = if count < 3 { 3 } else { count | 1 };
        while !(is_prime(prime) && (prime == 3 || prime % 3 == 2)) {
            prime += 2;
        }
        // Newton's iteration doubles the correct bits: 3, 6, 12, 24.
        let mut inverse = prime;
        let mut bits = 3;
        while bits < 16 {
            inverse = inverse.wrapping_mul(2_u32.wrapping_sub(prime.wrapping_mul(inverse)));
            bits *= 2;
        }
        Self {
            count,
            prime,
            inverse: inverse.wrapping_neg() & 0xffff,
        }
    }

    /// Where `position`, below `count`, goes in the order that `keys` choose.
    pub(super) const fn permute(&self, position: u32, keys: [u32; 2]) -> u32 {
        let (n, p) = (self.count, self.prime);
        let before = part_of(keys[0] >> 16, p);
        let factor = part_of(keys[0] & 0xffff, p - 1) + 1;
        let after = part_of(keys[1] >> 16, p);
        let rotation = part_of(keys[1] & 0xffff, n);
        let mut i = position;
        loop {
            i = wrap(i + before, p);
            let cube = self.product(self.product(i, i), i);
            i = wrap(self.product(cube, factor) + after, p);
            if i < n {
                return wrap(i + rotation, n);
            }
        }
    }

    /// a·b/2¹⁶ modulo `prime`, for a and b below it.
    ///
    /// The constant 2¹⁶ does not matter here, as `factor` is random. Montgomery, "Modular multiplication
    /// without trial division" (1985). prime < 1.0001·2¹⁵, so that a·b < 1.001·2³⁰ and m·prime < 1.001·2³¹:
    /// the sum is below 2³².
    const fn product(&self, a: u32, b: u32) -> u32 {
        let product = a * b;
        let m = product.wrapping_mul(self.inverse) & 0xffff;
        wrap((product + m * self.prime) >> 16, self.prime)
    }
}

/// x·n/2¹⁶ rounded down, for x < 2¹⁶ and n < 2¹⁶: a number below `n`.
const fn part_of(x: u32, n: u32) -> u32 {
    (x * n) >> 16
}

/// `x` modulo `n`, for x < 2n.
const fn wrap(x: u32, n: u32) -> u32 {
    if x < n { x } else { x - n }
}

/// Whether `n`, odd and at least 3, is prime.
const fn is_prime(n: u32) -> bool {
    let mut divisor = 3;
    while divisor * divisor <= n {
        if n.is_multiple_of(divisor) {
            return false;
        }
        divisor += 2;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::super::hash;
    use super::*;

    fn keys(case: u32) -> [u32; 2] {
        [hash(1, 0, 0, case), hash(2, 0, 0, case)]
    }

    #[test]
    fn every_place_is_taken_once() {
        let mut taken = [u32::MAX; 1 << 15];
        for count in (1..300).chain([1009, 32_766, 32_767, 32_768]) {
            let order = Order::new(count);
            for case in 0..3 {
                for position in 0..count {
                    let place = order.permute(position, keys(case));
                    assert!(place < count);
                    let mark = count * 4 + case;
                    assert_ne!(taken[place as usize], mark, "{count}: {place} twice");
                    taken[place as usize] = mark;
                }
            }
        }
    }

    #[test]
    fn extreme_keys_stay_in_range() {
        for count in [1, 2, 3, 4, 32_749, 32_768] {
            for keys in [[0, 0], [u32::MAX, 0], [0, u32::MAX], [u32::MAX; 2]] {
                for position in [0, count / 2, count - 1] {
                    assert!(Order::new(count).permute(position, keys) < count);
                }
            }
        }
    }

    #[test]
    fn all_orders_of_four_are_dealt() {
        let order = Order::new(4);
        let mut seen = [0_u32; 256];
        for case in 0..24_000 {
            let code = (0..4).fold(0, |code, i| code << 2 | order.permute(i, keys(case)));
            seen[code as usize] += 1;
        }
        let (least, most) = seen
            .iter()
            .filter(|&&times| times > 0)
            .fold((u32::MAX, 0), |(l, m), &times| (l.min(times), m.max(times)));
        assert_eq!(seen.iter().filter(|&&times| times > 0).count(), 24);
        assert!(least > 500 && most < 1500, "{least} to {most} times");
    }

    #[test]
    fn two_positions_go_to_any_two_places() {
        let cases = 40_000;
        for count in 2..=24_u32 {
            let order = Order::new(count);
            for (i, j) in [(0, 1), (0, count - 1), (count / 2, count - 1)] {
                if i == j {
                    continue;
                }
                let mut times = [[0_u32; 24]; 24];
                for case in 0..cases {
                    let keys = keys(case);
                    times[order.permute(i, keys) as usize][order.permute(j, keys) as usize] += 1;
                }
                // χ²·expected/cases; of it, one per degree of freedom is chance.
                let n = count as usize;
                let freedom = count * (count - 1);
                let expected = cases / freedom;
                let squares: u32 = (0..n * n)
                    .filter(|k| k / n != k % n)
                    .map(|k| times[k / n][k % n].abs_diff(expected).pow(2))
                    .sum();
                let excess = (squares / expected).saturating_sub(freedom);
                // A relative deviation of 10 % (root mean square), beside six standard deviations of chance.
                let bound = cases / 100 + 6 * (2 * freedom).isqrt();
                assert!(excess < bound, "{i} and {j} of {count}: {excess} of {bound}");
            }
        }
    }
}
