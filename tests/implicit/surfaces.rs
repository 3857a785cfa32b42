//! Points on surfaces, their normals, and rays that leave them.

use crate::exact::*;
use crate::hits::{SIZES, ray, rays};
use microlux::geom::{Dir, FAR, Ray};

/// What was met along a random ray: the case's surface there, as the core says.
fn met(random: &mut Random, case: &Case) -> Option<microlux::shape::Surface> {
    let ray = ray(random, case)?;
    let t = case.solid.intersect(&case.blobs, &ray, FAR + 1)?;
    Some(case.solid.surface(&case.blobs, ray.at(t)))
}

/// Step of the core's march, units: 2^-15 .. 2^-14 of the reach.
fn step(case: &Case) -> f64 {
    (f64::from(case.solid.lift()) - 5.0) / 4.0
}

/// Whether f's own kinks lie within `width` of a point: there a normal is one side's or the other's.
fn at_an_edge(case: &Case, p: Vec3, width: f64) -> bool {
    let n = case.normal(p, 1e-3 * width);
    let edge = |i: usize, sign: f64| {
        let mut d = [0.0; 3];
        d[i] = sign * width;
        dot(case.normal(along(p, d, 1.0), 1e-3 * width), n) < 0.9
    };
    (0..3).any(|i| edge(i, 1.0) || edge(i, -1.0))
}

#[test]
fn points_are_on_the_surface_and_normals_across_it() {
    let mut random = Random(2);
    for size in SIZES {
        for case in cases(&mut random, size) {
            let step = step(&case);
            let (mut count, mut edges) = (0, 0);
            let (mut off, mut turned) = (0.0f64, Vec::new());
            while count < rays() / 4 {
                let Some(surface) = met(&mut random, &case) else {
                    continue;
                };
                count += 1;
                let p = point(surface.point);
                if at_an_edge(&case, p, 30.0 * step + 10.0) {
                    edges += 1;
                    continue;
                }
                // f changes by |∇f| a unit.
                let h = 0.5 * step + 1.0;
                let n = case.normal(p, h);
                let steep = (case.f(along(p, n, h)) - case.f(along(p, n, -h))) / (2.0 * h);
                off = off.max((case.f(p) / steep).abs());
                turned.push(norm(sub(unit(dir(surface.normal)), n)));
            }
            turned.sort_by(f64::total_cmp);
            let most = turned[turned.len() - 1];
            println!(
                "{size:>8} {:<18} off by {off:.2} units, {:.3} steps; normals turned by {most:.1e}, half of them {:.1e}; {edges} of {count} at edges",
                case.name,
                off / step.max(1.0),
                turned[turned.len() / 2],
            );
            assert!(edges < count / 4);
            // A unit each way, the height to half of one, and a bit of a step.
            assert!(off <= 2.3 + 0.1 * step, "{}: {off} units", case.name);
        }
    }
}

#[test]
fn no_ray_meets_where_it_left_and_none_gets_out() {
    let mut random = Random(3);
    for size in SIZES {
        for case in cases(&mut random, size) {
            let mut nearest = f64::MAX;
            let mut count = 0;
            while count < rays() {
                let Some(surface) = met(&mut random, &case) else {
                    continue;
                };
                count += 1;
                // Half of them along the surface, within a thousandth.
                let mut wi = random.direction();
                let n = dir(surface.normal);
                if count % 2 == 0 {
                    let flat = along(wi, n, -dot(wi, n));
                    wi = along(flat, n, random.between(-1e-3, 1e-3) * norm(flat));
                }
                let Some(wi) = Dir::new(wi.map(|c| (c * 1e8) as i32)) else {
                    continue;
                };
                let side = if wi.dot_q24(surface.normal) >= 0 {
                    1.0
                } else {
                    -1.0
                };
                let origin = surface.leave(wi);
                let (o, d) = (point(origin), dir(wi));
                let tell = || format!("{size} {}: {:?} to {wi:?}", case.name, surface);
                // The start is on its side, with some way to the surface.
                let steep = match case.solid {
                    microlux::shape::Implicit::Metaballs(_) => 1.0 / f64::from(case.blobs[1].radius),
                    _ => 1.0,
                };
                let ray = Ray { origin, dir: wi };
                let t = case.solid.intersect(&case.blobs, &ray, FAR + 1);
                if !at_an_edge(&case, o, 30.0 * step(&case) + 10.0) {
                    nearest = nearest.min(side * case.f(o) / steep / f64::from(surface.lift));
                    assert!(case.f(o) * side > 0.0, "{}", tell());
                    if let Some(t) = t {
                        // Met at once, although by the formula nothing is near.
                        let wanted = case.first(o, d, 0.0).unwrap_or(f64::MAX);
                        assert!(
                            f64::from(t) > 8.0 * f64::from(surface.lift)
                                || wanted < 16.0 * f64::from(surface.lift),
                            "{}: {t} {wanted}",
                            tell()
                        );
                    }
                }
                if side < 0.0 && case.f(o) < 0.0 {
                    assert!(t.is_some(), "{}", tell());
                }
            }
            println!(
                "{size:>8} {:<18} starts are off by {nearest:.2} lifts at least",
                case.name
            );
        }
    }
}
