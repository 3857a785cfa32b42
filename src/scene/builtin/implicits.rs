use super::look;
use crate::camera::Camera;
use crate::color::{Radiance, albedo};
use crate::geom::{Dir, Unit, point};
use crate::light::Light;
use crate::material::{Conductor, Dielectric, Material};
use crate::num::{Metres, ONE_Q16, Share, Turn};
use crate::q;
use crate::scene::{SceneBuilder, SceneError};
use crate::shape::{
    Blob, Bound, Capsule, Gyroid, Implicit, Metaballs, Plane, Rectangle, RoundedBox, SmoothUnion, Torus,
};

/// Three balls for the metaballs, then two and a capsule for the smooth union, of [`implicits`].
pub fn blobs() -> [Blob; 6] {
    let size = |metres: Metres| Unit::DEFAULT.length(metres);
    [
        Blob::ball(point(q!(-1), q!(0.36), q!(0.95)), size(q!(0.52))),
        Blob::ball(point(q!(-0.62), q!(0.28), q!(1.15)), size(q!(0.4))),
        Blob::ball(point(q!(-0.8), q!(0.62), q!(0.8)), size(q!(0.36))),
        Blob::ball(point(q!(0.9), q!(0.24), q!(1)), size(q!(0.24))),
        Blob {
            a: point(q!(0.95), q!(0.14), q!(0.95)),
            b: point(q!(1.2), q!(0.6), q!(0.8)),
            radius: size(q!(0.1)),
        },
        Blob::ball(point(q!(1.22), q!(0.66), q!(0.78)), size(q!(0.2))),
    ]
}

/// A solid of each kind on a floor, under a lamp and a dim sky: a gyroid, a box of steel, metaballs of glass, a smooth
/// union, a capsule, and a torus that glows. Its [`blobs`] are the caller's to keep.
pub fn implicits() -> Result<(SceneBuilder<8, 7, 3>, Camera), SceneError> {
    let unit = Unit::DEFAULT;
    let size = |metres: Metres| unit.length(metres);
    let mut b = SceneBuilder::with_unit(unit);
    let grey = albedo(q!(0.5, Share), q!(0.5, Share), q!(0.48, Share));
    let floor = b.material(Material::lambert(grey))?;
    b.shape(Plane::new(point(q!(0), q!(0), q!(0)), Dir::Y), floor)?;

    let slant = Dir::new([4 * ONE_Q16, ONE_Q16, 2 * ONE_Q16]).unwrap_or(Dir::X);
    let gyroid = Gyroid::new(
        point(q!(0), q!(0.75), q!(-0.55)),
        [slant, Dir::Y],
        size(q!(0.55)),
        size(q!(0.07)),
        Bound::ball(size(q!(0.75))),
    );
    let turned = Dir::new([2 * ONE_Q16, 0, -ONE_Q16]).unwrap_or(Dir::X);
    let half = [q!(0.45), q!(0.4), q!(0.35)].map(size);
    let block = RoundedBox::new(
        point(q!(-1.45), q!(0.4), q!(-0.5)),
        turned,
        Dir::Y,
        half,
        size(q!(0.1)),
    );
    let capsule = Capsule::new(
        point(q!(-0.12), q!(0.12), q!(1.45)),
        point(q!(0.42), q!(0.12), q!(1.25)),
        size(q!(0.12)),
    );
    let blobs = blobs();
    // A fifth, in steps of 2^-27.
    let metaballs = Metaballs::new(&blobs, 0, 3, (1 << 27) / 5);
    let union = SmoothUnion::new(&blobs, 3, 3, size(q!(0.16)));

    let teal = albedo(q!(0.1, Share), q!(0.45, Share), q!(0.42, Share));
    let red = albedo(q!(0.65, Share), q!(0.12, Share), q!(0.08, Share));
    let blue = albedo(q!(0.16, Share), q!(0.26, Share), q!(0.62, Share));
    let steel = Conductor::new(albedo(q!(0.9, Share), q!(0.88, Share), q!(0.85, Share)));
    let solids = [
        (gyroid.map(Implicit::Gyroid), Material::lambert(teal)),
        (
            block.map(Implicit::RoundedBox),
            Material::Conductor(steel.rough(q!(0.2, Share))),
        ),
        (
            Some(Implicit::Metaballs(metaballs)),
            Material::Dielectric(Dielectric::new(q!(1.5))),
        ),
        (Some(Implicit::SmoothUnion(union)), Material::lambert(blue)),
        (Some(Implicit::Capsule(capsule)), Material::lambert(red)),
    ];
    for (solid, material) in solids {
        let material = b.material(material)?;
        if let Some(solid) = solid {
            b.shape(solid, material)?;
        }
    }
    let black = b.material(Material::Black)?;
    let axis = Dir::new([-2 * ONE_Q16, ONE_Q16, 3 * ONE_Q16]).unwrap_or(Dir::Z);
    let ring = Torus::new(
        point(q!(1.42), q!(0.72), q!(-0.5)),
        axis,
        size(q!(0.5)),
        size(q!(0.1)),
    );
    b.emitter(
        Implicit::Torus(ring),
        black,
        Radiance::new(q!(2.4), q!(1.15), q!(0.35)),
    )?;
    let lamp = Rectangle {
        center: point(q!(-1), q!(3.4), q!(1.2)),
        u: Dir::X,
        v: Dir::Z,
        normal: -Dir::Y,
        half: [q!(0.6), q!(0.6)].map(size),
    };
    b.emitter(lamp, black, Radiance::new(q!(11), q!(10.6), q!(10)))?;
    b.light(Light::Environment {
        radiance: Radiance::new(q!(0.16), q!(0.2), q!(0.27)),
    })?;

    let (eye, target) = (point(q!(0), q!(2), q!(5.2)), point(q!(0), q!(0.62), q!(0)));
    Ok((b, look(eye, target, q!(0.108, Turn))))
}
