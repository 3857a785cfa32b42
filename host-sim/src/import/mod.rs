//! From a file to a [`SceneDesc`].
//!
//! Reading is strict: what is not understood is an error that says where it stands and what to write instead, for a
//! scene that is silently not the one in the file is worse than none.

mod baked;
mod error;
mod gltf;
pub(crate) mod math;
mod mesh;
mod mitsuba;
mod mtl;
mod ngon;
mod obj;
mod pbr;
mod picture;
mod ply;
mod showcase;
mod suggest;
mod texture;

use std::collections::BTreeMap;
use std::path::Path;

use crate::desc::SceneDesc;
pub use error::ImportError;

/// How to read.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// What is not supported is left out with a warning. What is wrong (a broken number, a missing file) stays an
    /// error.
    pub lenient: bool,
    /// Values for the scene's `$name` parameters, before its own `<default>`s.
    pub parameters: BTreeMap<String, String>,
}

/// A scene, and what a user should know about how it was read: one line each.
#[derive(Clone, Debug)]
pub struct Loaded {
    pub scene: SceneDesc,
    /// What of the file became what here, and what was added because the file has none.
    pub notes: Vec<String>,
    /// What is left out, or not as the file means it: the picture will differ by it.
    pub warnings: Vec<String>,
}

/// Reads a scene by its file name's ending: `.xml` (Mitsuba 3), `.gltf` and `.glb`, or `.obj`, `.ply` and `.mlx` (baked meshes); what these lack
/// of camera and light is added.
pub fn load(path: &Path, options: &Options) -> Result<Loaded, ImportError> {
    let extension = path
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or("")
        .to_ascii_lowercase();
    match extension.as_str() {
        "xml" => mitsuba::load(path, options),
        "gltf" | "glb" | "obj" | "ply" | "mlx" => {
            if let Some(name) = options.parameters.keys().next() {
                let message = format!(
                    "a .{extension} file has no parameter \"{name}\"; only .xml scenes take parameters"
                );
                return Err(ImportError::new(path, message));
            }
            match extension.as_str() {
                "gltf" | "glb" => gltf::load(path),
                "obj" => showcase::load_obj(path),
                "mlx" => baked::load(path),
                _ => showcase::load_ply(path),
            }
        }
        _ => {
            let what = match path.exists() {
                true => "not a kind of scene this program reads",
                false => "no such file, nor a kind of scene this program reads",
            };
            Err(ImportError::new(
                path,
                format!("{what}; use .xml (Mitsuba 3), .gltf, .glb, .obj, .ply or .mlx (baked)"),
            ))
        }
    }
}

/// Reads a mesh file by its ending.
fn read_mesh(path: &Path) -> Result<mesh::RawMesh, ImportError> {
    let extension = path
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or("")
        .to_ascii_lowercase();
    if extension == "ply" {
        ply::read(path)
    } else {
        obj::read(path)
    }
}

/// The file's name without folder and ending.
fn stem(path: &Path) -> String {
    path.file_stem()
        .map_or_else(|| "scene".to_string(), |stem| stem.to_string_lossy().into_owned())
}
