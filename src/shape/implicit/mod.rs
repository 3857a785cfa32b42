//! Solids given by a function, found by marching along the ray.
//!
//! Each is the boundary of { p : f(p) ≤ 0 }, its normal along ∇f, outwards. A ray is brought into the solid's own frame and
//! size (the solid's reach has 15 bits in *steps*, and 8 more below: *fine steps*), steps along as far as f says that
//! nothing is near, and where the side has changed, halves down to one step.
//!
//! # Errors
//!
//! A hit lies before the surface by at most one step along the ray. The line that is marched is the ray within
//!
//! - √3 · ½ · 2^-15 of the way from the point of closest approach, 0.9 steps at most, by the 15 bits of its direction;
//! - f's own error: ⅛ step, of which distances have 1/64 (lengths are right to a fine step, the frame to 2^-22), and the
//!   gyroid the rest (sines are right to 9e-6, and a cell is at most four reaches).
//!
//! What decides outside from inside of a ray's start is f there. So a start that stands off the surface by more than
//! these sums is on its right side, and a ray that starts there does not meet the surface where it left it:
//! [`Implicit::surface`] brings the point onto the surface (1 unit for each of its coordinates, ½ for the height), its
//! normal is right to 2e-5 rad, which over the longest way along a straight side is 1.3 steps more; and the start is
//! rounded again, by 1 unit in each. The lift is 4 steps and 5 units: 1.2e-4 ..= 2.4e-4 of the reach.
//!
//! Measured over solids of 2^12 ..= 2^21 units (`tests/implicit`): half of all hits are within 2e-5 of the extent (and half a
//! unit), 99 % within 5e-5; one ray of 10⁴ meets something else than by the formula, at silhouettes. Points are off the
//! surface by 2 units or 0.1 steps, normals by 1e-4 rad at most (3e-4 within the blends of a smooth union), half of them
//! by 1e-5, but for what a unit is of the curvature's radius.
//!
//! # Cost
//!
//! A ray that passes the solid's sphere by costs what one that passes a [`super::Sphere`] does. One that does not costs
//! its steps, each of a root or two (a root for each blob, three sines and cosines for the gyroid). Measured on x86-64
//! over rays into the solid's sphere: evaluations of f and instructions a ray are 9.8 and 3,599 for a torus, 7.6 and
//! 2,614 for a capsule, 11.5 and 2,285 for a rounded box, 9.7 and 4,815 for a ball of gyroid, 15.5 and 5,524 for a block
//! of it, 18.3 and 8,516 for metaballs of three, 10.9 and 9,008 for a smooth union of three.

mod capsule;
mod gyroid;
mod length;
mod line;
mod march;
mod metaballs;
mod rounded_box;
mod smooth_union;
mod torus;

use super::Surface;
use crate::geom::{Dir, Point, REACH, Ray};
use crate::num::{leading_zeros, mul_q16, round_shift};
use line::{FINE, Line};
use march::{Field, march};

pub use capsule::Capsule;
pub use gyroid::{Bound, Gyroid};
pub use metaballs::Metaballs;
pub use rounded_box::RoundedBox;
pub use smooth_union::SmoothUnion;
pub use torus::Torus;

/// Most blobs that one solid is made of.
pub const MAX_BLOBS: usize = 16;

/// A solid's finest part, as a share of its reach: finer ones are refused.
pub const FINEST: i32 = 256;

/// A solid's finest part, units.
const LEAST: i32 = 64;

/// A part of metaballs or of a smooth union: a capsule from a to b, or a ball, where both are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blob {
    pub a: Point,
    pub b: Point,
    /// Units.
    pub radius: i32,
}

impl Blob {
    pub const fn ball(center: Point, radius: i32) -> Blob {
        Blob {
            a: center,
            b: center,
            radius,
        }
    }

    pub fn is_ball(&self) -> bool {
        self.a == self.b
    }
}

impl From<Capsule> for Blob {
    fn from(Capsule { a, b, radius }: Capsule) -> Blob {
        Blob { a, b, radius }
    }
}

/// A solid given by a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Implicit {
    Torus(Torus),
    Capsule(Capsule),
    RoundedBox(RoundedBox),
    Gyroid(Gyroid),
    Metaballs(Metaballs),
    SmoothUnion(SmoothUnion),
}

/// What is wrong with a solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImplicitError {
    /// It has no extent, or sizes that do not go together.
    Degenerate,
    /// A part is finer than 1/256 of the whole, or than 64 units.
    Thin,
    /// It is made of blobs that do not exist, of none, of more than [`MAX_BLOBS`], or of other than balls.
    Blobs,
}

/// Where a solid stands.
pub(crate) struct Place {
    center: Point,
    /// Radius of a ball about the centre that holds it, units: 1 ..= 2^23 − 1.
    reach: i32,
    /// Directions of its x and y; none if they are the scene's.
    axes: Option<[Dir; 2]>,
}

