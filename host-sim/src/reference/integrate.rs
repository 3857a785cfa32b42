//! Radiance along a ray: the rendering equation by random walks (Kajiya 1986).
//!
//! Two estimators of the same number, which share the scene and the hits but not how light is found: `guided` chooses
//! points on the lights and joins them with the material's own directions; `blind` only walks on. And one of another number:
//! how open to the sky a place is.

use super::bsdf::Surface;
use super::light::{Arrival, From, Lights};
use super::render::{Estimator, Settings};
use super::scene::{Material, Ray, Scene, scale};
use super::shape::{Hit, closest, occluded};
use super::strata::Sampler;
use super::vec::{Rgb, Vec3};
use super::warp;

/// Slots of the sampler: the pixel and the lens, then two diffuse vertices: a direction and up to this many lights.
const LIGHT_SLOTS: usize = 4;
const VERTEX_SLOTS: usize = 1 + LIGHT_SLOTS;
pub const PIXEL_SLOT: usize = 0;
pub const LENS_SLOT: usize = 1;
const FIRST_VERTEX_SLOT: usize = 2;
pub const SLOTS: usize = FIRST_VERTEX_SLOT + 2 * VERTEX_SLOTS;

/// Offset of a new ray's origin from its surface, relative to the scene or to the point's coordinates.
///
/// A hit point is off its surface by a few times 2⁻⁵³ ≈ 1e-16 of the largest length involved (ray, coordinates, radius).
/// 1e-9 leaves seven digits above that, enough for grazing rays, and is far below a pixel or any feature of a scene.
const OFFSET: f64 = 1e-9;

/// A scene made ready for one picture.
pub struct World<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    lights: Lights,
    scale: f64,
}

/// How the ray under way was chosen.
struct Last {
    point: Vec3,
    /// `None` if no light sample competes with it: from the camera or a specular surface.
    pdf: Option<f64>,
}

