use super::mis::weight_over_density;
use super::{First, Integrator, NoWitness, SplatSink, View, Witness, power_heuristic};
use crate::color::Radiance;
use crate::geom::Ray;
use crate::material::Density;
use crate::num::{Uniform, Wide};
use crate::sampler::Sampler;
use crate::scene::{Ahead, Prospect, Scene, Seen, ShapeSet, Vertex};

/// Path tracing: at each vertex a light is sampled and the BSDF is sampled, joined by multiple importance sampling.
///
/// Kajiya, "The Rendering Equation", 1986; Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997,
/// chapter 9.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Path {
    /// Paths of at most this many segments: 1 for emission only, 2 for direct light.
    pub max_depth: u16,
    /// From this many segments on, Russian roulette may end a path.
    pub rr_depth: u16,
    /// The camera itself sees through lights that are shapes (up to 8 in a row), and no environment.
    pub hide_emitters: bool,
}

/// Emitting shapes that one camera ray may pass through.
const HIDDEN: u8 = 8;

impl Path {
    /// As Mitsuba has it: roulette from the fifth segment on.
    pub const fn new(max_depth: u16) -> Path {
        Path {
            max_depth,
            rr_depth: 5,
            hide_emitters: false,
        }
    }

    /// Direct light only: paths of at most two segments.
    pub const fn direct() -> Path {
        Path::new(2)
    }

    /// One sample of the radiance that comes back along the ray.
    ///
    /// Draws the same numbers at each vertex whatever it finds there: light choice and roulette (1-D), place on the
    /// light (2-D), lobe (1-D), direction (2-D).
    ///
    /// `rays` counts what was asked of the scene, nearest hits and shadow rays.
    pub fn radiance(&self, scene: &Scene, ray: Ray, sampler: &mut impl Sampler, rays: &mut u32) -> Radiance {
        self.follow(scene, Ahead::ANY, ray, sampler, rays, &mut NoWitness)
    }

    /// [`Self::radiance`] along a ray of which `ahead` tells what it may meet, with `witness` told of what the path meets.
    #[inline]
    pub fn follow(
        &self,
        scene: &Scene,
        ahead: Ahead,
        ray: Ray,
        sampler: &mut impl Sampler,
        rays: &mut u32,
        witness: &mut impl Witness,
    ) -> Radiance {
        let (mut ray, mut ahead) = (ray, ahead);
        let mut sum = Radiance::BLACK;
        let mut throughput = Radiance::WHITE;
        let mut eta_squared = Wide::ONE;
        // Of the direction that led here; none for the camera's and for a delta distribution's.
        let mut density = Density::Told(Wide::ZERO);
        let mut depth = 0;
        // How many lights a camera ray may still pass through unseen.
        let mut hidden = if self.hide_emitters { HIDDEN } else { 0 };
        if self.max_depth == 0 {
            return sum;
        }
        // What the segment ends on.
        *rays += 1;
        let mut end = scene.closest_among(&ray, ahead.seen);
        loop {
            depth += 1;
            let hit = match end {
                Some(hit) => hit,
                None if depth > 1 || !self.hide_emitters => {
                    witness.nothing(&ray, throughput);
                    let mut background = throughput.mul(scene.background(ray.dir));
                    let light_pdf = scene.background_pdf(ray.dir);
                    let bsdf_pdf = density.tell();
                    if !bsdf_pdf.is_zero() && !light_pdf.is_zero() {
                        background = background.scale(power_heuristic(bsdf_pdf, light_pdf));
                    }
                    sum = sum.add(background);
                    break;
                }
                None => {
                    witness.nothing(&ray, throughput);
                    break;
                }
            };
            let vertex = scene.vertex(&ray, &hit);
            if depth == 1 && hidden > 0 && vertex.is_emitter {
                hidden -= 1;
                witness.passed(hit.t);
                depth = 0;
                ray.origin = vertex.surface.leave(ray.dir);
                ahead = Ahead::ANY;
                *rays += 1;
                end = scene.closest(&ray);
                continue;
            }

            witness.surface(scene, &hit, &vertex, throughput);

            // Add what the surface emits, weighted against the light sample that could have found it.
            if let Some(light) = vertex.light {
                let bsdf_pdf = density.tell();
                let weight = if bsdf_pdf.is_zero() {
                    Wide::ONE
                } else {
                    power_heuristic(bsdf_pdf, scene.light_pdf(light, ray.origin, ray.dir, &hit))
                };
                sum = sum.add(throughput.mul(vertex.emission).scale(weight));
            }
            if depth >= self.max_depth {
                break;
            }

            let (choice, place) = (sampler.next_1d(), sampler.next_2d());
            let (lobe, direction) = (sampler.next_1d(), sampler.next_2d());
            let (light, roulette) = scene.choose_light(choice);
            let prospect = scene.prospect(&vertex);
            if vertex.material.is_smooth() && !prospect.is_dark() {
                let direct =
                    self.sample_light(scene, ahead.shading, (&vertex, &prospect), light, place, rays);
                // To the camera's own vertex nothing led that takes light away.
                sum = sum.add(if depth == 1 {
                    direct
                } else {
                    throughput.mul(direct)
                });
            }

            // Of the last segment only light matters: mostly there is none, and what would come of it does not matter either.
            let is_last = depth + 1 == self.max_depth;
            if is_last && !prospect.may_end_on_light(direction) {
                break;
            }

            // Go on in a direction drawn from the BSDF.
            ahead = Ahead::ANY;
            let Some(drawn) = vertex.draw(direction, lobe) else {
                break;
            };
            ray = Ray {
                origin: vertex.surface.leave(drawn.wi),
                dir: drawn.wi,
            };
            if is_last {
                *rays += 1;
                end = match scene.closest_light(&ray) {
                    Some(Seen::Emitter(hit)) => Some(hit),
                    Some(Seen::Environment) => None,
                    None => break,
                };
            }
            let (told, sample) = (drawn.density(), drawn.weigh());
            throughput = throughput.mul(sample.weight);
            if throughput.is_black() {
                break;
            }
            if sample.eta_squared != Wide::ONE {
                eta_squared = eta_squared * sample.eta_squared;
            }
            density = told;

            // End paths that carry little, and let the others make up for it.
            if depth >= self.rr_depth {
                let survival = (throughput.max_channel() * eta_squared).to_fixed(16).min(62_259);
                if (roulette.to_bits() >> 16) >= survival {
                    break;
                }
                throughput = throughput.scale(Wide::new(survival, -16).recip());
            }
            if !is_last {
                *rays += 1;
                end = scene.closest_from(&ray, hit.shape);
            }
        }
        sum
    }