trait Solid {
    type Field: Field;

    fn place(&self) -> Place;

    fn field(&self, place: &Place, blobs: &[Blob]) -> Self::Field;
}

/// With `$solid` standing for what it is: the same body for each kind.
macro_rules! each {
    ($implicit:expr, $solid:ident => $body:expr) => {
        match $implicit {
            Implicit::Torus($solid) => $body,
            Implicit::Capsule($solid) => $body,
            Implicit::RoundedBox($solid) => $body,
            Implicit::Gyroid($solid) => $body,
            Implicit::Metaballs($solid) => $body,
            Implicit::SmoothUnion($solid) => $body,
        }
    };
}

impl Implicit {
    /// Distance to the first crossing with 0 < t < `t_max`; `blobs` are the scene's.
    #[inline(never)]
    pub fn intersect(&self, blobs: &[Blob], ray: &Ray, t_max: i32) -> Option<i32> {
        each!(self, solid => intersect(solid, blobs, ray, t_max))
    }

    /// The point on the surface nearest to one found along a ray, the normal there, and the lift.
    #[inline(never)]
    pub fn surface(&self, blobs: &[Blob], near: Point) -> Surface {
        each!(self, solid => surface(solid, blobs, near))
    }

    /// Corners of a box of the scene that holds all hits, units.
    pub fn bounds(&self, blobs: &[Blob]) -> (Point, Point) {
        let (low, high) = match self {
            Implicit::Torus(torus) => about(torus.center, torus.extent()),
            Implicit::Capsule(capsule) => join(&[Blob::from(*capsule)], 0),
            Implicit::RoundedBox(block) => about(block.center, block.extent()),
            Implicit::Gyroid(gyroid) => about(gyroid.center, gyroid.extent()),
            Implicit::Metaballs(balls) => join(chosen(blobs, balls.first, balls.count), 0),
            Implicit::SmoothUnion(union) => join(chosen(blobs, union.first, union.count), union.fill()),
        };
        let pad = self.lift();
        (
            Point(low.0.map(|c| c.saturating_sub(pad))),
            Point(high.0.map(|c| c.saturating_add(pad))),
        )
    }

    /// How far a ray's origin must be lifted off the surface so that the ray does not meet it again, units.
    #[inline]
    pub fn lift(&self) -> i32 {
        each!(self, solid => lift(&solid.place()))
    }

    /// The two directions that say how it is turned, which must be unit vectors at right angles; `None` if it isn't.
    pub fn axes(&self) -> Option<[Dir; 2]> {
        each!(self, solid => solid.place().axes)
    }

    /// The border: sizes that go together, in the range where every bound that is stated here holds.
    ///
    /// Directions and reach are the scene's to check ([`Self::axes`], [`Self::bounds`]).
    pub fn check(&self, blobs: &[Blob]) -> Result<(), ImplicitError> {
        let above = |sizes: &[i32]| sizes.iter().all(|size| (1..=REACH).contains(size));
        let (sane, finest) = match *self {
            Implicit::Torus(Torus { major, minor, .. }) => (
                above(&[major, minor]) && minor < major,
                minor.min(major.saturating_sub(minor)),
            ),
            Implicit::Capsule(Capsule { a, b, radius }) => (above(&[radius]) && a != b, radius),
            Implicit::RoundedBox(RoundedBox { half, radius, .. }) => {
                let least = half[0].min(half[1]).min(half[2]);
                (above(&half) && above(&[radius]) && radius <= least, least)
            }
            Implicit::Gyroid(gyroid) => {
                let Gyroid {
                    cell,
                    thickness,
                    bound,
                    ..
                } = gyroid;
                let half = bound.half();
                let sane = (1..=4 * REACH).contains(&cell) && above(&[thickness]) && above(&half);
                // thickness ≤ 0.3 cell, and no cell larger than the sphere's diameter twice over.
                let fits = || thickness as i64 * 10 <= cell as i64 * 3 && cell / 4 <= gyroid.place().reach;
                (sane && fits(), thickness.min(half[0]).min(half[1]).min(half[2]))
            }
            Implicit::Metaballs(balls) => {
                let parts = parts(blobs, balls.first, balls.count)?;
                if !parts.iter().all(Blob::is_ball) {
                    return Err(ImplicitError::Blobs);
                }
                let least = parts.iter().map(|ball| ball.radius).min().unwrap_or(0);
                let threshold = balls.threshold() > 0 && balls.threshold() < 1 << 27;
                let same = balls == Metaballs::new(blobs, balls.first, balls.count, balls.threshold());
                (
                    parts.iter().all(|ball| above(&[ball.radius])) && threshold && same,
                    mul_q16(least, balls.alone()),
                )
            }
            Implicit::SmoothUnion(union) => {
                let parts = parts(blobs, union.first, union.count)?;
                let least = parts.iter().map(|part| part.radius).min().unwrap_or(0);
                let same = union == SmoothUnion::new(blobs, union.first, union.count, union.k);
                (
                    parts.iter().all(|part| above(&[part.radius])) && above(&[union.k]) && same,
                    least.min(union.k),
                )
            }
        };
        let reach = each!(self, solid => solid.place().reach);
        if !sane || !(1..2 * REACH).contains(&reach) {
            return Err(ImplicitError::Degenerate);
        }
        if finest < LEAST || finest < reach / FINEST {
            return Err(ImplicitError::Thin);
        }
        Ok(())
    }
}

