//! The camera's subpath, with the strategies of path tracing on the way.

use super::connect::{HIDDEN, light_sample_weight};
use super::subpath::{PathVertex, cos, roulette, scatter, square};
use super::weight::{Partial, weight};
use super::{Bdpt, Strategy, Tally};
use crate::color::Radiance;
use crate::geom::Ray;
use crate::integrator::{View, Witness, power_heuristic};
use crate::num::{Uniform, Wide};
use crate::sampler::Sampler;
use crate::scene::{Hit, Seen, ShapeSet};
use heapless::Vec;

/// The weight of a BSDF's direction against a light sample: of paths too long for every other strategy.
#[inline]
fn bsdf_weight(bsdf_pdf: Wide, sample: Wide) -> Wide {
    if bsdf_pdf.is_zero() {
        Wide::ONE
    } else {
        power_heuristic(bsdf_pdf, sample)
    }
}

impl<const N: usize> Bdpt<N> {
    /// Follows the camera's ray: what emits on the way (no vertex from a light), light samples (one), and vertices to
    /// connect to. Answers with how much light came together.
    pub(super) fn camera_subpath<'a, T: Tally>(
        &self,
        view: &View<'a>,
        ray: Ray,
        sampler: &mut impl Sampler,
        tally: &mut T,
        rays: &mut u32,
        vertices: &mut Vec<PathVertex<'a>, N>,
    ) -> Wide {
        let scene = view.scene;
        let (mut ray, mut among) = (ray, view.ahead.seen);
        let mut partial = Partial::from_camera(view.film.density(ray.dir), T::SPLATS);
        let mut throughput = Radiance::WHITE;
        let mut eta_squared = Wide::ONE;
        // Of the direction that led here; none for the camera's and for a delta distribution's.
        let mut bsdf_pdf = Wide::ZERO;
        let mut depth = 0;
        // How many lights a camera ray may still pass through unseen, and how far it came meanwhile.
        let mut hidden = if self.hide_emitters { HIDDEN } else { 0 };
        let mut passed = 0i32;
        let mut found = Wide::ZERO;
        while depth < self.max_depth {
            depth += 1;
            *rays = rays.wrapping_add(1);
            // Of the last segment only light matters, unless it is the camera's own.
            let seen = if depth == self.max_depth && depth > 1 {
                scene.closest_light(&ray)
            } else {
                Some(
                    scene
                        .closest_among(&ray, among)
                        .map_or(Seen::Environment, Seen::Emitter),
                )
            };
            among = ShapeSet::ALL;
            let strategy = Strategy {
                light: 0,
                camera: depth + 1,
            };
            let hit = match seen {
                Some(Seen::Emitter(hit)) => hit,
                Some(Seen::Environment) if depth > 1 || !self.hide_emitters => {
                    tally.witness().nothing(&ray, throughput);
                    let sample = scene.background_pdf(ray.dir);
                    let weight = if depth == 1 || sample.is_zero() {
                        // Nothing else finds it.
                        Wide::ONE
                    } else if depth > Self::FULL_DEPTH {
                        bsdf_weight(bsdf_pdf, sample)
                    } else {
                        let emission = sample * scene.distant_density(ray.origin, ray.dir);
                        weight(Wide::ZERO, partial.shorter_at_light(sample, emission))
                    };
                    let light = throughput.mul(scene.background(ray.dir));
                    found = found + light.max_channel() * weight;
                    tally.gather(strategy, light, weight);
                    break;
                }
                Some(Seen::Environment) => {
                    tally.witness().nothing(&ray, throughput);
                    break;
                }
                None => break,
            };
            let vertex = scene.vertex(&ray, &hit);
            if depth == 1 && hidden > 0 && vertex.is_emitter {
                hidden -= 1;
                tally.witness().passed(hit.t);
                depth = 0;
                passed = passed.saturating_add(hit.t);
                ray.origin = vertex.surface.leave(ray.dir);
                continue;
            }

            tally.witness().surface(scene, &hit, &vertex, throughput);

            // Add what the surface emits.
            if let Some(light) = vertex.light {
                let weight = if depth == 1 {
                    Wide::ONE
                } else {
                    let sample = scene.light_pdf(light, ray.origin, ray.dir, &hit);
                    self.emission_weight(view, &partial, depth, bsdf_pdf, sample, light, &hit)
                };
                let light = throughput.mul(vertex.emission);
                found = found + light.max_channel() * weight;
                tally.gather(strategy, light, weight);
            }
            let cos = cos(&vertex, vertex.wo);
            if depth >= self.max_depth || cos.is_zero() {
                break;
            }
            let at = PathVertex {
                vertex,
                throughput,
                partial: partial.arrive(square(hit.t.saturating_add(passed)), cos),
                depth,
            };
            passed = 0;

            let (choice, place) = (sampler.next_1d(), sampler.next_2d());
            let (lobe, direction) = (sampler.next_1d(), sampler.next_2d());
            let (light, number) = scene.choose_light(choice);
            if at.vertex.material.is_smooth() {
                found = found + self.sample_light(view, &at, light, place, tally, rays);
                if depth + 2 <= self.max_depth.min(Self::FULL_DEPTH) {
                    // Full depth leaves room for as many as there are.
                    let _ = vertices.push(at);
                }
            }

            // Go on in a direction drawn from the BSDF.
            let Some(onward) = scatter(&at, direction, lobe) else {
                break;
            };
            throughput = throughput.mul(onward.sample.weight);
            if throughput.is_black() {
                break;
            }
            (ray, partial, bsdf_pdf) = (onward.ray, onward.partial, onward.sample.pdf);
            eta_squared = eta_squared * onward.sample.eta_squared;
            if depth >= self.rr_depth {
                let Some(more) = roulette(throughput.max_channel() * eta_squared, number) else {
                    break;
                };
                throughput = throughput.scale(more);
            }
        }
        found
    }

    /// The weight of a path that met a light by chance, at its segment number `depth` ≥ 2.
    #[allow(clippy::too_many_arguments, reason = "a camera subpath's state, once")]
    fn emission_weight(
        &self,
        view: &View,
        partial: &Partial,
        depth: u16,
        bsdf_pdf: Wide,
        sample: Wide,
        light: u16,
        hit: &Hit,
    ) -> Wide {
        if depth > Self::FULL_DEPTH {
            return bsdf_weight(bsdf_pdf, sample);
        }
        let chance = view.scene.light_chance(light as u32);
        let emission = view.scene.emission_density(light as u32, hit.triangle) * chance;
        weight(Wide::ZERO, partial.shorter_at_light(sample, emission))
    }

    /// The light that one sample of one light sends over a camera vertex; answers with how much.
    #[inline]
    fn sample_light(
        &self,
        view: &View,
        at: &PathVertex,
        light: u32,
        place: [Uniform; 2],
        tally: &mut impl Tally,
        rays: &mut u32,
    ) -> Wide {
        let scene = view.scene;
        let surface = &at.vertex.surface;
        let Some(sample) = scene.sample_light(light, surface, place) else {
            return Wide::ZERO;
        };
        let Some((reflected, pdf)) = at.eval(sample.wi) else {
            return Wide::ZERO;
        };
        let shadow = Ray {
            origin: surface.leave(sample.wi),
            dir: sample.wi,
        };
        *rays = rays.wrapping_add(1);
        if scene.occluded(&shadow, sample.distance, sample.shape) {
            return Wide::ZERO;
        }
        // One of several is chosen: the density is that much smaller.
        let count = scene.light_chance(light).recip();
        let arriving = at.throughput.mul(reflected.mul(sample.radiance));
        let arriving = if sample.is_delta() {
            arriving.scale(count)
        } else {
            arriving.scale(count / sample.pdf)
        };
        let weight = if at.depth < Self::FULL_DEPTH {
            let density = scene.sample_density(light, &sample) / count;
            let emission = scene.sample_emission_density(light, &sample, surface.point) / count;
            light_sample_weight(at, &sample, pdf, density, emission)
        } else if sample.is_delta() {
            Wide::ONE
        } else {
            power_heuristic(sample.pdf / count, pdf)
        };
        let strategy = Strategy {
            light: 1,
            camera: at.depth + 1,
        };
        tally.gather(strategy, arriving, weight);
        arriving.max_channel() * weight
    }
}
