//! Values and densities of the other models against their formulas in f64, over all pairs of directions.

use crate::rig::{
    Axes, GOLD, Named, Random, Vec3, dot, glass, metal, phong, rgb, share, to_dir, to_f64, view_at, wide,
};
use microlux::material::{Index, fresnel_conductor};
use microlux::num::Metres;
use std::f64::consts::PI;

/// What was wrong at most and on average, as a share.
#[derive(Default)]
struct Errors {
    worst: f64,
    squares: f64,
    sum: f64,
    count: f64,
}

impl Errors {
    fn add(&mut self, is: f64, exact: f64) {
        let error = is / exact - 1.0;
        self.worst = self.worst.max(error.abs());
        self.squares += error * error;
        self.sum += error;
        self.count += 1.0;
    }

    fn assert(&self, what: &str, allowed: f64) {
        let (mean, rms) = (self.sum / self.count, (self.squares / self.count).sqrt());
        println!(
            "{what}: worst {:.1e}, RMS {rms:.1e}, mean {mean:+.1e}, {} pairs",
            self.worst, self.count
        );
        assert!(self.count > 500.0, "{what}: {} pairs", self.count);
        assert!(self.worst < allowed, "{what}: worst {:.1e}", self.worst);
        assert!(rms < 0.2 * allowed, "{what}: RMS {rms:.1e}");
        assert!(mean.abs() < 0.02 * allowed + 3e-5, "{what}: mean {mean:+.1e}");
    }
}

/// Cosines of a pair of directions, all f64 of the integers the core sees.
struct Pair {
    o: f64,
    i: f64,
    /// Between them.
    oi: f64,
}

/// Evaluates at pairs of directions, half of them in the lobe, and compares with `exact`: (f cos, density).
fn compare(
    named: &Named,
    inside: bool,
    errors: &mut [Errors; 2],
    exact: impl Fn(&Pair) -> Option<(Vec3, f64)>,
) {
    let mut random = Random(17);
    for degrees in [1.0, 25.0, 50.0, 70.0, 84.0] {
        for _ in 0..600 {
            let view = view_at(
                if inside { 180.0 - degrees } else { degrees },
                6.0 * random.next(),
            );
            let normal = view.axes.0[2];
            let wi = match random.sample(&named.material, &view.local) {
                Some(sample) if random.next() < 0.5 => sample.wi,
                _ => to_dir([0; 3].map(|_| random.next() - 0.5)),
            };
            let unit = |v: Vec3| {
                let length = dot(v, v).sqrt();
                v.map(|c| c / length)
            };
            let (wo, d) = (unit(view.wo), unit(to_f64(wi)));
            let pair = Pair {
                o: dot(wo, normal),
                i: dot(d, normal),
                oi: dot(wo, d),
            };
            // At the horizon the share is one of rounding.
            if pair.i.abs() < 0.02 {
                continue;
            }
            let (Some((f, pdf)), Some((value, density))) =
                (named.material.eval(&view.local, wi), exact(&pair))
            else {
                continue;
            };
            // Lobes' far tails are no light.
            if density < 1e-6 {
                continue;
            }
            errors[1].add(wide(pdf), density);
            for (is, exact) in rgb(f).into_iter().zip(value) {
                if exact > 1e-7 {
                    errors[0].add(is, exact);
                }
            }
        }
    }
}

#[test]
fn blinn_phong_is_its_formula() {
    for normalized in [true, false] {
        for n in [0.0, 1.0, 12.5, 200.0, 2000.0] {
            let (kd, ks) = (0.4, 0.5);
            let named = phong(kd, ks, n, normalized);
            let mut errors = <[Errors; 2]>::default();
            // The shares of samples: as much as each part reflects.
            let weight = if normalized { ks } else { ks * 8.0 / (n + 8.0) };
            let lobe = (weight / (weight + kd)).clamp(1.0 / 32.0, 31.0 / 32.0);
            compare(&named, false, &mut errors, |pair| {
                if pair.i <= 0.0 {
                    return None;
                }
                let wo_h = ((1.0 + pair.oi) / 2.0).sqrt();
                let n_h = (pair.o + pair.i) / (2.0 * wo_h);
                let power = n_h.min(1.0).powf(n);
                let specular = if normalized {
                    ks * (n + 8.0) / (8.0 * PI) * power * pair.i
                } else {
                    ks / PI * power
                };
                let pdf = (1.0 - lobe) * pair.i / PI + lobe * (n + 1.0) / (2.0 * PI) * power / (4.0 * wo_h);
                Some(([kd / PI * pair.i + specular; 3], pdf))
            });
            // cos^n of a direction that is rounded to 2^-16.
            let allowed = 5e-4 + 3e-4 * n.sqrt();
            errors[0].assert(&named.name, allowed);
            errors[1].assert(&named.name, allowed);
        }
    }
}

