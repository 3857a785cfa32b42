//! What a scene is made of beside meshes, as it lies in flash: records of one size each, little-endian, each at a multiple
//! of 4 bytes.
//!
//! What a record's kind has no use for is 0. A record is taken if what it says is said by it alone: it is refused unless
//! writing again what was read gives the same bytes.

use crate::color::{Albedo, Radiance};
use crate::geom::{Dir, Point, Rotation};
use crate::light::{Light, MapParts, Sky};
use crate::material::{
    BlinnPhong, Conductor, Dielectric, Filter, Index, Material, OrenNayar, OrenNayarModel, RoughDielectric,
};
use crate::num::{Metres, Share, Turn};
use crate::scene::{Shape, Tint};
use crate::shape::{
    Blob, Bound, Capsule, Disk, Geometry, Gyroid, Implicit, Instance, Metaballs, Plane, Rectangle,
    RoundedBox, SmoothUnion, Sphere, Torus,
};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// A number that stands for none.
const NONE: u16 = u16::MAX;

/// Three mantissas and their exponent, [`Radiance::to_parts`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct Glow {
    mantissa: [u16; 3],
    exponent: i16,
}

impl Glow {
    pub fn of(light: Radiance) -> Glow {
        let (mantissa, exponent) = light.to_parts();
        Glow { mantissa, exponent }
    }

    pub fn radiance(&self) -> Radiance {
        let mantissa = self.mantissa.map(u32::from);
        Radiance::from_bits(mantissa, i32::from(self.exponent) - 15)
    }
}

/// A shape, 68 bytes.
///
/// | byte | what |
/// |---|---|
/// | 0 | kind |
/// | 1 | its colours: 0 the material's, 1 those of the mesh's vertices, 2 a texture's |
/// | 2, 3 | the texture |
/// | 4, 5 | material |
/// | 6, 7 | the light that it is; 65,535: none |
/// | 8, 9 | the user's number for it |
/// | 10, 11 | 0 |
/// | 12 ..= 67 | 14 numbers of 32 bits |
///
/// | kind | its numbers (units; directions in 2^-16) |
/// |---|---|
/// | 0 sphere | centre, radius |
/// | 1 plane | point, normal |
/// | 2 disk | centre, normal, radius |
/// | 3 rectangle | centre, u, v, normal, half its two sides |
/// | 4 mesh | its number |
/// | 5 instance | the mesh's number, place, three rows of the rotation in 2^-30, scale in 2^-16 |
/// | 6 torus | centre, axis, a direction across it, radii of ring and tube |
/// | 7 capsule | two ends, radius |
/// | 8 rounded box | centre, x, y, half its three sides, radius |
/// | 9 gyroid | centre, x, y, cell, thickness, half of its bound's sides, or the bound's radius, 0, 0 |
/// | 10 metaballs | first blob, how many, threshold in 2^-27 |
/// | 11 smooth union | first blob, how many, k |
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct ShapeRecord {
    kind: u8,
    tint: u8,
    texture: u16,
    material: u16,
    light: u16,
    id: u16,
    zero: u16,
    numbers: [i32; NUMBERS],
}

const NUMBERS: usize = 14;

/// A record's numbers, one after the other.
#[derive(Clone, Copy)]
struct Row {
    numbers: [i32; NUMBERS],
    at: usize,
}

impl Row {
    const EMPTY: Row = Row {
        numbers: [0; NUMBERS],
        at: 0,
    };

    fn with(self, number: i32) -> Row {
        self.with_all([number])
    }

    fn with_all<const N: usize>(mut self, numbers: [i32; N]) -> Row {
        self.put(&numbers);
        self
    }

    /// Once in a program, not in each kind of shape: flash is short.
    #[inline(never)]
    fn put(&mut self, numbers: &[i32]) {
        let places = self.numbers.iter_mut().skip(self.at);
        places.zip(numbers).for_each(|(place, number)| *place = *number);
        self.at += numbers.len();
    }

    #[inline(never)]
    fn next(&mut self) -> i32 {
        let number = self.numbers.get(self.at).copied().unwrap_or(0);
        self.at += 1;
        number
    }

    #[inline(never)]
    fn three(&mut self) -> [i32; 3] {
        [self.next(), self.next(), self.next()]
    }

    fn point(&mut self) -> Point {
        Point(self.three())
    }

    fn dir(&mut self) -> Dir {
        Dir(self.three())
    }
}

