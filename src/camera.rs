//! From a place in the picture to a ray.

use crate::geom::{Beam, Dir, Norm, Offset, Point, Ray};
use crate::num::{
    ONE_Q16, Recip, Uniform, Wide, leading_zeros, mul_q16, mul_shift, mul_shift_brief, mul_shift_medium,
    recip,
};
use crate::sampler::warp;
use fixed::types::I12F20;

/// A perspective camera: pinhole, or thin lens where it has an aperture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    origin: Point,
    right: Dir,
    up: Dir,
    forward: Dir,
    /// Half the picture's width at distance 1: the tangent of half the horizontal field of view, Q20, up to 32.
    tan_half: I12F20,
    /// Radius of the lens and distance of what is in focus along `forward`, units; radius 0 for a pinhole.
    lens: (i32, i32),
}

/// The widest picture: 176.4° across.
const MAX_TAN_HALF: I12F20 = I12F20::from_bits(32 << 20);

/// Pixels a side that are told apart.
const MAX_SIDE: u16 = 1 << 14;

impl Camera {
    /// At `origin`, looking at `target`, `up` (any length) upwards in the picture.
    ///
    /// `tan_half` from 0 to 32 (others are brought into that range): see [`Self::tan_half`].
    /// `None` if there is no way to look, or none that is not along `up`.
    pub fn look_at(origin: Point, target: Point, up: [i32; 3], tan_half: I12F20) -> Option<Camera> {
        let (forward, _) = origin.to(target).normalize()?;
        let up = Dir::new(up)?;
        let right = forward.cross(up)?;
        let up = right.cross(forward)?;
        Some(Camera::from_frame(origin, [right, up, forward], tan_half))
    }

    /// From three directions at right angles: right and up in the picture, and forward into it.
    ///
    /// `tan_half` as for [`Self::look_at`].
    pub const fn from_frame(origin: Point, [right, up, forward]: [Dir; 3], tan_half: I12F20) -> Camera {
        let bits = tan_half.to_bits();
        let most = MAX_TAN_HALF.to_bits();
        let bits = if bits < 0 {
            0
        } else if bits > most {
            most
        } else {
            bits
        };
        Camera {
            origin,
            right,
            up,
            forward,
            tan_half: I12F20::from_bits(bits),
            lens: (0, 1),
        }
    }

    /// The same with a lens of this radius, in focus at this distance along the view, units.
    pub const fn with_lens(self, radius: i32, focus: i32) -> Camera {
        Camera {
            lens: (radius, focus),
            ..self
        }
    }

    /// Half the picture's width at distance 1 for a horizontal field of view: tan(angle / 2), to about 2^-15.
    ///
    /// Angles in whole turns, 0 ..< ½ (180°); wider ones than 176° count as that.
    pub fn tan_half(field_of_view: crate::num::Turn) -> I12F20 {
        let half = crate::num::Turn::from_bits((field_of_view.to_bits() / 2).min(0x3e93_e93e));
        let (sin, cos) = crate::num::sin_cos(half);
        I12F20::from_bits(recip(cos.max(1) as u32).times(sin, 20))
    }

    pub const fn origin(&self) -> Point {
        self.origin
    }

    /// Right, up, forward.
    pub const fn frame(&self) -> [Dir; 3] {
        [self.right, self.up, self.forward]
    }

    /// As given: tangent of half the horizontal field of view.
    pub const fn half_width(&self) -> I12F20 {
        self.tan_half
    }

    /// Lens radius and focus distance, units.
    pub const fn lens(&self) -> (i32, i32) {
        self.lens
    }

    /// Whether rays start anywhere on a lens.
    pub const fn has_lens(&self) -> bool {
        self.lens.0 > 0
    }

    /// What stays the same over a picture of `width` × `height` pixels, up to 2^14 a side (as which larger ones count) and
    /// 32 times as high as wide.
    pub fn film(&self, width: u16, height: u16) -> FilmPlane {
        let (width, height) = (width.min(MAX_SIDE), height.min(MAX_SIDE));
        FilmPlane {
            camera: *self,
            half_width: width as i32 * ONE_Q16,
            half_height: height as i32 * ONE_Q16,
            is_small: (64..1 << 10).contains(&width) && height < 1 << 10 && self.tan_half <= I12F20::ONE,
            per_width: recip(width as u32),
            density: density_ahead(self.tan_half, width, height),
        }
    }

    /// Whether its three directions stand at right angles, to cosines of 2^-13.
    pub(crate) fn is_square(&self) -> bool {
        let [r, u, f] = self.frame();
        [r.dot(u), u.dot(f), f.dot(r)]
            .iter()
            .all(|cos| cos.abs() <= 1 << 3)
    }
}

/// A camera with a picture's size: pixel (x, y) covers [x, x + 1) × [y, y + 1), y down.
#[derive(Clone, Copy, Debug)]
pub struct FilmPlane {
    camera: Camera,
    /// Half the width and height in half-pixels, Q16.
    half_width: i32,
    half_height: i32,
    /// Neither wide nor narrow, of less than 90°: with products of less bits.
    is_small: bool,
    per_width: Recip,
    /// [`Self::density`] straight ahead.
    density: Wide,
}

