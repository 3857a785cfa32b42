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
    if slope == 0 || scene.occluded(&shadow, short_of(norm.length(), from.lift + to.lift, slope), None) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::Node;
    use crate::color::albedo;
    use crate::geom::{Dir, Point, point};
    use crate::integrator::bdpt::weight::Partial;
    use crate::light::Light;
    use crate::material::Material;
    use crate::num::{Share, Uniform};
    use crate::q;
    use crate::scene::SceneBuilder;
    use crate::shape::{Rectangle, Sphere};

    /// A ball above a floor, with nothing between them: from any place on the one, lifted towards the other, a ray reaches
    /// any place on the other that it can see.
    #[test]
    fn what_is_met_does_not_shade_itself() {
        let mut b = SceneBuilder::<2, 1, 1>::new();
        let matt = albedo(Share::ONE, Share::ONE, Share::ONE);
        let matt = b.material(Material::lambert(matt)).unwrap();
        let side = crate::num::Metres::from_num(3).to_bits();
        let (x, z) = (Dir([1 << 16, 0, 0]), Dir([0, 0, 1 << 16]));
        b.shape(
            Rectangle::new(point(q!(0), q!(0), q!(0)), z, x, [side; 2]).unwrap(),
            matt,
        )
        .unwrap();
        let center = point(q!(0), q!(1.2), q!(0));
        b.shape(Sphere::new(center, q!(0.6).to_bits()), matt).unwrap();
        b.light(Light::Point {
            position: point(q!(2), q!(2), q!(2)),
            intensity: Radiance::WHITE,
        })
        .unwrap();
        let mut nodes = [Node::EMPTY; 4];
        let scene = b.build(&mut nodes).unwrap();
        let met = |origin: Point, target: Point| {
            let (dir, _) = origin.to(target).normalize()?;
            let ray = Ray { origin, dir };
            let vertex = scene.vertex(&ray, &scene.closest(&ray)?);
            Some(PathVertex {
                vertex,
                throughput: Radiance::WHITE,
                partial: Partial::default(),
                depth: 1,
            })
        };
        let below = point(q!(0), q!(0.2), q!(0));
        let step = 1 << 14;
        let mut joined = 0;
        for (i, j) in (-20..20).flat_map(|i| (-20..20).map(move |j| (i, j))) {
            // The ball's underside, and the floor about it.
            let mut on_ball = center;
            on_ball.0[0] += i * step / 20;
            on_ball.0[2] += j * step / 20;
            let mut on_floor = point(q!(0), q!(0), q!(0));
            on_floor.0[0] += (7 * i + 3 * j) % 20 * step / 4;
            on_floor.0[2] += (3 * i - 7 * j) % 20 * step / 4;
            let (Some(ball), Some(floor)) = (met(below, on_ball), met(below, on_floor)) else {
                continue;
            };
            let facing = ball
                .vertex
                .surface
                .point
                .to(floor.vertex.surface.point)
                .normalize();
            if facing.is_none_or(|(dir, _)| dir.dot(ball.vertex.surface.normal) <= 0) {
                continue;
            }
            joined += 1;
            let rest = (Wide::ZERO, Uniform::ZERO);
            let there = connect(&scene, &ball, &floor, rest, &mut 0).is_some();
            let back = connect(&scene, &floor, &ball, rest, &mut 0).is_some();
            assert!(there && back, "{i}, {j}: {there} {back}");
        }
        assert!(joined > 1000, "{joined}");
    }
}
