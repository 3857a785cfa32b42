//! What makes a scene of a model: a camera, a light and a floor, each where the file has none.

use std::path::{Path, PathBuf};

use super::math::{Affine, add, cross, dot, length, scaled, sub, unit};
use super::mesh::Placement;
use super::mtl::{self, Mtl};
use super::{ImportError, Loaded, obj, ply, stem};
use crate::desc::{
    BsdfDesc, CameraDesc, GeometryDesc, IntegratorDesc, IntegratorKind, LightDesc, MeshDesc, NamedMaterial,
    SceneDesc, ShapeDesc, TintDesc, Vec3,
};

/// From the model towards the camera: from the right, the front and a little above.
const VIEW: Vec3 = [0.55, 0.42, 0.9];
const FOV: f64 = 32.0;
/// Share of the half picture that the model may fill.
const FILL: f64 = 0.82;
/// Longer side of the picture, pixels.
const SIDE: f64 = 256.0;

/// What a model file has.
#[derive(Debug, Default)]
pub(super) struct Model {
    pub materials: Vec<NamedMaterial>,
    /// All of them meshes.
    pub shapes: Vec<ShapeDesc>,
    pub lights: Vec<LightDesc>,
    /// With the picture's width over its height.
    pub camera: Option<(CameraDesc, f64)>,
    pub notes: Vec<String>,
    pub warnings: Vec<String>,
}

impl Model {
    /// The file's own camera and lights; else the model seen from a three-quarter angle, under a sky and a sun, and on a
    /// floor where it has neither.
    pub fn show(mut self, path: &Path) -> Result<Loaded, ImportError> {
        if self.shapes.is_empty() {
            return Err(ImportError::new(path, "no triangle has any area; check the mesh"));
        }
        let points: Vec<Vec3> = self.shapes.iter().flat_map(corners).copied().collect();
        let (low, high) = bounds(&points);
        let framed = framing(&points, scaled(add(low, high), 0.5));
        let Some(framed) = framed else {
            return Err(ImportError::new(
                path,
                "the model is too large to frame; scale it down",
            ));
        };
        let mut note = |what: &str| self.notes.push(ImportError::new(path, what).to_string());
        let dark = self.lights.is_empty() && self.shapes.iter().all(|shape| shape.emission.is_none());
        let alone = dark && self.camera.is_none();
        if self.camera.is_none() {
            note("no camera in it: seen from the right, the front and a little above");
        }
        if dark {
            note("no light in it: lit by a sky and a sun");
            self.lights = daylight();
        }
        if alone {
            note("neither camera nor light in it: put on a grey floor");
            self.shapes.push(ShapeDesc {
                name: "floor".to_string(),
                geometry: floor(low, high),
                material: self.materials.len(),
                emission: None,
            });
            self.materials.push(grey("floor", 0.4));
        }
        let (camera, aspect) = self.camera.unwrap_or((framed, 1.0));
        let max_depth = if self.materials.iter().any(is_glass) {
            16
        } else {
            5
        };
        let scene = SceneDesc {
            name: stem(path),
            width: (SIDE * aspect.min(1.0)).round().max(1.0) as u32,
            height: (SIDE / aspect.max(1.0)).round().max(1.0) as u32,
            spp: None,
            sampler: None,
            integrator: IntegratorDesc {
                kind: IntegratorKind::Path,
                max_depth: Some(max_depth),
                rr_depth: 5,
                hide_emitters: false,
                ao_radius: None,
            },
            camera,
            materials: self.materials,
            shapes: self.shapes,
            lights: self.lights,
            baked: None,
        };
        Ok(Loaded {
            scene,
            notes: self.notes,
            warnings: self.warnings,
        })
    }
}

const AS_IS: Placement = Placement {
    to_world: Affine::IDENTITY,
    face_normals: false,
    flip_normals: false,
};

/// Reads a `.ply` as one mesh of one grey.
pub(super) fn load_ply(path: &Path) -> Result<Loaded, ImportError> {
    let raw = ply::read(path)?;
    let (mesh, dropped) = raw.place(AS_IS);
    let mut model = Model::default();
    model.read(path, &raw.notes, dropped);
    let surface = silent(&mesh, "surface");
    model.add(stem(path), mesh, surface, None);
    model.show(path)
}

/// Reads an `.obj` as one mesh for each material.
pub(super) fn load_obj(path: &Path) -> Result<Loaded, ImportError> {
    let file = obj::read_parts(path)?;
    let (meshes, dropped) = file.raw.place_parts(AS_IS, &file.part);
    let mut model = Model::default();
    model.read(path, &file.raw.notes, dropped);
    let library = model.libraries(path, &file.libraries)?;
    let several = meshes.len() > 1;
    for (part, mesh) in meshes {
        let Some(name) = part.checked_sub(1).and_then(|index| file.names.get(index)) else {
            let surface = silent(&mesh, "surface");
            model.add(stem(path), mesh, surface, None);
            continue;
        };
        let shape = match several {
            true => format!("{}, {name}", stem(path)),
            false => stem(path),
        };
        let named = format!("material \"{name}\"");
        let Some((from, mtl)) = library.iter().find(|(_, mtl)| mtl.name == *name) else {
            if !library.is_empty() || file.libraries.is_empty() {
                model.warn(path, &format!("{named} is in no mtllib: it is grey"));
            }
            let surface = silent(&mesh, &named);
            model.add(shape, mesh, surface, None);
            continue;
        };
        let mut mtl = mtl.clone();
        mtl.read_textures(from.parent().unwrap_or(Path::new("")), !mesh.uvs.is_empty());
        let (mapped, emission) = (mtl.map(), mtl.emission());
        let glow = if emission.is_some() { ", emits" } else { "" };
        let note = format!("{named}: {}{glow}", mapped.words);
        model.notes.push(ImportError::new(from, note).to_string());
        for loss in mtl.losses.iter().chain(&mapped.losses) {
            model.warn(from, &format!("{named}: {loss}"));
        }
        let material = NamedMaterial {
            name: named,
            two_sided: !mtl.is_glass(),
            bsdf: mapped.bsdf,
            tint: mtl.tint.take(),
        };
        model.add(shape, mesh, material, emission);
    }
    model.show(path)
}

