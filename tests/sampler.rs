//! What the samplers promise: strata, uniformity, independence, order, lower error, and the same numbers for
//! ever.

use fixed::types::U0F32;
use microlux::sampler::{AnySampler, Independent, PcgRxsMXs32, Sampler, Sobol, Stratified};
use rand_core::{Infallible, SeedableRng, TryRng};

const SPP: [u32; 10] = [1, 2, 3, 4, 7, 16, 17, 64, 100, 256];

/// All samplers, for runs of `spp` samples.
fn samplers(seed: u32, spp: u32) -> [(&'static str, AnySampler); 3] {
    [
        ("independent", Independent::new(seed).into()),
        ("stratified", Stratified::new(seed, spp).into()),
        ("sobol", Sobol::new(seed).into()),
    ]
}

/// The pixels of a frame 256 wide, by number.
fn pixel(n: u32) -> (u16, u16) {
    ((n % 256) as u16, (n / 256) as u16)
}

/// What a sample draws: one number, a point, one number, a point, and so on.
#[derive(Debug, PartialEq)]
struct Draws {
    numbers: [u32; 4],
    points: [[u32; 2]; 4],
}

impl Draws {
    fn of(sampler: &mut impl Sampler, n: u32, index: u32) -> Self {
        let (x, y) = pixel(n);
        sampler.start(x, y, index);
        let mut draws = Self {
            numbers: [0; 4],
            points: [[0; 2]; 4],
        };
        for i in 0..4 {
            draws.numbers[i] = sampler.next_1d().to_bits();
            draws.points[i] = sampler.next_2d().map(U0F32::to_bits);
        }
        draws
    }

    /// All twelve dimensions in order.
    fn flat(&self) -> [u32; 12] {
        std::array::from_fn(|d| match d % 3 {
            0 => self.numbers[d / 3],
            axis => self.points[d / 3][axis - 1],
        })
    }
}

/// Which of `parts` equal parts of [0, 1) holds `u`, exactly.
fn part(u: u32, parts: u32) -> u32 {
    ((u64::from(u) * u64::from(parts)) >> 32) as u32
}

/// Asserts that `parts`, numbers below `n`, are each number once.
fn assert_each_once(parts: impl Iterator<Item = u32>, n: u32, what: &str) {
    let mut count = vec![0; n as usize];
    parts.for_each(|part| count[part as usize] += 1);
    assert!(count.iter().all(|&c| c == 1), "{what}: {count:?}");
}

#[test]
fn stratified_puts_one_sample_in_each_stratum() {
    for spp in SPP {
        // Cells in each row, as the docs give them.
        let rows: &[u32] = match spp {
            1 => &[1],
            2 => &[2],
            3 => &[2, 1],
            4 => &[2; 2],
            7 => &[3, 2, 2],
            16 => &[4; 4],
            17 => &[5, 4, 4, 4],
            64 => &[8; 8],
            100 => &[10; 10],
            _ => &[16; 16],
        };
        let cell = |[x, y]: [u32; 2]| {
            let mut first = 0;
            for &cells in rows {
                if part(y, spp) < first + cells {
                    return first + part(x, cells);
                }
                first += cells;
            }
            unreachable!("all rows together are as high as the square")
        };
        let mut sampler = Stratified::new(9, spp);
        for (n, pass) in [(0, 0), (1, 0), (300, 0), (300, 1), (65_535, 1000)] {
            let draws: Vec<_> = (0..spp)
                .map(|i| Draws::of(&mut sampler, n, pass * spp + i))
                .collect();
            for d in 0..4 {
                let what = format!("spp {spp}, pixel {n}, pass {pass}, draw {d}");
                assert_each_once(draws.iter().map(|s| part(s.numbers[d], spp)), spp, &what);
                assert_each_once(draws.iter().map(|s| cell(s.points[d])), spp, &what);
            }
        }
    }
}

#[test]
fn stratified_takes_any_count_and_any_index() {
    for spp in (1..200).chain([32_767, 32_768]) {
        let mut sampler = Stratified::new(1, spp);
        for first in [0, u32::MAX / spp * spp - spp] {
            let strata = (0..spp).map(|i| {
                sampler.start(3, 4, first + i);
                part(sampler.next_1d().to_bits(), spp)
            });
            assert_each_once(strata, spp, &format!("spp {spp} from {first}"));
        }
    }
    // Out of range is brought into range.
    let draws = |spp| Draws::of(&mut Stratified::new(1, spp), 5, u32::MAX);
    assert_eq!(draws(0), draws(1));
    assert_eq!(draws(u32::MAX), draws(Stratified::MAX_STRATA));
}

#[test]
fn stratified_deals_strata_evenly() {
    // Over pixels: the strata of two samples are any two, the strata of two draws of a sample unrelated.
    for spp in [2, 3, 4, 7, 16] {
        let mut sampler = Stratified::new(77, spp);
        let cases = 40_000;
        let n = spp as usize;
        let (mut samples, mut dimensions) = (vec![0; n * n], vec![0; n * n]);
        for case in 0..cases {
            let strata = |draws: Draws| draws.numbers.map(|u| part(u, spp) as usize);
            let a = strata(Draws::of(&mut sampler, case, 0));
            let b = strata(Draws::of(&mut sampler, case, spp - 1));
            samples[a[0] * n + b[0]] += 1;
            dimensions[a[0] * n + a[1]] += 1;
        }
        let distinct: Vec<u32> = (0..n * n)
            .filter(|i| i / n != i % n)
            .map(|i| samples[i])
            .collect();
        assert_eq!(distinct.iter().sum::<u32>(), cases);
        // Not exactly even by construction: orders are a prime's, cut to size.
        assert_even_but_for(0.1, &distinct, &format!("samples 0 and {} of {spp}", spp - 1));
        assert_even(&dimensions, &format!("draws 0 and 1 of {spp}"));
    }
}

#[test]
fn sobol_puts_one_sample_in_each_elementary_interval() {
    let mut sampler = Sobol::new(3);
    for k in 0..=8 {
        let spp = 1 << k;
        for (n, block) in [(0, 0), (1, 0), (300, 5), (65_535, 1_000_001)] {
            let draws: Vec<_> = (0..spp)
                .map(|i| Draws::of(&mut sampler, n, block * spp + i))
                .collect();
            for d in 0..4 {
                let what = format!("{spp} samples, pixel {n}, block {block}, draw {d}");
                assert_each_once(draws.iter().map(|s| part(s.numbers[d], spp)), spp, &what);
                for a in 0..=k {
                    let interval = |[x, y]: [u32; 2]| part(x, 1 << a) << (k - a) | part(y, spp >> a);
                    assert_each_once(draws.iter().map(|s| interval(s.points[d])), spp, &what);
                }
            }
        }
    }
}

/// Asserts that counts are as even as those of fair dice.
fn assert_even(counts: &[u32], what: &str) {
    assert_even_but_for(0.0, counts, what);
}

/// Asserts that χ² is within six standard deviations of its mean both ways, or is higher by what chances that
/// deviate by `rms` (root mean square, relative) would add.
fn assert_even_but_for(rms: f64, counts: &[u32], what: &str) {
    let total = f64::from(counts.iter().sum::<u32>());
    let expected = total / counts.len() as f64;
    let chi2: f64 = counts
        .iter()
        .map(|&c| (f64::from(c) - expected).powi(2) / expected)
        .sum();
    let freedom = counts.len() as f64 - 1.0;
    // χ² of few degrees is skewed: its tail is longer than six of its deviations.
    let bound = 6.0 * (2.0 * freedom).sqrt() + 12.0;
    let excess = chi2 - freedom;
    assert!(
        excess > -bound && excess < bound + total * rms * rms,
        "{what}: chi2 {chi2:.1} of {freedom}"
    );
}

/// Counts points of the unit square in 16 × 16 boxes.
fn assert_uniform_2d(points: impl Iterator<Item = [u32; 2]>, what: &str) {
    let mut counts = [0; 256];
    points.for_each(|[x, y]| counts[(part(x, 16) << 4 | part(y, 16)) as usize] += 1);
    assert_even(&counts, what);
}

#[test]
fn each_dimension_of_a_sample_is_uniform() {
    for (name, mut sampler) in samplers(11, 17) {
        for index in [0, 1, 5, 16, 100] {
            let draws: Vec<_> = (0..20_000)
                .map(|n| Draws::of(&mut sampler, n, index).flat())
                .collect();
            for d in 0..12 {
                // The first byte, and the third: jitter is uniform far inside a stratum too.
                for shift in [24, 8] {
                    let mut counts = [0; 256];
                    draws
                        .iter()
                        .for_each(|s| counts[(s[d] >> shift & 255) as usize] += 1);
                    let what = format!("{name}, sample {index}, dimension {d}, bits from {shift}");
                    assert_even(&counts, &what);
                }
            }
        }
    }
}

#[test]
fn dimensions_of_a_sample_are_independent() {
    for (name, mut sampler) in samplers(12, 16) {
        for index in [0, 7] {
            let draws: Vec<_> = (0..20_000)
                .map(|n| Draws::of(&mut sampler, n, index).flat())
                .collect();
            for b in 0..12 {
                for a in 0..b {
                    let what = format!("{name}, sample {index}, dimensions {a} and {b}");
                    assert_uniform_2d(draws.iter().map(|s| [s[a], s[b]]), &what);
                }
            }
        }
    }
}

#[test]
fn dimensions_are_uncorrelated_over_the_samples_of_a_pixel() {
    // Within a pixel, ordered alike in two dimensions, samples would lie on a diagonal; the mean over pixels
    // of the square of their correlation tells, since its sign may change between pixels. For random orders
    // it is 1/(spp − 1).
    let (spp, pixels) = (16, 4000);
    for (name, mut sampler) in samplers(13, spp) {
        let pairs: Vec<_> = (0..12).flat_map(|b| (0..b).map(move |a| (a, b))).collect();
        let mut squares = vec![0.0; pairs.len()];
        for n in 0..pixels {
            let draws: Vec<_> = (0..spp)
                .map(|i| {
                    Draws::of(&mut sampler, n, i)
                        .flat()
                        .map(|u| f64::from(u) / 2f64.powi(32))
                })
                .collect();
            for (sum, &(a, b)) in squares.iter_mut().zip(&pairs) {
                *sum += correlation(draws.iter().map(|s| (s[a], s[b]))).powi(2);
            }
        }
        for (sum, (a, b)) in squares.iter().zip(pairs) {
            let mean = sum / f64::from(pixels) * f64::from(spp - 1);
            // The two coordinates of one point are the exception that is wanted: less correlated than chance.
            let together = a % 3 == 1 && b == a + 1;
            // So are, the other way, the orders of Sobol': each aligned pair of samples is in opposite halves
            // in every dimension, each four in opposite quarters.
            let range = match name {
                "independent" => 0.9..1.1,
                _ if together => 0.0..0.15,
                "stratified" => 0.9..1.1,
                _ => 1.3..1.7,
            };
            assert!(range.contains(&mean), "{name}: {a} and {b}: {mean}");
        }
    }
}

fn correlation(pairs: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let n = pairs.clone().count() as f64;
    let (sx, sy) = pairs
        .clone()
        .fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x, sy + y));
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for (x, y) in pairs {
        let (dx, dy) = (x - sx / n, y - sy / n);
        xx += dx * dx;
        yy += dy * dy;
        xy += dx * dy;
    }
    xy / (xx * yy).sqrt()
}

