//! A scene as it lies in flash, and what that costs its meshes.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use microlux::bvh::{Child, Node, check_mesh, primitives};
use microlux::color::Albedo;
use microlux::integrator::AmbientOcclusion;
use microlux::scene::{Baked, Mesh, Shot, Technique};
use microlux::shape::{Bounds, TriangleMesh, Triangles};

use crate::bake::{self, Aligned, BlobTooLarge, Packed};
use crate::desc::{CameraDesc, IntegratorDesc, IntegratorKind, LensDesc, MeshDesc, SceneDesc};
use crate::quantise::CoreScene;
use crate::run::{self, Error, Options};

/// What was baked.
#[derive(Clone, Debug)]
pub struct Flash {
    /// For [`Baked::open`].
    pub bytes: Vec<u8>,
    pub meshes: Vec<Part>,
    /// If it is a whole scene.
    pub scene: Option<ScenePart>,
}

/// What a whole scene is beside its meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScenePart {
    pub bytes: usize,
    /// How large a [`Room`] for it is: shapes, materials, lights, and the most there are of meshes, textures or blobs.
    ///
    /// [`Room`]: microlux::scene::Room
    pub room: [usize; 4],
}

/// One of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    pub name: String,
    pub triangles: usize,
    pub nodes: usize,
    pub treelets: usize,
    pub vertices: usize,
    pub leaves: usize,
    /// By how far rounding moved a vertex, metres: at most, and as root of the mean square.
    pub displacement: [f64; 2],
    /// Longest side of the mesh, metres.
    pub extent: f64,
    /// What the surface area heuristic expects of a ray that meets the mesh, in nodes and triangles: with the nodes' rounded
    /// boxes, and with exact ones.
    pub sah: [f64; 2],
}

impl Part {
    /// Without head and table of the whole.
    pub fn bytes(&self) -> usize {
        self.nodes + self.treelets + self.vertices + self.leaves
    }
}

/// Bakes a whole scene, or its meshes alone, in the order in which it names them; maybe none.
pub fn bake(desc: &SceneDesc, is_whole: bool) -> Result<Flash, Error> {
    if desc.baked.is_some() {
        return Err(Error::Scene("it is baked already".to_string()));
    }
    let core = CoreScene::new(desc)?;
    let (mut packed, mut parts) = (Vec::new(), Vec::new());
    for owned in core.owned_meshes() {
        let (name, mesh) = (&owned.name, owned.borrow());
        let Some(plain) = mesh.triangles.plain() else {
            continue;
        };
        let made =
            Packed::new(plain, mesh.nodes).map_err(|error| Error::Scene(format!("{name}: {error}")))?;
        parts.push(Part {
            name: name.clone(),
            triangles: plain.triangles.len(),
            nodes: size_of_val(&*made.nodes),
            treelets: size_of_val(&*made.treelets),
            vertices: made.vertices.len(),
            leaves: made.leaves.len(),
            displacement: owned.displacement,
            extent: owned.extent,
            sah: sah(plain, mesh.nodes),
        });
        packed.push(made);
    }
    let too_large = |error: BlobTooLarge| Error::Scene(error.to_string());
    let alone = bake::blob(&packed, core.unit).map_err(too_large)?;
    if !is_whole {
        return Ok(Flash {
            bytes: alone,
            meshes: parts,
            scene: None,
        });
    }
    let lent = core.lend();
    let scene = core.scene(&lent)?;
    let of = scene.parts();
    let bytes = bake::scene_blob(&packed, of, &shot(desc, &core)).map_err(too_large)?;
    let most = of.meshes.len().max(of.textures.len()).max(of.blobs.len());
    Ok(Flash {
        meshes: parts,
        scene: Some(ScenePart {
            bytes: bytes.len() - alone.len(),
            room: [of.shapes.len(), of.materials.len(), of.lights.len(), most],
        }),
        bytes,
    })
}

/// How the scene wants to be rendered, as a baked one says it.
fn shot(desc: &SceneDesc, core: &CoreScene) -> Shot {
    let path = run::integrator(desc, &Options::for_scene(desc));
    Shot {
        camera: core.camera,
        width: desc.width as u16,
        height: desc.height as u16,
        spp: desc.spp.unwrap_or(0),
        technique: match desc.integrator.kind {
            IntegratorKind::Ao => Technique::AmbientOcclusion,
            IntegratorKind::Direct => Technique::Direct,
            IntegratorKind::Path => Technique::Path,
            IntegratorKind::Bdpt => Technique::Bdpt,
            IntegratorKind::Light => Technique::LightTracer,
        },
        max_depth: path.max_depth,
        rr_depth: path.rr_depth,
        hide_emitters: path.hide_emitters,
        ao_radius: run::ao_radius(desc, core),
    }
}

/// Whether what was baked is a whole scene, and not meshes alone.
pub fn is_scene(bytes: &[u8]) -> bool {
    Baked::open(bytes).is_ok_and(|baked| baked.has_scene())
}

