//! Every kernel of `num` against f64 over its domain, edges included: what its documentation says, held both ways.

use crate::figures::{Figures, Mean, Random, Said};
use microlux::num::*;

/// What rounding down does to evenly spread values: errors in (−1, 0] ulp.
const FLOOR: Said = Said {
    max: 1.0,
    rms: 0.58,
    mean: Mean::Is(-0.51),
};

/// Where carries and signs change.
const EDGES: [i32; 16] = [
    0,
    1,
    -1,
    2,
    0x7fff,
    0x8000,
    0xffff,
    0x1_0000,
    0x1_0001,
    -0x8000,
    -0x1_0000,
    -0x1_0001,
    i32::MAX,
    i32::MAX - 1,
    i32::MIN,
    i32::MIN + 1,
];

#[test]
fn products_and_their_narrow_twins_are_the_exact_floor() {
    let hold = |a: i32, b: i32| {
        let product = i64::from(a) * i64::from(b);
        assert_eq!(
            [mul_q16(a, b), narrow::mul_q16(a, b)],
            [(product >> 16) as i32; 2],
            "{a} {b}"
        );
        assert_eq!(
            [mul_hi_signed(a, b), narrow::mul_hi_signed(a, b)],
            [(product >> 32) as i32; 2]
        );
        for unit in [b & 0x1_ffff, -(b & 0x1_ffff), 0, 1 << 16, -1 << 16] {
            let exact = ((i64::from(a) * i64::from(unit)) >> 16) as i32;
            assert_eq!([mul_unit(a, unit), narrow::mul_unit(a, unit)], [exact; 2]);
        }
        let (short, share) = (a >> 15, b & 0x1_ffff);
        let share = share.min(1 << 16);
        let exact = ((i64::from(short) * i64::from(share)) >> 8) as i32;
        assert_eq!(
            [mul_share(short, share), narrow::mul_share(short, share)],
            [exact; 2]
        );
        let unsigned = u64::from(a as u32) * u64::from(b as u32);
        assert_eq!(
            [mul_hi(a as u32, b as u32), narrow::mul_hi(a as u32, b as u32)],
            [(unsigned >> 32) as u32; 2]
        );
        for shift in 1..32 {
            assert_eq!(
                [
                    mul_shift_short(a as u32, b as u32, shift),
                    narrow::mul_shift_short(a as u32, b as u32, shift)
                ],
                [(unsigned >> shift) as u32; 2]
            );
        }
        for shift in 0..64 {
            assert_eq!(
                [mul_shift(a, b, shift), narrow::mul_shift(a, b, shift)],
                [(product >> shift) as i32; 2]
            );
        }
        for a in [a >> 11, a.clamp(-1 << 20, 1 << 20)] {
            for shift in 22..54 {
                assert_eq!(
                    [mul_shift_brief(a, b, shift), narrow::mul_shift_brief(a, b, shift)],
                    [((i64::from(a) * i64::from(b)) >> shift) as i32; 2]
                );
            }
        }
        let (a, b) = (a.clamp(-0x3ff_ffff, 0x3ff_ffff), b & i32::MAX);
        for shift in 27..59 {
            assert_eq!(
                [
                    mul_shift_medium(a, b, shift),
                    narrow::mul_shift_medium(a, b, shift)
                ],
                [((i64::from(a) * i64::from(b)) >> shift) as i32; 2]
            );
        }
    };
    for a in EDGES {
        for b in EDGES {
            hold(a, b);
        }
    }
    let mut random = Random(1);
    for _ in 0..100_000 {
        hold(random.signed(32), random.signed(32));
    }
}

