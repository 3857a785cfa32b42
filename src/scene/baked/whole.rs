//! A whole scene beside its meshes: all that a picture of it needs.

use super::record::{
    BlobRecord, LightRecord, MapRecord, MaterialRecord, ShapeRecord, SkyRecord, TextureRecord,
};
use super::{Baked, BakedError};
use crate::bvh::Node;
use crate::camera::Camera;
use crate::color::Rgb9e5;
use crate::geom::{Dir, FAR, Point, REACH, Unit};
use crate::light::{Environment, Light, Map, MapParts, Sky};
use crate::material::{Material, Texels, Texture};
use crate::scene::check::is_unit;
use crate::scene::{Mesh, Parts, Scene, SceneError, Shape};
use crate::shape::{Blob, Grid};
use fixed::types::I12F20;
use heapless::Vec;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// What a whole scene begins with, 112 bytes.
///
/// | byte | what |
/// |---|---|
/// | 0 | the unit: 2^-n metres, i8 |
/// | 1 | the grid's shift: a step is 2^shift units |
/// | 2 | background: 0 none, or a light of the scene, 1 a sky, 2 a map |
/// | 3 | 0 |
/// | 4, 5 | how many shapes are finite |
/// | 6 ..= 19 | nodes, bounds between lights, shapes, materials, lights, blobs, textures |
/// | 20 ..= 31 | the grid's origin, units |
/// | 32 ..= 39 | the picture's width and height, u16; samples a pixel, u32 (0: not said) |
/// | 40, 41 | integrator: 0 ambient occlusion, 1 direct, 2 path, 3 bdpt, 4 light tracer; whether emitters are hidden |
/// | 42 ..= 47 | segments at most; segments before roulette; 0 |
/// | 48 ..= 51 | how far ambient occlusion looks, units |
/// | 52 ..= 63 | the camera's place |
/// | 64 ..= 99 | right, up and forward of it, in 2^-16 |
/// | 100 ..= 103 | half the picture's width at distance 1, in 2^-20 |
/// | 104 ..= 111 | radius of the lens, and distance of what is in focus, units |
///
/// After it come, each filled up with zeros to a multiple of 4 bytes: nodes (40 bytes each); bounds (u32);
/// [`ShapeRecord`]s; [`MaterialRecord`]s; [`LightRecord`]s; [`BlobRecord`]s; [`TextureRecord`]s; for each texture its
/// palette (3×u16 in 2^-15 a colour) and its texels; the [`SkyRecord`] or [`MapRecord`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct WholeHead {
    fraction_bits: i8,
    shift: u8,
    background: u8,
    zero: u8,
    bounded: u16,
    counts: [u16; 7],
    grid: [i32; 3],
    shot: ShotRecord,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct ShotRecord {
    size: [u16; 2],
    spp: u32,
    technique: u8,
    hide_emitters: u8,
    max_depth: u16,
    rr_depth: u16,
    zero: u16,
    ao_radius: i32,
    origin: [i32; 3],
    frame: [[i32; 3]; 3],
    tan_half: i32,
    lens: [i32; 2],
}

const _: () = assert!(size_of::<WholeHead>() == 112);

/// How a scene wants to be rendered: its camera, and what it says of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    pub camera: Camera,
    /// Pixels, 1 ..= 2^14 a side.
    pub width: u16,
    pub height: u16,
    /// Samples a pixel up to 65536; 0: it does not say.
    pub spp: u32,
    pub technique: Technique,
    /// Segments of a path at most.
    pub max_depth: u16,
    /// Segments after which roulette may end a path.
    pub rr_depth: u16,
    pub hide_emitters: bool,
    /// How far ambient occlusion looks, units, 1 ..= 1 + [`FAR`]: all there is.
    pub ao_radius: i32,
}

/// Which of the integrators a scene asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Technique {
    AmbientOcclusion,
    Direct,
    Path,
    Bdpt,
    LightTracer,
}

impl Technique {
    const ALL: [Technique; 5] = [
        Technique::AmbientOcclusion,
        Technique::Direct,
        Technique::Path,
        Technique::Bdpt,
        Technique::LightTracer,
    ];
}

impl ShotRecord {
    fn of(shot: &Shot) -> ShotRecord {
        let (radius, focus) = shot.camera.lens();
        ShotRecord {
            size: [shot.width, shot.height],
            spp: shot.spp,
            technique: shot.technique as u8,
            hide_emitters: shot.hide_emitters.into(),
            max_depth: shot.max_depth,
            rr_depth: shot.rr_depth,
            zero: 0,
            ao_radius: shot.ao_radius,
            origin: shot.camera.origin().0,
            frame: shot.camera.frame().map(|dir| dir.0),
            tan_half: shot.camera.half_width().to_bits(),
            lens: [radius, focus],
        }
    }

