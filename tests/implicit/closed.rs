//! Hits against closed forms, which march nowhere: the torus's quartic, and quadratics for all that is made of balls,
//! cylinders and slabs.

use crate::exact::*;
use crate::hits::{SIZES, ray, rays};
use microlux::geom::{Dir, FAR, Point, Ray};
use microlux::shape::{Blob, Capsule, Implicit, Metaballs, RoundedBox, SmoothUnion, Torus};

/// Real roots between two places of c₀ + c₁ t + …, ascending: between those of the derivative there is one each or none.
fn roots(c: &[f64], low: f64, high: f64) -> Vec<f64> {
    if c.len() < 2 {
        return Vec::new();
    }
    let value = |t: f64| c.iter().rev().fold(0.0, |sum, c| sum * t + c);
    let derivative: Vec<f64> = (1..c.len()).map(|i| i as f64 * c[i]).collect();
    let mut ends = vec![low];
    ends.extend(roots(&derivative, low, high));
    ends.push(high);
    let between = |ends: &[f64]| {
        let (mut a, mut b) = (ends[0], ends[1]);
        let below = value(a) < 0.0;
        if below == (value(b) < 0.0) {
            return None;
        }
        for _ in 0..100 {
            let middle = 0.5 * (a + b);
            if (value(middle) < 0.0) == below {
                a = middle;
            } else {
                b = middle;
            }
        }
        Some(0.5 * (a + b))
    };
    ends.windows(2).filter_map(between).collect()
}

/// Where a line first has a t² + 2 b t + c < 0.
fn entry(a: f64, b: f64, c: f64) -> Option<f64> {
    let d = b * b - a * c;
    (d > 0.0 && a > 0.0).then(|| (-b - d.sqrt()) / a)
}

fn ball(o: Vec3, d: Vec3, center: Vec3, radius: f64) -> Option<f64> {
    let v = sub(o, center);
    entry(dot(d, d), dot(v, d), dot(v, v) - radius * radius)
}

fn least(ways: impl IntoIterator<Item = Option<f64>>) -> Option<f64> {
    ways.into_iter().flatten().min_by(f64::total_cmp)
}

fn capsule(o: Vec3, d: Vec3, [a, b]: [Vec3; 2], radius: f64) -> Option<f64> {
    let ends = least([ball(o, d, a, radius), ball(o, d, b, radius)]);
    let length = norm(sub(b, a));
    if length == 0.0 {
        return ends;
    }
    let axis = unit(sub(b, a));
    let v = sub(o, a);
    let (across, flat) = (along(v, axis, -dot(v, axis)), along(d, axis, -dot(d, axis)));
    let side = entry(
        dot(flat, flat),
        dot(across, flat),
        dot(across, across) - radius * radius,
    );
    let side = side.filter(|t| (0.0..=length).contains(&dot(along(v, d, *t), axis)));
    least([ends, side])
}

