//! A glance along a direction before it is drawn: whether a light may be there at all.

use super::{Scene, Vertex};
use crate::geom::{Frame, Point};
use crate::light::{Environment, Light};
use crate::num::Uniform;
use crate::sampler::warp;
use crate::shape::{Disk, Geometry, Rectangle, Sphere};

impl Scene<'_> {
    /// Whether the direction that the BSDF draws by these numbers may end on a light: where not,
    /// [`Self::closest_light`] finds none. It takes less to ask than to draw it.
    ///
    /// Of diffuse surfaces, and lights that are closed forms: others always may. The direction is known to 1/24
    /// ([`warp::coarse_cosine_hemisphere`]), each light by a ball about it.
    #[cfg_attr(narrow_mul, inline(never))]
    pub fn may_end_on_light(&self, vertex: &Vertex, u: [Uniform; 2]) -> bool {
        if !matches!(self.environment, Environment::None) || self.has_many_lights() {
            return true;
        }
        let Some(normal) = vertex.diffuse_normal() else {
            return true;
        };
        let dir = Frame::turn_coarsely(normal, warp::coarse_cosine_hemisphere(u));
        let down = self.parts.grid.shift() + 2;
        self.parts.lights.iter().any(|light| {
            let Light::Area { shape, .. } = *light else {
                return false;
            };
            let shape = self.parts.shapes.get(shape as usize);
            let Some((center, radius)) = shape.and_then(|shape| ball(&shape.geometry)) else {
                return true;
            };
            // In steps of 4 of the scene's grid; three more for what is rounded off.
            let to = vertex.surface.point.to(center).0.map(|c| c >> down);
            let radius = ((radius + vertex.surface.lift) >> down) + 3;
            may_meet(dir, to, radius)
        })
    }
}

/// A ball about a closed form.
#[inline]
fn ball(geometry: &Geometry) -> Option<(Point, i32)> {
    match *geometry {
        Geometry::Sphere(Sphere { center, radius }) | Geometry::Disk(Disk { center, radius, .. }) => {
            Some((center, radius))
        }
        Geometry::Rectangle(Rectangle {
            center, half: [a, b], ..
        }) => {
            // √(a² + b²) is less than the longer and half the shorter.
            let radius = a.max(b) + (a.min(b) >> 1) + 1;
            Some((center, radius))
        }
        _ => None,
    }
}

/// Whether a ray may meet a ball `to` away, with a direction within e = 1/24 of `dir`, Q14.
///
/// If it does at distance s ≤ |to| + radius, the ball's centre is within radius + s e ≤ r (1 + e) + e |to| of the place
/// there along `dir`. That squared is at most 4/3 (1 + e)² r² + 4 e² |to|², which is under 3/2 r² + |to|²/128; the square
/// of the distance from `dir`'s line is |to|² − (`dir`·to)²/|dir|², and |dir|² is 1 − 1/128 at least.
#[cfg_attr(narrow_mul, inline(never))]
#[cfg_attr(not(narrow_mul), inline)]
fn may_meet(dir: [i32; 3], to: [i32; 3], radius: i32) -> bool {
    // |to|² under 3·2^28, the product with the direction under 2^30.
    const MOST: i32 = 1 << 14;
    if radius >= MOST || to.iter().any(|c| c.wrapping_add(MOST) as u32 >= 2 * MOST as u32) {
        return true;
    }
    let square = |c: i32| c * c;
    let distance = square(to[0]) + square(to[1]) + square(to[2]);
    let least = distance - square(radius) - (square(radius) >> 1) - (distance >> 6) - 1;
    let along = ((dir[0] * to[0] + dir[1] * to[1] + dir[2] * to[2]) >> 14) + 1;
    least <= 0 || (along > 0 && square(along) >= least)
}
