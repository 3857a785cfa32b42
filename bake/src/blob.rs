//! Packed meshes, and maybe the scene that they are for, in a row of bytes, as [`microlux::scene::Baked`] opens them.

use std::fmt::{self, Write};

use microlux::geom::Unit;
use microlux::scene::{BakedEntry, BakedHead, Parts, Shot};
use microlux::shape::Triangles;
use zerocopy::IntoBytes;

use crate::{Packed, scene};

/// More meshes than 65,535, or more bytes than 2^32.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlobTooLarge;

impl fmt::Display for BlobTooLarge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "too many meshes or bytes: bake fewer at a time")
    }
}

impl std::error::Error for BlobTooLarge {}

/// The bytes of meshes for a scene of this unit.
pub fn blob(meshes: &[Packed], unit: Unit) -> Result<Vec<u8>, BlobTooLarge> {
    written(meshes, unit, &[])
}

/// The bytes of a whole scene; `meshes` are its own, packed. What it says of its meshes is left.
pub fn scene_blob(meshes: &[Packed], parts: &Parts, shot: &Shot) -> Result<Vec<u8>, BlobTooLarge> {
    written(meshes, parts.unit, &scene::bytes(parts, shot))
}

fn written(meshes: &[Packed], unit: Unit, scene: &[u8]) -> Result<Vec<u8>, BlobTooLarge> {
    let (mut table, mut parts) = (Vec::new(), Vec::new());
    for packed in meshes {
        let mesh = packed.mesh();
        let Triangles::Packed(triangles) = mesh.triangles else {
            continue;
        };
        table.extend(BakedEntry::new(&triangles, mesh.nodes, unit).as_bytes());
        let nodes: Vec<u8> = mesh.nodes.iter().flat_map(|node| node.to_le_bytes()).collect();
        let treelets = triangles.treelets.iter();
        let treelets: Vec<u8> = treelets.flat_map(|treelet| treelet.to_le_bytes()).collect();
        for part in [&nodes[..], &treelets, triangles.vertices, triangles.leaves] {
            parts.extend(part);
            parts.resize(parts.len().next_multiple_of(4), 0);
        }
    }
    let rest = [&table[..], &parts, scene].concat();
    let count = u16::try_from(meshes.len()).map_err(|_| BlobTooLarge)?;
    if u32::try_from(rest.len() + size_of::<BakedHead>()).is_err() {
        return Err(BlobTooLarge);
    }
    Ok([BakedHead::new(count, &rest).as_bytes(), &rest].concat())
}

/// The same bytes as the source of a Rust module with one constant, `name`.
pub fn rust(bytes: &[u8], name: &str) -> String {
    let mut text = format!(
        "// Written by `host-sim bake`; open it with `microlux::scene::Baked::open({name})`.\n\n\
         #[repr(C, align(4))]\nstruct Aligned([u8; {}]);\n\n\
         pub static {name}: &[u8] = &BYTES.0;\n\n\
         #[rustfmt::skip]\nstatic BYTES: Aligned = Aligned([\n",
        bytes.len()
    );
    for line in bytes.chunks(24) {
        text += "   ";
        for byte in line {
            let _ = write!(text, " {byte},");
        }
        text += "\n";
    }
    text + "]);\n"
}

/// Bytes that lie at a multiple of 4, as [`microlux::scene::Baked::open`] wants them.
#[derive(Clone, Debug)]
pub struct Aligned {
    words: Vec<u32>,
    length: usize,
}

impl Aligned {
    pub fn new(bytes: &[u8]) -> Aligned {
        let mut words = vec![0; bytes.len().div_ceil(4)];
        words.as_mut_bytes()[..bytes.len()].copy_from_slice(bytes);
        Aligned {
            words,
            length: bytes.len(),
        }
    }

    pub fn bytes(&self) -> &[u8] {
        &self.words.as_bytes()[..self.length]
    }
}