impl ShapeRecord {
    #[inline(never)]
    pub fn of(shape: &Shape) -> ShapeRecord {
        let row = Row::EMPTY;
        let (kind, row) = match shape.geometry {
            Geometry::Sphere(s) => (0, row.with_all(s.center.0).with(s.radius)),
            Geometry::Plane(p) => (1, row.with_all(p.point.0).with_all(p.normal.0)),
            Geometry::Disk(d) => (2, row.with_all(d.center.0).with_all(d.normal.0).with(d.radius)),
            Geometry::Rectangle(r) => {
                let axes = row.with_all(r.center.0).with_all(r.u.0).with_all(r.v.0);
                (3, axes.with_all(r.normal.0).with_all(r.half))
            }
            Geometry::Mesh(mesh) => (4, row.with(mesh.into())),
            Geometry::Instance(i) => {
                let row = row.with(i.mesh.into()).with_all(i.at.0);
                let row = i.rotation.rows().into_iter().fold(row, Row::with_all);
                (5, row.with(i.scale() as i32))
            }
            Geometry::Implicit(Implicit::Torus(t)) => {
                let row = row.with_all(t.center.0).with_all(t.axis.0).with_all(t.side.0);
                (6, row.with_all([t.major, t.minor]))
            }
            Geometry::Implicit(Implicit::Capsule(c)) => {
                (7, row.with_all(c.a.0).with_all(c.b.0).with(c.radius))
            }
            Geometry::Implicit(Implicit::RoundedBox(b)) => {
                let row = row.with_all(b.center.0).with_all(b.x.0).with_all(b.y.0);
                (8, row.with_all(b.half).with(b.radius))
            }
            Geometry::Implicit(Implicit::Gyroid(g)) => {
                let row = row.with_all(g.center.0).with_all(g.x.0).with_all(g.y.0);
                let bound = match g.bound.radius() {
                    Some(radius) => [radius, 0, 0],
                    None => g.bound.half(),
                };
                (9, row.with_all([g.cell, g.thickness]).with_all(bound))
            }
            Geometry::Implicit(Implicit::Metaballs(m)) => {
                let row = row.with_all([m.first, m.count].map(i32::from));
                (10, row.with(m.threshold() as i32))
            }
            Geometry::Implicit(Implicit::SmoothUnion(u)) => {
                (11, row.with_all([u.first, u.count].map(i32::from)).with(u.k))
            }
        };
        let (tint, texture) = match shape.tint {
            Tint::None => (0, 0),
            Tint::Vertices => (1, 0),
            Tint::Texture(texture) => (2, texture),
        };
        ShapeRecord {
            kind,
            tint,
            texture,
            material: shape.material,
            light: shape.light.unwrap_or(NONE),
            id: shape.id,
            zero: 0,
            numbers: row.numbers,
        }
    }

    /// The shape, or what of the record makes no sense.
    pub fn shape(&self, blobs: &[Blob]) -> Result<Shape, &'static str> {
        let light = self.light;
        let shape = Shape {
            geometry: self.geometry(blobs).ok_or("kind")?,
            material: self.material,
            light: (light != NONE).then_some(light),
            tint: match self.tint {
                0 => Tint::None,
                1 => Tint::Vertices,
                2 => Tint::Texture(self.texture),
                _ => return Err("colours"),
            },
            id: self.id,
        };
        canonical(self, &ShapeRecord::of(&shape), shape)
    }

    fn geometry(&self, blobs: &[Blob]) -> Option<Geometry> {
        let mut row = Row {
            numbers: self.numbers,
            at: 0,
        };
        let solid = match self.kind {
            0 => return Some(Sphere::new(row.point(), row.next()).into()),
            1 => return Some(Plane::new(row.point(), row.dir()).into()),
            2 => {
                let disk = Disk {
                    center: row.point(),
                    normal: row.dir(),
                    radius: row.next(),
                };
                return Some(disk.into());
            }
            3 => {
                let rectangle = Rectangle {
                    center: row.point(),
                    u: row.dir(),
                    v: row.dir(),
                    normal: row.dir(),
                    half: [row.next(), row.next()],
                };
                return Some(rectangle.into());
            }
            4 => return Some(Geometry::Mesh(row.next() as u16)),
            5 => {
                let (mesh, at) = (row.next() as u16, row.point());
                let rotation = Rotation::from_rows([row.three(), row.three(), row.three()]);
                let scale = Metres::from_bits(row.next());
                return Some(
                    Instance::new(mesh)
                        .scaled(scale)
                        .turned(rotation)
                        .moved(at)
                        .into(),
                );
            }
            6 => Implicit::Torus(Torus {
                center: row.point(),
                axis: row.dir(),
                side: row.dir(),
                major: row.next(),
                minor: row.next(),
            }),
            7 => Implicit::Capsule(Capsule::new(row.point(), row.point(), row.next())),
            8 => Implicit::RoundedBox(RoundedBox {
                center: row.point(),
                x: row.dir(),
                y: row.dir(),
                half: row.three(),
                radius: row.next(),
            }),
            9 => Implicit::Gyroid(Gyroid {
                center: row.point(),
                x: row.dir(),
                y: row.dir(),
                cell: row.next(),
                thickness: row.next(),
                bound: Bound::block(row.three()),
            }),
            10 => {
                let (first, count) = (row.next() as u16, row.next() as u16);
                Implicit::Metaballs(Metaballs::new(blobs, first, count, row.next() as u32))
            }
            11 => {
                let (first, count) = (row.next() as u16, row.next() as u16);
                Implicit::SmoothUnion(SmoothUnion::new(blobs, first, count, row.next()))
            }
            _ => return None,
        };
        Some(Geometry::Implicit(solid))
    }
}