/// Fresnel's formulas for a metal with complex arithmetic, written out: unpolarised.
fn fresnel_metal(cos: f64, eta: f64, k: f64) -> f64 {
    // cos θt of the complex refractive index m: √(1 − sin²/m²); all as (re, im).
    let mul = |a: (f64, f64), b: (f64, f64)| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    let div = |a: (f64, f64), b: (f64, f64)| {
        let n = b.0 * b.0 + b.1 * b.1;
        ((a.0 * b.0 + a.1 * b.1) / n, (a.1 * b.0 - a.0 * b.1) / n)
    };
    let m = (eta, k);
    let sin2 = 1.0 - cos * cos;
    let q = div((sin2, 0.0), mul(m, m));
    let t = (1.0 - q.0, -q.1);
    let r = t.0.hypot(t.1);
    let root = (
        ((r + t.0) / 2.0).max(0.0).sqrt(),
        ((r - t.0) / 2.0).max(0.0).sqrt().copysign(t.1),
    );
    let mt = mul(m, root);
    let s = div((cos - mt.0, -mt.1), (cos + mt.0, mt.1));
    let mc = (m.0 * cos, m.1 * cos);
    let p = div((mc.0 - root.0, mc.1 - root.1), (mc.0 + root.0, mc.1 + root.1));
    (s.0 * s.0 + s.1 * s.1 + p.0 * p.0 + p.1 * p.1) / 2.0
}

#[test]
fn the_reflectance_of_metals_is_fresnel_s() {
    let (mut max, mut squares, mut sum, mut count) = (0.0f64, 0.0, 0.0, 0.0);
    for eta in [0.05, 0.14, 0.5, 1.0, 1.5, 2.9, 4.0] {
        for k in [0.05, 0.5, 1.6, 3.0, 6.7, 10.0] {
            let (eta, k) = (Index::from_num(eta), Index::from_num(k));
            for cos in (0..=65536).step_by(97) {
                let exact = fresnel_metal(f64::from(cos) / 65536.0, eta.to_num(), k.to_num());
                let error = f64::from(fresnel_conductor(cos, eta, k)) / 65536.0 - exact;
                max = max.max(error.abs());
                squares += error * error;
                sum += error;
                count += 1.0;
            }
        }
    }
    let (rms, mean) = (f64::sqrt(squares / count), sum / count);
    println!("Fresnel of metals: max {max:.2e}, RMS {rms:.2e}, mean {mean:+.2e}");
    assert!((4e-5..7.1e-5).contains(&max), "{max:e}");
    assert!(
        (8e-6..1.3e-5).contains(&rms) && mean.abs() < 5e-6,
        "{rms:e} {mean:e}"
    );
    // Nothing reflects more than all, whatever the numbers.
    for bits in [0u16, 1, 1 << 12, u16::MAX] {
        for other in [0u16, 1, 1 << 12, u16::MAX] {
            for cos in [0, 1, 30_000, 65_535, 65_536, 65_540] {
                let share = fresnel_conductor(cos, Index::from_bits(bits), Index::from_bits(other));
                assert!((0..=65_536).contains(&share));
            }
        }
    }
}

/// GGX's D by the angle of the facet, as Walter et al. write it (equation 33).
fn ggx(cos: f64, alpha: f64) -> f64 {
    let tan2 = (1.0 - cos * cos).max(0.0) / (cos * cos);
    alpha * alpha / (PI * cos.powi(4) * (alpha * alpha + tan2).powi(2))
}

/// Smith's G1 (equation 34).
fn smith(cos: f64, alpha: f64) -> f64 {
    let tan2 = (1.0 - cos * cos) / (cos * cos);
    2.0 / (1.0 + (1.0 + alpha * alpha * tan2).sqrt())
}

fn held(alpha: f64) -> f64 {
    f64::from(share(alpha).to_bits()) / 32768.0
}

