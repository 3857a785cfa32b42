//! How many segments the paths of [`firmware_common::rays`] have, which the core does not tell.
//!
//! It follows the same paths by the same numbers, as [`Path`] does without its light, and is held to it by the number of
//! all rays: see [`count`].

use anyhow::{Context, Result, ensure};
use firmware_common::rays::{Bundle, Kind, MAX_DEPTH, Motif, samples};
use microlux::{
    color::Radiance,
    geom::Ray,
    integrator::Path,
    num::{Uniform, Wide},
    sampler::Sampler,
    scene::{Scene, Vertex},
};

/// Rays of all paths of a motif.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Rays {
    segments: u32,
    shadows: u32,
}

/// Segments of all paths of a view; fails if the core's paths ask for another number of rays.
pub fn count(motif: Motif) -> Result<u32> {
    let traced = Bundle {
        motif,
        kind: Kind::Path,
    }
    .run(0);
    let mut rays = Rays::default();
    motif
        .with(|scene, camera| {
            let film = camera.film(
                firmware_common::golden::SETTINGS.width,
                firmware_common::golden::SETTINGS.height,
            );
            samples(|x, y, [place, lens], sampler| {
                if let Some(ray) = film.ray(x, y, place, lens) {
                    rays.follow(scene, ray, sampler);
                }
            });
        })
        .with_context(|| format!("{} is refused", motif.name()))?;
    ensure!(
        rays.segments + rays.shadows == traced.rays,
        "{}: {rays:?} were counted where the core's paths have {} rays: they are followed in another way than \
         integrator::Path does",
        motif.name(),
        traced.rays
    );
    Ok(rays.segments)
}

impl Rays {
    fn follow(&mut self, scene: &Scene, start: Ray, sampler: &mut impl Sampler) {
        let path = Path::new(MAX_DEPTH);
        let mut ray = start;
        let (mut throughput, mut eta_squared) = (Radiance::WHITE, Wide::ONE);
        for depth in 1..=path.max_depth {
            self.segments += 1;
            let hit = scene.closest(&ray);
            let Some(hit) = hit.filter(|_| depth < path.max_depth) else {
                return;
            };
            let vertex = scene.vertex(&ray, &hit);
            let (choice, place) = (sampler.next_1d(), sampler.next_2d());
            let (lobe, direction) = (sampler.next_1d(), sampler.next_2d());
            let (light, roulette) = scene.choose_light(choice);
            self.shadows += u32::from(has_shadow_ray(scene, &vertex, light, place));

            // The last is asked for where it may end on a light, before anything is known of what it is worth.
            let is_last = depth + 1 == path.max_depth;
            if is_last && !scene.prospect(&vertex).may_end_on_light(direction) {
                return;
            }
            let Some(sample) = vertex.sample(direction, lobe) else {
                return;
            };
            if is_last {
                self.segments += 1;
                return;
            }
            throughput = throughput.mul(sample.weight);
            eta_squared = eta_squared * sample.eta_squared;
            if throughput.is_black() {
                return;
            }
            ray = Ray {
                origin: vertex.surface.leave(sample.wi),
                dir: sample.wi,
            };
            if depth >= path.rr_depth {
                let survival = (throughput.max_channel() * eta_squared).to_fixed(16).min(62_259);
                if (roulette.to_bits() >> 16) >= survival {
                    return;
                }
                throughput = throughput.scale(Wide::new(survival, -16).recip());
            }
        }
    }
}

/// Whether the light sample could reach the vertex, if nothing stood between.
fn has_shadow_ray(scene: &Scene, vertex: &Vertex, light: u32, place: [Uniform; 2]) -> bool {
    let sample = scene.sample_light(light, &vertex.surface, place);
    vertex.material.is_smooth() && sample.is_some_and(|sample| vertex.eval(sample.wi).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;
    use microlux::scene::builtin::Builtin;

    /// The count of all rays is the core's, and a path has at least a segment and at most as many as it may.
    #[test]
    fn paths_are_followed_as_the_core_does() {
        let pixels = 30 * 25;
        for motif in [Builtin::Cornell, Builtin::Spheres, Builtin::Torus].map(Motif::Builtin) {
            let segments = count(motif).unwrap();
            assert!((pixels..=8 * pixels).contains(&segments), "{motif:?} {segments}");
        }
        count(Motif::Mesh).unwrap();
    }
}