#[test]
fn both_forms_of_a_cosine_are_the_exact_floor() {
    let mut random = Random(20);
    let unit = |random: &mut Random| match random.below(5) {
        0 => 0,
        1 => 1 << 16,
        2 => -1 << 16,
        _ => random.signed(17),
    };
    for _ in 0..100_000 {
        let a = [0; 3].map(|_| random.signed(17));
        let b = [0; 3].map(|_| unit(&mut random));
        let sum: i64 = (0..3).map(|i| i64::from(a[i]) * i64::from(b[i])).sum();
        let exact = (sum >> 8) as i32;
        assert_eq!(
            [
                dot_q24(a, b),
                dot_unit(a, b),
                dot_sparse(a, b),
                narrow::dot_unit(a, b),
                narrow::dot_sparse(a, b)
            ],
            [exact; 5]
        );
    }
}

#[test]
fn roots_of_large_numbers_are_roots() {
    let mut random = Random(21);
    for _ in 0..1_000_000 {
        let x = random.bits().max(1 << 28);
        assert_eq!(rsqrt_of_large(x), rsqrt(x), "{x}");
    }
}

#[test]
fn products_lose_half_an_ulp() {
    let mut random = Random(2);
    let (mut q16, mut hi, mut shifted) = (Figures::default(), Figures::default(), Figures::default());
    for _ in 0..1_000_000 {
        let (a, b) = (random.bits() as i32, (random.bits() & 0x1_ffff) as i32 - 0x1_0000);
        q16.add(f64::from(mul_q16(a, b)) - f64::from(a) * f64::from(b) / 65536.0);
        let (a, b) = (random.bits(), random.bits());
        hi.add(f64::from(mul_hi(a, b)) - f64::from(a) * (f64::from(b) / 2f64.powi(32)));
        let shift = 31 + random.below(10);
        let exact = f64::from(a as i32) * (f64::from(b as i32) / 2f64.powi(shift as i32));
        shifted.add(f64::from(mul_shift(a as i32, b as i32, shift)) - exact);
    }
    q16.assert("mul_q16, ulp", FLOOR);
    hi.assert("mul_hi, mul_hi_signed, ulp", FLOOR);
    shifted.assert("mul_shift, ulp", FLOOR);
}

#[test]
fn zeros_and_shifts_are_exact() {
    for bit in 0..32 {
        assert_eq!(leading_zeros(1 << bit), 31 - bit);
        assert_eq!(leading_zeros(u32::MAX >> bit), bit);
    }
    assert_eq!(leading_zeros(0), 32);
    let mut random = Random(3);
    for i in 0..300_000 {
        let edge = |at: usize| EDGES[(i >> (4 * at)) % 16];
        let v = if i < 4096 {
            [edge(0), edge(1), edge(2)]
        } else {
            [0; 3].map(|_| random.signed(32))
        };
        let largest = |shift: u32| {
            let fits = |c: i32| (-(1i64 << 15) <= i64::from(c >> shift)) && (i64::from(c >> shift) < 1 << 15);
            v.iter().all(|c| fits(*c))
        };
        let shift = normalize_shift(v, 15);
        assert!(largest(shift), "{v:?} >> {shift}");
        assert!(
            shift == 0 || !largest(shift - 1),
            "{v:?} >> {shift}: one less would do"
        );
        let by = i as u32 % 32;
        let half = (1i64 << by) >> 1;
        assert_eq!(i64::from(round_shift(v[0], by)), (i64::from(v[0]) + half) >> by);
    }
}

/// 1 and up: small ones, each table interval's ends in each octave, powers of two and their neighbours, random ones.
fn positive() -> impl Iterator<Item = u32> {
    let mut random = Random(4);
    let small = 1..=1 << 16;
    let ends = (0..32).flat_map(|zeros| {
        (0..256u64).map(move |i| (((0x80 + i / 2) << 24) as u32 - (i % 2) as u32) >> zeros)
    });
    let powers = (0..32).flat_map(|bit| [1u32 << bit, (1u32 << bit).wrapping_sub(1), (1 << bit) + 1]);
    let any = (0..1_000_000).map(move |_| random.any_size());
    small
        .chain(ends)
        .chain(powers)
        .chain(any)
        .filter(|x| *x > 0)
        .chain([u32::MAX])
}

