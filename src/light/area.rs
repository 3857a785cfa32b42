use super::{Emitter, LightSample};
use crate::color::Radiance;
use crate::geom::{Dir, Frame, Point};
use crate::num::{ONE_Q16, Uniform, Wide, isqrt, mul_q16, recip, short_recip};
use crate::sampler::warp;
use crate::shape::{Disk, Geometry, LIFT, Plane, Rectangle, Sphere, Surface};

/// A direction from `from` towards a point drawn on an emitter; `None` where it shows its dark side.
///
/// Spheres: uniform in the cone they fill. Flat shapes and triangles: uniform by area, pdf = d² / (A cos θ).
#[inline]
pub fn sample_area(
    emitter: Emitter,
    radiance: Radiance,
    from: &Surface,
    u: [Uniform; 2],
) -> Option<LightSample> {
    if let Emitter::Shape(Geometry::Sphere(sphere)) = emitter {
        return sample_sphere(sphere, radiance, from.point, u);
    }
    let FlatPlace {
        target,
        normal,
        lift,
        area,
    } = flat_place(emitter, u)?;
    let (wi, norm) = from.point.to(target).normalize()?;
    let cos = -wi.dot_normal(normal);
    if cos <= 0 {
        return None;
    }
    Some(LightSample {
        wi,
        distance: short_of(norm.length(), from.lift + lift, cos),
        radiance,
        pdf: norm.square() / (area * Wide::from_q16(cos)),
        shape: None,
        triangle: 0,
    })
}

/// A place drawn on a flat emitter, uniform by area.
struct FlatPlace {
    target: Point,
    normal: Dir,
    lift: i32,
    /// 1 over the place's density, units²: of a triangle, its area over the chance that just it is drawn.
    area: Wide,
}

#[inline]
fn flat_place(emitter: Emitter, u: [Uniform; 2]) -> Option<FlatPlace> {
    let (target, normal, lift, area) = match emitter {
        Emitter::Shape(Geometry::Disk(disk)) => {
            let Disk {
                center,
                normal,
                radius,
            } = *disk;
            let frame = Frame::about(normal);
            let [x, y] = warp::sample_disk(u);
            let target = center
                .along(frame.s, mul_q16(radius, x))
                .along(frame.t, mul_q16(radius, y));
            (target, normal, LIFT, disk.area())
        }
        Emitter::Shape(Geometry::Rectangle(rectangle)) => {
            let Rectangle {
                center,
                u: s,
                v: t,
                normal,
                half,
            } = *rectangle;
            let signed = |u: Uniform| (u.to_bits() >> 15) as i32 - ONE_Q16;
            let target = center
                .along_side(s, mul_q16(half[0], signed(u[0])))
                .along_side(t, mul_q16(half[1], signed(u[1])));
            (target, normal, LIFT, rectangle.area())
        }
        Emitter::Shape(
            Geometry::Sphere(_)
            | Geometry::Plane(_)
            | Geometry::Mesh(_)
            | Geometry::Instance(_)
            | Geometry::Implicit(_),
        ) => return None,
        Emitter::Triangle {
            corners: [a, b, c],
            normal,
            lift,
            area,
            chance,
        } => {
            let [b1, b2] = warp::sample_triangle(u);
            let (ab, ac) = (a.to(b).0, a.to(c).0);
            let mix = |i: usize| a.0[i] + mul_q16(ab[i], b1) + mul_q16(ac[i], b2);
            (Point([mix(0), mix(1), mix(2)]), normal, lift, area / chance)
        }
    };
    Some(FlatPlace {
        target,
        normal,
        lift,
        area,
    })
}

/// A place drawn on an emitter, uniform by area, as light leaves it; and 1 over its density, units².
///
/// As [`sample_area`] for flat shapes and triangles; on spheres all over.
pub fn sample_surface(emitter: Emitter, u: [Uniform; 2]) -> Option<(Surface, Wide)> {
    if let Emitter::Shape(Geometry::Sphere(sphere)) = emitter {
        let normal = warp::sample_sphere(u);
        let surface = Surface {
            point: sphere.center.along(normal, sphere.radius),
            normal,
            lift: sphere.lift(),
        };
        return Some((surface, surface_area(emitter)));
    }
    let place = flat_place(emitter, u)?;
    let surface = Surface {
        point: place.target,
        normal: place.normal,
        lift: place.lift,
    };
    Some((surface, place.area))
}