/// A place that the camera sees, as [`FilmPlane::project`] finds it.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    /// The pixel that shows it.
    pub pixel: (u16, u16),
    /// The place on the lens that it is seen from.
    pub lens: Point,
    /// From there to the place.
    pub dir: Dir,
    pub norm: Norm,
    /// [`FilmPlane::density`] of `dir`.
    pub density: Wide,
}

/// 1/A with A the film's area at distance 1: (2 tan)² · height/width. 0 for a film without area.
fn density_ahead(tan_half: I12F20, width: u16, height: u16) -> Wide {
    let side = Wide::new(tan_half.to_bits() as u32, 1 - 20);
    let area = side * side * Wide::new(height as u32, 0);
    if area.is_zero() {
        Wide::ZERO
    } else {
        Wide::new(width as u32, 0) / area
    }
}

impl FilmPlane {
    pub(crate) const fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Width and height, pixels.
    pub(crate) const fn size(&self) -> [i32; 2] {
        [self.half_width >> 16, self.half_height >> 16]
    }

    /// The ray through a place in the pixel; `lens` chooses a place on the lens, if there is one.
    ///
    /// Direction: right to 2^-16 a component.
    #[inline]
    pub fn ray(&self, x: u16, y: u16, place: [Uniform; 2], lens: [Uniform; 2]) -> Option<Ray> {
        let camera = &self.camera;
        // From the middle, in half-pixels Q16 (under 2^30).
        let across =
            |pixel: u16, u: Uniform| ((pixel.min(MAX_SIDE - 1) as i32) << 17) + (u.to_bits() >> 15) as i32;
        let sx = self.aside(across(x, place[0]) - self.half_width);
        let sy = self.aside(self.half_height - across(y, place[1]));
        let (r, u, f) = (camera.right.0, camera.up.0, camera.forward.0);
        // Axes of a camera that stands upright have components of 0.
        let share = |s: i32, d: i32| if d == 0 { 0 } else { mul_q16(s, d) };
        let part = |i: usize| (f[i] << 4) + share(sx, r[i]) + share(sy, u[i]);
        let through = [part(0), part(1), part(2)];
        if !camera.has_lens() {
            return Some(Ray {
                origin: camera.origin,
                dir: Dir::new(through)?,
            });
        }
        let (radius, focus) = camera.lens;
        let [lx, ly] = warp::sample_disk(lens);
        let scale = |by: i32| crate::num::mul_q16(radius, by);
        let origin = camera
            .origin
            .along(camera.right, scale(lx))
            .along(camera.up, scale(ly));
        let in_focus = camera
            .origin
            .add(crate::geom::Offset(through.map(|c| mul_shift(focus, c, 20))));
        Some(Ray {
            origin,
            dir: origin.to(in_focus).normalize()?.0,
        })
    }

    /// A place from the middle of the film, half-pixels Q16 (under 2^30), times tan/width: Q20 at distance 1.
    #[inline(always)]
    fn aside(&self, d: i32) -> i32 {
        let tan = self.camera.tan_half.to_bits();
        if self.is_small {
            // |d| < 2^26, 1/width · 2^(shift − 11) is 2^27 at least.
            let r = self.per_width;
            let share = mul_shift_medium(d, (r.mantissa >> 1) as i32, r.shift - 11);
            mul_shift_brief(tan, share, 26)
        } else {
            mul_shift(self.per_width.times(d, 10), tan, 26)
        }
    }

    /// About all rays through pixels `x` to `x` + `side` and `y` to `y` + `side`, those after the last left out.
    ///
    /// `None` of a camera that has a lens, and of what is more than 45° aside or above its view.
    pub fn beam(&self, x: u16, y: u16, side: u16) -> Option<Beam> {
        let camera = &self.camera;
        if camera.has_lens() || !camera.is_square() {
            return None;
        }
        let edge = |pixel: u16, by: u16| (pixel.saturating_add(by).min(MAX_SIDE - 1) as i32) << 17;
        let mut edges = [edge(x, 0), edge(x, side), -edge(y, side), -edge(y, 0)];
        for (axis, edges) in [-self.half_width, self.half_height]
            .iter()
            .zip(edges.chunks_exact_mut(2))
        {
            for edge in edges {
                *edge = self.aside_of_few(*axis + *edge);
            }
        }
        Beam::new(camera.origin, camera.frame(), edges)
    }

    /// [`Self::aside`] where that is seldom asked for.
    #[inline(never)]
    fn aside_of_few(&self, d: i32) -> i32 {
        self.aside(d)
    }

    /// The density per solid angle with which a ray through a place drawn anywhere on the film goes this way:
    /// 1/(A cos³ θ), A being the film's area at distance 1. 0 backwards.
    ///
    /// What a camera measures of the light that arrives along such a ray, over the whole film (Veach 1997, section 8.2):
    /// the importance it emits, times the cosine at the lens, over the density of the place on the lens.
    #[inline]
    pub fn density(&self, dir: Dir) -> Wide {
        let cos = dir.dot_q24(self.camera.forward);
        if cos <= 0 {
            return Wide::ZERO;
        }
        let cos = Wide::new(cos as u32, -24);
        self.density / (cos * cos * cos)
    }

