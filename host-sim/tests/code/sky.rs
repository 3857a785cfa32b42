// sky, written by `host-sim bake`: `scene` fills a builder, whose `build_from` takes `borrowed`.

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

/// 5 shapes, 5 materials, 0 lights.
pub type Builder = SceneBuilder<5, 5, 0>;

#[allow(dead_code)]
static BLOBS: [Blob; 0] = [];

static TEXTURES: [Texture; 0] = [
];

static CHOICE: [u32; 0] = [];

/// What is seen where nothing is.
pub fn sky() -> Sky {
    Sky::new(Dir([0, 65536, 0]), Radiance::from_bits([9830, 19661, 45875], -16), Radiance::from_bits([45875, 49152, 52429], -16), Radiance::from_bits([62915, 52429, 41943], -19)).with_sun(Dir([31790, 47684, 31790]), Turn::from_bits(47721859), Radiance::from_bits([38400, 34560, 27520], -6))
}

/// What the scene borrows: its meshes, in the order of the baked ones, and its `sky`.
pub fn borrowed<'a>(meshes: &'a [Mesh<'a>], sky: &'a Sky) -> Borrowed<'a> {
    Borrowed { meshes, textures: &TEXTURES, blobs: &BLOBS, environment: Environment::Sky(sky), choice: &CHOICE }
}

/// The scene, and its camera.
pub fn scene() -> Result<(Builder, Camera), SceneError> {
    let mut b = Builder::with_unit(Unit::new(20));
    let m = [
        b.material(Material::Lambert { albedo: Albedo::from_bits([13763, 13107, 11796]), two_sided: true })?,
        b.material(Material::Lambert { albedo: Albedo::from_bits([22938, 22282, 20316]), two_sided: true })?,
        b.material(Material::Mirror { reflectance: Albedo::from_bits([31130, 30474, 28836]), two_sided: true })?,
        b.material(Material::Conductor(Conductor::new(Albedo::from_bits([31130, 30474, 28836])).rough(Share::from_bits(8192))))?,
        b.material(Material::Dielectric(Dielectric::new(Metres::from_bits(98304)).tinted(Albedo::from_bits([32768, 32768, 32768]), Albedo::from_bits([32768, 32768, 32768]))))?,
    ];
    b.shape(Plane { point: Point([-52429, -629146, 0]), normal: Dir([0, 65536, 0]) }, m[0])?;
    b.shape(Sphere { center: Point([-1153434, -104858, 0]), radius: 524288 }, m[1])?;
    b.shape(Sphere { center: Point([0, 0, -524288]), radius: 629146 }, m[2])?;
    b.shape(Sphere { center: Point([1153434, -104858, 0]), radius: 524288 }, m[3])?;
    b.shape(Sphere { center: Point([52429, -314573, 838861]), radius: 314573 }, m[4])?;
    let camera = Camera::from_frame(Point([-52429, 734003, 4823450]), [Dir([65536, 0, 0]), Dir([0, 64567, -11229]), Dir([0, -11229, -64567])], fixed::types::I12F20::from_bits(340703));
    Ok((b, camera))
}