#[test]
fn pixels_seeds_and_passes_are_independent() {
    type Neighbour = fn(u32) -> (u32, u32);
    let neighbours: [(&str, Neighbour); 4] = [
        ("the pixel to the right", |n| (0, 2 * n + 1)),
        ("the pixel below", |n| (0, 2 * n + 256)),
        ("the next seed", |n| (1, 2 * n)),
        ("a seed far off", |n| (0x8000_0000, 2 * n)),
    ];
    for (what, neighbour) in neighbours {
        for kind in 0..3 {
            let at = |seed: u32, n| {
                let (name, mut sampler) = samplers(seed + 21, 16)[kind].clone();
                (name, Draws::of(&mut sampler, n, 3).flat())
            };
            let pairs: Vec<_> = (0..15_000)
                .map(|n| {
                    let (seed, other) = neighbour(n);
                    (at(0, 2 * n), at(seed, other))
                })
                .collect();
            for d in 0..12 {
                let what = format!("{}: dimension {d} against {what}", pairs[0].0.0);
                assert_uniform_2d(pairs.iter().map(|(a, b)| [a.1[d], b.1[d]]), &what);
            }
        }
    }
    // The second pass of a stratified pixel owes nothing to the first.
    let mut sampler = Stratified::new(22, 16);
    let mut draws = |n, index| Draws::of(&mut sampler, n, index).flat();
    let pairs: Vec<_> = (0..20_000).map(|n| (draws(n, 3), draws(n, 16 + 3))).collect();
    for d in 0..12 {
        let points = pairs.iter().map(|(a, b)| [a[d], b[d]]);
        assert_uniform_2d(
            points,
            &format!("stratified, dimension {d} against the next pass"),
        );
    }
}

