//! Vertices of subpaths, and how they look from either side.

use super::weight::Partial;
use crate::color::Radiance;
use crate::geom::{Dir, Ray};
use crate::material::BsdfSample;
use crate::num::{Uniform, Wide};
use crate::scene::Vertex;

/// Where a subpath met a surface.
#[derive(Clone, Copy, Debug)]
pub struct PathVertex<'a> {
    pub vertex: Vertex<'a>,
    /// Of the subpath up to here, over its density: of importance, or of light.
    pub throughput: Radiance,
    pub partial: Partial,
    /// Segments from the subpath's beginning.
    pub depth: u16,
}

impl PathVertex<'_> {
    /// What the surface passes on from `vertex.wo`'s end to `dir` of radiance that comes from `dir`, times the cosine
    /// there; and the density of that direction.
    #[inline]
    pub fn eval(&self, dir: Dir) -> Option<(Radiance, Wide)> {
        self.vertex.eval(dir)
    }

    /// The same of light that comes from `vertex.wo`'s end.
    #[inline]
    pub fn eval_light(&self, dir: Dir) -> Option<(Radiance, Wide)> {
        let vertex = &self.vertex;
        if vertex.is_reciprocal() {
            let (value, pdf) = vertex.eval(dir)?;
            return Some((scaled(value, vertex.eta_squared(dir)), pdf));
        }
        // The other way round, which has the shading normal's cosine at the light's end (Veach 1997, section 5.3).
        let (value, _) = vertex.eval_towards(dir, vertex.wo)?;
        let pdf = vertex.pdf(vertex.wo, dir);
        Some((value.scale(self.cos(dir) / self.cos(vertex.wo)), pdf))
    }

    /// The density of the way back to the vertex before, when one comes from `dir`.
    #[inline]
    pub fn reverse_pdf(&self, dir: Dir) -> Wide {
        self.vertex.pdf(dir, self.vertex.wo)
    }

    /// Cosine between a direction and the normal, on whichever side.
    #[inline]
    pub fn cos(&self, dir: Dir) -> Wide {
        cos(&self.vertex, dir)
    }
}

#[inline]
pub fn cos(vertex: &Vertex, dir: Dir) -> Wide {
    Wide::new(dir.dot_q24(vertex.surface.normal).unsigned_abs(), -24)
}

#[inline]
fn scaled(light: Radiance, by: Wide) -> Radiance {
    if by == Wide::ONE { light } else { light.scale(by) }
}

/// Squared length of a segment.
#[inline]
pub fn square(distance: i32) -> Wide {
    let distance = Wide::new(distance as u32, 0);
    distance * distance
}

/// A vertex with the ray that goes on from it.
pub struct Onward {
    pub ray: Ray,
    pub sample: BsdfSample,
    pub partial: Partial,
}

/// Draws a direction from the BSDF at a vertex that was arrived at; `None` where the subpath ends.
#[inline]
pub fn scatter(at: &PathVertex, direction: [Uniform; 2], lobe: Uniform) -> Option<Onward> {
    let sample = at.vertex.sample(direction, lobe)?;
    let cos = at.cos(sample.wi);
    let partial = if sample.is_specular() {
        at.partial.scatter_delta(cos)
    } else {
        at.partial.scatter(cos, sample.pdf, at.reverse_pdf(sample.wi))
    };
    let ray = Ray {
        origin: at.vertex.surface.leave(sample.wi),
        dir: sample.wi,
    };
    Some(Onward { ray, sample, partial })
}

/// The weight of a BSDF sample for light instead of radiance: without the squeeze into the denser medium.
#[inline]
pub fn light_weight(at: &PathVertex, sample: &BsdfSample) -> Radiance {
    if sample.is_specular() {
        return scaled(sample.weight, at.vertex.specular_light_gain(sample));
    }
    if at.vertex.is_reciprocal() {
        return scaled(sample.weight, sample.eta_squared);
    }
    match at.eval_light(sample.wi) {
        Some((value, _)) => value.scale(sample.pdf.recip()),
        None => Radiance::BLACK,
    }
}

/// Whether a subpath survives roulette with this number, and by what its throughput grows if so.
///
/// The chance is the share of what it carried at first, at most 0.95.
#[inline]
pub fn roulette(share: Wide, number: Uniform) -> Option<Wide> {
    let survival = share.to_fixed(16).min(62_259);
    if (number.to_bits() >> 16) >= survival {
        None
    } else {
        Some(Wide::new(survival, -16).recip())
    }
}