#[test]
fn reciprocals() {
    let mut error = Figures::default();
    for x in positive() {
        let r = recip(x);
        assert!(r.mantissa >= 1 << 31 && (32..=63).contains(&r.shift), "{x}");
        error.add(f64::from(r.mantissa) * f64::from(x) / 2f64.powi(r.shift as i32) - 1.0);
    }
    assert_eq!(recip(0), recip(1));
    error.assert(
        "recip, relative",
        Said {
            max: 3.0e-9,
            rms: 7.3e-10,
            mean: Mean::Is(-4.4e-10),
        },
    );
}

#[test]
fn quotients_by_reciprocal() {
    let mut random = Random(5);
    let (mut small, mut large) = (Figures::default(), Figures::default());
    for x in positive() {
        let r = recip(x);
        let a = random.signed(32);
        let exact = f64::from(a) / f64::from(x);
        // The most fraction bits that the product and the answer have room for.
        let room = |extra: &u32| exact.abs() * 2f64.powi(*extra as i32) < 2f64.powi(31) - 8.0;
        let extra = (0..r.shift).rev().find(room).unwrap_or(0);
        large.add(f64::from(r.times(a, extra)) - exact * 2f64.powi(extra as i32));
        if exact.abs() < 65536.0 {
            small.add(f64::from(r.times(a, 0)) - exact);
        }
    }
    small.assert(
        "Recip::times, ulp, answers under 2^16",
        Said {
            max: 1.001,
            rms: 0.65,
            mean: Mean::Is(-0.5),
        },
    );
    large.assert(
        "Recip::times, ulp, any answer",
        Said {
            max: 7.0,
            rms: 1.25,
            mean: Mean::Is(-0.42),
        },
    );
}

#[test]
fn reciprocal_roots() {
    let mut error = Figures::default();
    for x in positive() {
        let (mantissa, half) = rsqrt(x);
        assert!(mantissa >= 1 << 31 && half <= 15, "{x}");
        error.add(f64::from(mantissa) * 2f64.powi(half as i32 - 47) * f64::from(x).sqrt() - 1.0);
    }
    assert_eq!(rsqrt(0), rsqrt(1));
    error.assert(
        "rsqrt, relative",
        Said {
            max: 8.3e-9,
            rms: 1.3e-9,
            mean: Mean::Is(-7.4e-10),
        },
    );
}

#[test]
fn short_reciprocals() {
    let mut error = Figures::default();
    for b in 1 << 15..1 << 16 {
        let r = short_recip(b);
        assert!((1 << 15..=1 << 16).contains(&r), "{b}");
        error.add(f64::from(r) * f64::from(b) / 2f64.powi(31) - 1.0);
    }
    // Out of its domain it only does not fail.
    for b in [0, 1, 1 << 16, u32::MAX].into_iter().chain(positive()) {
        short_recip(b);
    }
    error.assert(
        "short_recip, relative",
        Said {
            max: 3.4e-5,
            rms: 1.6e-5,
            mean: Mean::Is(-1.42e-5),
        },
    );
}

#[test]
fn short_reciprocal_roots() {
    let mut error = Figures::default();
    for x in positive().map(|x| x.max(1)) {
        let n = x << (x.leading_zeros() & !1);
        let r = short_rsqrt(n);
        assert!(r < 1 << 16, "{n}");
        error.add(f64::from(r) * f64::from(n).sqrt() / 2f64.powi(31) - 1.0);
    }
    for n in [0, 1, (1 << 30) - 1] {
        assert!(short_rsqrt(n) < 1 << 16);
    }
    error.assert(
        "short_rsqrt, relative",
        Said {
            max: 5.5e-5,
            rms: 1.8e-5,
            mean: Mean::Is(-1.05e-5),
        },
    );
}

#[test]
fn roots_are_the_exact_floor() {
    // At each square and next to it, where the answer changes.
    for root in 0..=65535u32 {
        assert_eq!(isqrt(root * root), root);
        assert_eq!(isqrt(root * root + 2 * root), root);
        assert_eq!(isqrt(root * root + root), root);
    }
    assert_eq!(isqrt(u32::MAX), 65535);
    for x in positive() {
        assert_eq!(isqrt(x), x.isqrt());
    }
}