/// What was read, if writing it again gives the same record.
fn canonical<R: IntoBytes + Immutable, T>(record: &R, again: &R, value: T) -> Result<T, &'static str> {
    if record.as_bytes() == again.as_bytes() {
        Ok(value)
    } else {
        Err("numbers")
    }
}

/// A material, 32 bytes.
///
/// | byte | what |
/// |---|---|
/// | 0 | kind: 0 black, 1 Lambert, 2 mirror, 3 dielectric, 4 Oren–Nayar, 5 Blinn–Phong, 6 conductor, 7 rough dielectric |
/// | 1 | bits: 1 two-sided, 2 Blinn–Phong that is not normalised, 4 a conductor with refractive indices, 8 a rough one |
/// | 2, 3 | alpha in 2^-15; the model of Oren–Nayar: 0 full, 1 qualitative, 2 energy-preserving |
/// | 4 ..= 9 | reflectance in 2^-15; Blinn–Phong: diffuse |
/// | 10 ..= 15 | transmittance; Blinn–Phong: specular |
/// | 16 ..= 19 | ratio of refractive indices, or exponent, in 2^-16; sigma in 2^-17 of a turn |
/// | 20 ..= 31 | a conductor's refractive indices η, then k, by colour, in 2^-12 |
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct MaterialRecord {
    kind: u8,
    bits: u8,
    alpha: u16,
    colors: [[u16; 3]; 2],
    value: i32,
    index: [[u16; 3]; 2],
}

const TWO_SIDED: u8 = 1;
const UNNORMALIZED: u8 = 2;
const INDEX: u8 = 4;
const ROUGH: u8 = 8;

impl MaterialRecord {
    fn new(kind: u8, two_sided: bool, first: Albedo, second: Albedo) -> MaterialRecord {
        let bits = |Albedo(color): Albedo| color.map(|c| c.to_bits());
        MaterialRecord {
            kind,
            bits: if two_sided { TWO_SIDED } else { 0 },
            alpha: 0,
            colors: [bits(first), bits(second)],
            value: 0,
            index: [[0; 3]; 2],
        }
    }

    pub fn of(material: &Material) -> MaterialRecord {
        let black = Albedo::BLACK;
        match material {
            Material::Black => MaterialRecord::new(0, false, black, black),
            Material::Lambert { albedo, two_sided } => MaterialRecord::new(1, *two_sided, *albedo, black),
            Material::Mirror {
                reflectance,
                two_sided,
            } => MaterialRecord::new(2, *two_sided, *reflectance, black),
            Material::Dielectric(glass) => {
                let (reflectance, transmittance) = glass.tints();
                MaterialRecord {
                    value: glass.eta().to_bits(),
                    ..MaterialRecord::new(3, false, reflectance, transmittance)
                }
            }
            Material::OrenNayar(diffuse) => MaterialRecord {
                alpha: match diffuse.model() {
                    OrenNayarModel::Full => 0,
                    OrenNayarModel::Qualitative => 1,
                    OrenNayarModel::EnergyPreserving => 2,
                },
                value: i32::from(diffuse.sigma().to_bits()),
                ..MaterialRecord::new(4, diffuse.is_two_sided(), diffuse.reflectance(), black)
            },
            Material::BlinnPhong(phong) => {
                let record = MaterialRecord::new(5, phong.is_two_sided(), phong.diffuse(), phong.specular());
                let unnormalized = if phong.is_normalized() { 0 } else { UNNORMALIZED };
                MaterialRecord {
                    bits: record.bits | unnormalized,
                    value: phong.exponent().to_bits(),
                    ..record
                }
            }
            Material::Conductor(metal) => {
                let record = MaterialRecord::new(6, metal.is_two_sided(), metal.reflectance(), black);
                let index = metal.index();
                let rough = if metal.is_rough() { ROUGH } else { 0 };
                MaterialRecord {
                    bits: record.bits | rough | index.map_or(0, |_| INDEX),
                    alpha: metal.alpha().to_bits(),
                    index: index.map_or(record.index, |of| of.map(|of| of.map(|c| c.to_bits()))),
                    ..record
                }
            }
            Material::RoughDielectric(glass) => {
                let (reflectance, transmittance) = glass.tints();
                MaterialRecord {
                    alpha: glass.alpha().to_bits(),
                    value: glass.eta().to_bits(),
                    ..MaterialRecord::new(7, false, reflectance, transmittance)
                }
            }
        }
    }

