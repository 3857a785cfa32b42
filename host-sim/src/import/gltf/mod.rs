//! glTF 2.0, as text with its buffers beside it or within, and as GLB.
//!
//! The `gltf` crate parses; what it trusts in a file (spans, types, indices, the shape of the tree) is checked here before
//! it is read. Light is photometric in glTF and radiometric here: numbers are taken as they are, so that 1 cd/m² is a
//! radiance of 1, as viewers do.

mod buffer;
mod material;
mod mesh;

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use gltf::camera::Projection;
use gltf::khr_lights_punctual::Kind;
use gltf::scene::Transform;
use gltf::{Document, Gltf, Node};

use self::buffer::Buffers;
use self::material::Materials;
use super::error::ImportError;
use super::math::{Affine, cross, dot, scaled, sub, unit};
use super::showcase::Model;
use super::{Loaded, suggest};
use crate::desc::{CameraDesc, LightDesc, MeshDesc, Vec3};

/// Extensions that are read, or that change nothing here.
const READ: [&str; 8] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_texture_transform",
    "KHR_xmp_json_ld",
];

/// Bytes that every GLB file begins with.
const GLB_HEADER: usize = 12;

/// Reads the default scene, or the first.
pub(super) fn load(path: &Path) -> Result<Loaded, ImportError> {
    let bytes = std::fs::read(path).map_err(|error| ImportError::io(path, &error))?;
    if let Some(says) = bytes.strip_prefix(b"glTF").and_then(|rest| rest.get(4..8))
        && says
            .iter()
            .rev()
            .fold(0, |value, &byte| value << 8 | usize::from(byte))
            < GLB_HEADER
    {
        let message = "is a broken GLB file: shorter than its own head; export the model again";
        return Err(ImportError::new(path, message));
    }
    let wrong = |error| malformed(path, &bytes, &error);
    let Gltf { document, blob } = Gltf::from_slice_without_validation(&bytes).map_err(wrong)?;
    // The crate's own validation takes some of what it looks at for granted.
    let json = document.into_json();
    if let Some((what, index)) = hollow(&json) {
        let message = format!("{what}[{index}] lacks what it must have; export the model again");
        return Err(ImportError::new(path, message));
    }
    let document = Document::from_json(json).map_err(wrong)?;
    let buffers = Buffers::read(path, &document, blob)?;
    let mut reader = Reader {
        path,
        buffers: &buffers,
        materials: Materials::new(path, &buffers),
        model: Model::default(),
        seen: vec![false; document.nodes().len()],
        cameras: 0,
        uses: uses(&document),
        shared: HashMap::new(),
    };
    reader.left_out(&document);
    let roots: Vec<Node> = match document.default_scene().or_else(|| document.scenes().next()) {
        Some(scene) => scene.nodes().collect(),
        None => top_nodes(&document),
    };
    // Depth first, as the file lists them, without recursion: a file may be as deep as it likes.
    let mut waiting: Vec<(Node, Affine)> = roots.into_iter().map(|n| (n, Affine::IDENTITY)).rev().collect();
    while let Some((node, parent)) = waiting.pop() {
        let to_world = reader.node(&node, parent)?;
        let children: Vec<Node> = node.children().collect();
        waiting.extend(children.into_iter().map(|child| (child, to_world)).rev());
    }
    reader.finish().show(path)
}

/// The list and place of something without a part that the `gltf` crate takes for granted.
fn hollow(json: &gltf::json::Root) -> Option<(&'static str, usize)> {
    let image = |image: &gltf::json::Image| match image.buffer_view {
        Some(_) => image.mime_type.is_some(),
        None => image.uri.is_some(),
    };
    let texture = |texture: &gltf::json::Texture| texture.source.value() < json.images.len();
    let mesh = |mesh: &gltf::json::Mesh| {
        let named = |primitive: &gltf::json::mesh::Primitive| {
            let accessors = primitive.attributes.values().chain(primitive.indices.as_ref());
            accessors
                .map(|index| index.value())
                .all(|index| index < json.accessors.len())
        };
        mesh.primitives.iter().all(named)
    };
    let place = |what, found: Option<usize>| found.map(|index| (what, index));
    place("images", json.images.iter().position(|i| !image(i)))
        .or_else(|| place("textures", json.textures.iter().position(|t| !texture(t))))
        .or_else(|| place("meshes", json.meshes.iter().position(|m| !mesh(m))))
}

/// How many nodes each mesh stands at.
fn uses(document: &Document) -> Vec<usize> {
    let mut uses = vec![0; document.meshes().len()];
    for mesh in document.nodes().filter_map(|node| node.mesh()) {
        uses[mesh.index()] += 1;
    }
    uses
}

/// Nodes that are nobody's child.
fn top_nodes(document: &Document) -> Vec<Node<'_>> {
    let mut is_child = vec![false; document.nodes().len()];
    for child in document.nodes().flat_map(|node| node.children()) {
        is_child[child.index()] = true;
    }
    document.nodes().filter(|node| !is_child[node.index()]).collect()
}