    /// The shot, or what of it makes no sense.
    fn shot(&self) -> Result<Shot, &'static str> {
        let technique = Technique::ALL.get(usize::from(self.technique));
        let frame = self.frame.map(Dir);
        let origin = self.origin;
        let [radius, focus] = self.lens;
        let [x, y, z] = frame;
        let is_frame = frame.into_iter().all(is_unit)
            && [x.dot(y), y.dot(z), z.dot(x)].iter().all(|cos| cos.abs() <= 16);
        let camera = Camera::from_frame(Point(origin), frame, I12F20::from_bits(self.tan_half));
        let shot = Shot {
            camera: camera.with_lens(radius, focus),
            width: self.size[0],
            height: self.size[1],
            spp: self.spp,
            technique: *technique.ok_or("technique")?,
            max_depth: self.max_depth,
            rr_depth: self.rr_depth,
            hide_emitters: self.hide_emitters != 0,
            ao_radius: self.ao_radius,
        };
        let side = |pixels| (1..=1 << 14).contains(&pixels);
        let wrong = if !side(shot.width) || !side(shot.height) {
            "size"
        } else if shot.spp > 1 << 16 {
            "samples"
        } else if !(1..=FAR + 1).contains(&shot.ao_radius) {
            "radius of occlusion"
        } else if origin.iter().any(|c| c.unsigned_abs() > 2 * REACH as u32) {
            "place of the camera"
        } else if !is_frame {
            "directions of the camera"
        } else if !(0..=REACH).contains(&radius) || !(1..=2 * REACH).contains(&focus) {
            "lens"
        } else if ShotRecord::of(&shot) != *self {
            "numbers"
        } else {
            return Ok(shot);
        };
        Err(wrong)
    }
}

impl WholeHead {
    /// Of a scene and how it wants to be rendered.
    pub fn new(parts: &Parts, shot: &Shot) -> WholeHead {
        WholeHead {
            fraction_bits: parts.unit.fraction_bits() as i8,
            shift: parts.grid.shift() as u8,
            background: match parts.environment {
                Environment::None | Environment::Constant(_) => 0,
                Environment::Sky(_) => 1,
                Environment::Map(_) => 2,
            },
            zero: 0,
            bounded: parts.bounded,
            counts: [
                parts.nodes.len(),
                parts.choice.len(),
                parts.shapes.len(),
                parts.materials.len(),
                parts.lights.len(),
                parts.blobs.len(),
                parts.textures.len(),
            ]
            .map(|count| count as u16),
            grid: parts.grid.origin().0,
            shot: ShotRecord::of(shot),
        }
    }
}

/// Memory for what is taken out of its records: so many shapes, materials and lights, and `LENT` meshes, textures and
/// blobs each.
///
/// `host-sim bake` says how many a scene has.
#[derive(Clone, Debug)]
pub struct Room<'a, const SHAPES: usize, const MATERIALS: usize, const LIGHTS: usize, const LENT: usize> {
    shapes: Vec<Shape, SHAPES>,
    materials: Vec<Material, MATERIALS>,
    lights: Vec<Light, LIGHTS>,
    meshes: Vec<Mesh<'a>, LENT>,
    textures: Vec<Texture<'a>, LENT>,
    blobs: Vec<Blob, LENT>,
    sky: Option<Sky>,
}

impl<const SHAPES: usize, const MATERIALS: usize, const LIGHTS: usize, const LENT: usize>
    Room<'_, SHAPES, MATERIALS, LIGHTS, LENT>
{
    pub const fn new() -> Self {
        Room {
            shapes: Vec::new(),
            materials: Vec::new(),
            lights: Vec::new(),
            meshes: Vec::new(),
            textures: Vec::new(),
            blobs: Vec::new(),
            sky: None,
        }
    }
}

impl<const SHAPES: usize, const MATERIALS: usize, const LIGHTS: usize, const LENT: usize> Default
    for Room<'_, SHAPES, MATERIALS, LIGHTS, LENT>
{
    fn default() -> Self {
        Self::new()
    }
}

/// A whole scene, ready to be rendered as it wants to be.
#[derive(Clone, Copy, Debug)]
pub struct Whole<'a> {
    pub scene: Scene<'a>,
    pub shot: Shot,
}

