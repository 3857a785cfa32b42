// cornell, written by `host-sim bake`: `scene` fills a builder, whose `build_from` takes `borrowed`.

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

/// 20 shapes, 6 materials, 1 lights.
pub type Builder = SceneBuilder<20, 6, 1>;

#[allow(dead_code)]
static BLOBS: [Blob; 0] = [];

static TEXTURES: [Texture; 1] = [
    // stripes
    Texture { width: 3, height: 1, palette: &[[29491, 3277, 3277], [29491, 29491, 29491], [3277, 3277, 29491]], texels: Texels::Half(&[16, 2]), filter: Filter::Bilinear },
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
        b.material(Material::Lambert { albedo: Albedo::from_bits([24248, 23921, 22938]), two_sided: true })?,
        b.material(Material::Lambert { albedo: Albedo::from_bits([19661, 2294, 1966]), two_sided: true })?,
        b.material(Material::Lambert { albedo: Albedo::from_bits([4260, 14418, 3932]), two_sided: true })?,
        b.material(Material::Lambert { albedo: Albedo::from_bits([0, 0, 0]), two_sided: false })?,
        b.material(Material::Lambert { albedo: Albedo::from_bits([29491, 29491, 29491]), two_sided: true })?,
        b.material(Material::Lambert { albedo: Albedo::from_bits([29491, 29491, 29491]), two_sided: true })?,
    ];
    b.shape(Rectangle { normal: Dir([0, 65536, 0]), u: Dir([0, 0, 65536]), v: Dir([65536, 0, 0]), center: Point([0, -1048576, 0]), half: [1048576, 1048576] }, m[0])?;
    b.shape(Rectangle { normal: Dir([0, -65536, 0]), u: Dir([65536, 0, 0]), v: Dir([0, 0, 65536]), center: Point([0, 1048576, 0]), half: [1048576, 1048576] }, m[0])?;
    b.shape(Rectangle { normal: Dir([0, 0, 65536]), u: Dir([65536, 0, 0]), v: Dir([0, 65536, 0]), center: Point([0, 0, -1048576]), half: [1048576, 1048576] }, m[0])?;
    b.shape(Rectangle { normal: Dir([65536, 0, 0]), u: Dir([0, 65536, 0]), v: Dir([0, 0, 65536]), center: Point([-1048576, 0, 0]), half: [1048576, 1048576] }, m[1])?;
    b.shape(Rectangle { normal: Dir([-65536, 0, 0]), u: Dir([0, 0, 65536]), v: Dir([0, 65536, 0]), center: Point([1048576, 0, 0]), half: [1048576, 1048576] }, m[2])?;
    b.shape(Rectangle { normal: Dir([-62672, 0, 19161]), u: Dir([0, -65536, 0]), v: Dir([19161, 0, 62672]), center: Point([-668287, -408945, -225666]), half: [639631, 304087] }, m[0])?;
    b.shape(Rectangle { normal: Dir([62673, 0, -19161]), u: Dir([0, 65536, 0]), v: Dir([19160, 0, 62671]), center: Point([-86687, -408945, -403479]), half: [639631, 304087] }, m[0])?;
    b.shape(Rectangle { normal: Dir([0, 65535, 0]), u: Dir([19161, 0, 62672]), v: Dir([62672, 0, -19161]), center: Point([-377487, 230687, -314573]), half: [304087, 304087] }, m[0])?;
    b.shape(Rectangle { normal: Dir([-19161, 0, -62673]), u: Dir([-62672, 0, 19161]), v: Dir([0, 65536, 0]), center: Point([-466394, -408945, -605373]), half: [304087, 639631] }, m[0])?;
    b.shape(Rectangle { normal: Dir([19161, 0, 62672]), u: Dir([62672, 0, -19161]), v: Dir([0, 65535, 0]), center: Point([-288581, -408945, -23773]), half: [304087, 639631] }, m[0])?;
    b.shape(Rectangle { normal: Dir([-61966, 0, -21336]), u: Dir([0, -65536, 0]), v: Dir([-21336, 0, 61966]), center: Point([79482, -754975, 247029]), half: [293601, 304087] }, m[0])?;
    b.shape(Rectangle { normal: Dir([61966, 0, 21336]), u: Dir([0, 65536, 0]), v: Dir([-21336, 0, 61966]), center: Point([654522, -754975, 445031]), half: [293601, 304087] }, m[0])?;
    b.shape(Rectangle { normal: Dir([0, 65537, 0]), u: Dir([-21336, 0, 61966]), v: Dir([61967, 0, 21336]), center: Point([367002, -461373, 346030]), half: [304087, 304087] }, m[0])?;
    b.shape(Rectangle { normal: Dir([21336, 0, -61966]), u: Dir([-61966, 0, -21336]), v: Dir([0, 65537, 0]), center: Point([466003, -754975, 58510]), half: [304087, 293601] }, m[0])?;
    b.shape(Rectangle { normal: Dir([-21336, 0, 61966]), u: Dir([61966, 0, 21336]), v: Dir([0, 65537, 0]), center: Point([268001, -754975, 633550]), half: [304087, 293601] }, m[0])?;
    b.emitter(Rectangle { normal: Dir([0, -65536, 0]), u: Dir([65536, 0, 0]), v: Dir([0, 0, 65536]), center: Point([0, 1032847, -52429]), half: [272630, 220201] }, m[3], Radiance::from_bits([33792, 27853, 17613], -11))?;
    b.tinted(Instance::new(0).scaled(Metres::from_bits(65536)).turned(Rotation::from_rows([[886197368, 0, 606280240], [0, 1073741824, 0], [-606280239, 0, 886197368]])).moved(Point([-404629, -812646, 21636])), m[4], Tint::Vertices)?;
    b.tinted(Instance::new(0).scaled(Metres::from_bits(111411)).turned(Rotation::from_rows([[886197368, 0, 606280240], [0, 1073741824, 0], [-606280239, 0, 886197368]])).moved(Point([444593, -720896, 36781])), m[4], Tint::Vertices)?;
    b.tinted(Instance::new(1).scaled(Metres::from_bits(65536)).turned(Rotation::from_rows([[-31352750, 0, 1073283984], [0, 1073741824, 0], [-1073283983, 0, -31352750]])).moved(Point([-393227, -812646, 313807])), m[5], Tint::Texture(0))?;
    b.tinted(Instance::new(1).scaled(Metres::from_bits(111411)).turned(Rotation::from_rows([[-31352750, 0, 1073283984], [0, 1073741824, 0], [-1073283983, 0, -31352750]])).moved(Point([463976, -720896, 313272])), m[5], Tint::Texture(0))?;
    let camera = Camera::from_frame(Point([0, 0, 4299162]), [Dir([65536, 0, 0]), Dir([0, 65536, 0]), Dir([0, 0, -65536])], fixed::types::I12F20::from_bits(361054));
    Ok((b, camera))
}