/// 1 over the density with which [`sample_surface`] draws any place on an emitter, units².
pub fn surface_area(emitter: Emitter) -> Wide {
    match emitter {
        Emitter::Shape(Geometry::Sphere(sphere)) => sphere.radius_squared() * Wide::PI.shl(2),
        Emitter::Shape(Geometry::Disk(disk)) => disk.area(),
        Emitter::Shape(Geometry::Rectangle(rectangle)) => rectangle.area(),
        Emitter::Shape(
            Geometry::Plane(_) | Geometry::Mesh(_) | Geometry::Instance(_) | Geometry::Implicit(_),
        ) => Wide::ZERO,
        Emitter::Triangle { area, chance, .. } => area / chance,
    }
}

/// The density with which [`sample_area`] would have drawn `wi`, which meets the emitter `distance` units away.
#[inline]
pub fn pdf_area(emitter: Emitter, from: Point, wi: Dir, distance: i32) -> Wide {
    let (normal, area) = match emitter {
        Emitter::Shape(Geometry::Sphere(sphere)) => {
            return match cone(sphere, from) {
                Some(cone) => cone.pdf(),
                None => Wide::ZERO,
            };
        }
        Emitter::Shape(Geometry::Disk(disk)) => (disk.normal, disk.area()),
        Emitter::Shape(Geometry::Rectangle(rectangle)) => (rectangle.normal, rectangle.area()),
        Emitter::Shape(
            Geometry::Plane(Plane { .. }) | Geometry::Mesh(_) | Geometry::Instance(_) | Geometry::Implicit(_),
        ) => {
            return Wide::ZERO;
        }
        Emitter::Triangle {
            normal, area, chance, ..
        } => (normal, area / chance),
    };
    let cos = -wi.dot(normal);
    if cos <= 0 {
        return Wide::ZERO;
    }
    let d = Wide::new(distance as u32, 0);
    (d * d) / (area * Wide::from_q16(cos))
}

/// A shadow ray's length: short of a surface by a lift, seen at this angle, and by what lengths are uncertain.
///
/// The lift is the surface's own and, since the ray begins by its own lift nearer where the two face each other, that of
/// where it begins, added.
///
/// A length is known to 2^-13: two directions' and one root's 2^-14 at most.
#[inline]
pub(crate) fn short_of(length: i32, lift: i32, cos: i32) -> i32 {
    // Within 60° of the normal by a short reciprocal, right to 3.4e-5 and then one more.
    let slant = if cos >= 1 << 15 && lift < 1 << 14 {
        ((lift * short_recip(cos.min(0xffff) as u32)) >> 15) + 1
    } else {
        recip(cos as u32).times_short(lift, 16)
    };
    let slant = slant.min(length);
    length - (length >> 12) - slant
}

/// The cone of directions that meet a sphere from a point outside.
struct Cone {
    /// Towards the centre.
    axis: Dir,
    distance: i32,
    /// sin² θmax = r²/d².
    sin2_max: Wide,
    /// 1 − cos θmax, to full relative precision however small.
    versine: Wide,
}

impl Cone {
    fn pdf(&self) -> Wide {
        warp::pdf_cone(self.versine)
    }
}

fn cone(sphere: &Sphere, from: Point) -> Option<Cone> {
    let (axis, norm) = from.to(sphere.center).normalize()?;
    let sin2_max = sphere.radius_squared() / norm.square();
    if sin2_max.is_at_least(Wide::ONE) {
        return None;
    }
    let cos_max = isqrt(!sin2_max.to_fixed(32)) as i32;
    // 1 − √(1 − s) = s / (1 + √(1 − s))
    let versine = sin2_max / Wide::from_q16(ONE_Q16 + cos_max);
    Some(Cone {
        axis,
        distance: norm.length(),
        sin2_max,
        versine,
    })
}

/// Uniform in the cone.
fn sample_sphere(sphere: &Sphere, radiance: Radiance, from: Point, u: [Uniform; 2]) -> Option<LightSample> {
    let cone = cone(sphere, from)?;
    let (local, share) = warp::sample_cone(u, cone.versine, cone.sin2_max.sqrt());
    // The way there leads d cos θ ahead, less half a chord: r √(1 − (sin θ / sin θmax)²) (pbrt, 4th ed., 6.2.4).
    let chord = mul_q16(sphere.radius, isqrt(!share) as i32);
    // From where an endless plane is met, lengths may be past the end of the numbers.
    let distance = mul_q16(cone.distance, local.0[2]).saturating_sub(chord);
    Some(LightSample {
        wi: Frame::about(cone.axis).to_world(local),
        distance,
        radiance,
        pdf: cone.pdf(),
        shape: None,
        triangle: 0,
    })
}
