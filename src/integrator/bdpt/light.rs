//! A light's subpath, with the strategies that connect its vertices.

use super::connect::{connect, connect_to_lens};
use super::subpath::{PathVertex, cos, light_weight, roulette, scatter, square};
use super::weight::Partial;
use super::{Strategy, Tally};
use crate::integrator::View;
use crate::num::{Uniform, Wide};
use crate::sampler::Sampler;

/// How light is followed.
pub struct LightWalk {
    /// Segments of the longest path that a light's vertex is connected in.
    pub full: u16,
    /// From this many segments on, Russian roulette may end the subpath.
    pub rr_depth: u16,
    /// Lights that are shapes stand in no camera ray's way.
    pub hide_emitters: bool,
    /// How much light the camera's subpath found for its pixel.
    pub found: Wide,
}

/// Connections that would bring less than 2^-this of what was found for the pixel so far are taken now and then.
const LEAST: i32 = 3;

/// By how much the number of one connection's roulette differs from the one's before: the golden ratio, in turns.
const GOLDEN: u32 = 0x9e37_79b9;

impl LightWalk {
    /// Follows a ray of light, and connects each vertex with the lens and with the camera's.
    pub fn follow<T: Tally>(
        &self,
        view: &View,
        sampler: &mut impl Sampler,
        tally: &mut T,
        rays: &mut u32,
        camera: &[PathVertex],
    ) {
        let scene = view.scene;
        // Segments of the light's share in the longest paths to connect.
        let full = self.full;
        let mut found = self.found;
        let longest = match camera.first() {
            _ if T::SPLATS => full.saturating_sub(1),
            Some(first) => full.saturating_sub(1 + first.depth),
            None => 0,
        };
        if longest == 0 {
            return;
        }
        let (choice, place, direction) = (sampler.next_1d(), sampler.next_2d(), sampler.next_2d());
        let (light, _) = scene.choose_light(choice);
        let Some(emission) = scene.emit(light, place, direction) else {
            return;
        };
        let count = scene.light_chance(light).recip();
        let mut throughput = emission.power.scale(count);
        let first = throughput.max_channel();
        let mut ray = emission.ray;
        let mut partial = Partial::default();
        let mut depth = 0;
        while depth < longest && !throughput.is_black() {
            depth += 1;
            *rays = rays.wrapping_add(1);
            let Some(hit) = scene.closest(&ray) else {
                break;
            };
            let vertex = scene.vertex(&ray, &hit);
            let cos = cos(&vertex, vertex.wo);
            if cos.is_zero() {
                break;
            }
            partial = if depth == 1 {
                let point = vertex.surface.point;
                let sample = scene.emission_sample_density(light, &emission, point, hit.t);
                let delta = scene.is_delta_light(light);
                Partial::from_light(sample / count, emission.density / count, delta).arrive(Wide::ONE, cos)
            } else {
                partial.arrive(square(hit.t), cos)
            };
            let at = PathVertex {
                vertex,
                throughput,
                partial,
                depth,
            };
            if at.vertex.material.is_smooth() {
                if T::SPLATS {
                    let lens = if view.film.has_lens() {
                        sampler.next_2d()
                    } else {
                        [Uniform::ZERO; 2]
                    };
                    if let Some((pixel, light, weight)) =
                        connect_to_lens(view, &at, lens, self.hide_emitters, rays)
                    {
                        let strategy = Strategy {
                            light: depth + 1,
                            camera: 1,
                        };
                        tally.splat(strategy, pixel, light, weight);
                    }
                }
                let mut number = if camera.is_empty() {
                    0
                } else {
                    sampler.next_1d().to_bits()
                };
                let least = if T::ALL { Wide::ZERO } else { found.shl(-LEAST) };
                for end in camera.iter().take_while(|end| end.depth + depth < full) {
                    if let Some((light, weight)) =
                        connect(scene, end, &at, (least, Uniform::from_bits(number)), rays)
                    {
                        let strategy = Strategy {
                            light: depth + 1,
                            camera: end.depth + 1,
                        };
                        tally.gather(strategy, light, weight);
                        found = found + light.max_channel() * weight;
                    }
                    number = number.wrapping_add(GOLDEN);
                }
            }
            if depth >= longest {
                break;
            }
            let (lobe, direction, number) = (sampler.next_1d(), sampler.next_2d(), sampler.next_1d());
            let Some(onward) = scatter(&at, direction, lobe) else {
                break;
            };
            throughput = throughput.mul(light_weight(&at, &onward.sample));
            (ray, partial) = (onward.ray, onward.partial);
            if depth >= self.rr_depth {
                let Some(more) = roulette(throughput.max_channel() / first, number) else {
                    break;
                };
                throughput = throughput.scale(more);
            }
        }
    }
}
