//! Files into scenes: what is read means what Mitsuba 3 means by it, what is not says where it stands.

mod errors;
mod gltf;
mod material;
mod mesh;
mod obj;
mod own;
mod picture;
mod shape;
mod tint;

use std::path::PathBuf;

use host_sim::desc::*;
use host_sim::import::{ImportError, Loaded, Options, load};

/// A folder of its own with a `scene.xml` in it.
pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn with(files: &[(&str, &str)]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in files {
            std::fs::write(folder.path().join(name), content).unwrap();
        }
        Self(folder)
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn load(&self, name: &str, options: &Options) -> Result<Loaded, ImportError> {
        load(&self.path(name), options)
    }

    /// The error with the folder's name taken out.
    pub fn error(&self, name: &str) -> String {
        let error = self
            .load(name, &Options::default())
            .expect_err("this must not load")
            .to_string();
        error.replace(&format!("{}/", self.0.path().display()), "")
    }
}

/// Lines 1 and 2 of every scene below; what is asked about starts on line 3.
pub const HEAD: &str = "<scene version=\"3.0.0\"><integrator type=\"path\"/>\n<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/><film type=\"hdrfilm\"><rfilter type=\"box\"/></film></sensor>\n";

pub fn scene(body: &str) -> String {
    format!("{HEAD}{body}\n</scene>\n")
}

pub fn read(body: &str) -> SceneDesc {
    let loaded = Folder::with(&[("s.xml", &scene(body))]).load("s.xml", &Options::default());
    let loaded = loaded.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(loaded.warnings, Vec::<String>::new());
    loaded.scene
}

pub fn error(body: &str) -> String {
    Folder::with(&[("s.xml", &scene(body))]).error("s.xml")
}

pub fn lenient(body: &str) -> Loaded {
    let options = Options {
        lenient: true,
        ..Options::default()
    };
    Folder::with(&[("s.xml", &scene(body))])
        .load("s.xml", &options)
        .unwrap_or_else(|error| panic!("{error}"))
}

pub fn near(a: Vec3, b: Vec3) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 2e-6)
}

pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Volume from the surface (divergence theorem): positive for triangles counter-clockwise from outside.
pub fn volume(mesh: &MeshDesc) -> f64 {
    let corners = mesh
        .triangles
        .iter()
        .map(|t| t.map(|i| mesh.vertices[i as usize]));
    corners
        .map(|[a, b, c]| a.iter().zip(cross(b, c)).map(|(a, n)| a * n).sum::<f64>() / 6.0)
        .sum()
}
