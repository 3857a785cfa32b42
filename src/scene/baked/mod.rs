//! Meshes and whole scenes as `host-sim bake` writes them, read where they lie.
//!
//! All numbers are little-endian; everything begins at a multiple of 4 bytes, the whole too ([`include_baked!`] sees to it).
//!
//! | byte | what |
//! |---|---|
//! | 0 ..= 7 | `microlux` |
//! | 8, 9 | version: 2 |
//! | 10, 11 | meshes |
//! | 12 ..= 15 | bytes in all |
//! | 16 ..= 19 | CRC-32 (IEEE 802.3) of all bytes after it |
//! | 20 … | for each mesh an entry of 44 bytes |
//! | … | for each mesh its four parts, each filled up with zeros to a multiple of 4 |
//! | … | the scene that they are for, or nothing: a [`WholeHead`], and what that tells of |
//!
//! | byte of an entry | what |
//! |---|---|
//! | 0 ..= 11 | the grid's origin, 3×i32 scene units |
//! | 12 ..= 23 | bounds of the vertices, grid steps: 3×u16 the lowest, 3×u16 the highest |
//! | 24 | the grid's shift: a step is 2^shift scene units |
//! | 25 | the scene's unit: 2^-n metres, i8 |
//! | 26 | what vertices say beside where they are: bits of [`Layers`] |
//! | 27 | 0 |
//! | 28 ..= 43 | bytes of its parts, 4×u32: nodes (40 each), treelets (12 each), vertices, leaves |

mod record;
mod whole;

use super::{Mesh, SceneError};
use crate::bvh::Node;
use crate::geom::{Point, Unit};
use crate::num::Crc;
use crate::shape::{Bounds, Grid, Layers, PackedMesh, Treelet, Triangles};
use zerocopy::byteorder::little_endian::{I32, U16, U32};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

pub use record::{BlobRecord, LightRecord, MapRecord, MaterialRecord, ShapeRecord, SkyRecord, TextureRecord};
pub use whole::{Background, Records, Room, Shot, Technique, Whole, WholeHead};

/// What is at the beginning.
#[repr(C)]
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
pub struct Head {
    magic: [u8; 8],
    version: U16,
    meshes: U16,
    bytes: U32,
    checksum: U32,
}

/// What stands for a mesh in the table.
#[repr(C)]
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
pub struct Entry {
    origin: [I32; 3],
    bounds: [[U16; 3]; 2],
    shift: u8,
    fraction_bits: i8,
    layers: u8,
    zero: u8,
    parts: [U32; 4],
}

const MAGIC: [u8; 8] = *b"microlux";
const VERSION: u16 = 2;
/// Of [`Head::checksum`], before which nothing is summed.
const SUMMED_FROM: usize = size_of::<Head>();

const _: () = assert!(size_of::<Head>() == 20 && size_of::<Entry>() == 44);
// What stands in flash is what the core sees, without a copy.
const _: () = assert!(cfg!(target_endian = "little"), "baked meshes are little-endian");

impl Head {
    /// Of so many meshes, `rest` being all that comes after.
    pub fn new(meshes: u16, rest: &[u8]) -> Head {
        Head {
            magic: MAGIC,
            version: VERSION.into(),
            meshes: meshes.into(),
            bytes: ((SUMMED_FROM + rest.len()) as u32).into(),
            checksum: crc32(rest).into(),
        }
    }
}

impl Entry {
    /// Of a mesh in a scene of this unit.
    pub fn new(mesh: &PackedMesh, nodes: &[Node], unit: Unit) -> Entry {
        let parts = [
            size_of_val(nodes),
            size_of_val(mesh.treelets),
            mesh.vertices.len(),
            mesh.leaves.len(),
        ];
        Entry {
            origin: mesh.grid.origin().0.map(I32::new),
            bounds: [mesh.bounds.low, mesh.bounds.high].map(|corner| corner.map(U16::new)),
            shift: mesh.grid.shift() as u8,
            fraction_bits: unit.fraction_bits() as i8,
            layers: mesh.layers.bits(),
            zero: 0,
            parts: parts.map(|bytes| (bytes as u32).into()),
        }
    }
}

/// A part of a mesh's entry in the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    Grid,
    Unit,
    Layers,
    Zero,
    Nodes,
    Treelets,
    /// How many bytes its parts have.
    Bytes,
}