#[test]
fn angles() {
    let (mut sine, mut length) = (Figures::default(), Figures::default());
    let mut random = Random(6);
    let ends = (0..=16u32).flat_map(|i| [-2, -1, 0, 1, 2].map(|d| (i << 28).wrapping_add_signed(d)));
    for phase in ends.chain((0..1 << 20).map(|i| (i << 12) + (random.bits() >> 20))) {
        let turns = f64::from(phase) / 2f64.powi(32);
        let (s, c) = sin_cos(Turn::from_bits(phase));
        assert!(s.abs() <= ONE_Q16 && c.abs() <= ONE_Q16);
        let (s, c) = (f64::from(s) / 65536.0, f64::from(c) / 65536.0);
        let (exact_s, exact_c) = (turns * std::f64::consts::TAU).sin_cos();
        // Away from zero counts as positive: that is what would brighten.
        sine.add((s - exact_s) * exact_s.signum());
        sine.add((c - exact_c) * exact_c.signum());
        length.add(s.hypot(c) - 1.0);
    }
    for (quarter, exact) in [(0, (0, 1)), (1, (1, 0)), (2, (0, -1)), (3, (-1, 0))] {
        assert_eq!(
            sin_cos(Turn::from_bits(quarter << 30)),
            (exact.0 * ONE_Q16, exact.1 * ONE_Q16)
        );
    }
    sine.assert(
        "sin_cos",
        Said {
            max: 8.6e-6,
            rms: 4.5e-6,
            mean: Mean::Within(1e-7),
        },
    );
    length.assert(
        "sin_cos, length",
        Said {
            max: 1.15e-5,
            rms: 4.5e-6,
            mean: Mean::Within(1e-7),
        },
    );
}

fn value(w: Wide) -> f64 {
    f64::from(w.mantissa()) * 2f64.powi(i32::from(w.exponent()) - 15)
}

/// Mantissas at both ends of the octave and anywhere, exponents equal to far apart.
fn wide(random: &mut Random) -> Wide {
    let mantissa = match random.below(16) {
        0 => (1 << 15) + random.below(3),
        1 => (1 << 16) - 1 - random.below(3),
        _ => (1 << 15) + random.below(1 << 15),
    };
    Wide::new(mantissa, random.below(40) as i32 - 35)
}

#[test]
fn wide_numbers_round_to_nearest() {
    let mut random = Random(7);
    let mut of = [(); 8].map(|()| Figures::default());
    for _ in 0..1_000_000 {
        let (a, b) = (wide(&mut random), wide(&mut random));
        let x = random.any_size();
        let cases = [
            (Wide::new(x, -7), f64::from(x) / 128.0),
            (a * b, value(a) * value(b)),
            (a + b, value(a) + value(b)),
            (a.saturating_sub(b), value(a) - value(b)),
            (a / b, value(a) / value(b)),
            (a.recip(), 1.0 / value(a)),
            (a.sqrt(), value(a).sqrt()),
        ];
        for (figures, (is, exact)) in of.iter_mut().zip(cases) {
            if exact > 0.0 {
                assert!(is.mantissa() >= 1 << 15);
                // In steps of the exact answer's octave.
                figures.add((value(is) - exact) / 2f64.powi(exact.log2().floor() as i32 - 15));
            } else {
                assert_eq!(is, Wide::ZERO);
            }
        }
        let fraction = random.below(32) as i32 - 4;
        let exact = value(a) * 2f64.powi(fraction);
        if exact < 2f64.powi(32) {
            of[7].add(f64::from(a.to_fixed(fraction)) - exact);
        } else {
            assert_eq!(a.to_fixed(fraction), u32::MAX);
        }
        assert_eq!(a.partial_cmp(&b), value(a).partial_cmp(&value(b)));
        assert_eq!(value(a.shl(-9)), value(a) / 512.0);
    }
    let names = [
        "new",
        "mul",
        "add",
        "saturating_sub",
        "div",
        "recip",
        "sqrt",
        "to_fixed",
    ];
    for (figures, name) in of.iter().zip(names) {
        figures.assert(
            &format!("Wide {name}, ulp"),
            Said {
                max: 0.501,
                rms: 0.3,
                mean: Mean::Within(0.035),
            },
        );
    }
}