    /// The light that one sample of one light sends over the vertex, weighted against the BSDF sample that could have
    /// found it.
    #[cfg_attr(narrow_mul, inline(never))]
    #[cfg_attr(not(narrow_mul), inline)]
    fn sample_light(
        &self,
        scene: &Scene,
        shading: ShapeSet,
        (vertex, prospect): (&Vertex, &Prospect),
        light: u32,
        place: [Uniform; 2],
        rays: &mut u32,
    ) -> Radiance {
        let Some(sample) = scene.sample_light(light, &vertex.surface, place) else {
            return Radiance::BLACK;
        };
        let Some((reflected, bsdf_pdf)) = vertex.eval_with(prospect, sample.wi) else {
            return Radiance::BLACK;
        };
        let shadow = Ray {
            origin: vertex.surface.leave(sample.wi),
            dir: sample.wi,
        };
        *rays += 1;
        let shading = if shading == ShapeSet::ALL {
            scene.shade_at(vertex.surface.point)
        } else {
            shading
        };
        if scene.occluded_by(shading, &shadow, sample.distance, sample.shape) {
            return Radiance::BLACK;
        }
        let arriving = reflected.mul(sample.radiance);
        // One of several is chosen: the density is that much smaller.
        if sample.is_delta() {
            return arriving.scale(scene.light_chance(light).recip());
        }
        let pdf = scene.pdf_of_chosen(light, sample.pdf);
        arriving.scale(weight_over_density(pdf, bsdf_pdf))
    }
}

impl Integrator for Path {
    #[inline]
    fn radiance(
        &self,
        view: &View,
        ray: Ray,
        sampler: &mut impl Sampler,
        _: &mut impl SplatSink,
        rays: &mut u32,
    ) -> Radiance {
        self.follow(view.scene, view.ahead, ray, sampler, rays, &mut NoWitness)
    }

    fn sense(&self, view: &View, ray: Ray, sampler: &mut impl Sampler, rays: &mut u32) -> (Radiance, First) {
        let mut first = First::new();
        let light = self.follow(view.scene, view.ahead, ray, sampler, rays, &mut first);
        (light, first.settled(view, ray, rays))
    }
}
