// materials, written by `host-sim bake`: `scene` fills a builder, whose `build_from` takes `borrowed`.

#[allow(unused_imports)]
use microlux::{
    camera::Camera,
    color::{Albedo, Radiance},
    geom::{Dir, Point, Rotation, Unit},
    light::{Environment, Light, Sky},
    material::*,
    num::{Metres, Share, Turn},
    scene::{Borrowed, Mesh, SceneBuilder, SceneError, Tint},
    shape::*,
};

/// 12 shapes, 12 materials, 2 lights.
pub type Builder = SceneBuilder<12, 12, 2>;

#[allow(dead_code)]
static BLOBS: [Blob; 0] = [];

static TEXTURES: [Texture; 0] = [
];

static CHOICE: [u32; 0] = [];

/// What the scene borrows: its meshes, in the order of the baked ones.
pub fn borrowed<'a>(meshes: &'a [Mesh<'a>]) -> Borrowed<'a> {
    Borrowed { meshes, textures: &TEXTURES, blobs: &BLOBS, environment: Environment::None, choice: &CHOICE }
}

/// The scene, and its camera.
pub fn scene() -> Result<(Builder, Camera), SceneError> {
    let mut b = Builder::with_unit(Unit::new(20));
    let m = [
        b.material(Material::Lambert { albedo: Albedo::from_bits([16384, 15729, 14746]), two_sided: true })?,
        b.material(Material::OrenNayar(OrenNayar::new(OrenNayarModel::Full, Albedo::from_bits([24576, 14746, 9830]), Turn::from_bits(429490176))))?,
        b.material(Material::OrenNayar(OrenNayar::new(OrenNayarModel::Qualitative, Albedo::from_bits([24576, 14746, 9830]), Turn::from_bits(429490176))))?,
        b.material(Material::OrenNayar(OrenNayar::new(OrenNayarModel::EnergyPreserving, Albedo::from_bits([24576, 14746, 9830]), Turn::from_bits(858980352))))?,
        b.material(Material::BlinnPhong(BlinnPhong::new(Albedo::from_bits([14746, 1638, 1638]), Albedo::from_bits([13107, 13107, 13107]), Metres::from_bits(3932160))))?,
        b.material(Material::BlinnPhong(BlinnPhong::new(Albedo::from_bits([1638, 3932, 14746]), Albedo::from_bits([32768, 32768, 32768]), Metres::from_bits(1310720)).unnormalized()))?,
        b.material(Material::Conductor(Conductor::new(Albedo::from_bits([32768, 32768, 32768])).with_index([Index::from_bits(1024), Index::from_bits(4506), Index::from_bits(4752)], [Index::from_bits(14132), Index::from_bits(10609), Index::from_bits(9831)])))?,
        b.material(Material::Conductor(Conductor::new(Albedo::from_bits([32768, 32768, 32768])).with_index([Index::from_bits(779), Index::from_bits(2253), Index::from_bits(5530)], [Index::from_bits(13517), Index::from_bits(9012), Index::from_bits(7701)]).rough(Share::from_bits(3277))))?,
        b.material(Material::Conductor(Conductor::new(Albedo::from_bits([32768, 32768, 32768])).with_index([Index::from_bits(1024), Index::from_bits(4506), Index::from_bits(4752)], [Index::from_bits(14132), Index::from_bits(10609), Index::from_bits(9831)]).rough(Share::from_bits(13108))))?,
        b.material(Material::RoughDielectric(RoughDielectric::new(Dielectric::new(Metres::from_bits(98304)).tinted(Albedo::from_bits([32768, 32768, 32768]), Albedo::from_bits([32768, 32768, 32768])), Share::from_bits(6554))))?,
        b.material(Material::Dielectric(Dielectric::new(Metres::from_bits(98304)).tinted(Albedo::from_bits([32768, 32768, 32768]), Albedo::from_bits([32768, 32768, 32768]))))?,
        b.material(Material::Lambert { albedo: Albedo::from_bits([0, 0, 0]), two_sided: false })?,
    ];
    b.shape(Plane { point: Point([0, -1572864, -513802]), normal: Dir([0, 65536, 0]) }, m[0])?;
    b.shape(Sphere { center: Point([-1572864, -1237320, -1038090]), radius: 335544 }, m[1])?;
    b.shape(Sphere { center: Point([-786432, -1237320, -1038090]), radius: 335544 }, m[2])?;
    b.shape(Sphere { center: Point([0, -1237320, -1038090]), radius: 335544 }, m[3])?;
    b.shape(Sphere { center: Point([786432, -1237320, -1038090]), radius: 335544 }, m[4])?;
    b.shape(Sphere { center: Point([1572864, -1237320, -1038090]), radius: 335544 }, m[5])?;
    b.shape(Sphere { center: Point([-1572864, -1237320, -94372]), radius: 335544 }, m[6])?;
    b.shape(Sphere { center: Point([-786432, -1237320, -94372]), radius: 335544 }, m[7])?;
    b.shape(Sphere { center: Point([0, -1237320, -94372]), radius: 335544 }, m[8])?;
    b.shape(Sphere { center: Point([786432, -1237320, -94372]), radius: 335544 }, m[9])?;
    b.shape(Sphere { center: Point([1572864, -1237320, -94372]), radius: 335544 }, m[10])?;
    b.emitter(Rectangle { normal: Dir([0, -65536, 0]), u: Dir([65536, 0, 0]), v: Dir([0, 0, 65536]), center: Point([-629146, 1572864, 744489]), half: [943718, 629146] }, m[11], Radiance::from_bits([32768, 30720, 26624], -12))?;
    b.light(Light::Environment { radiance: Radiance::from_bits([28836, 34079, 41943], -17) })?;
    let camera = Camera::from_frame(Point([0, 419430, 4099932]), [Dir([65536, 0, 0]), Dir([0, 61225, -23377]), Dir([0, -23377, -61225])], fixed::types::I12F20::from_bits(434334));
    Ok((b, camera))
}