#[test]
fn order_does_not_matter() {
    for (name, sampler) in samplers(31, 17) {
        let cases: Vec<_> = (0..50).flat_map(|n| (0..40).map(move |i| (n * 97, i))).collect();
        let fresh = |&(n, i): &(u32, u32)| Draws::of(&mut sampler.clone(), n, i);
        let expected: Vec<_> = cases.iter().map(fresh).collect();

        let mut used = sampler.clone();
        for (case, expected) in cases.iter().zip(&expected).rev() {
            assert_eq!(Draws::of(&mut used, case.0, case.1), *expected, "{name} {case:?}");
            // Leave it in the middle of a sample.
            used.next_1d();
        }
    }
}

#[test]
fn a_new_sampler_stands_at_the_first_sample_of_the_first_pixel() {
    for (name, sampler) in samplers(32, 16) {
        let mut started = sampler.clone();
        started.start(0, 0, 0);
        let [mut a, mut b] = [sampler, started];
        assert_eq!((a.next_1d(), a.next_2d()), (b.next_1d(), b.next_2d()), "{name}");
    }
}

/// Root mean square error over pixels of the mean of `f` over the third point drawn by each of `spp` samples.
fn rmse(sampler: &mut impl Sampler, spp: u32, exact: f64, f: fn(f64, f64) -> f64) -> f64 {
    let pixels = 2000;
    let unit = |u: u32| f64::from(u) / 2f64.powi(32);
    let squares = (0..pixels).map(|n| {
        let value = |i| {
            let [x, y] = Draws::of(sampler, n, i).points[2];
            f(unit(x), unit(y))
        };
        let mean = (0..spp).map(value).sum::<f64>() / f64::from(spp);
        (mean - exact).powi(2)
    });
    (squares.sum::<f64>() / f64::from(pixels)).sqrt()
}