#[test]
fn rough_metal_is_its_formula() {
    for alpha in [0.02, 0.1, 0.35, 0.8, 1.0] {
        let named = metal(alpha, true);
        let alpha = held(alpha);
        let mut errors = <[Errors; 2]>::default();
        compare(&named, false, &mut errors, |pair| {
            if pair.i <= 0.0 {
                return None;
            }
            let wo_h = ((1.0 + pair.oi) / 2.0).sqrt();
            let d = ggx((pair.o + pair.i) / (2.0 * wo_h), alpha);
            let pdf = d * smith(pair.o, alpha) / (4.0 * pair.o);
            let channel = |c: usize| {
                let [eta, k] = GOLD.map(|of| Index::from_num(of[c]).to_num());
                fresnel_metal(wo_h, eta, k) * pdf * smith(pair.i, alpha)
            };
            Some(([0, 1, 2].map(channel), pdf))
        });
        // D moves by its share of the lobe's width for each rounding of a direction.
        let allowed = 1e-3 + 2e-4 / alpha;
        errors[0].assert(&named.name, allowed);
        errors[1].assert(&named.name, allowed);
    }
}

/// Fresnel's formulas for glass; `eta` beyond over here.
fn fresnel_glass(cos: f64, eta: f64) -> f64 {
    let sin2 = (1.0 - cos * cos) / (eta * eta);
    if sin2 >= 1.0 {
        return 1.0;
    }
    let t = (1.0 - sin2).sqrt();
    let s = (cos - eta * t) / (cos + eta * t);
    let p = (eta * cos - t) / (eta * cos + t);
    (s * s + p * p) / 2.0
}

#[test]
fn rough_glass_is_its_formula_on_both_sides() {
    for alpha in [0.05, 0.2, 0.7] {
        for (eta, inside) in [
            (1.5, false),
            (1.5, true),
            (2.4, false),
            (0.75, false),
            (1.1, true),
        ] {
            let named = glass(alpha, eta);
            // As the core holds it: its reciprocal is rounded down.
            let bits = f64::from(Metres::from_num(eta).to_bits());
            let bits = if inside {
                (2f64.powi(32) / bits).floor()
            } else {
                bits
            };
            let eta = bits / 65536.0;
            let alpha = held(alpha);
            let mut errors = <[Errors; 2]>::default();
            compare(&named, inside, &mut errors, |pair| {
                let turn = if inside { -1.0 } else { 1.0 };
                let (o, i) = (turn * pair.o, turn * pair.i);
                if i > 0.0 {
                    let wo_h = ((1.0 + pair.oi) / 2.0).sqrt();
                    let f = fresnel_glass(wo_h, eta);
                    let cos2_t = 1.0 - (1.0 - wo_h * wo_h) / (eta * eta);
                    // It has 16 bits: of little, few are left; and next to total reflection it is steep.
                    if f < 0.02 || (0.0..0.01).contains(&cos2_t) {
                        return None;
                    }
                    let d = ggx((o + i) / (2.0 * wo_h), alpha);
                    let pdf = f * d * smith(o, alpha) / (4.0 * o);
                    return Some(([pdf * smith(i, alpha); 3], pdf));
                }
                // Walter et al., equations 16, 17, 21: with refractive indices 1 and η.
                let length = (1.0 + 2.0 * eta * pair.oi + eta * eta).sqrt();
                let side = (o + eta * i).signum();
                let (wo_h, wi_h) = (
                    side * (1.0 + eta * pair.oi) / length,
                    side * (pair.oi + eta) / length,
                );
                let h = side * (o + eta * i) / length;
                if wo_h <= 0.1 || wi_h >= -0.1 || h <= 0.0 {
                    return None;
                }
                let f = 1.0 - fresnel_glass(wo_h, eta);
                let (d, jacobian) = (
                    ggx(h, alpha),
                    eta * eta * wi_h.abs() / (wo_h + eta * wi_h).powi(2),
                );
                let pdf = f * d * smith(o, alpha) * wo_h / o * jacobian;
                // Radiance: less by the square of the index.
                Some(([pdf * smith(-i, alpha) / (eta * eta); 3], pdf))
            });
            let allowed = 4e-3 + 6e-4 / (alpha * (eta - 1.0).abs()).sqrt();
            errors[0].assert(&named.name, allowed);
            errors[1].assert(&named.name, allowed);
        }
    }
}

/// The rig itself: axes at right angles, in the right order.
#[test]
fn axes_are_axes() {
    for v in [[1.0, 2.0, 3.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]] {
        let Axes([s, t, n]) = Axes::about(v);
        assert!(dot(s, t).abs() < 1e-12 && dot(t, n).abs() < 1e-12 && dot(n, s).abs() < 1e-12);
        assert!(
            s[0] * (t[1] * n[2] - t[2] * n[1])
                + s[1] * (t[2] * n[0] - t[0] * n[2])
                + s[2] * (t[0] * n[1] - t[1] * n[0])
                > 0.9
        );
    }
}
