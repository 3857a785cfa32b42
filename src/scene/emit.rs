//! Light as it leaves the lights: the beginnings of paths that come from them.

use super::{Hit, Scene};
use crate::geom::Point;
use crate::light::{self, Emission, Emitter, Light, LightSample};
use crate::num::{Uniform, Wide};
use crate::shape::Geometry;

impl Scene<'_> {
    /// A ray of light from light number `index`, as [`Self::sample_light`] counts them; `None` where none can be drawn.
    ///
    /// What is divided by is the density of the light's own rays, without that of its choice.
    pub fn emit(&self, index: u32, place: [Uniform; 2], direction: [Uniform; 2]) -> Option<Emission> {
        let Some(light) = self.parts.lights.get(index as usize) else {
            let sample = self.environment_of(index)?.sample(direction)?;
            let light = sample.radiance.scale(sample.pdf.recip());
            return self.emit_from(sample.wi, light, sample.pdf, place);
        };
        match *light {
            Light::Point { position, intensity } => {
                let bits = self.parts.unit.fraction_bits();
                Some(light::emit_point(position, intensity, direction, bits))
            }
            Light::Area { shape, radiance } => {
                let geometry = &self.parts.shapes.get(shape as usize)?.geometry;
                let Geometry::Mesh(mesh) = *geometry else {
                    return light::emit_area(Emitter::Shape(geometry), radiance, place, direction);
                };
                let count = self.drawn_triangles(mesh)?;
                let (triangle, rest) = light::choose(place[0], count);
                let emitter = self.triangle(mesh, triangle)?;
                let emission = light::emit_area(emitter, radiance, [rest, place[1]], direction)?;
                Some(Emission { triangle, ..emission })
            }
            Light::Directional {
                direction,
                irradiance,
            } => self.emit_from(-direction, irradiance, Wide::ONE, place),
            Light::Environment { .. } => None,
        }
    }

    /// [`Emission::density`] of what a light that has a place emits, from a triangle of it if it is a mesh; 0 where
    /// [`Self::emit`] draws nothing.
    pub fn emission_density(&self, index: u32, triangle: u32) -> Wide {
        match self.parts.lights.get(index as usize) {
            Some(Light::Point { .. }) => light::POINT_DENSITY,
            Some(Light::Area { shape, .. }) => match self.parts.shapes.get(*shape as usize) {
                Some(shape) => match shape.geometry {
                    Geometry::Mesh(mesh) => self
                        .triangle(mesh, triangle)
                        .map_or(Wide::ZERO, light::area_density),
                    _ => light::area_density(Emitter::Shape(&shape.geometry)),
                },
                None => Wide::ZERO,
            },
            _ => Wide::ZERO,
        }
    }

    /// [`Emission::density`] of the ray of light number `index` that arrives first at `from`, as a sample of it does.
    pub fn sample_emission_density(&self, index: u32, sample: &LightSample, from: Point) -> Wide {
        match self.parts.lights.get(index as usize) {
            Some(Light::Directional { .. }) => self.distant_density(from, sample.wi),
            None => sample.pdf * self.distant_density(from, sample.wi),
            _ => self.emission_density(index, sample.triangle),
        }
    }

    /// The density with which [`Self::sample_light`] drew a sample of light number `index`: per solid angle; of a point
    /// light, whose place is certain, per solid angle that a unit² there fills.
    pub fn sample_density(&self, index: u32, sample: &LightSample) -> Wide {
        match self.parts.lights.get(index as usize) {
            Some(Light::Point { .. }) => {
                let distance = Wide::new(sample.distance as u32, 0);
                distance * distance
            }
            Some(Light::Directional { .. }) => Wide::ONE,
            _ => sample.pdf,
        }
    }

    /// The same for the sample that would lead from `at`, which a ray of light reached after `distance`, back to where it
    /// came from.
    pub fn emission_sample_density(&self, index: u32, emission: &Emission, at: Point, distance: i32) -> Wide {
        match self.parts.lights.get(index as usize) {
            Some(Light::Point { .. }) => {
                let distance = Wide::new(distance as u32, 0);
                distance * distance
            }
            Some(Light::Area { shape, .. }) => {
                let hit = Hit {
                    t: distance,
                    shape: *shape,
                    triangle: emission.triangle,
                    barycentric: [0; 2],
                };
                self.shape_pdf(at, -emission.ray.dir, &hit)
            }
            Some(Light::Directional { .. }) => Wide::ONE,
            Some(Light::Environment { .. }) => Wide::ZERO,
            None => self.distant_pdf(emission),
        }
    }

    /// Whether light number `index` is one that no ray meets: a point, or parallel.
    pub fn is_delta_light(&self, index: u32) -> bool {
        matches!(
            self.parts.lights.get(index as usize),
            Some(Light::Point { .. } | Light::Directional { .. })
        )
    }
}