    /// The material, or what of the record makes no sense.
    pub fn material(&self) -> Result<Material, &'static str> {
        let has = |bit| self.bits & bit != 0;
        let two_sided = has(TWO_SIDED);
        let [first, second] = self.colors.map(Albedo::from_bits);
        let alpha = Share::from_bits(self.alpha);
        let value = Metres::from_bits(self.value);
        let material = match self.kind {
            0 => Material::Black,
            1 => Material::Lambert {
                albedo: first,
                two_sided,
            },
            2 => Material::Mirror {
                reflectance: first,
                two_sided,
            },
            3 => Material::Dielectric(Dielectric::new(value).tinted(first, second)),
            4 => {
                let model = match self.alpha {
                    0 => OrenNayarModel::Full,
                    1 => OrenNayarModel::Qualitative,
                    2 => OrenNayarModel::EnergyPreserving,
                    _ => return Err("model"),
                };
                let sigma = Turn::from_bits((self.value as u32) << 15);
                let diffuse = OrenNayar::new(model, first, sigma);
                Material::OrenNayar(if two_sided { diffuse } else { diffuse.one_sided() })
            }
            5 => {
                let phong = BlinnPhong::new(first, second, value);
                let phong = if has(UNNORMALIZED) {
                    phong.unnormalized()
                } else {
                    phong
                };
                Material::BlinnPhong(if two_sided { phong } else { phong.one_sided() })
            }
            6 => {
                let [eta, k] = self.index.map(|of| of.map(Index::from_bits));
                let metal = Conductor::new(first);
                let metal = if has(INDEX) {
                    metal.with_index(eta, k)
                } else {
                    metal
                };
                let metal = if has(ROUGH) { metal.rough(alpha) } else { metal };
                Material::Conductor(if two_sided { metal } else { metal.one_sided() })
            }
            7 => {
                let smooth = Dielectric::new(value).tinted(first, second);
                Material::RoughDielectric(RoughDielectric::new(smooth, alpha))
            }
            _ => return Err("kind"),
        };
        canonical(self, &MaterialRecord::of(&material), material)
    }
}

/// A light, 24 bytes.
///
/// | byte | what |
/// |---|---|
/// | 0 | kind: 0 point, 1 directional, 2 area, 3 the same from all around |
/// | 1 | 0 |
/// | 2, 3 | the shape that it is |
/// | 4 ..= 15 | where it stands, 3×i32 units, or the way it travels, in 2^-16 |
/// | 16 ..= 23 | its light: three mantissas in 2^-15, u16, and their exponent, i16 |
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct LightRecord {
    kind: u8,
    zero: u8,
    shape: u16,
    place: [i32; 3],
    glow: Glow,
}

impl LightRecord {
    pub fn of(light: &Light) -> LightRecord {
        let (kind, shape, place, glow) = match *light {
            Light::Point { position, intensity } => (0, 0, position.0, intensity),
            Light::Directional {
                direction,
                irradiance,
            } => (1, 0, direction.0, irradiance),
            Light::Area { shape, radiance } => (2, shape, [0; 3], radiance),
            Light::Environment { radiance } => (3, 0, [0; 3], radiance),
        };
        LightRecord {
            kind,
            zero: 0,
            shape,
            place,
            glow: Glow::of(glow),
        }
    }

    /// The light, or what of the record makes no sense.
    pub fn light(&self) -> Result<Light, &'static str> {
        let (place, glow) = (self.place, self.glow.radiance());
        let light = match self.kind {
            0 => Light::Point {
                position: Point(place),
                intensity: glow,
            },
            1 => Light::Directional {
                direction: Dir(place),
                irradiance: glow,
            },
            2 => Light::Area {
                shape: self.shape,
                radiance: glow,
            },
            3 => Light::Environment { radiance: glow },
            _ => return Err("kind"),
        };
        canonical(self, &LightRecord::of(&light), light)
    }
}