#[test]
fn patterns_lower_the_error() {
    type Integrand = fn(f64, f64) -> f64;
    let smooth: Integrand = |x, y| (-x * x - y * y).exp();
    // The integral of exp(-x²) over [0, 1) is √π/2 erf(1).
    let smooth_integral = 0.746_824_132_812_427_f64.powi(2);
    let disk: Integrand = |x, y| f64::from(u8::from(x * x + y * y < 1.0));
    let disk_integral = std::f64::consts::FRAC_PI_4;

    // Error of stratified and of sobol over that of independent, at most. Measured: 0.122 and 0.021, 0.412
    // and 0.368, 0.228 and 0.247, 0.550 and 0.552.
    let expected = [
        ("smooth", smooth, smooth_integral, 64, 0.14, 0.025),
        ("disk", disk, disk_integral, 64, 0.45, 0.41),
        ("smooth", smooth, smooth_integral, 17, 0.26, 0.28),
        ("disk", disk, disk_integral, 17, 0.61, 0.61),
    ];
    for (name, f, exact, spp, stratified_bound, sobol_bound) in expected {
        let [independent, stratified, sobol] =
            samplers(41, spp).map(|(_, mut sampler)| rmse(&mut sampler, spp, exact, f));
        assert!(
            stratified < stratified_bound * independent,
            "{name} at {spp}: {stratified}"
        );
        assert!(sobol < sobol_bound * independent, "{name} at {spp}: {sobol}");
    }
}

/// A generator of a user's own, with a seed that is no whole number of words.
struct Bytes([u8; 11], usize);

impl SeedableRng for Bytes {
    type Seed = [u8; 11];

    fn from_seed(seed: [u8; 11]) -> Self {
        Self(seed, 0)
    }
}

