//! The scene's lights: which is chosen how often, and what it sends where.

use super::{Hit, Scene};
use crate::color::Radiance;
use crate::geom::{Dir, FAR, Point};
use crate::light::{self, Emitter, Environment, Light, LightSample};
use crate::num::{Uniform, Wide};
use crate::shape::{Geometry, Surface};

impl<'a> Scene<'a> {
    /// How many lights [`Self::sample_light`] draws from.
    #[inline]
    pub fn light_count(&self) -> u32 {
        self.light_count
    }

    /// What comes from where nothing is: see [`Self::background`].
    #[inline]
    pub fn environment(&self) -> &Environment<'a> {
        &self.environment
    }

    /// The radiance from infinitely far away that is seen along a direction.
    #[inline]
    pub fn background(&self, dir: Dir) -> Radiance {
        self.environment.radiance(dir)
    }

    /// The density per solid angle with which choosing the environment and sampling it would have led to a direction; 0
    /// if it is not sampled.
    #[inline]
    pub fn background_pdf(&self, dir: Dir) -> Wide {
        if self.environment.is_sampled() {
            self.environment.pdf(dir) * self.light_chance(self.light_count - 1)
        } else {
            Wide::ZERO
        }
    }

    /// One of the lights by a number, and what is left of it as a new one.
    #[inline]
    pub fn choose_light(&self, u: Uniform) -> (u32, Uniform) {
        if self.parts.choice.is_empty() {
            light::choose(u, self.light_count)
        } else {
            light::choose_by(u, self.parts.choice)
        }
    }

    /// How often [`Self::choose_light`] takes a light; the environment, if it is sampled, is the last.
    #[inline]
    pub fn light_chance(&self, index: u32) -> Wide {
        if self.light_count == 1 {
            Wide::ONE
        } else if self.parts.choice.is_empty() {
            Wide::new(self.light_count, 0).recip()
        } else {
            light::chance_by(index as usize, self.parts.choice)
        }
    }

    /// A density on a light as that of a light that is chosen: times [`Self::light_chance`], which is mostly 1.
    #[inline]
    pub(crate) fn pdf_of_chosen(&self, index: u32, pdf: Wide) -> Wide {
        if self.light_count == 1 {
            pdf
        } else {
            pdf * self.light_chance(index)
        }
    }

    /// A direction from a place towards light number `index`; `None` where it can send nothing. The shadow ray begins where
    /// [`Surface::leave`] says.
    #[inline]
    pub fn sample_light(&self, index: u32, from: &Surface, u: [Uniform; 2]) -> Option<LightSample> {
        let Some(light) = self.parts.lights.get(index as usize) else {
            return self.sample_background(index, u);
        };
        match *light {
            Light::Point { position, intensity } => {
                light::sample_point(position, intensity, from.point, self.parts.unit.fraction_bits())
            }
            Light::Directional {
                direction,
                irradiance,
            } => Some(light::sample_directional(direction, irradiance)),
            Light::Area { shape, radiance } => {
                let geometry = &self.parts.shapes.get(shape as usize)?.geometry;
                let Geometry::Mesh(mesh) = *geometry else {
                    let sample = light::sample_area(Emitter::Shape(geometry), radiance, from, u)?;
                    let is_sphere = matches!(geometry, Geometry::Sphere(_));
                    return Some(LightSample {
                        shape: is_sphere.then_some(shape),
                        ..sample
                    });
                };
                let count = self.drawn_triangles(mesh)?;
                let (triangle, rest) = light::choose(u[0], count);
                let sample =
                    light::sample_area(self.triangle(mesh, triangle)?, radiance, from, [rest, u[1]])?;
                Some(LightSample { triangle, ..sample })
            }
            Light::Environment { .. } => None,
        }
    }

    /// The environment, if it is light number `index`.
    pub(super) fn environment_of(&self, index: u32) -> Option<&Environment<'a>> {
        (index == self.light_count.wrapping_sub(1)).then_some(&self.environment)
    }

    fn sample_background(&self, index: u32, u: [Uniform; 2]) -> Option<LightSample> {
        let sample = self.environment_of(index)?.sample(u)?;
        Some(LightSample {
            wi: sample.wi,
            distance: FAR + 1,
            radiance: sample.radiance,
            pdf: sample.pdf,
            shape: None,
            triangle: 0,
        })
    }

    /// The density per solid angle with which choosing a light and sampling it would have led to this hit.
    #[inline]
    pub fn light_pdf(&self, light: u16, from: Point, wi: Dir, hit: &Hit) -> Wide {
        let Some(shape) = self.parts.shapes.get(hit.shape as usize) else {
            return Wide::ZERO;
        };
        debug_assert_eq!(shape.light, Some(light));
        self.pdf_of_chosen(u32::from(light), self.shape_pdf(from, wi, hit))
    }

    /// The same if the light is chosen already.
    #[inline]
    pub(super) fn shape_pdf(&self, from: Point, wi: Dir, hit: &Hit) -> Wide {
        let Some(shape) = self.parts.shapes.get(hit.shape as usize) else {
            return Wide::ZERO;
        };
        let emitter = match shape.geometry {
            Geometry::Mesh(mesh) => self.triangle(mesh, hit.triangle),
            _ => Some(Emitter::Shape(&shape.geometry)),
        };
        emitter.map_or(Wide::ZERO, |emitter| light::pdf_area(emitter, from, wi, hit.t))
    }

    /// How many triangles a mesh that emits light is drawn from. Those of a packed mesh are not: their numbers have gaps,
    /// and it is found by BSDF sampling alone, with weight 1.
    pub(super) fn drawn_triangles(&self, mesh: u16) -> Option<u32> {
        let mesh = self.parts.meshes.get(mesh as usize)?;
        Some(mesh.triangles.plain()?.triangles.len() as u32)
    }

    /// A triangle as one of its mesh's, any of which may be drawn.
    pub(super) fn triangle(&self, mesh: u16, triangle: u32) -> Option<Emitter<'a>> {
        let count = self.drawn_triangles(mesh)?;
        let mesh = &self.parts.meshes.get(mesh as usize)?.triangles;
        Some(Emitter::Triangle {
            corners: mesh.corners(triangle)?.map(|corner| mesh.grid().to_scene(corner)),
            normal: mesh.normal(triangle)?,
            lift: mesh.offset(),
            area: mesh.double_area(triangle).shl(-1),
            chance: Wide::new(count, 0).recip(),
        })
    }
}
