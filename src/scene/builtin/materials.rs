use super::look;
use crate::camera::Camera;
use crate::color::{Albedo, Radiance, albedo};
use crate::geom::{Dir, Unit, point};
use crate::light::Light;
use crate::material::{
    BlinnPhong, Conductor, Dielectric, Index, Material, OrenNayar, OrenNayarModel, RoughDielectric,
};
use crate::num::{Metres, Share, Turn};
use crate::q;
use crate::scene::{SceneBuilder, SceneError};
use crate::shape::{Plane, Rectangle, Sphere};

/// Gold's refractive index at 630, 530 and 460 nm, from tables (Johnson and Christy 1972), rounded.
const GOLD: [[Index; 3]; 2] = [
    [q!(0.19, Index), q!(0.55, Index), q!(1.35, Index)],
    [q!(3.30, Index), q!(2.20, Index), q!(1.88, Index)],
];
/// Copper's.
const COPPER: [[Index; 3]; 2] = [
    [q!(0.25, Index), q!(1.10, Index), q!(1.16, Index)],
    [q!(3.45, Index), q!(2.59, Index), q!(2.40, Index)],
];

/// A ball of each material that is more than matt or a mirror, two rows of five on a floor, under a lamp and a dim sky.
///
/// Behind: Oren and Nayar's full and shorter model, the one that keeps energy, Blinn–Phong with its energy kept and as it
/// was first written. In front: smooth copper, gold of a little roughness, copper of much, frosted glass, clear glass.
pub fn materials() -> Result<(SceneBuilder<12, 12, 2>, Camera), SceneError> {
    let unit = Unit::DEFAULT;
    let mut b = SceneBuilder::with_unit(unit);
    let clay = albedo(q!(0.75, Share), q!(0.45, Share), q!(0.30, Share));
    let red = albedo(q!(0.45, Share), q!(0.05, Share), q!(0.05, Share));
    let blue = albedo(q!(0.05, Share), q!(0.12, Share), q!(0.45, Share));
    let shine = albedo(q!(0.4, Share), q!(0.4, Share), q!(0.4, Share));
    let rough = |model, sigma| Material::OrenNayar(OrenNayar::new(model, clay, sigma));
    let metal = |[eta, k]: [[Index; 3]; 2], alpha| {
        Material::Conductor(Conductor::new(Albedo::WHITE).with_index(eta, k).rough(alpha))
    };
    let glass = Dielectric::new(q!(1.5));
    let balls = [
        rough(OrenNayarModel::Full, q!(0.1, Turn)),
        rough(OrenNayarModel::Qualitative, q!(0.1, Turn)),
        rough(OrenNayarModel::EnergyPreserving, q!(0.2, Turn)),
        Material::BlinnPhong(BlinnPhong::new(red, shine, q!(60))),
        Material::BlinnPhong(BlinnPhong::new(blue, Albedo::WHITE, q!(20)).unnormalized()),
        metal(COPPER, Share::ZERO),
        metal(GOLD, q!(0.1, Share)),
        metal(COPPER, q!(0.4, Share)),
        Material::RoughDielectric(RoughDielectric::new(glass, q!(0.2, Share))),
        Material::Dielectric(glass),
    ];

    let floor = b.material(Material::lambert(albedo(
        q!(0.5, Share),
        q!(0.48, Share),
        q!(0.45, Share),
    )))?;
    b.shape(Plane::new(point(q!(0), q!(0), q!(0)), Dir::Y), floor)?;
    let columns = [q!(-1.5), q!(-0.75), q!(0), q!(0.75), q!(1.5)];
    let places = [q!(-0.5), q!(0.4)]
        .into_iter()
        .flat_map(|z| columns.map(|x| point(x, q!(0.32), z)));
    let radius = unit.length(q!(0.32));
    for (material, center) in balls.into_iter().zip(places) {
        let material = b.material(material)?;
        b.shape(Sphere::new(center, radius), material)?;
    }
    let black = b.material(Material::Black)?;
    let lamp = Rectangle {
        center: point(q!(-0.6), q!(3), q!(1.2)),
        u: Dir::X,
        v: Dir::Z,
        normal: -Dir::Y,
        half: [q!(0.9), q!(0.6)].map(|half: Metres| unit.length(half)),
    };
    b.emitter(lamp, black, Radiance::new(q!(8), q!(7.5), q!(6.5)))?;
    b.light(Light::Environment {
        radiance: Radiance::new(q!(0.22), q!(0.26), q!(0.32)),
    })?;

    let (eye, target) = (point(q!(0), q!(1.9), q!(4.4)), point(q!(0), q!(0.22), q!(0)));
    Ok((b, look(eye, target, q!(0.125, Turn))))
}