impl TryRng for Bytes {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        self.1 += 1;
        Ok(u32::from(self.0[self.1 - 1]) << 24)
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        rand_core::utils::next_u64_via_u32(self)
    }

    fn try_fill_bytes(&mut self, dst: &mut [u8]) -> Result<(), Infallible> {
        rand_core::utils::fill_bytes_via_next_word(dst, || self.try_next_u32())
    }
}

#[test]
fn independent_takes_any_generator_and_fills_its_seed() {
    let mut sampler = Independent::<Bytes>::new(51);
    let seeds: Vec<_> = (0..20_000)
        .map(|n| {
            let (x, y) = pixel(n);
            sampler.start(x, y, 2);
            [(); 11].map(|()| sampler.next_1d().to_bits())
        })
        .collect();
    for b in 0..11 {
        for a in 0..b {
            let what = format!("bytes {a} and {b} of the seed");
            assert_uniform_2d(seeds.iter().map(|s| [s[a], s[b]]), &what);
        }
    }
}

#[test]
fn independent_draws_the_generator_in_order() {
    let mut sampler = Independent::<PcgRxsMXs32>::new(52);
    sampler.start(1, 2, 3);
    let seed = microlux::sampler::hash(52, 1, 2, 3).to_le_bytes();
    let mut rng = PcgRxsMXs32::from_seed(seed);
    let mut next = || U0F32::from_bits(rng.try_next_u32().unwrap());
    assert_eq!(sampler.next_1d(), next());
    assert_eq!(sampler.next_2d(), [next(), next()]);
}

/// Asserts what `sampler` draws at two pixels: a number, a point, a number, a point.
fn assert_known(sampler: impl Into<AnySampler>, expected: [[u32; 6]; 2]) {
    let mut sampler = sampler.into();
    for ((x, y, index), expected) in [(17, 200, 6), (17, 201, 123)].into_iter().zip(expected) {
        sampler.start(x, y, index);
        let draws: [[u32; 3]; 2] = std::array::from_fn(|_| {
            let u = sampler.next_1d();
            let [v, w] = sampler.next_2d();
            [u, v, w].map(U0F32::to_bits)
        });
        assert_eq!(draws.as_flattened(), expected, "{draws:#x?}");
    }
}

#[test]
fn known_answers() {
    // A change here changes every picture. They were checked against a model that shares no code: exact
    // fractions, direction numbers one by one, residues by division.
    assert_known(
        Independent::<PcgRxsMXs32>::new(5),
        [
            [
                0x9873_274a,
                0xe616_b9fa,
                0xdeb2_63d2,
                0x45e1_7dc8,
                0xaba9_bf60,
                0x24ab_acb6,
            ],
            [
                0x684e_2143,
                0x4d8a_ad5d,
                0x41b1_3301,
                0x8107_950f,
                0x569f_ee7b,
                0xa4fb_9a49,
            ],
        ],
    );
    assert_known(
        Stratified::new(5, 16),
        [
            [
                0x1fdb_2627,
                0x3036_1cfe,
                0x0728_f276,
                0xe80b_093e,
                0xc14d_dc2f,
                0x6002_dc86,
            ],
            [
                0xf41f_29b4,
                0x07b2_5b32,
                0x97c4_a54f,
                0xe204_4826,
                0xd25e_3dfa,
                0xae89_47bb,
            ],
        ],
    );
    assert_known(
        Stratified::new(5, 7),
        [
            [
                0x243e_0e15,
                0x959d_7bff,
                0x0c46_31f0,
                0xc93d_cbfd,
                0x01bd_2594,
                0x36e0_557b,
            ],
            [
                0x0f28_458a,
                0x30dd_43d9,
                0x3be3_0234,
                0xd867_c01e,
                0x0634_a659,
                0xb56b_2626,
            ],
        ],
    );
    assert_known(
        Sobol::new(5),
        [
            [
                0xe2e8_692e,
                0x847a_9478,
                0xed4e_4336,
                0xc967_1662,
                0xbf77_7a93,
                0xe6f1_2ae8,
            ],
            [
                0x6828_b0d9,
                0x96e2_1ac4,
                0x266b_d1ed,
                0xcb91_73ab,
                0x2481_2097,
                0x40cb_e005,
            ],
        ],
    );
}
