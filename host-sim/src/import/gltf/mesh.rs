//! Meshes of glTF: each primitive of each node is a shape of its own, placed in the world.

use std::sync::Arc;

use gltf::Semantic;
use gltf::accessor::{DataType, Dimensions};
use gltf::mesh::{Mesh, Mode, Primitive};

use super::super::error::ImportError;
use super::super::math::Affine;
use super::super::mesh::{Placement, RawMesh, placed};
use super::material::Has;
use super::{Reader, named};
use crate::desc::{GeometryDesc, ShapeDesc};

/// Which texture coordinates the material's base colour wants.
fn texture_set(primitive: &Primitive) -> Option<u32> {
    let material = primitive.material();
    let info = material.pbr_metallic_roughness().base_color_texture()?;
    let moved = info
        .texture_transform()
        .and_then(|transform| transform.tex_coord());
    Some(moved.unwrap_or(info.tex_coord()))
}

impl Reader<'_> {
    pub(super) fn mesh(&mut self, node: &str, mesh: &Mesh, to_world: Affine) -> Result<(), ImportError> {
        let mesh_name = named("mesh", mesh.name(), mesh.index());
        let several = mesh.primitives().len() > 1;
        for primitive in mesh.primitives() {
            let part = format!("{mesh_name}, primitive {}", primitive.index());
            let name = match several {
                true => format!("{node} part {}", primitive.index()),
                false => node.to_string(),
            };
            if primitive.morph_targets().len() > 0 {
                self.warn(&format!(
                    "{name}: its morph targets are left out, the mesh is as modelled"
                ));
            }
            let used = (mesh.index(), primitive.index());
            let is_shared = self.uses.get(mesh.index()).is_some_and(|uses| *uses > 1);
            let set = texture_set(&primitive);
            let has = Has {
                colors: primitive.get(&Semantic::Colors(0)).is_some(),
                uvs: set.is_some_and(|set| primitive.get(&Semantic::TexCoords(set)).is_some()),
            };
            let (material, emission) = self.materials.of(&primitive.material(), has)?;
            if let Some(known) = self.shared.get(&used) {
                let geometry = placed(known, &to_world);
                self.model.shapes.push(ShapeDesc {
                    name,
                    geometry,
                    material,
                    emission,
                });
                continue;
            }
            let raw = self
                .triangles(&primitive)
                .map_err(|what| self.error(format!("{part}: {what}")))?;
            let Some(mut raw) = raw else {
                self.warn(&format!(
                    "{name}: points and lines have no surface and are left out"
                ));
                continue;
            };
            let instanced = is_shared && emission.is_none();
            let place = if instanced { Affine::IDENTITY } else { to_world };
            // The side of a mirrored mesh's front is that of the unmirrored one (glTF 2.0, 3.7.4).
            if place.determinant() < 0.0 {
                raw.triangles.iter_mut().for_each(|t| t.swap(1, 2));
            }
            let (mesh, dropped) = raw.place(Placement {
                to_world: place,
                face_normals: raw.normals.is_empty(),
                flip_normals: false,
            });
            if dropped > 0 {
                self.warn(&format!("{name}: {dropped} triangles without area are left out"));
            }
            if mesh.triangles.is_empty() {
                continue;
            }
            let geometry = if instanced {
                let mesh = Arc::new(mesh);
                let geometry = placed(&mesh, &to_world);
                self.shared.insert(used, mesh);
                geometry
            } else {
                GeometryDesc::Mesh(mesh)
            };
            self.model.shapes.push(ShapeDesc {
                name,
                geometry,
                material,
                emission,
            });
        }
        Ok(())
    }

    /// `None` for what is not made of triangles.
    fn triangles(&self, primitive: &Primitive) -> Result<Option<RawMesh>, String> {
        if !matches!(
            primitive.mode(),
            Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
        ) {
            return Ok(None);
        }
        let buffers = self.buffers;
        let reader = primitive.reader(|buffer| buffers.get(&buffer));
        let positions = primitive
            .get(&Semantic::Positions)
            .ok_or("has no POSITION; export the model again")?;
        buffers.check(&positions, Dimensions::Vec3, &[DataType::F32])?;
        let wide = |v: [f32; 3]| v.map(f64::from);
        let mut raw = RawMesh {
            positions: reader.read_positions().into_iter().flatten().map(wide).collect(),
            ..RawMesh::default()
        };
        if let Some(normals) = primitive.get(&Semantic::Normals) {
            buffers.check(&normals, Dimensions::Vec3, &[DataType::F32])?;
            if normals.count() != positions.count() {
                return Err(format!(
                    "has {} normals for {} vertices",
                    normals.count(),
                    positions.count()
                ));
            }
            raw.normals = reader.read_normals().into_iter().flatten().map(wide).collect();
        }
        if let Some(colors) = primitive.get(&Semantic::Colors(0)) {
            let dimensions = match colors.dimensions() {
                Dimensions::Vec4 => Dimensions::Vec4,
                _ => Dimensions::Vec3,
            };
            buffers.check(&colors, dimensions, &[DataType::U8, DataType::U16, DataType::F32])?;
            raw.colors = reader
                .read_colors(0)
                .into_iter()
                .flat_map(|colors| colors.into_rgb_f32())
                .map(|color| color.map(|c| f64::from(c).clamp(0.0, 1.0)))
                .collect();
        }
        let set = texture_set(primitive);
        if let Some((set, uvs)) = set.and_then(|set| Some((set, primitive.get(&Semantic::TexCoords(set))?))) {
            buffers.check(
                &uvs,
                Dimensions::Vec2,
                &[DataType::U8, DataType::U16, DataType::F32],
            )?;
            raw.uvs = reader
                .read_tex_coords(set)
                .into_iter()
                .flat_map(|uvs| uvs.into_f32())
                .map(|uv| uv.map(f64::from))
                .collect();
        }
        let counts = [raw.colors.len(), raw.uvs.len()];
        if counts
            .iter()
            .any(|count| ![0, raw.positions.len()].contains(count))
        {
            return Err("has not one colour or texture coordinate for each vertex".to_string());
        }
        let all = raw.uvs.iter().flatten().chain(raw.colors.iter().flatten());
        if all.copied().any(|x| !x.is_finite()) {
            return Err(
                "has a colour or texture coordinate that is not finite; export the model again".to_string(),
            );
        }
        if let Some(at) = raw
            .positions
            .iter()
            .position(|p| p.iter().any(|x| !x.is_finite()))
        {
            return Err(format!("vertex {at} is not finite; export the model again"));
        }
        let count = raw.positions.len() as u32;
        let indices: Vec<u32> = match primitive.indices() {
            Some(indices) => {
                buffers.check(
                    &indices,
                    Dimensions::Scalar,
                    &[DataType::U8, DataType::U16, DataType::U32],
                )?;
                reader
                    .read_indices()
                    .into_iter()
                    .flat_map(|i| i.into_u32())
                    .collect()
            }
            None => (0..count).collect(),
        };
        if let Some((at, wrong)) = indices.iter().enumerate().find(|(_, i)| **i >= count) {
            return Err(format!(
                "index {at} names vertex {wrong} of {count}; export the model again"
            ));
        }
        // (glTF 2.0, 3.7.2.1)
        raw.triangles = match primitive.mode() {
            Mode::Triangles => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
            Mode::TriangleStrip => indices
                .windows(3)
                .enumerate()
                .map(|(i, t)| {
                    if i % 2 == 0 {
                        [t[0], t[1], t[2]]
                    } else {
                        [t[0], t[2], t[1]]
                    }
                })
                .collect(),
            _ => indices
                .get(1..)
                .unwrap_or_default()
                .windows(2)
                .map(|t| [indices[0], t[0], t[1]])
                .collect(),
        };
        Ok(Some(raw))
    }
}
