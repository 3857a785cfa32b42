//! A vertex of the camera's and one of a light's, joined by a segment.

use super::subpath::{PathVertex, roulette};
use super::weight::weight;
use crate::camera::Projection;
use crate::color::Radiance;
use crate::geom::Ray;
use crate::integrator::View;
use crate::light::{LightSample, short_of};
use crate::num::{Uniform, Wide};
use crate::scene::{Scene, Vertex};

/// What a strategy found, before its weight, and the weight.
pub type Found = Option<(Radiance, Wide)>;

/// Two subpaths of two vertices or more each.
///
/// What would bring less than `least` is taken only so often as its share in it, by `number`, and that much more of it:
/// most of a connection's cost is the shadow ray.
#[inline]
pub fn connect(
    scene: &Scene,
    camera: &PathVertex,
    light: &PathVertex,
    (least, number): (Wide, Uniform),
    rays: &mut u32,
) -> Found {
    let (from, to) = (&camera.vertex.surface, &light.vertex.surface);
    let (dir, norm) = from.point.to(to.point).normalize()?;
    let (here, pdf) = camera.eval(dir)?;
    let (there, light_pdf) = light.eval_light(-dir)?;
    let per_square = norm.square().recip();
    let carried = camera.throughput.mul(here).mul(light.throughput.mul(there));
    let carried = carried.scale(per_square);
    if carried.is_black() {
        return None;
    }
    let shorter_light = light
        .partial
        .shorter(pdf * light.cos(dir) * per_square, light.reverse_pdf(-dir));
    let shorter_camera = camera
        .partial
        .shorter(light_pdf * camera.cos(dir) * per_square, camera.reverse_pdf(dir));
    let weight = weight(shorter_light, shorter_camera);
    let carried = match small(carried.max_channel() * weight, least) {
        None => carried,
        Some(chance) => carried.scale(roulette(chance, number)?),
    };
    let shadow = Ray {
        origin: from.leave(dir),
        dir,
    };
    let slope = dir.dot(to.normal).abs();
    *rays = rays.wrapping_add(1);
    if slope == 0 || scene.occluded(&shadow, short_of(norm.length(), to.lift, slope), None) {
        return None;
    }
    Some((carried, weight))
}

/// The share in `least` of something smaller.
#[inline]
fn small(brings: Wide, least: Wide) -> Option<Wide> {
    (!brings.is_at_least(least)).then(|| brings / least)
}

/// A light sample, as path tracing makes it; its weight among all strategies.
///
/// `sample_density` and `emission` are those of [`Scene::sample_density`] and [`Scene::emission_density`], times the
/// chances of the light's choice.
#[inline]
pub fn light_sample_weight(
    camera: &PathVertex,
    sample: &LightSample,
    pdf: Wide,
    sample_density: Wide,
    emission: Wide,
) -> Wide {
    // (44): what the BSDF's direction would have met, where any does.
    let shorter_light = if sample.is_delta() {
        Wide::ZERO
    } else {
        let ratio = pdf / sample_density;
        ratio * ratio
    };
    let from_light = emission * camera.cos(sample.wi) / sample_density;
    let shorter_camera = if from_light.is_zero() {
        Wide::ZERO
    } else {
        camera.partial.shorter(from_light, camera.reverse_pdf(sample.wi))
    };
    weight(shorter_light, shorter_camera)
}

/// A light subpath's vertex and the lens: the pixel that sees it, what it adds to the picture, and its weight.
#[inline]
pub fn connect_to_lens(
    view: &View,
    light: &PathVertex,
    lens: [Uniform; 2],
    hide_emitters: bool,
    rays: &mut u32,
) -> Option<((u16, u16), Radiance, Wide)> {
    let surface = &light.vertex.surface;
    if hide_emitters && light.vertex.is_emitter {
        return None;
    }
    let seen = view.film.project(surface.point, lens)?;
    let (reflected, _) = light.eval_light(-seen.dir)?;
    // Lens and film as a whole: see `FilmPlane::density`.
    let per_square = seen.density / seen.norm.square();
    let arriving = light.throughput.mul(reflected).scale(per_square);
    if arriving.is_black() || !is_seen(view.scene, &light.vertex, &seen, hide_emitters, rays) {
        return None;
    }
    let shorter_light = light
        .partial
        .shorter(per_square * light.cos(seen.dir), light.reverse_pdf(-seen.dir));
    Some((seen.pixel, arriving, weight(shorter_light, Wide::ZERO)))
}

/// Emitting shapes that one camera ray may pass through.
pub const HIDDEN: u8 = 8;

/// Whether nothing stands between the lens and a vertex, or only what is hidden from the camera.
fn is_seen(scene: &Scene, vertex: &Vertex, seen: &Projection, hide_emitters: bool, rays: &mut u32) -> bool {
    let slope = seen.dir.dot(vertex.surface.normal).abs();
    if slope == 0 {
        return false;
    }
    let mut ray = Ray {
        origin: seen.lens,
        dir: seen.dir,
    };
    let mut distance = short_of(seen.norm.length(), vertex.surface.lift, slope);
    let mut hidden = if hide_emitters { HIDDEN } else { 0 };
    loop {
        *rays = rays.wrapping_add(1);
        if hidden == 0 {
            return !scene.occluded(&ray, distance, None);
        }
        // As the camera's own rays do: through one light after the other.
        hidden -= 1;
        let Some(hit) = scene.closest(&ray) else {
            return true;
        };
        if hit.t >= distance {
            return true;
        }
        let between = scene.vertex(&ray, &hit);
        if !between.is_emitter {
            return false;
        }
        distance -= hit.t;
        ray.origin = between.surface.leave(ray.dir);
    }
}