/// The crate's error, with the part of the file that it is about.
fn malformed(path: &Path, bytes: &[u8], error: &gltf::Error) -> ImportError {
    let message = match error {
        gltf::Error::Validation(found) => match found.first() {
            Some((place, what)) => {
                let place = place.to_string();
                match required(bytes, &place) {
                    Some(extension) => {
                        format!("needs the extension {extension}, which is not supported; export it without")
                    }
                    None => format!("{place}: {}; export the model again", validation(what)),
                }
            }
            None => "is not sound; export the model again".to_string(),
        },
        gltf::Error::Deserialize(error) => {
            // serde_json says where.
            let place = (error.line() > 0).then(|| u32::try_from(error.line()).unwrap_or(u32::MAX));
            let text = error.to_string();
            let what = text.split(" at line ").next().unwrap_or(&text);
            let message = format!("is no glTF: {what}; export the model again");
            return match place.filter(|_| !bytes.starts_with(b"glTF")) {
                Some(line) => ImportError::at(path, line, message),
                None => ImportError::new(path, format!("its JSON part {message}")),
            };
        }
        gltf::Error::Binary(gltf::binary::Error::Version(version)) => {
            format!("is of version {version} of binary glTF; export it as version 2")
        }
        gltf::Error::Binary(error) => format!("is a broken GLB file: {error}; export the model again"),
        other => format!("is no glTF: {other}; export the model again"),
    };
    ImportError::new(path, message)
}

fn validation(what: &gltf::json::validation::Error) -> &'static str {
    use gltf::json::validation::Error;
    match what {
        Error::IndexOutOfBounds => "names what does not exist",
        Error::Invalid => "has a value that is not allowed",
        Error::Missing => "is missing",
        Error::Oversize => "is larger than memory",
        Error::Unsupported => "is not supported",
    }
}

/// The extension that `extensionsRequired[i]` names.
fn required(bytes: &[u8], place: &str) -> Option<String> {
    let (index, _) = place.strip_prefix("extensionsRequired[")?.split_once(']')?;
    let document = Gltf::from_slice_without_validation(bytes).ok()?;
    let name = document.extensions_required().nth(index.parse().ok()?)?;
    Some(name.to_string())
}

/// `node "Lamp"`, or `nodes[3]`.
fn named(kind: &str, name: Option<&str>, index: usize) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} \"{name}\""),
        _ if kind == "mesh" => format!("meshes[{index}]"),
        _ => format!("{kind}s[{index}]"),
    }
}

struct Reader<'a> {
    path: &'a Path,
    buffers: &'a Buffers,
    materials: Materials<'a>,
    model: Model,
    seen: Vec<bool>,
    cameras: usize,
    /// Nodes of each mesh.
    uses: Vec<usize>,
    /// Primitives of meshes of several nodes, where they are modelled.
    shared: HashMap<(usize, usize), Arc<MeshDesc>>,
}

impl<'a> Reader<'a> {
    fn error(&self, message: String) -> ImportError {
        ImportError::new(self.path, message)
    }

    fn note(&mut self, what: &str) {
        self.model
            .notes
            .push(ImportError::new(self.path, what).to_string());
    }

    fn warn(&mut self, what: &str) {
        self.model
            .warnings
            .push(ImportError::new(self.path, what).to_string());
    }

    /// What the file has that no node tells of.
    fn left_out(&mut self, document: &Document) {
        if document.scenes().len() > 1 {
            self.warn(&format!(
                "{} other scenes in it are left out",
                document.scenes().len() - 1
            ));
        }
        if document.animations().len() > 0 {
            self.warn(&format!(
                "{} animations are left out: all is at rest",
                document.animations().len()
            ));
        }
        let unknown: Vec<&str> = document.extensions_used().filter(|e| !READ.contains(e)).collect();
        if !unknown.is_empty() {
            self.warn(&format!(
                "{} left out",
                match unknown.len() {
                    1 => format!("extension {} is", unknown[0]),
                    _ => format!(
                        "extensions {} are",
                        suggest::list(&unknown).replace(" or ", " and ")
                    ),
                }
            ));
        }
    }

    /// What stands at a node; the transform that its children are under.
    fn node(&mut self, node: &Node, parent: Affine) -> Result<Affine, ImportError> {
        let name = named("node", node.name(), node.index());
        let seen = &mut self.seen[node.index()];
        if std::mem::replace(seen, true) {
            return Err(self.error(format!(
                "{name} is reached twice: a node has one parent and is not within itself; export the model again"
            )));
        }
        let to_world = placed(node.transform()).then(parent);
        if to_world
            .columns
            .iter()
            .chain([&to_world.translation])
            .flatten()
            .any(|x| !x.is_finite())
        {
            return Err(self.error(format!("{name}: its transform is not finite; correct it")));
        }
        if node.skin().is_some() {
            self.warn(&format!("{name}: its skin is left out, the mesh is as modelled"));
        }
        if let Some(mesh) = node.mesh() {
            self.mesh(&name, &mesh, to_world)?;
        }
        if let Some(light) = node.light() {
            self.light(
                &named("light", light.name().or(node.name()), light.index()),
                &light,
                to_world,
            );
        }
        if let Some(camera) = node.camera() {
            self.camera(
                &named("camera", camera.name().or(node.name()), camera.index()),
                &camera,
                to_world,
            );
        }
        Ok(to_world)
    }

