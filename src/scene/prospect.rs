//! What a surface has of a light before any direction is drawn: nothing, or where about it stands.
//!
//! As the bounds by which a light tree leaves lights out (Conty Estevez and Kulla, "Importance Sampling of Many Lights with
//! Adaptive Tree Splitting", 2018): a ball about the light, and the side on which it is bright.

use super::{Scene, Vertex};
use crate::geom::{Dir, Frame};
use crate::light::{Environment, Light};
use crate::num::Uniform;
use crate::sampler::warp;
use crate::shape::{Disk, Geometry, Rectangle, Sphere, Surface};

/// The scene's only light, as a surface has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prospect {
    /// Nothing is known.
    Any,
    /// No light from there is reflected: it shines the other way, or stands below the horizon.
    Dark,
    /// A diffuse surface and a light within a ball.
    Ball {
        /// The surface's normal, on the eye's side.
        normal: Dir,
        /// From the surface to the ball's middle, steps of 4 of the scene's grid, within ±2^14; what is rounded off is in
        /// the radius.
        to: [i32; 3],
        /// Under 2^14.
        radius: i32,
    },
}

impl Prospect {
    #[inline]
    pub fn is_dark(&self) -> bool {
        matches!(self, Prospect::Dark)
    }

    /// Whether the direction that the BSDF draws by these numbers may end on the light; where not, no light comes back along
    /// it. It takes less to ask than to draw it.
    ///
    /// The direction is known to 1/24 ([`warp::coarse_cosine_hemisphere`]).
    #[cfg_attr(narrow_mul, inline(never))]
    pub fn may_end_on_light(&self, u: [Uniform; 2]) -> bool {
        match *self {
            Prospect::Any => true,
            Prospect::Dark => false,
            Prospect::Ball { normal, to, radius } => {
                let dir = Frame::turn_coarsely(normal, warp::coarse_cosine_hemisphere(u));
                may_meet(dir, to, radius)
            }
        }
    }
}

/// Within ±2^14 squares add up to less than 3·2^28, and products with directions of Q14 to less than 2^30.
const MOST: i32 = 1 << 14;

impl Scene<'_> {
    /// What a vertex has of the scene's light: [`Prospect::Dark`] only where no sample of it ([`Self::sample_light`]) is
    /// reflected, and no direction drawn leads to its bright side.
    ///
    /// Of diffuse surfaces, in scenes with one light, which is a closed form: with several, or a sky, it takes more to tell
    /// than it spares.
    #[cfg_attr(narrow_mul, inline(never))]
    pub fn prospect(&self, vertex: &Vertex) -> Prospect {
        self.prospect_of_one(vertex).unwrap_or(Prospect::Any)
    }

    #[inline(always)]
    fn prospect_of_one(&self, vertex: &Vertex) -> Option<Prospect> {
        if self.light_count != 1 || !matches!(self.environment, Environment::None) {
            return None;
        }
        let Light::Area { shape, .. } = *self.parts.lights.first()? else {
            return None;
        };
        let shape = self.parts.shapes.get(shape as usize)?;
        let (center, bright, radius) = match shape.geometry {
            Geometry::Rectangle(Rectangle {
                center,
                normal,
                half: [a, b],
                ..
            }) => {
                // √(a² + b²) is less than the longer and half the shorter.
                (center, Some(normal), a.max(b) + (a.min(b) >> 1) + 1)
            }
            Geometry::Disk(Disk {
                center,
                normal,
                radius,
            }) => (center, Some(normal), radius),
            Geometry::Sphere(Sphere { center, radius }) => (center, None, radius),
            _ => return None,
        };
        let Surface { point, lift, .. } = vertex.surface;
        let shift = self.parts.grid.shift();
        let offset = point.to(center);
        let to = offset.0.map(|c| c >> (shift + 2));
        // Each component is off by less than one.
        let radius = ((radius + lift) >> (shift + 2)) + 3;
        if to.iter().fold(radius, |all, c| all | (c ^ (c >> 31))) >= MOST {
            return None;
        }
        // Of less than 2^15 steps, sides at right angles to 2^-15 and a direction to 2^-16 count; and places, which are rounded.
        if bright.is_some_and(|normal| offset.dot_normal(normal) > (16 << shift) + 24) {
            return Some(Prospect::Dark);
        }
        // A cosine is off by 3·2^-14 for the normal's bits and 2^-12 for a drawn direction's: 14 steps at most, and 2 for `to`.
        let normal = vertex.diffuse_normal()?;
        let [x, y, z] = normal.0.map(|c| c >> 2);
        let height = (x * to[0] + y * to[1] + z * to[2]) >> 14;
        Some(if height + radius < -16 {
            Prospect::Dark
        } else {
            Prospect::Ball { normal, to, radius }
        })
    }
}

/// Whether a ray may meet a ball `to` away, with a direction within e = 1/24 of `dir`, Q14.
///
/// If it does at distance s ≤ |to| + radius, the ball's centre is within radius + s e ≤ r (1 + e) + e |to| of the place
/// there along `dir`. That squared is at most 4/3 (1 + e)² r² + 4 e² |to|², which is under 3/2 r² + |to|²/128; the square
/// of the distance from `dir`'s line is |to|² − (`dir`·to)²/|dir|², and |dir|² is 1 − 1/128 at least.
#[inline]
fn may_meet(dir: [i32; 3], to: [i32; 3], radius: i32) -> bool {
    let square = |c: i32| c * c;
    let distance = square(to[0]) + square(to[1]) + square(to[2]);
    let least = distance - square(radius) - (square(radius) >> 1) - (distance >> 6) - 1;
    let along = ((dir[0] * to[0] + dir[1] * to[1] + dir[2] * to[2]) >> 14) + 1;
    least <= 0 || (along > 0 && square(along) >= least)
}