    /// The pixel in which a point is seen from the place on the lens that `lens` chooses; `None` where it is in none.
    ///
    /// The inverse of [`Self::ray`], right to 1/1000 pixel for pictures of up to 2^10 pixels a side.
    pub fn project(&self, point: Point, lens: [Uniform; 2]) -> Option<Projection> {
        let (from, aside) = self.lens_place(lens);
        let offset = from.to(point);
        let (dir, norm) = offset.normalize()?;
        let [x, y] = self.across(offset, aside)?;
        let pixel = |place: i32, half: i32| (place >= 0 && place < half >> 4).then_some((place >> 12) as u16);
        Some(Projection {
            pixel: (pixel(x, self.half_width)?, pixel(y, self.half_height)?),
            lens: from,
            dir,
            norm,
            density: self.density(dir),
        })
    }

    /// Where in the picture a point is seen from the lens's middle, pixels from the left and top edge, Q12: [`Self::project`]
    /// with all its bits. Somewhat beside the picture, too.
    pub fn place(&self, point: Point) -> Option<[i32; 2]> {
        self.across(self.camera.origin.to(point), [0; 2])
    }

    /// Where an offset from the lens leads to, Q12 of a pixel; `aside` as [`Self::lens_place`] has it.
    #[inline]
    fn across(&self, offset: Offset, aside: [i32; 2]) -> Option<[i32; 2]> {
        let camera = &self.camera;
        // All the bits there are, the largest component of 28: sums of three products stay under 2^30.
        let largest = offset.0.iter().fold(0, |m, c| m | c.unsigned_abs());
        let zeros = leading_zeros(largest) as i32 - 4;
        let v = Offset(
            offset
                .0
                .map(|c| if zeros >= 0 { c << zeros } else { c >> -zeros }),
        );
        let depth = v.dot(camera.forward);
        if depth <= 0 {
            return None;
        }
        let tan = camera.tan_half.to_bits();
        let (per_depth, per_tan) = (recip(depth as u32), recip(tan as u32));
        // A place on the film at distance 1, Q20, as half-pixels from the middle, Q11.
        let across = |axis: Dir, aside: i32| {
            let along = v.dot(axis);
            // Wider than any film.
            if along.abs() >> 6 > depth {
                return None;
            }
            let place = per_depth.times(along, 20).wrapping_add(aside);
            if place.unsigned_abs() >> 5 > tan as u32 {
                return None;
            }
            let share = per_tan.times(place, 24);
            Some(mul_shift(share, self.half_width >> 16, 13))
        };
        let x = (self.half_width >> 5) + across(camera.right, aside[0])?;
        let y = (self.half_height >> 5) - across(camera.up, aside[1])?;
        Some([x, y])
    }

    /// Whether rays start anywhere on a lens.
    #[inline]
    pub const fn has_lens(&self) -> bool {
        self.camera.has_lens()
    }

    /// The middle of the lens.
    #[inline]
    pub const fn origin(&self) -> Point {
        self.camera.origin()
    }

    /// A place on the lens, and how far aside it is over the distance of what is in focus, Q20.
    fn lens_place(&self, lens: [Uniform; 2]) -> (Point, [i32; 2]) {
        let camera = &self.camera;
        if !camera.has_lens() {
            return (camera.origin, [0; 2]);
        }
        let (radius, focus) = camera.lens;
        let by = warp::sample_disk(lens).map(|by| mul_q16(radius, by));
        let origin = camera.origin.along(camera.right, by[0]).along(camera.up, by[1]);
        let per_focus = recip(focus.max(1) as u32);
        (origin, by.map(|by| per_focus.times(by, 20)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::narrow;

    /// Whatever film counts as small, its products have no more bits than they may have.
    #[test]
    fn a_small_film_stays_within_its_products() {
        let mut small = 0;
        for (width, height) in
            (1..1100).flat_map(|width| [(width, 1), (width, 240), (width, 1023), (240, width)])
        {
            for tan in [1, 355_000, 1 << 20, (1 << 20) + 1, 32 << 20] {
                let tan_half = I12F20::from_bits(tan);
                let frame = [Dir::X, Dir::Y, -Dir::Z];
                let film = Camera::from_frame(Point([0; 3]), frame, tan_half).film(width, height);
                if !film.is_small {
                    continue;
                }
                small += 1;
                let (mantissa, shift) = ((film.per_width.mantissa >> 1) as i32, film.per_width.shift - 11);
                for most in [film.half_width, film.half_height] {
                    for d in [most, -most, most / 3, 1 - most] {
                        let share = mul_shift(d, mantissa, shift);
                        assert_eq!(
                            narrow::mul_shift_medium(d, mantissa, shift),
                            share,
                            "{width} {height}"
                        );
                        assert_eq!(
                            narrow::mul_shift_brief(tan, share, 26),
                            mul_shift(tan, share, 26),
                            "{tan}"
                        );
                    }
                }
            }
        }
        assert!(small > 5000, "{small}");
    }
}
