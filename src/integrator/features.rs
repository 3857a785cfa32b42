use crate::color::Albedo;
use crate::geom::{Dir, Ray};
use crate::num::Uniform;
use crate::scene::Scene;

/// What is seen first that is no mirror or glass: the layers beside a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Features {
    pub albedo: Albedo,
    /// The one that shading sees, towards the eye's side.
    pub normal: Dir,
    /// Length of the way there, units; at most `i32::MAX`.
    pub depth: i32,
    /// The user's number for the shape.
    pub id: u16,
}

/// Mirrors and glass that a way may lead through before it is given up at the last.
const BOUNCES: usize = 8;

/// Follows a ray through mirrors and through glass (refracted, unless all is reflected); `None` where it meets nothing.
pub fn features(scene: &Scene, ray: Ray) -> Option<Features> {
    let mut ray = ray;
    let mut depth = 0i32;
    for bounce in 0..=BOUNCES {
        let hit = scene.closest(&ray)?;
        let vertex = scene.vertex(&ray, &hit);
        depth = depth.saturating_add(hit.t);
        let onward = if vertex.is_emitter || vertex.material.is_smooth() || bounce == BOUNCES {
            None
        } else {
            // The last of the lobe's range: refraction, wherever there is any.
            vertex.sample([Uniform::ZERO; 2], Uniform::MAX)
        };
        let Some(onward) = onward else {
            return Some(Features {
                albedo: vertex.albedo(),
                normal: vertex.facing(),
                depth,
                id: vertex.id,
            });
        };
        ray = Ray {
            origin: vertex.surface.leave(onward.wi),
            dir: onward.wi,
        };
    }
    None
}
