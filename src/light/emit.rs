use super::{Emitter, area};
use crate::color::Radiance;
use crate::geom::{Frame, Point, Ray};
use crate::num::{Uniform, Wide};
use crate::sampler::warp;

/// A ray of light as it leaves a light, drawn from all that the light emits.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    pub ray: Ray,
    /// Radiance times cosine (of a point light: intensity) over `density`, lengths in units.
    pub power: Radiance,
    /// Of the place (units⁻², 1 for a point light) times of the direction (sr⁻¹, over the cosine at a surface).
    pub density: Wide,
    /// The emitter's triangle, 0 where it is no mesh.
    pub triangle: u32,
}

/// From a place on the emitter, uniform by area, to its bright side by cosine: density 1/(π A).
pub fn emit_area(
    emitter: Emitter,
    radiance: Radiance,
    place: [Uniform; 2],
    direction: [Uniform; 2],
) -> Option<Emission> {
    let (surface, _) = area::sample_surface(emitter, place)?;
    let drawn = warp::sample_cosine_hemisphere(direction);
    let dir = Frame::about(surface.normal).to_world(drawn);
    let density = area_density(emitter);
    Some(Emission {
        ray: Ray {
            origin: surface.leave(dir),
            dir,
        },
        power: radiance.scale(density.recip()),
        density,
        triangle: 0,
    })
}

/// From the point to all around: density 1/(4π). `fraction_bits` as in [`crate::geom::Unit`].
pub fn emit_point(
    position: Point,
    intensity: Radiance,
    direction: [Uniform; 2],
    fraction_bits: i32,
) -> Emission {
    Emission {
        ray: Ray {
            origin: position,
            dir: warp::sample_sphere(direction),
        },
        power: intensity.scale(POINT_DENSITY.recip().shl(2 * fraction_bits)),
        density: POINT_DENSITY,
        triangle: 0,
    }
}

/// [`Emission::density`] of a point light: 1/(4π).
pub const POINT_DENSITY: Wide = Wide::INV_PI.shl(-2);

/// [`Emission::density`] of a shape: 1/(π A), 0 for one that can't be drawn from.
pub fn area_density(emitter: Emitter) -> Wide {
    let area = area::surface_area(emitter);
    if area.is_zero() {
        Wide::ZERO
    } else {
        Wide::INV_PI / area
    }
}