    fn light(&mut self, name: &str, light: &gltf::khr_lights_punctual::Light, to_world: Affine) {
        let intensity = f64::from(light.intensity());
        let power = light.color().map(|c| f64::from(c).max(0.0) * intensity);
        if !(power.iter().all(|c| c.is_finite()) && power.iter().any(|c| *c > 0.0)) {
            self.warn(&format!("{name} gives no light and is left out"));
            return;
        }
        let position = to_world.translation;
        match light.kind() {
            Kind::Point => {
                self.note(&format!("{name}: a point of {intensity:.3} W/sr"));
                self.model.lights.push(LightDesc::Point {
                    position,
                    intensity: power,
                });
            }
            Kind::Spot { .. } => {
                self.warn(&format!(
                    "{name}: its cone is left out, the spot shines all around"
                ));
                self.model.lights.push(LightDesc::Point {
                    position,
                    intensity: power,
                });
            }
            Kind::Directional => {
                let Some(direction) = unit(scaled(to_world.columns[2], -1.0)) else {
                    self.warn(&format!("{name}: points nowhere and is left out"));
                    return;
                };
                self.note(&format!("{name}: from far away, {intensity:.3} W/m²"));
                self.model.lights.push(LightDesc::Directional {
                    direction,
                    irradiance: power,
                });
            }
        }
        if light.range().is_some() {
            self.warn(&format!("{name}: its range is left out, light has no end"));
        }
    }

    /// The first perspective camera is the scene's.
    fn camera(&mut self, name: &str, camera: &gltf::Camera, to_world: Affine) {
        let Projection::Perspective(lens) = camera.projection() else {
            self.warn(&format!("{name}: is orthographic and left out"));
            return;
        };
        self.cameras += 1;
        if self.model.camera.is_some() {
            return;
        }
        let aspect = lens.aspect_ratio().map_or(1.0, f64::from);
        let half = f64::from(lens.yfov()) / 2.0;
        let sound = (1e-3..=1e3).contains(&aspect) && half > 0.0 && half < 1.5;
        match upright(to_world).filter(|_| sound) {
            Some([right, up, forward]) => {
                let fov_x = 2.0 * (aspect * half.tan()).atan().to_degrees();
                self.note(&format!("{name}: seen through it, {fov_x:.1} degrees across"));
                let desc = CameraDesc {
                    origin: to_world.translation,
                    right,
                    up,
                    forward,
                    fov_x,
                    lens: None,
                };
                self.model.camera = Some((desc, aspect));
            }
            None => self.warn(&format!("{name}: sees nothing and is left out")),
        }
    }

    fn finish(mut self) -> Model {
        if self.cameras > 1 {
            self.warn(&format!("{} further cameras are left out", self.cameras - 1));
        }
        self.model.materials = self.materials.list;
        self.model.notes.extend(self.materials.notes);
        self.model.warnings.extend(self.materials.warnings);
        self.model
    }
}

/// Right, up and forward of a camera that looks along −z with y up; scales and shear do not matter.
fn upright(to_world: Affine) -> Option<[Vec3; 3]> {
    let [_, y, z] = to_world.columns;
    let forward = unit(scaled(z, -1.0))?;
    let up = unit(sub(y, scaled(forward, dot(y, forward))))?;
    Some([cross(forward, up), up, forward])
}

fn placed(transform: Transform) -> Affine {
    let wide = |v: [f32; 3]| v.map(f64::from);
    match transform {
        Transform::Matrix { matrix } => {
            let column = |i: usize| wide([matrix[i][0], matrix[i][1], matrix[i][2]]);
            Affine {
                columns: [column(0), column(1), column(2)],
                translation: column(3),
            }
        }
        Transform::Decomposed {
            translation,
            rotation,
            scale,
        } => {
            // A quaternion is of unit length in the file up to the rounding of f32.
            let [x, y, z, w] = rotation.map(f64::from);
            let n = x * x + y * y + z * z + w * w;
            let s = if n > 0.0 { 2.0 / n } else { 0.0 };
            let turned = Affine {
                columns: [
                    [
                        1.0 - s * (y * y + z * z),
                        s * (x * y + w * z),
                        s * (x * z - w * y),
                    ],
                    [
                        s * (x * y - w * z),
                        1.0 - s * (x * x + z * z),
                        s * (y * z + w * x),
                    ],
                    [
                        s * (x * z + w * y),
                        s * (y * z - w * x),
                        1.0 - s * (x * x + y * y),
                    ],
                ],
                translation: [0.0; 3],
            };
            let moved = Affine::translate(wide(translation));
            Affine::scale(wide(scale)).then(turned).then(moved)
        }
    }
}
