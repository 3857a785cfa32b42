//! A whole scene in a row of bytes, beside its meshes.

use microlux::light::Environment;
use microlux::material::{Filter, Texels};
use microlux::scene::{
    BlobRecord, LightRecord, MapRecord, MaterialRecord, Parts, ShapeRecord, Shot, SkyRecord, TextureRecord,
    WholeHead,
};
use zerocopy::IntoBytes;

/// The bytes of all that a scene is made of but its meshes, which follow theirs.
pub(crate) fn bytes(parts: &Parts, shot: &Shot) -> Vec<u8> {
    let mut out = Row(Vec::new());
    out.put(WholeHead::new(parts, shot).as_bytes());
    for node in parts.nodes {
        out.put(&node.to_le_bytes());
    }
    for bound in parts.choice {
        out.put(&bound.to_le_bytes());
    }
    for shape in parts.shapes {
        out.put(ShapeRecord::of(shape).as_bytes());
    }
    for material in parts.materials {
        out.put(MaterialRecord::of(material).as_bytes());
    }
    for light in parts.lights {
        out.put(LightRecord::of(light).as_bytes());
    }
    for blob in parts.blobs {
        out.put(BlobRecord::of(blob).as_bytes());
    }
    for texture in parts.textures {
        let (kind, _) = texels(texture.texels);
        let record = TextureRecord {
            width: texture.width,
            height: texture.height,
            colors: texture.palette.len() as u16,
            kind,
            filter: match texture.filter {
                Filter::Nearest => 0,
                Filter::Bilinear => 1,
            },
        };
        out.put(record.as_bytes());
    }
    for texture in parts.textures {
        out.put(&le_bytes(texture.palette.iter().flatten()));
        out.put(texels(texture.texels).1);
    }
    match parts.environment {
        Environment::None | Environment::Constant(_) => {}
        Environment::Sky(sky) => out.put(SkyRecord::of(sky).as_bytes()),
        Environment::Map(map) => {
            let map = map.parts();
            out.put(MapRecord::of(&map).as_bytes());
            for texel in map.texels {
                out.put(&texel.0.to_le_bytes());
            }
            out.put(&le_bytes(map.bands));
            out.put(&le_bytes(map.steps));
        }
    }
    out.0
}

fn texels(texels: Texels<'_>) -> (u8, &[u8]) {
    match texels {
        Texels::Half(bytes) => (0, bytes),
        Texels::Byte(bytes) => (1, bytes),
    }
}

fn le_bytes<'a>(numbers: impl IntoIterator<Item = &'a u16>) -> Vec<u8> {
    numbers.into_iter().flat_map(|n| n.to_le_bytes()).collect()
}

/// Parts, each of which begins at a multiple of 4.
struct Row(Vec<u8>);

impl Row {
    fn put(&mut self, part: &[u8]) {
        self.0.extend(part);
        self.0.resize(self.0.len().next_multiple_of(4), 0);
    }
}