/// Not inlined: a ray that passes by one kind need not make room for what another marches with.
#[inline(never)]
fn intersect<S: Solid>(solid: &S, blobs: &[Blob], ray: &Ray, t_max: i32) -> Option<i32> {
    let place = solid.place();
    let line = Line::new(&place, ray, t_max)?;
    let field = solid.field(&place, blobs);
    march(&field, &line).filter(|t| *t < t_max)
}

#[inline(never)]
fn surface<S: Solid>(solid: &S, blobs: &[Blob], near: Point) -> Surface {
    let place = solid.place();
    let up = place.up();
    let (outwards, height) = solid.field(&place, blobs).slope(place.to_local(near));
    // All the bits there are, so that turning it rounds nothing that matters.
    let size = outwards.iter().fold(0, |size, c| size | (c ^ (c >> 31)));
    let spare = leading_zeros(size as u32 | 1).saturating_sub(3);
    let normal = match place.to_scene(outwards.map(|c| c << spare)).normalize() {
        Some((normal, _)) => normal,
        None => Dir::Z,
    };
    // A hit is never farther off than this.
    let height = height.clamp(-64 << FINE, 64 << FINE);
    Surface {
        point: near.along(normal, -round_shift(height, up)),
        normal,
        lift: lift(&place),
    }
}

/// Four steps, and five units; see the head of this file.
#[inline]
fn lift(place: &Place) -> i32 {
    5 + ((4 << FINE) >> place.up())
}

/// Some of the scene's blobs; none where there are fewer.
fn chosen(blobs: &[Blob], first: u16, count: u16) -> &[Blob] {
    let first = first as usize;
    blobs.get(first..first + count as usize).unwrap_or(&[])
}

/// The same at the border.
fn parts(blobs: &[Blob], first: u16, count: u16) -> Result<&[Blob], ImplicitError> {
    let parts = chosen(blobs, first, count);
    if parts.is_empty() || parts.len() > MAX_BLOBS {
        return Err(ImplicitError::Blobs);
    }
    Ok(parts)
}

/// No less than the length of a vector, by 15 % more at most: the largest component and half of each other.
fn upper_length(v: [i32; 3]) -> i32 {
    let [a, b, c] = v.map(|c| c.saturating_abs());
    let most = a.max(b).max(c);
    // ⌈(a + b + c + most) / 2⌉
    let sum = a as i64 + b as i64 + c as i64 + most as i64 + 1;
    (sum >> 1).min(i32::MAX as i64) as i32
}

/// The middle of the box around some blobs, and the radius of a ball about it that holds them.
fn around(blobs: &[Blob], radius: impl Fn(&Blob) -> i32) -> (Point, i32) {
    let (low, high) = join(blobs, 0);
    let center = Point([0, 1, 2].map(|i| low.0[i].wrapping_add(high.0[i]) >> 1));
    let reach = |blob: &Blob| {
        let way = |p: Point| upper_length(center.to(p).0);
        way(blob.a).max(way(blob.b)).saturating_add(radius(blob))
    };
    (center, blobs.iter().map(reach).max().unwrap_or(0))
}

/// The box around some blobs, each thicker by `more`.
fn join(blobs: &[Blob], more: i32) -> (Point, Point) {
    let mut low = [i32::MAX; 3];
    let mut high = [i32::MIN; 3];
    for blob in blobs {
        let radius = blob.radius.saturating_add(more);
        for (i, (low, high)) in low.iter_mut().zip(&mut high).enumerate() {
            *low = (*low).min(blob.a.0[i].min(blob.b.0[i]).saturating_sub(radius));
            *high = (*high).max(blob.a.0[i].max(blob.b.0[i]).saturating_add(radius));
        }
    }
    if blobs.is_empty() {
        return (Point([0; 3]), Point([0; 3]));
    }
    (Point(low), Point(high))
}

fn about(Point(c): Point, half: [i32; 3]) -> (Point, Point) {
    (
        Point([0, 1, 2].map(|i| c[i].saturating_sub(half[i]))),
        Point([0, 1, 2].map(|i| c[i].saturating_add(half[i]))),
    )
}