/// A baked scene as the files say scenes; what is wrong in a line.
pub fn scene(name: &str, bytes: Aligned) -> Result<SceneDesc, String> {
    let records = Baked::open(bytes.bytes()).and_then(|baked| baked.records());
    let records = records.map_err(|error| format!("{error}; bake it again"))?;
    let Shot {
        camera,
        width,
        height,
        spp,
        technique,
        max_depth,
        rr_depth,
        hide_emitters,
        ao_radius,
    } = records.shot;
    let step = f64::from(-records.unit.fraction_bits()).exp2();
    let metres = |units: i32| f64::from(units) * step;
    let [right, up, forward] = camera.frame().map(|dir| dir.0.map(|c| f64::from(c) / 65536.0));
    let (aperture, focus) = camera.lens();
    Ok(SceneDesc {
        name: name.to_string(),
        width: width.into(),
        height: height.into(),
        spp: (spp > 0).then_some(spp),
        sampler: None,
        integrator: IntegratorDesc {
            kind: match technique {
                Technique::AmbientOcclusion => IntegratorKind::Ao,
                Technique::Direct => IntegratorKind::Direct,
                Technique::Path => IntegratorKind::Path,
                Technique::Bdpt => IntegratorKind::Bdpt,
                Technique::LightTracer => IntegratorKind::Light,
            },
            max_depth: (max_depth < run::UNLIMITED).then_some(max_depth.into()),
            rr_depth: rr_depth.into(),
            hide_emitters,
            ao_radius: (ao_radius < AmbientOcclusion::FULL).then_some(metres(ao_radius)),
        },
        camera: CameraDesc {
            origin: camera.origin().0.map(metres),
            right,
            up,
            forward,
            fov_x: camera.half_width().to_num::<f64>().atan().to_degrees() * 2.0,
            lens: camera.has_lens().then(|| LensDesc {
                aperture_radius: metres(aperture),
                focus_distance: metres(focus),
            }),
        },
        materials: Vec::new(),
        shapes: Vec::new(),
        lights: Vec::new(),
        baked: Some(Arc::new(bytes)),
    })
}

/// MacDonald and Booth 1990, with the costs of [`bake::build`]'s nodes and of triangles taken as equal.
fn sah(mesh: &TriangleMesh, nodes: &[Node]) -> [f64; 2] {
    let area = |b: Bounds| {
        let [x, y, z] = [0, 1, 2].map(|i| f64::from(b.high[i]) - f64::from(b.low[i]));
        x * y + y * z + z * x
    };
    let mut exact = vec![Bounds::EMPTY; nodes.len()];
    let mut sums = [0.0; 2];
    // Children stand after their node.
    for (index, node) in nodes.iter().enumerate().rev() {
        for (rounded, child) in node.children() {
            let (bounds, cost) = match child {
                Child::None => continue,
                Child::Node(child) => (exact.get(usize::from(child)).copied(), 1.0),
                Child::Leaf(base, leaf) => {
                    let leaf = primitives(base, leaf);
                    let cost = leaf.len() as f64;
                    let corners = leaf.filter_map(|triangle| mesh.corners(triangle));
                    let around = |b: Bounds, corners: [_; 3]| b.union(Bounds::of(&corners));
                    (Some(corners.fold(Bounds::EMPTY, around)), cost)
                }
            };
            let bounds = bounds.unwrap_or(Bounds::EMPTY);
            sums[0] += cost * area(rounded);
            sums[1] += cost * area(bounds);
            exact[index] = exact[index].union(bounds);
        }
    }
    let whole = exact.first().map_or(1.0, |&root| area(root));
    sums.map(|sum| 1.0 + sum / whole)
}

/// The meshes of a baked file, all of them checked, each with the metres that a unit of its scene is; what is wrong in a
/// line.
pub fn meshes(bytes: &[u8]) -> Result<Vec<(Mesh<'_>, f64)>, String> {
    let wrong = |error: &dyn std::fmt::Display| format!("{error}; bake it again");
    let baked = Baked::open(bytes).map_err(|error| wrong(&error))?;
    let mesh = |index| {
        let (mesh, unit) = baked
            .mesh(index)
            .and_then(|mesh| Ok((mesh, baked.unit(index)?)))
            .map_err(|error| wrong(&error))?;
        check_mesh(&mesh.triangles, mesh.nodes)
            .map_err(|error| wrong(&format_args!("mesh {index}: {error}")))?;
        Ok((mesh, f64::from(-unit.fraction_bits()).exp2()))
    };
    (0..baked.count()).map(mesh).collect()
}

/// Bytes of a baked file's triangles and of their trees.
pub fn bytes(path: &Path) -> Result<[usize; 2], Error> {
    let told = |error: String| Error::Scene(error);
    let bytes = std::fs::read(path).map_err(|error| told(error.to_string()))?;
    let bytes = Aligned::new(&bytes);
    let meshes = meshes(bytes.bytes()).map_err(told)?;
    let sum = |of: fn(&Mesh) -> usize| meshes.iter().map(|(mesh, _)| of(mesh)).sum();
    Ok([
        sum(|mesh| mesh.triangles.bytes()),
        sum(|mesh| size_of_val(mesh.nodes)),
    ])
}

/// The triangles of a mesh, if a unit is `scale` metres.
pub fn described(mesh: &Triangles, scale: f64) -> MeshDesc {
    let mut places = HashMap::new();
    let mut desc = MeshDesc::default();
    for number in mesh.numbers() {
        let Some(corners) = mesh.corners(number) else {
            continue;
        };
        let (normals, colors, uvs) = (mesh.normals(number), mesh.colors(number), mesh.uvs(number));
        desc.triangles.push([0, 1, 2].map(|corner| {
            let (place, normal) = (corners[corner], normals.map(|normals| normals[corner]));
            let (color, uv) = (colors.map(|colors| colors[corner]), uvs.map(|uvs| uvs[corner]));
            *places.entry((place, normal, color, uv)).or_insert_with(|| {
                let point = mesh.grid().to_scene(place).0;
                desc.vertices.push(point.map(|c| f64::from(c) * scale));
                let normal = normal.map(|normal| normal.decode().0.map(|c| f64::from(c) / 65536.0));
                desc.normals.extend(normal);
                let light = |color| Albedo::from_srgb(color).0.map(|c| c.to_num());
                desc.colors.extend(color.map(light));
                desc.uvs
                    .extend(uv.map(|uv| uv.map(|part| f64::from(part) / 4096.0)));
                desc.vertices.len() as u32 - 1
            })
        }));
    }
    desc
}
