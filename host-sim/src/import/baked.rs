//! `.mlx`: what `host-sim bake` wrote, a whole scene, or meshes for a look at them.

use std::path::Path;

use super::showcase::{Model, grey};
use super::{ImportError, Loaded, stem};
use crate::bake::Aligned;
use crate::desc::{BsdfDesc, GeometryDesc, NamedMaterial, ShapeDesc, TintDesc};
use crate::flash;
use microlux::shape::Layers;

pub(super) fn load(path: &Path) -> Result<Loaded, ImportError> {
    let bytes = std::fs::read(path).map_err(|error| ImportError::io(path, &error))?;
    let bytes = Aligned::new(&bytes);
    if flash::is_scene(bytes.bytes()) {
        let scene = flash::scene(&stem(path), bytes).map_err(|error| ImportError::new(path, error))?;
        return Ok(Loaded {
            scene,
            notes: Vec::new(),
            warnings: Vec::new(),
        });
    }
    let meshes = flash::meshes(bytes.bytes()).map_err(|error| ImportError::new(path, error))?;
    let mut model = Model {
        materials: vec![
            NamedMaterial {
                name: "clay".to_string(),
                two_sided: true,
                bsdf: BsdfDesc::Diffuse {
                    reflectance: [0.6, 0.55, 0.5],
                },
                tint: None,
            },
            NamedMaterial {
                tint: Some(TintDesc::Vertices),
                ..grey("its colours", 1.0)
            },
        ],
        ..Model::default()
    };
    for (index, (mesh, scale)) in meshes.iter().enumerate() {
        model.shapes.push(ShapeDesc {
            name: format!("{} {index}", stem(path)),
            geometry: GeometryDesc::Mesh(flash::described(&mesh.triangles, *scale)),
            material: usize::from(mesh.triangles.layers().has(Layers::COLORS)),
            emission: None,
        });
    }
    model.show(path)
}
