use super::canonical;
use crate::geom::{Dir, Point, Rotation};
use crate::num::Metres;
use crate::scene::{Shape, Tint};
use crate::shape::{
    Blob, Bound, Capsule, Disk, Geometry, Gyroid, Implicit, Instance, Metaballs, Plane, Rectangle,
    RoundedBox, SmoothUnion, Sphere, Torus,
};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// A number that stands for none.
const NONE: u16 = u16::MAX;

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

const _: () = assert!(size_of::<ShapeRecord>() == 68 && size_of::<BlobRecord>() == 28);
