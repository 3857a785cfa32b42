//! What emits: each light draws a direction towards itself, and says with what density it would have. Lights never
//! trace rays.

mod area;
mod choice;
mod emit;
mod environment;
mod map;
mod sky;

use crate::color::Radiance;
use crate::geom::{Dir, FAR, Point};
use crate::num::Wide;
use crate::shape::Geometry;

pub(crate) use area::short_of;
pub use area::{pdf_area, sample_area, sample_surface, surface_area};
pub use choice::{chance_by, choose, choose_by, share_out};
pub use emit::{Emission, POINT_DENSITY, area_density, emit_area, emit_point};
pub use environment::{Environment, EnvironmentSample};
pub use map::{Map, MapError, MapParts};
pub use sky::{Sky, Sun};

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// Radiant intensity, W·sr⁻¹; falls off by 1/d², d in metres.
    Point { position: Point, intensity: Radiance },
    /// Irradiance on a plane facing it, W·m⁻²; `direction` is the way the light travels.
    Directional { direction: Dir, irradiance: Radiance },
    /// A shape that emits on the side of its normal, W·sr⁻¹·m⁻².
    Area { shape: u16, radiance: Radiance },
    /// The same radiance from all around, W·sr⁻¹·m⁻².
    ///
    /// It is found by directions drawn from the BSDF alone: for a constant radiance they are the better ones.
    Environment { radiance: Radiance },
}

/// A direction towards a light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    pub wi: Dir,
    /// Nothing may stand nearer than this along `wi`, units.
    pub distance: i32,
    /// What arrives along `wi` if nothing does; of a delta light, already integrated.
    pub radiance: Radiance,
    /// Per solid angle; [`Wide::ZERO`] for a delta light.
    pub pdf: Wide,
    /// The sphere that the light is: it does not stand in its own way, however the distance was rounded at its rim.
    pub shape: Option<u16>,
    /// The triangle that was drawn, 0 where the light is no mesh.
    pub triangle: u32,
}

impl LightSample {
    /// A delta light: no direction drawn from a BSDF hits it.
    pub const fn is_delta(&self) -> bool {
        self.pdf.is_zero()
    }
}

/// A point light seen from `from`: I/d². `fraction_bits` as in [`crate::geom::Unit`].
#[inline]
pub fn sample_point(
    position: Point,
    intensity: Radiance,
    from: Point,
    fraction_bits: i32,
) -> Option<LightSample> {
    let (wi, norm) = from.to(position).normalize()?;
    let square = norm.square().shl(-2 * fraction_bits);
    Some(LightSample {
        wi,
        distance: norm.length(),
        radiance: intensity.scale(square.recip()),
        pdf: Wide::ZERO,
        shape: None,
        triangle: 0,
    })
}

/// Parallel light.
#[inline]
pub fn sample_directional(direction: Dir, irradiance: Radiance) -> LightSample {
    LightSample {
        wi: -direction,
        distance: FAR,
        radiance: irradiance,
        pdf: Wide::ZERO,
        shape: None,
        triangle: 0,
    }
}

/// What an area light needs of its shape: closed forms know, a mesh has its triangle looked up.
#[derive(Clone, Copy, Debug)]
pub enum Emitter<'a> {
    Shape(&'a Geometry),
    /// One triangle of a mesh, and the chance that just it is drawn.
    Triangle {
        corners: [Point; 3],
        normal: Dir,
        lift: i32,
        area: Wide,
        chance: Wide,
    },
}
