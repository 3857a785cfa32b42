//! Hits against an f64 root finder.

use crate::exact::*;
use microlux::geom::{FAR, Point, Ray};

/// About 2^12 to 2^21 units.
pub const SIZES: [f64; 4] = [3e3, 3e4, 7e5, 2e6];

pub fn rays() -> usize {
    std::env::var("MICROLUX_RAYS").map_or(3000, |n| n.parse().unwrap())
}

/// From around a solid, near or far, to a place within the ball around it.
pub fn ray(random: &mut Random, case: &Case) -> Option<Ray> {
    let (center, radius) = case.ball();
    let away = radius * 1.05 * 2f64.powf(random.between(0.0, 4.0));
    let from = along(center, random.direction(), away);
    let at = along(center, random.direction(), radius * 0.8 * random.unit().cbrt());
    let origin = Point(from.map(|c| c.round() as i32));
    if origin.0.iter().any(|c| c.unsigned_abs() > 1 << 23) {
        return None;
    }
    let (dir, _) = origin.to(Point(at.map(|c| c.round() as i32))).normalize()?;
    Some(Ray { origin, dir })
}

#[test]
fn hits_are_where_the_formulas_have_them() {
    let mut random = Random(1);
    let mut failed = Vec::new();
    for size in SIZES {
        for case in cases(&mut random, size) {
            case.solid.check(&case.blobs).unwrap();
            let (_, radius) = case.ball();
            let (mut count, mut both, mut differ) = (0, 0, 0);
            let mut errors = Vec::new();
            while count < rays() {
                let Some(ray) = ray(&mut random, &case) else {
                    continue;
                };
                count += 1;
                let (origin, d) = (point(ray.origin), dir(ray.dir));
                let wanted = case.first(origin, d, 0.0);
                let met = case.solid.intersect(&case.blobs, &ray, FAR + 1);
                match (wanted, met) {
                    (Some(wanted), Some(t)) => {
                        both += 1;
                        errors.push((f64::from(t) - wanted).abs() / (2.0 * radius));
                    }
                    (None, None) => {}
                    _ => differ += 1,
                }
            }
            errors.sort_by(f64::total_cmp);
            let at = |share: f64| errors[((errors.len() - 1) as f64 * share) as usize];
            let line = format!(
                "{size:>8} {:<18} {both:>6} hits, {differ:>3} differ, p50 {:.1e} p99 {:.1e} p99.99 {:.1e} max {:.1e}",
                case.name,
                at(0.5),
                at(0.99),
                at(0.9999),
                at(1.0)
            );
            println!("{line}");
            if differ as f64 > 0.001 * count as f64 || at(0.99) > 1e-3 || both < count / 20 {
                failed.push(line);
            }
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}
