//! Pearson's chi-square test of each `sample` against the density that `eval` tells.

use crate::rig::{Axes, Named, Random, Vec3, View, dot, smooth_materials, to_dir, to_f64, view, wide};
use std::f64::consts::{PI, TAU};

const RINGS: usize = 14;
const SECTORS: usize = 10;
/// Points a side at which a bin's density is taken.
const FINE: usize = 16;
const SAMPLES: usize = 40_000;
const SIGNIFICANCE: f64 = 0.01;

/// Rings and sectors about a direction, narrow where the lobe is.
struct Bins {
    axes: Axes,
    width: f64,
}

impl Bins {
    /// Where the lobe ends, more or less: half of the rings are within.
    fn edge(&self) -> f64 {
        (8.0 * self.width).min(0.5 * PI)
    }

    fn theta(&self, ring: f64) -> f64 {
        let t = 2.0 * ring / RINGS as f64;
        if t <= 1.0 {
            self.edge() * t.powf(1.5)
        } else {
            self.edge() * (PI / self.edge()).powf(t - 1.0)
        }
    }

    fn place(&self, v: Vec3) -> usize {
        let [x, y, z] = self.axes.to_local(v);
        let theta = x.hypot(y).atan2(z);
        let t = if theta <= self.edge() {
            (theta / self.edge()).powf(1.0 / 1.5)
        } else {
            1.0 + (theta / self.edge()).ln() / (PI / self.edge()).ln()
        };
        let ring = 0.5 * t * RINGS as f64;
        let sector = y.atan2(x).rem_euclid(TAU) / TAU * SECTORS as f64;
        (ring as usize).min(RINGS - 1) * SECTORS + (sector as usize).min(SECTORS - 1)
    }

    /// Adds the density's integral over each bin, on the side of the surface that is asked for.
    fn integrate(&self, named: &Named, view: &View, above: bool, into: &mut [f64]) {
        for (bin, sum) in into.iter_mut().enumerate() {
            let (ring, sector) = (bin / SECTORS, bin % SECTORS);
            for i in 0..FINE {
                let part = |i: f64| self.theta(ring as f64 + i / FINE as f64);
                let (low, mid, high) = (part(i as f64), part(i as f64 + 0.5), part(i as f64 + 1.0));
                let solid = (low.cos() - high.cos()) * TAU / (SECTORS * FINE) as f64;
                for j in 0..FINE {
                    let phi = TAU * (sector as f64 + (j as f64 + 0.5) / FINE as f64) / SECTORS as f64;
                    let wi = self.axes.at(mid, phi);
                    if (dot(wi, view.axes.0[2]) > 0.0) != above {
                        continue;
                    }
                    let pdf = named
                        .material
                        .eval(&view.local, to_dir(wi))
                        .map(|(_, pdf)| wide(pdf));
                    *sum += pdf.unwrap_or(0.0) * solid;
                }
            }
        }
    }
}

/// Where the middle of the lobe is, on the eye's side and on the other.
fn lobes(named: &Named, view: &View) -> [Vec3; 2] {
    let n = view.axes.0[2];
    let wo = view.wo;
    let cos = dot(wo, n);
    let (n, cos, eta) = if cos > 0.0 {
        (n, cos, named.eta)
    } else {
        (n.map(|c| -c), -cos, 1.0 / named.eta)
    };
    if named.width == 1.0 {
        return [n, n.map(|c| -c)];
    }
    let mirrored = [0, 1, 2].map(|i| 2.0 * cos * n[i] - wo[i]);
    let cos_t = (1.0 - (1.0 - cos * cos) / (eta * eta)).max(0.0).sqrt();
    let refracted = [0, 1, 2].map(|i| (cos / eta - cos_t) * n[i] - wo[i] / eta);
    [mirrored, refracted]
}

