use super::{Integrator, SplatSink, View};
use crate::color::Radiance;
use crate::geom::{FAR, Frame, Ray};
use crate::sampler::{Sampler, warp};

/// How open the surface is that the camera sees: the share of the hemisphere above it, by cosine, where nothing stands.
///
/// (1/π) ∫ V cos θ dω about the shading normal on the eye's side, V being 1 where a ray meets nothing within the radius
/// (Landis, "Production-Ready Global Illumination", SIGGRAPH course notes 16, 2002). Materials count for nothing, lights are
/// shapes like others, and where the camera sees nothing it is black.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AmbientOcclusion {
    /// What is farther away than this does not count, units: [`Self::FULL`] for all there is.
    pub radius: i32,
}

impl AmbientOcclusion {
    /// All that a ray meets.
    pub const FULL: i32 = FAR + 1;

    /// Everything counts, however far away.
    pub const fn new() -> AmbientOcclusion {
        AmbientOcclusion {
            radius: AmbientOcclusion::FULL,
        }
    }

    /// Only what is nearer than `radius` counts, units.
    pub const fn within(radius: i32) -> AmbientOcclusion {
        AmbientOcclusion { radius }
    }
}

impl Default for AmbientOcclusion {
    fn default() -> AmbientOcclusion {
        AmbientOcclusion::new()
    }
}

impl Integrator for AmbientOcclusion {
    /// Draws a direction (2-D).
    fn radiance(
        &self,
        view: &View,
        ray: Ray,
        sampler: &mut impl Sampler,
        _: &mut impl SplatSink,
        rays: &mut u32,
    ) -> Radiance {
        *rays = rays.wrapping_add(1);
        let Some(hit) = view.closest(&ray) else {
            return Radiance::BLACK;
        };
        let vertex = view.scene.vertex(&ray, &hit);
        let (surface, normal) = (&vertex.surface, vertex.facing());
        let drawn = warp::sample_cosine_hemisphere(sampler.next_2d());
        let dir = Frame::about(normal).to_world(drawn);
        if (dir.dot_q24(surface.normal) > 0) != (vertex.wo.dot_q24(surface.normal) > 0) {
            // A smooth normal's hemisphere reaches behind the surface.
            return Radiance::BLACK;
        }
        let outwards = Ray {
            origin: surface.leave(dir),
            dir,
        };
        *rays = rays.wrapping_add(1);
        if view
            .scene
            .occluded(&outwards, self.radius.min(AmbientOcclusion::FULL), None)
        {
            Radiance::BLACK
        } else {
            Radiance::WHITE
        }
    }
}