fn slabs(o: Vec3, d: Vec3, half: Vec3) -> Option<f64> {
    let (mut enter, mut leave) = (f64::MIN, f64::MAX);
    for i in 0..3 {
        let [a, b] = [-half[i], half[i]].map(|side| (side - o[i]) / d[i]);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    (enter < leave).then_some(enter)
}

/// Three boxes, each as long as the whole along one axis, and capsules along the twelve edges of the inner one.
fn rounded_box(o: Vec3, d: Vec3, half: Vec3, radius: f64) -> Option<f64> {
    let inner = half.map(|h| h - radius);
    let plates = (0..3).map(|i| {
        let mut plate = inner;
        plate[i] = half[i];
        slabs(o, d, plate)
    });
    let edges = (0..12).map(|edge: usize| {
        let (axis, signs) = (edge % 3, edge / 3);
        let mut a = inner;
        a[(axis + 1) % 3] *= [-1.0, 1.0][signs % 2];
        a[(axis + 2) % 3] *= [-1.0, 1.0][signs / 2];
        let mut b = a;
        b[axis] = -a[axis];
        capsule(o, d, [a, b], radius)
    });
    least(plates.chain(edges))
}

/// Distance to the first hit from outside of it; everything about the point nearest to its middle, in its own size.
fn closed(case: &Case, ray: &Ray) -> Option<f64> {
    let (middle, size) = case.ball();
    let (origin, d) = (point(ray.origin), dir(ray.dir));
    let t0 = dot(sub(middle, origin), d) / dot(d, d);
    let near = along(origin, d, t0);
    let to = |p: Point| scaled(sub(near, point(p)), 1.0 / size);
    let length = |units: i32| f64::from(units) / size;
    let t = match case.solid {
        Implicit::Torus(Torus {
            center,
            axis,
            major,
            minor,
            ..
        }) => {
            let (v, n) = (to(center), unit(dir(axis)));
            let (major, minor) = (length(major), length(minor));
            // |p|² and h as polynomials; (|p|² + R² − r²)² = 4 R² (|p|² − h²).
            let p2 = [dot(v, v), 2.0 * dot(v, d), dot(d, d)];
            let (h, dh) = (dot(v, n), dot(d, n));
            let h2 = [h * h, 2.0 * h * dh, dh * dh];
            let s = [p2[0] + major * major - minor * minor, p2[1], p2[2]];
            let mut quartic = [
                s[0] * s[0],
                2.0 * s[0] * s[1],
                s[1] * s[1] + 2.0 * s[0] * s[2],
                2.0 * s[1] * s[2],
                s[2] * s[2],
            ];
            for i in 0..3 {
                quartic[i] -= 4.0 * major * major * (p2[i] - h2[i]);
            }
            roots(&quartic, -2.0, 2.0).first().copied()
        }
        Implicit::Capsule(Capsule { a, b, radius }) => {
            let (a, b) = (scaled(to(a), -1.0), scaled(to(b), -1.0));
            capsule([0.0; 3], d, [a, b], length(radius))
        }
        Implicit::RoundedBox(RoundedBox {
            center,
            x,
            y,
            half,
            radius,
        }) => {
            let axes = frame(x, y);
            let into = |v: Vec3| axes.map(|axis| dot(v, axis));
            rounded_box(into(to(center)), into(d), half.map(length), length(radius))
        }
        Implicit::Metaballs(balls) => {
            // One ball alone.
            let threshold = f64::from(balls.threshold()) / f64::from(1 << 27);
            let blob = case.blobs[0];
            let radius = length(blob.radius) * (1.0 - threshold.cbrt()).sqrt();
            ball(to(blob.a), d, [0.0; 3], radius)
        }
        Implicit::SmoothUnion(_) => {
            // Parts too far from one another to melt.
            let part = |blob: &Blob| {
                let ends = [scaled(to(blob.a), -1.0), scaled(to(blob.b), -1.0)];
                capsule([0.0; 3], d, ends, length(blob.radius))
            };
            least(case.blobs.iter().map(part))
        }
        Implicit::Gyroid(_) => panic!("has no closed form"),
    };
    t.map(|t| t0 + t * size)
}

/// Kinds with a closed form, in one size.
fn closed_cases(random: &mut Random, size: f64) -> Vec<Case> {
    let closed = ["torus", "thin torus", "capsule", "rounded box"];
    let mut all = cases(random, size);
    all.retain(|case| closed.contains(&case.name));
    let u = |share: f64| (share * size) as i32;
    let at = |p: Vec3| Point(p.map(|c| (c * size) as i32));
    let one = vec![Blob::ball(at([0.2, -0.1, 0.3]), u(0.9))];
    let threshold = (0.3 * f64::from(1 << 27)) as u32;
    all.push(Case {
        name: "one metaball",
        solid: Implicit::Metaballs(Metaballs::new(&one, 0, 1, threshold)),
        blobs: one,
    });
    let apart = vec![
        Blob::ball(at([-0.6, 0.0, 0.0]), u(0.25)),
        Capsule::new(at([0.4, -0.3, 0.1]), at([0.2, 0.6, -0.2]), u(0.15)).into(),
        Blob::ball(at([0.1, -0.5, -0.6]), u(0.2)),
    ];
    all.push(Case {
        name: "parts apart",
        solid: Implicit::SmoothUnion(SmoothUnion::new(&apart, 0, 3, u(0.05))),
        blobs: apart,
    });
    all
}

#[test]
fn hits_are_where_the_closed_forms_have_them() {
    let mut random = Random(4);
    let mut failed = Vec::new();
    for size in SIZES {
        for case in closed_cases(&mut random, size) {
            case.solid.check(&case.blobs).unwrap();
            let (_, radius) = case.ball();
            let (mut count, mut differ) = (0, 0);
            let mut errors = Vec::new();
            while count < rays() {
                let Some(ray) = ray(&mut random, &case) else {
                    continue;
                };
                count += 1;
                match (
                    closed(&case, &ray),
                    case.solid.intersect(&case.blobs, &ray, FAR + 1),
                ) {
                    (Some(wanted), Some(t)) => errors.push((f64::from(t) - wanted).abs() / (2.0 * radius)),
                    (None, None) => {}
                    _ => differ += 1,
                }
            }
            errors.sort_by(f64::total_cmp);
            let at = |share: f64| errors[((errors.len() - 1) as f64 * share) as usize];
            let line = format!(
                "{size:>8} {:<14} {:>6} hits, {differ:>3} differ, p50 {:.1e} p99 {:.1e} max {:.1e}",
                case.name,
                errors.len(),
                at(0.5),
                at(0.99),
                at(1.0)
            );
            println!("{line}");
            // Measured: 2e-4 where a unit is 2e-4 of the extent, 4e-5 where it is less.
            let most = 5e-5 + 0.5 / radius;
            if differ as f64 > 0.001 * count as f64 || at(0.99) > most || errors.len() < count / 20 {
                failed.push(line);
            }
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// Between two equal balls both distances are the same, and a blend is k/4 lower: √(c² + h²) − radius = k/4.
#[test]
fn a_blend_is_a_quarter_of_k_high_in_the_middle() {
    for size in [3000, 700_000] {
        let (c, radius, k) = (size / 2, size * 2 / 5, size * 3 / 5);
        let balls = [
            Blob::ball(Point([-c, 0, 0]), radius),
            Blob::ball(Point([c, 0, 0]), radius),
        ];
        let solid = Implicit::SmoothUnion(SmoothUnion::new(&balls, 0, 2, k));
        solid.check(&balls).unwrap();
        let high = f64::from(radius) + f64::from(k) / 4.0;
        let height = (high * high - f64::from(c) * f64::from(c)).sqrt();
        let from = 3 * size;
        let ray = Ray {
            origin: Point([0, from, 0]),
            dir: -Dir::Y,
        };
        let t = solid.intersect(&balls, &ray, FAR + 1).unwrap();
        let error = f64::from(t) - (f64::from(from) - height);
        assert!(error.abs() <= 2.0 + 1e-4 * f64::from(size), "{size}: {error}");
    }
}