/// One of the balls and capsules that solids are made of, 28 bytes: two ends and a radius, units.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct BlobRecord {
    a: [i32; 3],
    b: [i32; 3],
    radius: i32,
}

impl BlobRecord {
    pub fn of(blob: &Blob) -> BlobRecord {
        BlobRecord {
            a: blob.a.0,
            b: blob.b.0,
            radius: blob.radius,
        }
    }

    pub fn blob(&self) -> Blob {
        let [a, b] = [self.a, self.b].map(Point);
        Blob {
            a,
            b,
            radius: self.radius,
        }
    }
}

/// A texture without palette and texels, 8 bytes.
///
/// | byte | what |
/// |---|---|
/// | 0 ..= 3 | width and height, u16 |
/// | 4, 5 | colours of its palette |
/// | 6 | texels: 0 half a byte each, 1 a byte |
/// | 7 | between texels: 0 the nearest, 1 bilinear |
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct TextureRecord {
    pub width: u16,
    pub height: u16,
    pub colors: u16,
    pub kind: u8,
    pub filter: u8,
}

impl TextureRecord {
    /// How colours between texels come about.
    pub fn filter(&self) -> Option<Filter> {
        match self.filter {
            0 => Some(Filter::Nearest),
            1 => Some(Filter::Bilinear),
            _ => None,
        }
    }

    /// Bytes of its texels, if they are of a kind there is.
    pub fn texel_bytes(&self) -> Option<usize> {
        let (width, height) = (usize::from(self.width), usize::from(self.height));
        match self.kind {
            0 => Some(width.div_ceil(2) * height),
            1 => Some(width * height),
            _ => None,
        }
    }
}

/// A sky, 60 bytes: up; the colours of zenith, horizon and ground; the way to the sun, its radiance (black: there is none)
/// and its angular diameter in 2^-32 of a turn.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct SkyRecord {
    up: [i32; 3],
    colors: [Glow; 3],
    sun: [i32; 3],
    glow: Glow,
    diameter: u32,
}

impl SkyRecord {
    pub fn of(sky: &Sky) -> SkyRecord {
        let sun = sky.sun();
        SkyRecord {
            up: sky.up().0,
            colors: sky.colors().map(Glow::of),
            sun: sun.map_or([0; 3], |sun| sun.direction.0),
            glow: Glow::of(sun.map_or(Radiance::BLACK, |sun| sun.radiance)),
            diameter: sun.map_or(0, |sun| sun.diameter.to_bits()),
        }
    }

    /// The sky, or what of the record makes no sense.
    pub fn sky(&self) -> Result<Sky, &'static str> {
        let [zenith, horizon, ground] = self.colors.map(|glow| glow.radiance());
        let sky = Sky::new(Dir(self.up), zenith, horizon, ground).with_sun(
            Dir(self.sun),
            Turn::from_bits(self.diameter),
            self.glow.radiance(),
        );
        canonical(self, &SkyRecord::of(&sky), sky)
    }
}

/// A map of the environment without its numbers, 48 bytes.
///
/// | byte | what |
/// |---|---|
/// | 0 ..= 3 | width and height, u16 |
/// | 4, 5 | exponent of all texels, i16 |
/// | 6, 7 | steps in a band |
/// | 8, 9 | bounds between bands |
/// | 10, 11 | 0 |
/// | 12 ..= 47 | its axes x, y, z in the scene, in 2^-16 |
///
/// Then its texels, u32; the bounds between bands, u16; those between the steps of each band, u16.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct MapRecord {
    pub width: u16,
    pub height: u16,
    pub exponent: i16,
    pub steps_in_band: u16,
    pub bands: u16,
    zero: u16,
    pub axes: [[i32; 3]; 3],
}

impl MapRecord {
    pub fn of(map: &MapParts) -> MapRecord {
        MapRecord {
            width: map.width,
            height: map.height,
            exponent: map.exponent,
            steps_in_band: map.steps_in_band,
            bands: (map.bands.len() as u16),
            zero: 0,
            axes: map.axes.map(|axis| axis.0),
        }
    }
}

const _: () = assert!(size_of::<ShapeRecord>() == 68 && size_of::<MaterialRecord>() == 32);
const _: () = assert!(size_of::<LightRecord>() == 24 && size_of::<BlobRecord>() == 28);
const _: () = assert!(size_of::<TextureRecord>() == 8 && size_of::<SkyRecord>() == 60);
const _: () = assert!(size_of::<MapRecord>() == 48);
