use super::look;
use crate::camera::Camera;
use crate::color::{Albedo, Radiance, albedo};
use crate::geom::{Dir, Unit, point};
use crate::light::Light;
use crate::material::{Dielectric, Material};
use crate::num::{Share, Turn};
use crate::q;
use crate::scene::{SceneBuilder, SceneError};
use crate::shape::{Disk, Plane, Rectangle, Sphere};

/// Ten shapes, each kind that has a closed form: two matt balls, a mirror and a glass one, a tinted glass disk, a mirror on
/// the wall, between a floor and a wall without end; every kind of light that is no mesh.
pub fn spheres() -> Result<(SceneBuilder<10, 7, 6>, Camera), SceneError> {
    let unit = Unit::DEFAULT;
    let mut b = SceneBuilder::with_unit(unit);
    let floor = b.material(Material::lambert(albedo(
        q!(0.45, Share),
        q!(0.45, Share),
        q!(0.42, Share),
    )))?;
    let wall = b.material(Material::Lambert {
        albedo: albedo(q!(0.3, Share), q!(0.4, Share), q!(0.5, Share)),
        two_sided: false,
    })?;
    let matt = b.material(Material::lambert(albedo(
        q!(0.62, Share),
        q!(0.22, Share),
        q!(0.12, Share),
    )))?;
    let mirror = b.material(Material::mirror(albedo(
        q!(0.95, Share),
        q!(0.93, Share),
        q!(0.88, Share),
    )))?;
    let glass = Dielectric::new(q!(1.5));
    let clear = b.material(Material::Dielectric(glass))?;
    let tint = albedo(q!(0.9, Share), q!(0.7, Share), q!(0.5, Share));
    let tinted = b.material(Material::Dielectric(glass.tinted(Albedo::WHITE, tint)))?;
    let black = b.material(Material::Black)?;

    let (x, y, z) = (Dir::X, Dir::Y, Dir::Z);
    let ball = |center, radius| Sphere::new(center, unit.length(radius));
    b.shape(Plane::new(point(q!(0), q!(0), q!(0)), y), floor)?;
    b.shape(ball(point(q!(-1.15), q!(0.5), q!(0.1)), q!(0.5)), matt)?;
    b.shape(ball(point(q!(0.1), q!(0.7), q!(-0.9)), q!(0.7)), mirror)?;
    b.shape(ball(point(q!(0.95), q!(0.45), q!(0.6)), q!(0.45)), clear)?;
    b.shape(ball(point(q!(-0.25), q!(0.12), q!(0.75)), q!(0.12)), matt)?;
    b.shape(Plane::new(point(q!(0), q!(0), q!(-3)), z), wall)?;
    b.shape(
        Disk::new(point(q!(-0.4), q!(0.35), q!(1.2)), z, unit.length(q!(0.3))),
        tinted,
    )?;
    b.shape(
        Rectangle {
            center: point(q!(1.6), q!(1.2), q!(-2.9)),
            u: x,
            v: y,
            normal: z,
            half: [q!(0.5), q!(0.7)].map(|side| unit.length(side)),
        },
        mirror,
    )?;
    b.emitter(
        ball(point(q!(-1.6), q!(1.9), q!(-1.8)), q!(0.25)),
        black,
        Radiance::new(q!(6), q!(5), q!(3)),
    )?;
    let lamp = Disk::new(point(q!(0.6), q!(3), q!(0.5)), -y, unit.length(q!(0.5)));
    b.emitter(lamp, black, Radiance::new(q!(5), q!(5.5), q!(6)))?;

    b.light(Light::Point {
        position: point(q!(-1.5), q!(3.2), q!(2.6)),
        intensity: Radiance::new(q!(8), q!(7), q!(6)),
    })?;
    if let Some(direction) = Dir::new([-2, -3, -1]) {
        b.light(Light::Directional {
            direction,
            irradiance: Radiance::new(q!(0.5), q!(0.4), q!(0.3)),
        })?;
    }
    b.light(Light::Environment {
        radiance: Radiance::new(q!(0.32), q!(0.42), q!(0.58)),
    })?;

    let (eye, target) = (point(q!(0), q!(1.6), q!(5.2)), point(q!(0), q!(0.55), q!(0)));
    let camera = look(eye, target, q!(0.0944, Turn));
    Ok((b, camera.with_lens(unit.length(q!(0.02)), unit.length(q!(5.2)))))
}
