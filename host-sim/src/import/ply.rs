//! Stanford PLY, ascii and binary of both byte orders: `vertex` with x, y, z and maybe nx, ny, nz; `face` with a list of
//! indices.

use std::io::BufReader;
use std::path::Path;

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType,
};

use super::error::ImportError;
use super::mesh::RawMesh;
use super::ngon::Cutter;
use crate::desc::Vec3;

/// Reads the `vertex` and `face` elements; others are skipped.
pub(super) fn read(path: &Path) -> Result<RawMesh, ImportError> {
    let file = std::fs::File::open(path).map_err(|error| ImportError::io(path, &error))?;
    parse(path, BufReader::new(file))
}

fn parse(path: &Path, source: impl std::io::BufRead) -> Result<RawMesh, ImportError> {
    let wrong = |error: ParseError| malformed(path, &error);
    let mut reader = Reader::new(source);
    let header = Parser::<Skipped>::new().read_header(&mut reader).map_err(wrong)?;
    check_header(path, &header)?;

    let mut raw = RawMesh::default();
    let mut faces = Vec::new();
    for (name, element) in &header.elements {
        match name.as_str() {
            "vertex" => {
                let vertices = Parser::<Vertex>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(wrong)?;
                raw.positions = vertices.iter().map(|v| v.position).collect();
                if ["nx", "ny", "nz"]
                    .iter()
                    .all(|n| element.properties.contains_key(*n))
                {
                    raw.normals = vertices.iter().map(|v| v.normal).collect();
                }
                let has = |names: &[&str]| names.iter().all(|n| element.properties.contains_key(*n));
                if has(&["red", "green", "blue"]) || has(&["r", "g", "b"]) {
                    raw.colors = vertices
                        .iter()
                        .map(|v| v.color.map(|c| c.clamp(0.0, 1.0)))
                        .collect();
                }
                if has(&["u", "v"]) || has(&["s", "t"]) {
                    raw.uvs = vertices.iter().map(|v| v.uv).collect();
                }
            }
            "face" => {
                faces = Parser::<Face>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(wrong)?;
            }
            _ => {
                Parser::<Skipped>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(wrong)?;
            }
        }
    }

    let uvs = raw.uvs.iter().map(|[u, v]| [*u, *v, 0.0]);
    let all = raw
        .positions
        .iter()
        .chain(&raw.normals)
        .chain(&raw.colors)
        .copied();
    for (i, vertex) in all.chain(uvs).enumerate() {
        if !vertex.iter().all(|x| x.is_finite()) {
            let index = i % raw.positions.len();
            return Err(ImportError::new(
                path,
                format!("vertex {index}: not a finite number; export the mesh again"),
            ));
        }
    }
    let count = raw.positions.len();
    let mut cutter = Cutter::new();
    for (i, Face(corners)) in faces.iter().enumerate() {
        let corners = corners
            .iter()
            .map(|&c| u32::try_from(c).ok().filter(|&c| (c as usize) < count).ok_or(c));
        let corners = corners.collect::<Result<Vec<u32>, i64>>().map_err(|index| {
            let message =
                format!("face {i}: vertex {index} does not exist, the file has {count}; correct the index");
            ImportError::new(path, message)
        })?;
        if corners.len() < 3 {
            let message = format!(
                "face {i}: a face needs 3 corners, this one has {}; remove it",
                corners.len()
            );
            return Err(ImportError::new(path, message));
        }
        let added = cutter.add(&mut raw, &corners);
        added.map_err(|what| ImportError::new(path, format!("face {i}: {what}")))?;
    }
    raw.notes.extend(cutter.note());
    Ok(raw)
}

/// The parser's own words, with its line where the file is text.
fn malformed(path: &Path, error: &ParseError) -> ImportError {
    let text = error.to_string();
    let what = text
        .split_once(": ")
        .filter(|_| error.line().is_some())
        .map_or(text.as_str(), |(_, what)| what);
    // A line that is not what the header promises is quoted after `String: `, then the grammar follows.
    let what = match what
        .split_once("String: '")
        .and_then(|(_, quoted)| quoted.split_once('\''))
    {
        Some((quoted, _)) => format!("\"{}\" is not what the header promises", quoted.trim()),
        None => what.trim_end_matches('.').to_string(),
    };
    let line = error.line().and_then(|line| u32::try_from(line).ok());
    ImportError {
        line,
        ..ImportError::new(path, format!("{what}; export the mesh again"))
    }
}

fn check_header(path: &Path, header: &Header) -> Result<(), ImportError> {
    let missing =
        |what: &str| ImportError::new(path, format!("has no {what}; export the mesh with its faces"));
    let vertex = header.elements.get("vertex").ok_or_else(|| missing("vertices"))?;
    let face = header
        .elements
        .get("face")
        .filter(|face| face.count > 0)
        .ok_or_else(|| missing("faces"))?;
    if let Some(axis) = ["x", "y", "z"]
        .iter()
        .find(|axis| !vertex.properties.contains_key(**axis))
    {
        return Err(missing(&format!("property {axis} in its vertices")));
    }
    let is_list = |(name, property): (&String, &ply_rs_bw::ply::PropertyDef)| {
        is_indices(name) && matches!(property.data_type, PropertyType::List(..))
    };
    if !face.properties.iter().any(is_list) {
        return Err(missing("list vertex_indices in its faces"));
    }
    if header.encoding != Encoding::Ascii {
        return Ok(());
    }
    // An ascii element is one line; a promise of more lines than memory is caught by the parser at the end of the file.
    let has_fields = |element: &ElementDef| element.count == 0 || !element.properties.is_empty();
    match header.elements.values().find(|element| !has_fields(element)) {
        Some(element) => Err(missing(&format!("properties in its {}", element.name))),
        None => Ok(()),
    }
}

fn is_indices(name: &str) -> bool {
    name == "vertex_indices" || name == "vertex_index"
}

#[derive(Default)]
struct Vertex {
    position: Vec3,
    normal: Vec3,
    /// 0 to 1: what is stored as bytes, over 255.
    color: Vec3,
    uv: [f64; 2],
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let slot = match name {
            "x" => &mut self.position[0],
            "y" => &mut self.position[1],
            "z" => &mut self.position[2],
            "nx" => &mut self.normal[0],
            "ny" => &mut self.normal[1],
            "nz" => &mut self.normal[2],
            "red" | "r" => &mut self.color[0],
            "green" | "g" => &mut self.color[1],
            "blue" | "b" => &mut self.color[2],
            "u" | "s" => &mut self.uv[0],
            "v" | "t" => &mut self.uv[1],
            _ => return PropertyAccessResult::Ignored,
        };
        let is_color = ["red", "green", "blue", "r", "g", "b"].contains(&name);
        *slot = match property {
            Property::UChar(n) if is_color => f64::from(n) / 255.0,
            Property::Char(n) => n.into(),
            Property::UChar(n) => n.into(),
            Property::Short(n) => n.into(),
            Property::UShort(n) => n.into(),
            Property::Int(n) => n.into(),
            Property::UInt(n) => n.into(),
            Property::Float(n) => n.into(),
            Property::Double(n) => n,
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// Its corners, as the file says them.
#[derive(Default)]
struct Face(Vec<i64>);

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !is_indices(name) {
            return PropertyAccessResult::Ignored;
        }
        self.0 = match property {
            Property::ListChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListInt(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUInt(list) => list.into_iter().map(i64::from).collect(),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// An element nobody asked for.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}
