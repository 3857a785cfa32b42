//! `.mlx`: what `host-sim bake` wrote, for a look at it.

use std::collections::HashMap;
use std::path::Path;

use super::showcase::Model;
use super::{ImportError, Loaded, stem};
use crate::bake::Aligned;
use crate::desc::{BsdfDesc, GeometryDesc, MeshDesc, NamedMaterial, ShapeDesc};
use crate::flash;

pub(super) fn load(path: &Path) -> Result<Loaded, ImportError> {
    let bytes = std::fs::read(path).map_err(|error| ImportError::io(path, &error))?;
    let bytes = Aligned::new(&bytes);
    let meshes = flash::meshes(bytes.bytes()).map_err(|error| ImportError::new(path, error))?;
    let mut model = Model {
        materials: vec![NamedMaterial {
            name: "clay".to_string(),
            two_sided: true,
            bsdf: BsdfDesc::Diffuse {
                reflectance: [0.6, 0.55, 0.5],
            },
        }],
        ..Model::default()
    };
    for (index, (mesh, scale)) in meshes.iter().enumerate() {
        let mut places = HashMap::new();
        let mut vertices = Vec::new();
        let mut triangles = Vec::new();
        for triangle in flash::corners(&mesh.triangles, *scale) {
            triangles.push(triangle.map(|corner| {
                *places.entry(corner.map(f64::to_bits)).or_insert_with(|| {
                    vertices.push(corner);
                    vertices.len() as u32 - 1
                })
            }));
        }
        model.shapes.push(ShapeDesc {
            name: format!("{} {index}", stem(path)),
            geometry: GeometryDesc::Mesh(MeshDesc {
                vertices,
                triangles,
                normals: Vec::new(),
            }),
            material: 0,
            emission: None,
        });
    }
    model.show(path)
}