/// What a reader of bytes has still before it.
struct Rest<'a>(&'a [u8]);

impl<'a> Rest<'a> {
    /// The next things, and the zeros after them to a multiple of 4 bytes.
    fn take<T: FromBytes + Immutable + KnownLayout>(&mut self, count: usize) -> Result<&'a [T], BakedError> {
        let short = BakedError::Cut { left: self.0.len() };
        let (taken, _) = <[T]>::ref_from_prefix_with_elems(self.0, count).map_err(|_| short)?;
        let bytes = size_of_val(taken).next_multiple_of(4);
        self.0 = self.0.get(bytes..).ok_or(short)?;
        Ok(taken)
    }

    fn one<T: FromBytes + Immutable + KnownLayout>(&mut self) -> Result<&'a T, BakedError> {
        let left = self.0.len();
        self.take(1)?.first().ok_or(BakedError::Cut { left })
    }
}

/// What a whole scene is made of, as it lies there: borrowed, or taken out one by one.
#[derive(Clone, Copy, Debug)]
pub struct Records<'a> {
    pub unit: Unit,
    pub shot: Shot,
    pub grid: Grid,
    pub bounded: u16,
    pub nodes: &'a [Node],
    pub choice: &'a [u32],
    pub background: Background<'a>,
    shapes: &'a [ShapeRecord],
    materials: &'a [MaterialRecord],
    lights: &'a [LightRecord],
    blobs: &'a [BlobRecord],
    textures: &'a [TextureRecord],
    /// Where the textures' palettes and texels begin.
    colors: &'a [u8],
}

/// What is behind everything, if it is no light of the scene.
#[derive(Clone, Copy, Debug)]
pub enum Background<'a> {
    None,
    Sky(Sky),
    Map(Map<'a>),
}

/// What a record's field that makes no sense is reported as, with what the record is of.
fn named<T>(what: &'static str, index: u16, read: Result<T, &'static str>) -> Result<T, BakedError> {
    read.map_err(|field| BakedError::Record { what, index, field })
}

impl<'a> Records<'a> {
    fn new(bytes: &'a [u8]) -> Result<Records<'a>, BakedError> {
        let wrong = |field| BakedError::Whole { field };
        let mut rest = Rest(bytes);
        let head: &WholeHead = rest.one()?;
        let unit = Unit::new(head.fraction_bits.into());
        if head.zero != 0 || unit.fraction_bits() != i32::from(head.fraction_bits) {
            return Err(wrong("unit"));
        }
        let [nodes, choice, shapes, materials, lights, blobs, textures] = head.counts.map(usize::from);
        let mut records = Records {
            unit,
            shot: head.shot.shot().map_err(wrong)?,
            grid: Grid::new(Point(head.grid), head.shift).ok_or(wrong("grid"))?,
            bounded: head.bounded,
            nodes: rest.take(nodes)?,
            choice: rest.take(choice)?,
            background: Background::None,
            shapes: rest.take(shapes)?,
            materials: rest.take(materials)?,
            lights: rest.take(lights)?,
            blobs: rest.take(blobs)?,
            textures: rest.take(textures)?,
            colors: rest.0,
        };
        for texture in records.textures() {
            let texture = texture?;
            rest.take::<[u16; 3]>(texture.palette.len())?;
            let (Texels::Half(bytes) | Texels::Byte(bytes)) = texture.texels;
            rest.take::<u8>(bytes.len())?;
        }
        records.background = match head.background {
            0 => Background::None,
            1 => Background::Sky(rest.one::<SkyRecord>()?.sky().map_err(|_| wrong("sky"))?),
            2 => Background::Map(map(&mut rest)?),
            _ => return Err(wrong("background")),
        };
        if !rest.0.is_empty() {
            return Err(BakedError::Cut { left: rest.0.len() });
        }
        Ok(records)
    }

    /// The shapes, of which some are made of the scene's `blobs`.
    pub fn shapes(&self, blobs: &[Blob]) -> impl ExactSizeIterator<Item = Result<Shape, BakedError>> {
        self.shapes
            .iter()
            .enumerate()
            .map(|(index, record)| named("shape", index as u16, record.shape(blobs)))
    }

    pub fn materials(&self) -> impl ExactSizeIterator<Item = Result<Material, BakedError>> + use<'a> {
        let records = self.materials.iter().enumerate();
        records.map(|(index, record)| named("material", index as u16, record.material()))
    }

