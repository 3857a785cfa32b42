//! Radiance against f64: what its documentation says, held both ways.

use crate::figures::{Figures, Mean, Random, Said};
use microlux::color::{Albedo, Radiance, mean_q32};
use microlux::num::{Share, Wide};

fn values(r: Radiance) -> [f64; 3] {
    let (mantissa, exponent) = r.to_parts();
    mantissa.map(|m| f64::from(m) * 2f64.powi(i32::from(exponent) - 15))
}

fn largest(v: [f64; 3]) -> f64 {
    v[0].max(v[1]).max(v[2])
}

fn value(w: Wide) -> f64 {
    f64::from(w.mantissa()) * 2f64.powi(i32::from(w.exponent()) - 15)
}

/// Colours of channels near and far apart, pure ones too.
fn radiance(random: &mut Random) -> Radiance {
    let shape = random.below(4);
    let bits = [0, 1, 2].map(|i| match shape {
        0 => random.any_size() >> 8,
        1 if i == 1 => random.any_size(),
        1 => 0,
        _ => random.bits() >> 4,
    });
    Radiance::from_bits(bits, random.below(24) as i32 - 40)
}

#[test]
fn steps_are_rounded_to_nearest() {
    let mut random = Random(21);
    let mut of = [(); 6].map(|()| Figures::default());
    for _ in 0..400_000 {
        let (a, b) = (radiance(&mut random), radiance(&mut random));
        let (x, y) = (values(a), values(b));
        let share = [0; 3].map(|_| Share::from_bits(random.below(0x8001) as u16));
        let w = Wide::new(random.any_size(), -20);
        let bits = [0; 3].map(|_| random.any_size());
        let q16 = random.signed(32);
        let cases = [
            (
                Radiance::from_bits(bits, -16),
                bits.map(|b| f64::from(b) / 65536.0),
            ),
            (a.add(b), [0, 1, 2].map(|i| x[i] + y[i])),
            (a.mul(b), [0, 1, 2].map(|i| x[i] * y[i])),
            (
                a.mul_albedo(Albedo(share)),
                [0, 1, 2].map(|i| x[i] * share[i].to_num::<f64>()),
            ),
            (a.scale(w), x.map(|c| c * value(w))),
            (a.scale_q16(q16), x.map(|c| c * value(Wide::from_q16(q16)))),
        ];
        for (figures, (is, exact)) in of.iter_mut().zip(cases) {
            let most = largest(exact);
            if most == 0.0 {
                assert!(is.is_black());
                continue;
            }
            let is = values(is);
            for i in 0..3 {
                figures.add((is[i] - exact[i]) / most);
            }
        }
    }
    let names = ["from_bits", "add", "mul", "mul_albedo", "scale", "scale_q16"];
    for (figures, name) in of.iter().zip(names) {
        figures.assert(
            name,
            Said {
                max: 1.53e-5,
                rms: 5.7e-6,
                mean: Mean::Within(4e-7),
            },
        );
    }
}

#[test]
fn sums_and_means() {
    let mut random = Random(22);
    let [mut q32, mut mean] = [(); 2].map(|()| Figures::default());
    for _ in 0..200_000 {
        let a = radiance(&mut random);
        for (is, exact) in a.to_q32().into_iter().zip(values(a)) {
            q32.add(is as f64 - exact * 2f64.powi(32));
        }
        let bits = 1 + random.below(16);
        let count = 1 + random.below(1 << bits);
        let down = random.below(64);
        let sum = [0; 3].map(|_| ((u64::from(random.bits()) << 32) | u64::from(random.bits())) >> down);
        let exact = sum.map(|s| s as f64 / 2f64.powi(32) / f64::from(count));
        let is = values(mean_q32(sum, count));
        let most = largest(exact);
        if most == 0.0 {
            continue;
        }
        for i in 0..3 {
            mean.add((is[i] - exact[i]) / most);
        }
    }
    q32.assert(
        "to_q32, ulp",
        Said {
            max: 0.5,
            rms: 0.07,
            mean: Mean::Within(0.01),
        },
    );
    mean.assert(
        "mean_q32",
        Said {
            max: 1.53e-5,
            rms: 6.3e-6,
            mean: Mean::Within(1e-7),
        },
    );
}