#[test]
fn wide_numbers_at_their_ends() {
    let largest = Wide::new(0xffff, i32::from(i16::MAX) - 15);
    let smallest = Wide::new(1, i32::from(i16::MIN));
    for (name, is, expected) in [
        ("too large", Wide::new(1, 40_000), largest),
        ("too small", Wide::new(1, -40_000), Wide::ZERO),
        ("product too large", largest * largest, largest),
        ("product too small", smallest * smallest, Wide::ZERO),
        ("sum too large", largest + largest, largest),
        ("quotient too large", largest / smallest, largest),
        ("quotient too small", smallest / largest, Wide::ZERO),
        ("by nothing", Wide::ONE / Wide::ZERO, largest),
        ("nothing by nothing", Wide::ZERO / Wide::ZERO, Wide::ZERO),
        ("reciprocal of nothing", Wide::ZERO.recip(), largest),
        ("root of nothing", Wide::ZERO.sqrt(), Wide::ZERO),
        ("sum with nothing", Wide::ZERO + smallest, smallest),
        (
            "difference with nothing",
            smallest.saturating_sub(Wide::ZERO),
            smallest,
        ),
        (
            "difference of equals",
            largest.saturating_sub(largest),
            Wide::ZERO,
        ),
        ("rounded up an octave", Wide::new(0xffff_8000, -32), Wide::ONE),
        ("negative", Wide::from_q16(-1), Wide::ZERO),
        ("moved too far", smallest.shl(-1), Wide::ZERO),
    ] {
        assert_eq!(is, expected, "{name}");
    }
    assert_eq!(smallest.sqrt(), Wide::new(1, -16384));
    assert_eq!(
        [largest.to_fixed(0), smallest.to_fixed(0), Wide::ONE.to_fixed(31)],
        [u32::MAX, 0, 1 << 31]
    );
    assert_eq!(
        Wide::PI,
        Wide::new((std::f64::consts::PI * 2f64.powi(29)).round() as u32, -29)
    );
    assert_eq!(
        Wide::INV_PI,
        Wide::new((std::f64::consts::FRAC_1_PI * 2f64.powi(29)).round() as u32, -29)
    );
}

#[test]
fn logarithms_of_shares() {
    let mut random = Random(31);
    let mut of = Figures::default();
    let edges = (0..32).flat_map(|bit| [1u32 << bit, (1 << bit) | 1, u32::MAX >> bit, (1 << bit) - 1]);
    let anywhere = (0..1_000_000).map(|_| random.any_size());
    for x in edges.chain(anywhere) {
        let exact = 32.0 - f64::from(x.max(1)).log2();
        of.add(f64::from(neg_log2(x)) - exact * 2f64.powi(26));
    }
    of.assert(
        "neg_log2, ulp",
        Said {
            max: 0.63,
            rms: 0.29,
            mean: Mean::Is(0.03),
        },
    );
}

#[test]
fn powers_of_one_half() {
    let mut random = Random(32);
    let mut of = Figures::default();
    let edges = (0..64).flat_map(|k| {
        [
            k << 26,
            (k << 26) | 1,
            (k << 26) | ((1 << 26) - 1),
            (k << 26) | (1 << 20),
        ]
    });
    let anywhere = (0..1_000_000).map(|_| random.bits());
    for x in edges.chain(anywhere) {
        let (mantissa, exponent) = exp2_neg(x);
        assert!(mantissa >= (1 << 31) - 1 && exponent < 64);
        let exact = (-f64::from(x) / 2f64.powi(26)).exp2();
        of.add(f64::from(mantissa) * 2f64.powi(-32 - exponent as i32) / exact - 1.0);
    }
    of.assert(
        "exp2_neg",
        Said {
            max: 4.8e-10,
            rms: 1.5e-10,
            mean: Mean::Within(1e-11),
        },
    );
}

