//! How much light each light sends into the scene, and the choice that follows it.

use super::Scene;
use super::arrange::finite_box;
use crate::light::{Light, share_out};
use crate::num::Wide;
use crate::shape::Geometry;

impl<'a> Scene<'a> {
    /// Chooses lights by their power from here on: the more light one sends, the more often it is drawn.
    ///
    /// `table` holds the choice, one number fewer than there are lights to choose from ([`Self::light_count`]); with
    /// fewer, or with no choice, the scene stays as it is. Unbiased whatever the estimate of a power.
    pub fn choose_by_power(mut self, table: &'a mut [u32]) -> Scene<'a> {
        let bounds = self.light_count.saturating_sub(1) as usize;
        if bounds > 0
            && let Some(table) = table.get_mut(..bounds)
        {
            let extent = self.extent_squared();
            share_out(
                (0..self.light_count).map(|light| self.power(light, extent)),
                table,
            );
            self.parts.choice = table;
        }
        self
    }

    /// Luminance that a light sends out, W: of one infinitely far away, what of it falls on a disk as wide as the scene.
    fn power(&self, index: u32, extent: Wide) -> Wide {
        let square_metres = |area: Wide| area.shl(-2 * self.parts.unit.fraction_bits());
        let disk = square_metres(extent) * Wide::PI;
        match self.parts.lights.get(index as usize) {
            Some(Light::Point { intensity, .. }) => intensity.luminance() * Wide::PI.shl(2),
            Some(Light::Directional { irradiance, .. }) => irradiance.luminance() * disk,
            Some(Light::Area { shape, radiance }) => {
                radiance.luminance() * Wide::PI * square_metres(self.area(*shape))
            }
            Some(Light::Environment { .. }) => Wide::ZERO,
            None => self.environment.flux() * disk,
        }
    }

    /// Area that light is drawn from, units²; 0 for a shape that is none.
    fn area(&self, shape: u16) -> Wide {
        match self.parts.shapes.get(shape as usize).map(|shape| shape.geometry) {
            Some(Geometry::Sphere(sphere)) => sphere.radius_squared() * Wide::PI.shl(2),
            Some(Geometry::Disk(disk)) => disk.area(),
            Some(Geometry::Rectangle(rectangle)) => rectangle.area(),
            Some(Geometry::Mesh(index)) => match self.parts.meshes.get(index as usize) {
                Some(mesh) => (0..self.drawn_triangles(index).unwrap_or(0))
                    .map(|triangle| mesh.triangles.double_area(triangle).shl(-1))
                    .fold(Wide::ZERO, Wide::add),
                None => Wide::ZERO,
            },
            _ => Wide::ZERO,
        }
    }

    /// Square of the radius of a ball about all finite shapes, units²; of a metre if there are none.
    fn extent_squared(&self) -> Wide {
        let diagonal = finite_box(&self.parts).and_then(|(low, high)| low.to(high).normalize());
        match diagonal {
            Some((_, norm)) => norm.square().shl(-2),
            None => Wide::new(1, 2 * self.parts.unit.fraction_bits()),
        }
    }
}
