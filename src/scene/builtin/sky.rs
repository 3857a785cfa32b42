use super::look;
use crate::camera::Camera;
use crate::color::{Albedo, Radiance, albedo};
use crate::geom::{Dir, Unit, point};
use crate::light::Sky;
use crate::material::{Conductor, Dielectric, Material};
use crate::num::{ONE_Q16, Share, Turn};
use crate::q;
use crate::scene::{SceneBuilder, SceneError};
use crate::shape::{Plane, Sphere};

/// Balls in the open, for [`sky`] or [`super::studio`] to light: matt, mirror, metal and glass on a floor.
pub fn open() -> Result<(SceneBuilder<5, 5, 0>, Camera), SceneError> {
    let unit = Unit::DEFAULT;
    let mut b = SceneBuilder::with_unit(unit);
    let floor = b.material(Material::lambert(albedo(
        q!(0.42, Share),
        q!(0.40, Share),
        q!(0.36, Share),
    )))?;
    b.shape(Plane::new(point(q!(0), q!(0), q!(0)), Dir::Y), floor)?;
    let silver = albedo(q!(0.95, Share), q!(0.93, Share), q!(0.88, Share));
    let balls = [
        (
            point(q!(-1.05), q!(0.5), q!(0)),
            q!(0.5),
            Material::lambert(albedo(q!(0.7, Share), q!(0.68, Share), q!(0.62, Share))),
        ),
        (
            point(q!(0.05), q!(0.6), q!(-0.5)),
            q!(0.6),
            Material::mirror(silver),
        ),
        (
            point(q!(1.15), q!(0.5), q!(0)),
            q!(0.5),
            Material::Conductor(Conductor::new(silver).rough(q!(0.25, Share))),
        ),
        (
            point(q!(0.1), q!(0.3), q!(0.8)),
            q!(0.3),
            Material::Dielectric(Dielectric::new(q!(1.5)).tinted(Albedo::WHITE, Albedo::WHITE)),
        ),
    ];
    for (center, radius, material) in balls {
        let material = b.material(material)?;
        b.shape(Sphere::new(center, unit.length(radius)), material)?;
    }
    let (eye, target) = (point(q!(0), q!(1.3), q!(4.6)), point(q!(0), q!(0.5), q!(0)));
    Ok((b, look(eye, target, q!(0.1, Turn))))
}

/// A blue sky over brown ground, and a sun of 4° behind the eye's right shoulder.
pub fn sky() -> Sky {
    let gradient = Sky::new(
        Dir::Y,
        Radiance::new(q!(0.15), q!(0.3), q!(0.7)),
        Radiance::new(q!(0.7), q!(0.75), q!(0.8)),
        Radiance::new(q!(0.12), q!(0.1), q!(0.08)),
    );
    let towards = Dir::new([2 * ONE_Q16, 3 * ONE_Q16, 2 * ONE_Q16]).unwrap_or(Dir::Y);
    let sun = Radiance::new(q!(600), q!(540), q!(430));
    gradient.with_sun(towards, q!(0.0111, Turn), sun)
}