#[test]
fn powers_of_shares() {
    let mut random = Random(33);
    let (mut all, mut small) = (Figures::default(), Figures::default());
    for _ in 0..1_000_000 {
        // Exponents of all sizes, and bases that keep something with them.
        let n = random.any_size() >> 2;
        let exact_n = f64::from(n) / 65536.0;
        let x = (-32.0 * f64::from(random.bits()) / 2f64.powi(32) / exact_n).exp2() * 2f64.powi(32);
        let x = (x as u32).max(1);
        let exact = (f64::from(x) / 2f64.powi(32)).powf(exact_n);
        if exact < 2f64.powi(-32) {
            continue;
        }
        let error = value(pow(x, n)) / exact - 1.0;
        all.add(error);
        if exact_n <= 30.0 {
            small.add(error);
        }
    }
    let said = |max, rms| Said {
        max,
        rms,
        mean: Mean::Within(1e-6),
    };
    all.assert("pow", said(1.1e-4, 1e-5));
    small.assert("pow, exponents up to 30", said(1.6e-5, 6.5e-6));
    assert_eq!([pow(0, 0), pow(7, 0), pow(u32::MAX, 1 << 30)], [Wide::ONE; 3]);
    assert_eq!([pow(0, 3 << 16), pow(1 << 31, 100 << 16)], [Wide::ZERO; 2]);
    assert_eq!(pow(1 << 30, 3 << 15), Wide::new(1, -3));
}

#[test]
fn angles_of_cosines() {
    let mut of = Figures::default();
    for cos in 0..=65536 {
        let exact = (f64::from(cos) / 65536.0).acos() / std::f64::consts::FRAC_PI_2;
        of.add(f64::from(acos(cos)) / 65536.0 - exact);
    }
    of.assert(
        "acos, quarter turns",
        Said {
            max: 1.8e-5,
            rms: 5.9e-6,
            mean: Mean::Is(2.6e-6),
        },
    );
    assert_eq!(
        [acos(-5), acos(0), acos(65536), acos(70_000)],
        [65536, 65536, 0, 0]
    );
}

#[test]
fn ratios() {
    let mut error = Figures::default();
    let mut random = Random(41);
    for _ in 0..1_000_000 {
        let (x, y) = (random.any_size(), random.any_size());
        let (a, b) = (x.min(y), x.max(y));
        error.add(f64::from(ratio(a, b)) - f64::from(a) / f64::from(b) * 2f64.powi(32));
    }
    for x in [1, 2, 3, 77, 1 << 16, u32::MAX] {
        assert!(ratio(x, x) >= u32::MAX - 16);
        assert_eq!(ratio(0, x), 0);
    }
    assert_eq!(ratio(0, 0), 0);
    error.assert(
        "ratio, 2^-32",
        Said {
            max: 14.0,
            rms: 1.5,
            mean: Mean::Is(-1.2),
        },
    );
}

#[test]
fn angles_of_vectors() {
    let mut error = Figures::default();
    let mut random = Random(42);
    let mut hold = |y: i32, x: i32| {
        let exact = f64::from(y).atan2(f64::from(x)) / std::f64::consts::TAU;
        let found = f64::from(atan2(y, x).to_bits()) / 2f64.powi(32);
        // The short way around.
        error.add((found - exact + 1.5).rem_euclid(1.0) - 0.5);
    };
    for y in EDGES {
        for x in EDGES {
            hold(y, x);
        }
    }
    for _ in 0..1_000_000 {
        hold(random.signed(32), random.signed(32));
        // Of unit vectors: every angle alike.
        let (sin, cos) = sin_cos(Turn::from_bits(random.bits()));
        hold(sin, cos);
    }
    assert_eq!(atan2(0, 0), Turn::ZERO);
    error.assert(
        "atan2, turns",
        Said {
            max: 3.0e-7,
            rms: 1.9e-7,
            mean: Mean::Within(2e-9),
        },
    );
}