/// Probability of a chi-square above `x` with `freedom` degrees: the incomplete gamma function, by its series or by its
/// continued fraction (Press et al., Numerical Recipes, section 6.2).
fn survival(x: f64, freedom: f64) -> f64 {
    let (a, x) = (0.5 * freedom, 0.5 * x);
    // Stirling's series with three terms; a is 2 or more.
    let ln_gamma = (a - 0.5) * a.ln() - a + 0.5 * TAU.ln() + 1.0 / (12.0 * a) - 1.0 / (360.0 * a.powi(3));
    let front = (a * x.ln() - x - ln_gamma).exp();
    if x < a + 1.0 {
        let (mut term, mut sum, mut k) = (1.0 / a, 1.0 / a, a);
        while term > sum * 1e-12 {
            k += 1.0;
            term *= x / k;
            sum += term;
        }
        return 1.0 - front * sum;
    }
    let (mut b, mut c) = (x + 1.0 - a, 1e300);
    let mut d = 1.0 / b;
    let mut h = d;
    for i in 1..10_000 {
        let an = -f64::from(i) * (f64::from(i) - a);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        h *= d * c;
        if (d * c - 1.0).abs() < 1e-12 {
            break;
        }
    }
    front * h
}

/// The probability that the samples differ as much as they do from the density by chance; and the density's integral.
fn test(named: &Named, degrees: f64, samples: usize) -> (f64, f64) {
    let view = view(degrees);
    let up = if degrees < 90.0 { 1.0 } else { -1.0 };
    let [near, far] = lobes(named, &view);
    // A facet that turns by an angle turns what it refracts by less.
    let bins = [(near, 1.0), (far, (1.0 - 1.0 / named.eta).abs().min(1.0))].map(|(axis, by)| Bins {
        axes: Axes::about(axis),
        width: named.width * by,
    });
    const COUNT: usize = RINGS * SECTORS;
    let mut expected = vec![0.0; 2 * COUNT];
    let (near, far) = expected.split_at_mut(COUNT);
    bins[0].integrate(named, &view, up > 0.0, near);
    if named.eta != 1.0 {
        bins[1].integrate(named, &view, up < 0.0, far);
    }
    let total: f64 = expected.iter().sum();
    // The last is for light that is absorbed.
    expected.push((1.0 - total).max(0.0));
    let mut seen = vec![0u32; 2 * COUNT + 1];
    let mut random = Random(degrees.to_bits() ^ named.name.len() as u64);
    for _ in 0..samples {
        let place = match random.sample(&named.material, &view.local) {
            None => 2 * COUNT,
            Some(sample) => {
                let wi = to_f64(sample.wi);
                let side = usize::from(up * dot(wi, view.axes.0[2]) < 0.0);
                side * COUNT + bins[side].place(wi)
            }
        };
        seen[place] += 1;
    }
    // Bins with few samples are taken together.
    let (mut chi2, mut freedom) = (0.0, -1.0);
    let mut order: Vec<usize> = (0..expected.len()).collect();
    order.sort_by(|a, b| expected[*a].total_cmp(&expected[*b]));
    let (mut pool, mut pooled) = (0.0, 0.0);
    for bin in order {
        pool += expected[bin] * samples as f64;
        pooled += f64::from(seen[bin]);
        if pool > 10.0 {
            chi2 += (pooled - pool) * (pooled - pool) / pool;
            freedom += 1.0;
            (pool, pooled) = (0.0, 0.0);
        }
    }
    assert!(freedom > 20.0, "{}: too few bins", named.name);
    (survival(chi2, freedom), total)
}

const ANGLES: [f64; 3] = [0.0, 50.0, 80.0];

#[test]
fn samples_follow_the_density() {
    let materials = smooth_materials();
    let mut cases: Vec<(&Named, f64)> = Vec::new();
    for named in &materials {
        cases.extend(ANGLES.map(|angle| (named, angle)));
        if named.eta != 1.0 {
            cases.push((named, 130.0));
        }
    }
    let least = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / cases.len() as f64);
    let mut failed = String::new();
    for (named, angle) in cases {
        let (p, total) = test(named, angle, SAMPLES);
        if p < least || total > 1.005 {
            failed += &format!("{} at {angle}°: p {p:.2e}, integral {total:.4}\n", named.name);
        }
    }
    assert!(failed.is_empty(), "\n{failed}");
}

#[test]
fn chi_square_has_the_quantiles_of_tables() {
    // Abramowitz and Stegun, table 26.8.
    for (freedom, x, q) in [
        (30.0, 50.892, 0.01),
        (30.0, 20.599, 0.9),
        (100.0, 124.342, 0.05),
        (5.0, 16.75, 0.005),
    ] {
        assert!((survival(x, freedom) / q - 1.0).abs() < 1e-3, "{freedom} {x}");
    }
}
