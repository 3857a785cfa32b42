//! Bidirectional path tracing: light is followed from the camera and from the lights, and every vertex of one way is
//! joined to every vertex of the other.

mod connect;
mod subpath;
mod weight;

use super::{Integrator, SplatSink, View, power_heuristic};
use crate::color::Radiance;
use crate::geom::Ray;
use crate::num::{Uniform, Wide};
use crate::sampler::Sampler;
use crate::scene::{Hit, Seen};
use connect::{HIDDEN, connect, connect_to_lens, light_sample_weight};
use heapless::Vec;
use subpath::{PathVertex, cos, light_weight, roulette, scatter, square};
use weight::{Partial, weight};

/// Bidirectional path tracing, with all connections of which the camera's end is a pixel's own; and, where there is a
/// whole frame to add to, of light subpaths with the lens.
///
/// Lafortune and Willems, "Bi-Directional Path Tracing", Compugraphics 1993; Veach, "Robust Monte Carlo Methods for Light
/// Transport Simulation", 1997, chapter 10. Weights are in `weight`.
///
/// A camera subpath of up to `N` vertices that light can be connected to is kept; light subpaths are followed a vertex
/// at a time. Paths of up to [`Self::FULL_DEPTH`] segments are found by every strategy there is; what is longer by
/// those of path tracing alone, so that `N` costs memory and noise, never light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bdpt<const N: usize = 8> {
    /// Paths of at most this many segments: 1 for emission only, 2 for direct light.
    pub max_depth: u16,
    /// From this many segments on, Russian roulette may end a subpath.
    pub rr_depth: u16,
    /// The camera itself sees through lights that are shapes (up to 8 in a row), and no environment.
    pub hide_emitters: bool,
}

/// How a path was found: by how many vertices from a light and from the camera, the lens counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Strategy {
    pub light: u16,
    pub camera: u16,
}

/// Who wants to know what each strategy found.
pub trait Tally {
    /// Whether light subpaths are connected with the lens.
    const SPLATS: bool;

    /// Light for the pixel at hand, before its weight.
    fn gather(&mut self, strategy: Strategy, light: Radiance, weight: Wide);

    /// Light for another pixel.
    fn splat(&mut self, strategy: Strategy, pixel: (u16, u16), light: Radiance, weight: Wide);
}

/// The sum that makes a picture.
struct Sum<'a, F> {
    light: Radiance,
    splats: &'a mut F,
}

impl<F: SplatSink> Tally for Sum<'_, F> {
    const SPLATS: bool = F::EXISTS;

    #[inline]
    fn gather(&mut self, _: Strategy, light: Radiance, weight: Wide) {
        self.light = self.light.add(light.scale(weight));
    }

    #[inline]
    fn splat(&mut self, _: Strategy, (x, y): (u16, u16), light: Radiance, weight: Wide) {
        self.splats.add(x, y, light.scale(weight));
    }
}

impl Bdpt {
    /// With memory for 8 vertices; roulette from the fifth segment on, as [`super::Path`].
    pub const fn new(max_depth: u16) -> Bdpt {
        Bdpt::with_capacity(max_depth)
    }
}

