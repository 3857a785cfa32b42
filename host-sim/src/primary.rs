//! Primary rays in both arithmetics: who hits, and where.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::dequantise::{self, Frame};
use crate::metrics::Percentiles;
use crate::quantise::{CoreScene, QuantiseError};
use crate::reference;
use microlux::num::Uniform;
use microlux::scene::Scene;
use rayon::prelude::*;

/// How far the fixed-point primary rays are from the f64 ones.
#[derive(Clone, Debug, PartialEq)]
pub struct PrimaryReport {
    pub rays: u64,
    /// Share of the rays where one side hits and the other misses.
    pub hit_miss_disagreement: f64,
    /// Distance between the two hit points where both hit, as a share of the scene's extent (the diagonal of the box
    /// around everything finite), or of the way there where that is longer (on infinite planes).
    pub hit_point_error: Percentiles,
    /// The same without the pixels at silhouettes: see [`DISCONTINUITY`].
    pub hit_point_error_away: Percentiles,
}

impl PrimaryReport {
    /// The numbers with the names that files have for them.
    pub fn entries(&self) -> [(&'static str, f64); 5] {
        [
            ("hit_miss_disagreement", self.hit_miss_disagreement),
            ("hit_point_error_p50", self.hit_point_error.p50),
            ("hit_point_error_p99", self.hit_point_error.p99),
            ("hit_point_error_p9999", self.hit_point_error_away.p9999),
            ("hit_point_error_max", self.hit_point_error.max),
        ]
    }
}

/// A pixel stands at a silhouette if in its 3×3 neighbourhood in the f64 picture the farthest depth is more than this
/// many times the nearest, or some rays hit and some miss.
pub const DISCONTINUITY: f64 = 1.05;

/// Rays at least, spread evenly over the picture.
const RAYS: f64 = 1e6;

/// What one ray found.
struct Pair {
    /// Depth in the f64 picture.
    depth: Option<f64>,
    /// Whether only one side hits.
    disagree: bool,
    /// Distance of the hit points as a share of the extent, or of the way there.
    error: Option<f64>,
}

/// A regular grid of rays through each pixel, through both cameras and both kinds of arithmetic; a lens by its middle.
///
/// `None` if `cancel` was set.
pub fn compare(
    core: &CoreScene,
    width: u32,
    height: u32,
    cancel: &AtomicBool,
) -> Result<Option<PrimaryReport>, QuantiseError> {
    let lent = core.lend();
    let scene = core.scene(&lent)?;
    let reference = dequantise::scene(core)?;
    let extent = reference::extent(&reference);
    let side = (RAYS / f64::from(width * height)).sqrt().ceil().max(1.0) as u32;
    let rows: Vec<Vec<Vec<Pair>>> = (0..height)
        .into_par_iter()
        .map(|y| {
            let stopped = cancel.load(Ordering::Relaxed);
            let columns = if stopped { 0..0 } else { 0..width };
            columns
                .map(|x| pixel(core, &scene, &reference, [width, height], [x, y], side, extent))
                .collect()
        })
        .collect();
    if cancel.load(Ordering::Relaxed) {
        return Ok(None);
    }
    let mut all = Vec::new();
    let mut away = Vec::new();
    let (mut rays, mut disagreements) = (0u64, 0u64);
    for (y, row) in rows.iter().enumerate() {
        for (x, pairs) in row.iter().enumerate() {
            let errors = pairs.iter().filter_map(|pair| pair.error);
            if !at_silhouette(&rows, x, y) {
                away.extend(errors.clone());
            }
            all.extend(errors);
            rays += pairs.len() as u64;
            disagreements += pairs.iter().filter(|pair| pair.disagree).count() as u64;
        }
    }
    Ok(Some(PrimaryReport {
        rays,
        hit_miss_disagreement: disagreements as f64 / rays.max(1) as f64,
        hit_point_error: Percentiles::of(&mut all),
        hit_point_error_away: Percentiles::of(&mut away),
    }))
}

fn pixel(
    core: &CoreScene,
    scene: &Scene,
    reference: &reference::Scene,
    size: [u32; 2],
    [x, y]: [u32; 2],
    side: u32,
    extent: f64,
) -> Vec<Pair> {
    let film = core.camera.film(size[0] as u16, size[1] as u16);
    let frame = Frame::of(core);
    let place = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
    let uniform = |u: f64| Uniform::from_bits((u * 4294967296.0) as u32);
    let one = |i: u32, j: u32| {
        let (u, v) = (place(i), place(j));
        let ray = film.ray(x as u16, y as u16, [uniform(u), uniform(v)], [Uniform::ZERO; 2]);
        let fixed = ray.and_then(|ray| Some(scene.vertex(&ray, &scene.closest(&ray)?).surface.point));
        let fixed = fixed.map(|point| frame.point(point));
        let ray = reference::primary_ray(reference, size, f64::from(x) + u, f64::from(y) + v);
        let exact = reference::closest(reference, &ray);
        let error = fixed.zip(exact.as_ref()).map(|(a, hit)| {
            let d = [a.x - hit.point.x, a.y - hit.point.y, a.z - hit.point.z];
            d.iter().map(|c| c * c).sum::<f64>().sqrt() / extent.max(hit.t)
        });
        Pair {
            depth: exact.as_ref().map(|hit| hit.t),
            disagree: fixed.is_some() != exact.is_some(),
            error,
        }
    };
    (0..side)
        .flat_map(|j| (0..side).map(move |i| (i, j)))
        .map(|(i, j)| one(i, j))
        .collect()
}

fn at_silhouette(rows: &[Vec<Vec<Pair>>], x: usize, y: usize) -> bool {
    let (mut near, mut far) = (f64::INFINITY, 0.0f64);
    let (mut hits, mut misses) = (false, false);
    for row in &rows[y.saturating_sub(1)..(y + 2).min(rows.len())] {
        for pairs in &row[x.saturating_sub(1)..(x + 2).min(row.len())] {
            for pair in pairs {
                match pair.depth {
                    Some(depth) => {
                        (near, far) = (near.min(depth), far.max(depth));
                        hits = true;
                    }
                    None => misses = true,
                }
            }
        }
    }
    (hits && misses) || far > near * DISCONTINUITY
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;
    use crate::desc::GeometryDesc;

    /// A scene eight times as large is the same in the core's units: shares must not tell the two apart.
    #[test]
    fn errors_are_shares() {
        let report = |factor: f64| {
            let mut desc = builtin::scene("furnace").unwrap();
            desc.camera.origin = desc.camera.origin.map(|x| factor * x);
            for shape in &mut desc.shapes {
                if let GeometryDesc::Sphere { radius, .. } = &mut shape.geometry {
                    *radius *= factor;
                }
            }
            let core = CoreScene::new(&desc).unwrap();
            compare(&core, 8, 8, &AtomicBool::new(false)).unwrap().unwrap()
        };
        let (small, large) = (report(1.0), report(8.0));
        let (a, b) = (small.hit_point_error.p50, large.hit_point_error.p50);
        assert!(a > 0.0 && (a / b - 1.0).abs() < 1e-6, "{a:e} {b:e}");
        assert_eq!(small.rays, large.rays);
    }

    /// A camera high over an infinite floor, with the horizon in the picture.
    #[test]
    fn far_floors_are_hit_where_they_are() {
        let core = CoreScene::new(&builtin::scene("materials").unwrap()).unwrap();
        let report = compare(&core, 32, 32, &AtomicBool::new(false)).unwrap().unwrap();
        assert!(
            report.hit_point_error.p99 < 1e-3,
            "{:e}",
            report.hit_point_error.p99
        );
        assert_eq!(report.hit_miss_disagreement, 0.0);
    }
}