impl Model {
    fn warn(&mut self, path: &Path, what: &str) {
        self.warnings.push(ImportError::new(path, what).to_string());
    }

    /// What is to be said about reading a mesh.
    fn read(&mut self, path: &Path, notes: &[String], dropped: usize) {
        notes.iter().for_each(|note| self.warn(path, note));
        if dropped > 0 {
            self.warn(path, &format!("{dropped} triangles without area are left out"));
        }
    }

    fn add(&mut self, name: String, mesh: MeshDesc, material: NamedMaterial, emission: Option<Vec3>) {
        if mesh.triangles.is_empty() {
            return;
        }
        self.shapes.push(ShapeDesc {
            name,
            geometry: GeometryDesc::Mesh(mesh),
            material: self.materials.len(),
            emission,
        });
        self.materials.push(material);
    }

    /// The materials of all libraries that there are, each with its file.
    fn libraries(
        &mut self,
        path: &Path,
        libraries: &[(u32, String)],
    ) -> Result<Vec<(PathBuf, Mtl)>, ImportError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut found = Vec::new();
        for (line, names) in libraries {
            // A name may have blanks in it, and a line several names.
            let names = names.replace('\\', "/");
            let each: Vec<PathBuf> = names.split_whitespace().map(|name| folder.join(name)).collect();
            let files = match each.iter().any(|file| file.is_file()) {
                true => each,
                false => vec![folder.join(&names)],
            };
            for file in files {
                if !file.is_file() {
                    let what = format!("mtllib: no file {}: its materials are grey", file.display());
                    self.warnings.push(ImportError::at(path, *line, what).to_string());
                    continue;
                }
                found.extend(mtl::read(&file)?.into_iter().map(|mtl| (file.clone(), mtl)));
            }
        }
        Ok(found)
    }
}

/// What a mesh is of that says nothing: grey, or of its vertices' colours.
fn silent(mesh: &MeshDesc, name: &str) -> NamedMaterial {
    if mesh.colors.is_empty() {
        return grey(name, 0.7);
    }
    NamedMaterial {
        tint: Some(TintDesc::Vertices),
        ..grey(name, 1.0)
    }
}

/// What a surface is of that says nothing.
pub(super) fn grey(name: &str, reflectance: f64) -> NamedMaterial {
    NamedMaterial {
        name: name.to_string(),
        two_sided: true,
        bsdf: BsdfDesc::Diffuse {
            reflectance: [reflectance; 3],
        },
        tint: None,
    }
}

fn is_glass(material: &NamedMaterial) -> bool {
    matches!(
        material.bsdf,
        BsdfDesc::Dielectric { .. } | BsdfDesc::RoughDielectric { .. }
    )
}

fn corners(shape: &ShapeDesc) -> &[Vec3] {
    match &shape.geometry {
        GeometryDesc::Mesh(mesh) => &mesh.vertices,
        _ => &[],
    }
}

fn daylight() -> Vec<LightDesc> {
    vec![
        LightDesc::Constant {
            radiance: [0.4, 0.5, 0.65],
        },
        LightDesc::Directional {
            direction: unit([-0.35, -1.0, -0.5]).unwrap_or([0.0, -1.0, 0.0]),
            irradiance: [1.9, 1.75, 1.5],
        },
    ]
}

/// A square below everything, 16 times as wide as the model's sphere.
fn floor(low: Vec3, high: Vec3) -> GeometryDesc {
    let center = scaled(add(low, high), 0.5);
    let half = 8.0 * (length(sub(high, low)) / 2.0);
    GeometryDesc::Rectangle {
        center: [center[0], low[1], center[2]],
        u: [0.0, 0.0, half],
        v: [half, 0.0, 0.0],
    }
}

fn bounds(points: &[Vec3]) -> (Vec3, Vec3) {
    let fold = |with: fn(f64, f64) -> f64, start: f64| {
        points.iter().fold([start; 3], |a, b| {
            [with(a[0], b[0]), with(a[1], b[1]), with(a[2], b[2])]
        })
    };
    (fold(f64::min, f64::INFINITY), fold(f64::max, f64::NEG_INFINITY))
}

/// The camera along [`VIEW`], as near as all points stay within [`FILL`] of the square picture.
fn framing(points: &[Vec3], center: Vec3) -> Option<CameraDesc> {
    let back = unit(VIEW)?;
    let right = unit(cross([0.0, 1.0, 0.0], back))?;
    let up = cross(back, right);
    let tan = FILL * (FOV.to_radians() / 2.0).tan();
    let distance = points
        .iter()
        .map(|&p| sub(p, center))
        .map(|p| dot(p, back) + dot(p, right).abs().max(dot(p, up).abs()) / tan)
        .fold(0.0, f64::max);
    let origin = add(center, scaled(back, distance));
    (distance > 0.0 && distance.is_finite()).then_some(CameraDesc {
        origin,
        right,
        up,
        forward: scaled(back, -1.0),
        fov_x: FOV,
        lens: None,
    })
}
