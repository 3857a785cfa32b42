// implicits, written by `host-sim bake`: `scene` fills a builder, whose `build_from` takes `borrowed`.

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

/// 8 shapes, 7 materials, 3 lights.
pub type Builder = SceneBuilder<8, 7, 3>;

#[allow(dead_code)]
static BLOBS: [Blob; 6] = [Blob { a: Point([-524288, -660603, 498074]), b: Point([-524288, -660603, 498074]), radius: 272630 }, Blob { a: Point([-325059, -702546, 602931]), b: Point([-325059, -702546, 602931]), radius: 209715 }, Blob { a: Point([-419430, -524288, 419430]), b: Point([-419430, -524288, 419430]), radius: 188744 }, Blob { a: Point([471859, -723517, 524288]), b: Point([471859, -723517, 524288]), radius: 125829 }, Blob { a: Point([498074, -775946, 498074]), b: Point([629146, -534774, 419430]), radius: 52429 }, Blob { a: Point([639631, -503316, 408945]), b: Point([639631, -503316, 408945]), radius: 104858 }];

static TEXTURES: [Texture; 0] = [
];

static CHOICE: [u32; 1] = [268435455];

/// What the scene borrows: its meshes, in the order of the baked ones.
pub fn borrowed<'a>(meshes: &'a [Mesh<'a>]) -> Borrowed<'a> {
    Borrowed { meshes, textures: &TEXTURES, blobs: &BLOBS, environment: Environment::None, choice: &CHOICE }
}

/// The scene, and its camera.
pub fn scene() -> Result<(Builder, Camera), SceneError> {
    let mut b = Builder::with_unit(Unit::new(19));
    let m = [
        b.material(Material::Lambert { albedo: Albedo::from_bits([16384, 16384, 15729]), two_sided: true })?,
        b.material(Material::Lambert { albedo: Albedo::from_bits([3277, 14746, 13763]), two_sided: true })?,
        b.material(Material::Lambert { albedo: Albedo::from_bits([5243, 8520, 20316]), two_sided: true })?,
        b.material(Material::Lambert { albedo: Albedo::from_bits([21299, 3932, 2621]), two_sided: true })?,
        b.material(Material::Dielectric(Dielectric::new(Metres::from_bits(98304)).tinted(Albedo::from_bits([32768, 32768, 32768]), Albedo::from_bits([32768, 32768, 32768]))))?,
        b.material(Material::Mirror { reflectance: Albedo::from_bits([29491, 28836, 27853]), two_sided: true })?,
        b.material(Material::Lambert { albedo: Albedo::from_bits([0, 0, 0]), two_sided: false })?,
    ];
    b.shape(Rectangle { normal: Dir([0, 65536, 0]), u: Dir([0, 0, 65536]), v: Dir([65536, 0, 0]), center: Point([0, -849347, 0]), half: [2621440, 2621440] }, m[0])?;
    b.shape(Implicit::Gyroid(Gyroid { center: Point([0, -456131, -288358]), x: Dir([54366, 13592, 33979]), y: Dir([-20021, 61982, 7240]), cell: 288358, thickness: 36700, bound: Bound::ball(393216) }), m[1])?;
    b.shape(Implicit::RoundedBox(RoundedBox { center: Point([-760218, -639631, -262144]), x: Dir([58617, 0, -29309]), y: Dir([0, 65537, 0]), half: [235930, 209715, 183501], radius: 52429 }), m[2])?;
    b.shape(Implicit::Metaballs(Metaballs::new(&BLOBS, 0, 3, 26843546)), m[4])?;
    b.shape(Implicit::SmoothUnion(SmoothUnion::new(&BLOBS, 3, 3, 83886)), m[5])?;
    b.shape(Implicit::Capsule(Capsule::new(Point([-62915, -786432, 760218]), Point([220201, -786432, 655360]), 62915)), m[3])?;
    b.emitter(Implicit::Torus(Torus { center: Point([744489, -471859, -262144]), axis: Dir([-32745, 16373, 54357]), side: Dir([-56138, 0, -33818]), major: 262144, minor: 52429 }), m[6], Radiance::from_bits([39322, 18842, 5734], -14))?;
    b.emitter(Rectangle { normal: Dir([0, -65536, 0]), u: Dir([65536, 0, 0]), v: Dir([0, 0, 65536]), center: Point([-524288, 933233, 629146]), half: [314573, 314573] }, m[6], Radiance::from_bits([45056, 43418, 40960], -12))?;
    b.light(Light::Environment { radiance: Radiance::from_bits([20972, 26214, 35389], -17) })?;
    let camera = Camera::from_frame(Point([0, 199229, 2726298]), [Dir([65536, 0, 0]), Dir([0, 63343, -16810]), Dir([0, -16810, -63343])], fixed::types::I12F20::from_bits(371320));
    Ok((b, camera))
}