/// What is wrong with a blob from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BakedError {
    /// It does not lie at a multiple of 4 bytes.
    Unaligned,
    /// It does not begin as such.
    Magic,
    /// It is of another version of the format.
    Version { found: u16 },
    /// There are fewer bytes, or more, than the head says, or than the table needs.
    Length { expected: usize, found: usize },
    /// A byte is not what it was.
    Checksum { expected: u32, found: u32 },
    /// A mesh's grid, unit or number of bytes is none.
    Entry { mesh: u16, field: Field },
    /// There is no such mesh.
    NoMesh { mesh: u16, meshes: u16 },
    /// There are meshes alone.
    NoScene,
    /// The scene says of something what makes no sense.
    Whole { field: &'static str },
    /// The same of its `index`th shape, material, light or texture.
    Record {
        what: &'static str,
        index: u16,
        field: &'static str,
    },
    /// The scene ends before all that its head tells of, or does not.
    Cut { left: usize },
    /// The scene cannot be rendered, or does not fit in the memory for it.
    Scene(SceneError),
}

impl core::fmt::Display for BakedError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Unaligned => write!(
                f,
                "what was baked lies at no multiple of 4 bytes: take include_baked!"
            ),
            Self::Magic => write!(f, "this was not baked: it begins otherwise"),
            Self::Version { found } => {
                write!(
                    f,
                    "version {found} of what is baked; this is {VERSION}: bake again"
                )
            }
            Self::Length { expected, found } => write!(f, "{found} bytes instead of {expected}"),
            Self::Checksum { expected, found } => {
                write!(
                    f,
                    "checksum {found:08x} instead of {expected:08x}: a byte has changed"
                )
            }
            Self::Entry { mesh, field } => {
                let field = match field {
                    Field::Grid => "its grid reaches too far",
                    Field::Unit => "its unit is none",
                    Field::Layers => "its vertices say what this version does not know",
                    Field::Zero => "a byte that must be 0 is not",
                    Field::Nodes => "its nodes are no whole number of nodes",
                    Field::Treelets => "its treelets are no whole number of treelets",
                    Field::Bytes => "its parts are larger than memory, or not all there",
                };
                write!(f, "the table's entry of mesh {mesh}: {field}")
            }
            Self::NoMesh { mesh, meshes } => write!(f, "there is no mesh {mesh}, but {meshes} of them"),
            Self::NoScene => f.write_str("there are meshes, but no scene"),
            Self::Whole { field } => write!(f, "the scene: its {field} makes no sense"),
            Self::Record { what, index, field } => write!(f, "{what} {index}: its {field} makes no sense"),
            Self::Cut { left } => write!(f, "the scene: {left} bytes are left where it needs others"),
            Self::Scene(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for BakedError {}

/// Baked meshes, and maybe the scene that they are for, borrowed from where they lie.
#[derive(Clone, Copy, Debug)]
pub struct Baked<'a> {
    table: &'a [Entry],
    parts: &'a [u8],
    scene: &'a [u8],
}