impl<'a> World<'a> {
    pub fn new(scene: &'a Scene, settings: &'a Settings) -> World<'a> {
        World {
            scene,
            settings,
            lights: Lights::new(scene),
            scale: scale(scene),
        }
    }

    /// Radiance that arrives at the origin of a camera ray. Adds the rays it traced to `rays`.
    pub fn radiance(&self, ray: Ray, sampler: &mut Sampler, rays: &mut u64) -> Rgb {
        match self.settings.estimator {
            Estimator::Guided => self.guided(ray, sampler, rays),
            Estimator::Blind => self.blind(ray, sampler, rays),
            Estimator::AmbientOcclusion { radius } => self.ambient_occlusion(ray, radius, sampler, rays),
        }
    }

    /// The share of the hemisphere, by the cosine, from which nothing within `radius` hides the point that is seen.
    fn ambient_occlusion(&self, ray: Ray, radius: f64, sampler: &mut Sampler, rays: &mut u64) -> Rgb {
        *rays += 1;
        let Some(hit) = closest(self.scene, &ray) else {
            return Rgb::ZERO;
        };
        let surface = Surface::new(&ray, &hit);
        let wi = surface
            .shading
            .frame_to_world(warp::cosine_hemisphere(sampler.slot(FIRST_VERTEX_SLOT)));
        if surface.normal.dot(wi) <= 0.0 {
            return Rgb::ZERO;
        }
        *rays += 1;
        match self.blocked(&surface, wi, radius) {
            true => Rgb::ZERO,
            false => Rgb::ONE,
        }
    }

    fn guided(&self, mut ray: Ray, sampler: &mut Sampler, rays: &mut u64) -> Rgb {
        let mut radiance = Rgb::ZERO;
        let mut throughput = Rgb::ONE;
        let mut eta = 1.0;
        let mut last = Last {
            point: ray.origin,
            pdf: None,
        };
        let mut slot = FIRST_VERTEX_SLOT;
        for segments in 1.. {
            if self.settings.max_depth.is_some_and(|limit| segments > limit) {
                break;
            }
            let Some(hit) = self.follow(ray, segments, rays) else {
                let weight = |pdf| last.pdf.map_or(1.0, |mine| power_heuristic(mine, pdf));
                radiance += throughput * self.background(ray.direction, segments, weight);
                break;
            };

            // Light emitted towards us, weighted against having chosen this point as a light sample.
            if let Some(emission) = self.emission(&hit, segments) {
                let weight = match last.pdf {
                    Some(pdf) => power_heuristic(pdf, self.lights.pdf(last.point, &hit)),
                    None => 1.0,
                };
                radiance += throughput * emission * weight;
            }
            if self.settings.max_depth == Some(segments) {
                break;
            }

            // Light that arrives directly from each light.
            let surface = Surface::new(&ray, &hit);
            let material = self.material(&hit);
            if !material.is_specular() {
                radiance += throughput * self.direct(&surface, &material, slot + 1, sampler, rays);
            }

            // The next segment, as the material likes it.
            let u = if material.is_specular() {
                [0.0; 2]
            } else {
                sampler.slot(slot)
            };
            let Some(bounce) = material.sample(&surface, u, sampler.rng.uniform()) else {
                break;
            };
            throughput *= bounce.weight;
            eta *= bounce.eta;
            last = Last {
                point: surface.point,
                pdf: bounce.pdf,
            };
            ray = self.leave(&surface, bounce.wi);
            if !material.is_specular() {
                slot += VERTEX_SLOTS;
            }
            if !self.survives(&mut throughput, eta, segments, sampler) {
                break;
            }
        }
        radiance
    }

    fn blind(&self, mut ray: Ray, sampler: &mut Sampler, rays: &mut u64) -> Rgb {
        let mut radiance = Rgb::ZERO;
        let mut throughput = Rgb::ONE;
        let mut eta = 1.0;
        for segments in 1..=self.settings.max_depth.unwrap_or(u32::MAX) {
            let Some(hit) = self.follow(ray, segments, rays) else {
                return radiance + throughput * self.background(ray.direction, segments, |_| 1.0);
            };
            if let Some(emission) = self.emission(&hit, segments) {
                radiance += throughput * emission;
            }
            let surface = Surface::new(&ray, &hit);
            let u = sampler.rng.pair();
            let Some(bounce) = self
                .material(&hit)
                .sample_uniform(&surface, u, sampler.rng.uniform())
            else {
                break;
            };
            throughput *= bounce.weight;
            eta *= bounce.eta;
            ray = self.leave(&surface, bounce.wi);
            if !self.survives(&mut throughput, eta, segments, sampler) {
                break;
            }
        }
        radiance
    }

    /// Light of one point on each light, scattered towards the eye.
    fn direct(
        &self,
        surface: &Surface,
        material: &Material,
        slot: usize,
        sampler: &mut Sampler,
        rays: &mut u64,
    ) -> Rgb {
        let mut sum = Rgb::ZERO;
        for (index, light) in self.lights.each.iter().enumerate() {
            let planned = index < LIGHT_SLOTS && slot < SLOTS;
            let u = if planned {
                sampler.slot(slot + index)
            } else {
                sampler.rng.pair()
            };
            let Some(arrival) = light.sample(surface.point, u) else {
                continue;
            };
            let (scattered, pdf) = material.eval(surface, arrival.wi);
            if scattered == Rgb::ZERO {
                continue;
            }
            *rays += 1;
            if !self.arrives(surface, &arrival) {
                continue;
            }
            let weight = match arrival.pdf {
                Some(light_pdf) => power_heuristic(light_pdf, pdf),
                None => 1.0,
            };
            sum += scattered * arrival.weight * weight;
        }
        sum
    }

    /// The nearest hit, past the emitters that a camera ray is not to see.
    fn follow(&self, mut ray: Ray, segments: u32, rays: &mut u64) -> Option<Hit> {
        loop {
            *rays += 1;
            let hit = closest(self.scene, &ray)?;
            let hidden = segments == 1 && self.settings.hide_emitters;
            if !(hidden && self.scene.shapes[hit.shape].emission.is_some()) {
                return Some(hit);
            }
            ray = self.leave(&Surface::new(&ray, &hit), ray.direction);
        }
    }

    fn background(&self, direction: Vec3, segments: u32, weight: impl Fn(f64) -> f64) -> Rgb {
        if segments == 1 && self.settings.hide_emitters {
            Rgb::ZERO
        } else {
            self.lights.background(direction, weight)
        }
    }

    fn emission(&self, hit: &Hit, segments: u32) -> Option<Rgb> {
        let visible = hit.front && !(segments == 1 && self.settings.hide_emitters);
        self.scene.shapes[hit.shape].emission.filter(|_| visible)
    }

    fn material(&self, hit: &Hit) -> Material {
        self.scene.materials[self.scene.shapes[hit.shape].material].tinted(hit.tint)
    }

    /// A ray from the surface, its origin moved off it to the side it leaves by.
    fn leave(&self, surface: &Surface, direction: Vec3) -> Ray {
        let length = OFFSET * self.scale.max(surface.point.abs().max_component());
        let side = length.copysign(surface.normal.dot(direction));
        Ray {
            origin: surface.point + surface.normal * side,
            direction,
        }
    }

    fn arrives(&self, surface: &Surface, arrival: &Arrival) -> bool {
        match arrival.from {
            From::Distance(distance) => !self.blocked(surface, arrival.wi, distance),
            From::Shape(shape) => closest(self.scene, &self.leave(surface, arrival.wi))
                .is_some_and(|hit| hit.shape == shape && hit.front),
        }
    }

    fn blocked(&self, surface: &Surface, wi: Vec3, distance: f64) -> bool {
        let mut ray = self.leave(surface, wi);
        if distance == f64::INFINITY {
            return occluded(self.scene, &ray, distance);
        }
        // From the moved origin to the same point on the light, and not quite there.
        let to_light = surface.point + wi * distance - ray.origin;
        ray.direction = to_light.normalized();
        occluded(self.scene, &ray, to_light.length() * (1.0 - OFFSET))
    }

    /// Russian roulette after `rr_depth` segments: paths that carry little end, the others carry more.
    ///
    /// `eta` takes out the factor 1/η² that radiance only carries while it is inside glass.
    fn survives(&self, throughput: &mut Rgb, eta: f64, segments: u32, sampler: &mut Sampler) -> bool {
        let carried = throughput.max_component();
        if carried == 0.0 {
            return false;
        }
        if segments < self.settings.rr_depth {
            return true;
        }
        let chance = (carried * eta * eta).min(0.95);
        *throughput *= 1.0 / chance;
        sampler.rng.uniform() < chance
    }
}

/// Veach 1997, equation 9.13 with β = 2 and one sample from each technique.
fn power_heuristic(mine: f64, other: f64) -> f64 {
    let ratio = other / mine;
    1.0 / (1.0 + ratio * ratio)
}