    pub fn lights(&self) -> impl ExactSizeIterator<Item = Result<Light, BakedError>> + use<'a> {
        let records = self.lights.iter().enumerate();
        records.map(|(index, record)| named("light", index as u16, record.light()))
    }

    pub fn blobs(&self) -> impl ExactSizeIterator<Item = Blob> + use<'a> {
        self.blobs.iter().map(BlobRecord::blob)
    }

    pub fn textures(&self) -> impl ExactSizeIterator<Item = Result<Texture<'a>, BakedError>> + use<'a> {
        let mut rest = Rest(self.colors);
        let records = self.textures.iter().enumerate();
        records.map(move |(index, record)| {
            let wrong = |field| BakedError::Record {
                what: "texture",
                index: index as u16,
                field,
            };
            let palette = rest.take(record.colors.into())?;
            let bytes = rest.take(record.texel_bytes().ok_or(wrong("texels"))?)?;
            Ok(Texture {
                width: record.width,
                height: record.height,
                palette,
                texels: if record.kind == 0 {
                    Texels::Half(bytes)
                } else {
                    Texels::Byte(bytes)
                },
                filter: record.filter().ok_or(wrong("filter"))?,
            })
        })
    }
}

fn map<'a>(rest: &mut Rest<'a>) -> Result<Map<'a>, BakedError> {
    let wrong = BakedError::Whole { field: "map" };
    let record: &MapRecord = rest.one()?;
    let (width, height) = (record.width, record.height);
    let bands = usize::from(record.bands);
    let row = usize::from(record.steps_in_band).checked_sub(1).ok_or(wrong)?;
    let texels: &[Rgb9e5] = rest.take(usize::from(width) * usize::from(height))?;
    let parts = MapParts {
        width,
        height,
        texels,
        exponent: record.exponent,
        axes: record.axes.map(Dir),
        bands: rest.take(bands)?,
        steps: rest.take(row * (bands + 1))?,
        steps_in_band: record.steps_in_band,
    };
    if MapRecord::of(&parts) != *record {
        return Err(wrong);
    }
    Map::new(parts).map_err(|_| wrong)
}

/// Puts all that there is into a part of the room.
fn fill<T, const N: usize>(
    into: &mut Vec<T, N>,
    what: &'static str,
    from: impl ExactSizeIterator<Item = Result<T, BakedError>>,
) -> Result<(), BakedError> {
    into.clear();
    let needed = from.len();
    for one in from {
        let full = |_| BakedError::Scene(SceneError::Full { what, needed });
        into.push(one?).map_err(full)?;
    }
    Ok(())
}

impl<'a> Baked<'a> {
    /// Whether there is a whole scene, and not meshes alone.
    pub fn has_scene(&self) -> bool {
        !self.scene.is_empty()
    }

    /// What the scene is made of beside its meshes.
    pub fn records(&self) -> Result<Records<'a>, BakedError> {
        if !self.has_scene() {
            return Err(BakedError::NoScene);
        }
        Records::new(self.scene)
    }

    /// The border: takes the scene out of its records into `room`, checks everything, and lends it out.
    pub fn scene<'r, const SHAPES: usize, const MATERIALS: usize, const LIGHTS: usize, const LENT: usize>(
        &self,
        room: &'r mut Room<'a, SHAPES, MATERIALS, LIGHTS, LENT>,
    ) -> Result<Whole<'r>, BakedError> {
        let records = self.records()?;
        fill(&mut room.blobs, "blobs", records.blobs().map(Ok))?;
        fill(&mut room.shapes, "shapes", records.shapes(&room.blobs))?;
        fill(&mut room.materials, "materials", records.materials())?;
        fill(&mut room.lights, "lights", records.lights())?;
        fill(&mut room.textures, "textures", records.textures())?;
        let meshes = usize::from(self.count());
        fill(
            &mut room.meshes,
            "meshes",
            (0..meshes).map(|mesh| self.mesh(mesh as u16)),
        )?;
        let environment = match records.background {
            Background::None => Environment::None,
            Background::Sky(sky) => Environment::Sky(room.sky.insert(sky)),
            Background::Map(map) => Environment::Map(map),
        };
        let parts = Parts {
            unit: records.unit,
            shapes: &room.shapes,
            bounded: records.bounded,
            materials: &room.materials,
            lights: &room.lights,
            environment,
            choice: records.choice,
            meshes: &room.meshes,
            textures: &room.textures,
            blobs: &room.blobs,
            grid: records.grid,
            nodes: records.nodes,
        };
        let scene = Scene::new(parts).map_err(BakedError::Scene)?;
        Ok(Whole {
            scene,
            shot: records.shot,
        })
    }
}