impl<'a> Baked<'a> {
    /// Reads head and table, and sums all bytes. What they tell of is checked with the scene.
    pub fn open(bytes: &'a [u8]) -> Result<Baked<'a>, BakedError> {
        if bytes.as_ptr().addr() & 3 != 0 {
            return Err(BakedError::Unaligned);
        }
        let short = |expected| BakedError::Length {
            expected,
            found: bytes.len(),
        };
        let (head, rest) = Head::ref_from_prefix(bytes).map_err(|_| short(SUMMED_FROM))?;
        if head.magic != MAGIC {
            return Err(BakedError::Magic);
        }
        if head.version != VERSION {
            return Err(BakedError::Version {
                found: head.version.get(),
            });
        }
        let says = head.bytes.get() as usize;
        if says != bytes.len() {
            return Err(short(says));
        }
        let (expected, found) = (head.checksum.get(), crc32(rest));
        if found != expected {
            return Err(BakedError::Checksum { expected, found });
        }
        let meshes = usize::from(head.meshes.get());
        let needed = SUMMED_FROM + meshes * size_of::<Entry>();
        let (table, parts) =
            <[Entry]>::ref_from_prefix_with_elems(rest, meshes).map_err(|_| short(needed))?;
        let mut end = 0usize;
        for (mesh, entry) in (0..).zip(table) {
            let wrong = |field| BakedError::Entry { mesh, field };
            for part in entry.parts {
                end = padded(part.get())
                    .and_then(|part| end.checked_add(part))
                    .ok_or(wrong(Field::Bytes))?;
            }
            if let Some(field) = entry.fault() {
                return Err(wrong(field));
            }
        }
        let (parts, scene) = parts
            .split_at_checked(end)
            .ok_or(short(needed.saturating_add(end)))?;
        Ok(Baked { table, parts, scene })
    }

    /// How many meshes there are.
    pub fn count(&self) -> u16 {
        self.table.len() as u16
    }

    /// The unit of the scene that a mesh is for.
    pub fn unit(&self, mesh: u16) -> Result<Unit, BakedError> {
        self.entry(mesh)
            .map(|entry| Unit::new(entry.fraction_bits.into()))
    }

    /// A mesh as a scene borrows it.
    pub fn mesh(&self, mesh: u16) -> Result<Mesh<'a>, BakedError> {
        let entry = self.entry(mesh)?;
        let wrong = |field| BakedError::Entry { mesh, field };
        let before = self.table.iter().take(mesh.into()).flat_map(|entry| entry.parts);
        let mut start = before
            .filter_map(|part| padded(part.get()))
            .fold(0usize, usize::saturating_add);
        let mut next = |bytes: U32| {
            let part = self.parts.get(start..)?.get(..bytes.get() as usize)?;
            start = start.saturating_add(padded(bytes.get())?);
            Some(part)
        };
        let [nodes, treelets, vertices, leaves] = entry.parts;
        let (nodes, treelets) = (
            next(nodes).ok_or(wrong(Field::Bytes))?,
            next(treelets).ok_or(wrong(Field::Bytes))?,
        );
        let [low, high] = entry.bounds.map(|corner| corner.map(U16::get));
        Ok(Mesh {
            triangles: Triangles::Packed(PackedMesh {
                grid: entry.grid().ok_or(wrong(Field::Grid))?,
                bounds: Bounds { low, high },
                layers: Layers::from_bits(entry.layers).ok_or(wrong(Field::Layers))?,
                treelets: <[Treelet]>::ref_from_bytes(treelets).map_err(|_| wrong(Field::Treelets))?,
                vertices: next(vertices).ok_or(wrong(Field::Bytes))?,
                leaves: next(leaves).ok_or(wrong(Field::Bytes))?,
            }),
            nodes: <[Node]>::ref_from_bytes(nodes).map_err(|_| wrong(Field::Nodes))?,
        })
    }

    fn entry(&self, mesh: u16) -> Result<&'a Entry, BakedError> {
        let none = BakedError::NoMesh {
            mesh,
            meshes: self.count(),
        };
        self.table.get(usize::from(mesh)).ok_or(none)
    }
}

impl Entry {
    /// What of it makes no sense by itself.
    fn fault(&self) -> Option<Field> {
        let [nodes, treelets, ..] = self.parts.map(|part| part.get() as usize);
        let unit = i32::from(self.fraction_bits);
        if !nodes.is_multiple_of(size_of::<Node>()) {
            Some(Field::Nodes)
        } else if !treelets.is_multiple_of(size_of::<Treelet>()) {
            Some(Field::Treelets)
        } else if Unit::new(unit).fraction_bits() != unit {
            Some(Field::Unit)
        } else if Layers::from_bits(self.layers).is_none() {
            Some(Field::Layers)
        } else if self.zero != 0 {
            Some(Field::Zero)
        } else if self.grid().is_none() {
            Some(Field::Grid)
        } else {
            None
        }
    }

    fn grid(&self) -> Option<Grid> {
        Grid::new(Point(self.origin.map(I32::get)), self.shift)
    }
}

/// Bytes of a part with the zeros after it.
fn padded(bytes: u32) -> Option<usize> {
    bytes.checked_next_multiple_of(4).map(|bytes| bytes as usize)
}

fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = Crc::new();
    crc.bytes(bytes);
    crc.value()
}

/// The bytes of a file that `host-sim bake` wrote, as [`Baked::open`] wants them: at a multiple of 4.
///
/// ```ignore
/// static BUNNY: &[u8] = microlux::include_baked!("bunny.mlx");
/// ```
#[macro_export]
macro_rules! include_baked {
    ($path:expr) => {{
        #[repr(C, align(4))]
        struct Aligned<T: ?Sized>(T);
        static BYTES: &Aligned<[u8]> = &Aligned(*include_bytes!($path));
        &BYTES.0
    }};
}
