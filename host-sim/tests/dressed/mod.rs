//! A scene of instances, textures, colours and smooth normals, for more than one test.

use std::sync::Arc;

use host_sim::builtin;
use host_sim::desc::{
    BsdfDesc, GeometryDesc, InstanceDesc, MeshDesc, NamedMaterial, SceneDesc, ShapeDesc, TextureDesc,
    TintDesc,
};

/// The built-in room with instances of a tent, textured and coloured, with smooth normals that lean away from their faces'.
pub fn dressed() -> SceneDesc {
    let mut desc = builtin::scene("cornell").unwrap();
    let tent = MeshDesc {
        vertices: vec![
            [-0.1, 0.0, -0.1],
            [0.1, 0.0, -0.1],
            [0.0, 0.0, 0.15],
            [0.0, 0.25, 0.0],
        ],
        triangles: vec![[0, 3, 1], [1, 3, 2], [2, 3, 0], [0, 1, 2]],
        normals: [
            [-0.6, 0.5, -0.6],
            [0.8, 0.3, -0.5],
            [0.1, 0.4, 0.9],
            [0.2, 1.0, 0.0],
        ]
        .map(|n: [f64; 3]| {
            let length = n.iter().map(|c| c * c).sum::<f64>().sqrt();
            n.map(|c| c / length)
        })
        .to_vec(),
        colors: vec![[1.0, 0.2, 0.1], [0.1, 0.9, 0.3], [0.2, 0.3, 1.0], [1.0; 3]],
        uvs: vec![[0.0, 0.0], [1.0, 0.0], [0.5, 1.0], [0.5, 0.5]],
    };
    let picture = TextureDesc {
        name: "stripes".to_string(),
        width: 3,
        height: 1,
        texels: vec![[0.9, 0.1, 0.1], [0.9; 3], [0.1, 0.1, 0.9]],
        nearest: false,
    };
    let tints = [
        TintDesc::Vertices,
        TintDesc::Texture {
            texture: Arc::new(picture),
            to_uv: [[2.0, 0.0, 0.25], [0.0, 1.0, 0.0]],
        },
    ];
    for (i, tint) in tints.into_iter().enumerate() {
        let mesh = Arc::new(tent.clone());
        desc.materials.push(NamedMaterial {
            name: format!("cloth {i}"),
            two_sided: true,
            bsdf: BsdfDesc::Diffuse {
                reflectance: [0.9; 3],
            },
            tint: Some(tint),
        });
        for (side, scale) in [(-1.0, 1.0), (1.0, 1.7)] {
            let (sin, cos) = (0.6 + i as f64).sin_cos();
            desc.shapes.push(ShapeDesc {
                name: format!("tent {i} {side}"),
                geometry: GeometryDesc::Instance(InstanceDesc {
                    mesh: Arc::clone(&mesh),
                    at: [0.4 * side, 0.1, 0.3 * i as f64],
                    scale,
                    axes: [[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]],
                }),
                material: desc.materials.len() - 1,
                emission: None,
            });
        }
    }
    desc
}