impl<const N: usize> Integrator for Bdpt<N> {
    #[inline]
    fn radiance(
        &self,
        view: &View,
        ray: Ray,
        sampler: &mut impl Sampler,
        splats: &mut impl SplatSink,
        rays: &mut u32,
    ) -> Radiance {
        let mut sum = Sum {
            light: Radiance::BLACK,
            splats,
        };
        self.follow(view, ray, sampler, &mut sum, rays);
        sum.light
    }
}

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
    /// Segments of the longest path that every strategy looks for.
    pub const FULL_DEPTH: u16 = N as u16 + 2;

    /// The same as [`Bdpt::new`] with memory for `N` vertices.
    pub const fn with_capacity(max_depth: u16) -> Bdpt<N> {
        Bdpt {
            max_depth,
            rr_depth: 5,
            hide_emitters: false,
        }
    }

    /// One sample: a camera subpath along `ray`, a light subpath, and what joins them.
    ///
    /// Draws as [`super::Path`] does; then for the light subpath which light (1-D), the place (2-D) and the direction
    /// (2-D), and at each of its vertices lobe (1-D), direction (2-D) and roulette (1-D), and a place on the lens (2-D) if
    /// there is one. In tiles there is no light subpath where the camera's has no vertex to connect it with.
    pub fn follow<'a>(
        &self,
        view: &View<'a>,
        ray: Ray,
        sampler: &mut impl Sampler,
        tally: &mut impl Tally,
        rays: &mut u32,
    ) {
        let mut vertices = Vec::new();
        self.camera_subpath(view, ray, sampler, tally, rays, &mut vertices);
        self.light_subpath(view, sampler, tally, rays, &vertices);
    }

    /// Follows the camera's ray: what emits on the way (no vertex from a light), light samples (one), and vertices to
    /// connect to.
    fn camera_subpath<'a, T: Tally>(
        &self,
        view: &View<'a>,
        ray: Ray,
        sampler: &mut impl Sampler,
        tally: &mut T,
        rays: &mut u32,
        vertices: &mut Vec<PathVertex<'a>, N>,
    ) {
        let scene = view.scene;
        let mut ray = ray;
        let mut partial = Partial::from_camera(view.film.density(ray.dir), T::SPLATS);
        let mut throughput = Radiance::WHITE;
        let mut eta_squared = Wide::ONE;
        // Of the direction that led here; none for the camera's and for a delta distribution's.
        let mut bsdf_pdf = Wide::ZERO;
        let mut depth = 0;
        // How many lights a camera ray may still pass through unseen, and how far it came meanwhile.
        let mut hidden = if self.hide_emitters { HIDDEN } else { 0 };
        let mut passed = 0i32;
        while depth < self.max_depth {
            depth += 1;
            *rays = rays.wrapping_add(1);
            // Of the last segment only light matters, unless it is the camera's own.
            let seen = if depth == self.max_depth && depth > 1 {
                scene.closest_light(&ray)
            } else {
                Some(scene.closest(&ray).map_or(Seen::Environment, Seen::Emitter))
            };
            let strategy = Strategy {
                light: 0,
                camera: depth + 1,
            };
            let hit = match seen {
                Some(Seen::Emitter(hit)) => hit,
                Some(Seen::Environment) if depth > 1 || !self.hide_emitters => {
                    let sample = scene.background_pdf(ray.dir);
                    let weight = if depth == 1 || sample.is_zero() {
                        // Nothing else finds it.
                        Wide::ONE
                    } else if depth > Self::FULL_DEPTH {
                        bsdf_weight(bsdf_pdf, sample)
                    } else {
                        // No light subpath begins there.
                        weight(Wide::ZERO, partial.shorter_at_light(sample, Wide::ZERO))
                    };
                    tally.gather(strategy, throughput.mul(scene.background(ray.dir)), weight);
                    break;
                }
                Some(Seen::Environment) | None => break,
            };
            let vertex = scene.vertex(&ray, &hit);
            if depth == 1 && hidden > 0 && vertex.is_emitter {
                hidden -= 1;
                depth = 0;
                passed = passed.saturating_add(hit.t);
                ray.origin = vertex.surface.leave(ray.dir);
                continue;
            }

            // Add what the surface emits.
            if let Some(light) = vertex.light {
                let weight = if depth == 1 {
                    Wide::ONE
                } else {
                    let sample = scene.light_pdf(light, ray.origin, ray.dir, &hit);
                    self.emission_weight(view, &partial, depth, bsdf_pdf, sample, light, &hit)
                };
                tally.gather(strategy, throughput.mul(vertex.emission), weight);
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
                self.sample_light(view, &at, light, place, tally, rays);
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

    /// The light that one sample of one light sends over a camera vertex.
    #[inline]
    fn sample_light(
        &self,
        view: &View,
        at: &PathVertex,
        light: u32,
        place: [Uniform; 2],
        tally: &mut impl Tally,
        rays: &mut u32,
    ) {
        let scene = view.scene;
        let surface = &at.vertex.surface;
        let Some(sample) = scene.sample_light(light, surface.point, place) else {
            return;
        };
        let Some((reflected, pdf)) = at.eval(sample.wi) else {
            return;
        };
        let shadow = Ray {
            origin: surface.leave(sample.wi),
            dir: sample.wi,
        };
        *rays = rays.wrapping_add(1);
        if scene.occluded(&shadow, sample.distance, sample.shape) {
            return;
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
            let emission = scene.emission_density(light, sample.triangle) / count;
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
    }

    /// Follows a ray of light, and connects each vertex with the lens and with the camera's.
    fn light_subpath<T: Tally>(
        &self,
        view: &View,
        sampler: &mut impl Sampler,
        tally: &mut T,
        rays: &mut u32,
        camera: &[PathVertex],
    ) {
        let scene = view.scene;
        // Segments of the longest paths to connect, and of the light's share in them.
        let full = self.max_depth.min(Self::FULL_DEPTH);
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
                for end in camera.iter().take_while(|end| end.depth + depth < full) {
                    if let Some((light, weight)) = connect(scene, end, &at, rays) {
                        let strategy = Strategy {
                            light: depth + 1,
                            camera: end.depth + 1,
                        };
                        tally.gather(strategy, light, weight);
                    }
                }
            }
            if depth >= longest {
                break;
            }
            let (lobe, direction, number) = (sampler.next_1d(), sampler.next_2d(), sampler.next_1d());
            let Some(onward) = scatter(&at, direction, lobe) else {
                break;
            };
            throughput = throughput.mul(light_weight(&onward.sample));
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
