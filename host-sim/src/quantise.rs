//! A scene as the files say it, rounded into the core's integers: the one place where floats become fixed point.

mod implicit;
mod instance;
mod light;
mod material;
mod mesh;
mod rounding;
mod texture;

use crate::bake::Aligned;
use crate::desc::{GeometryDesc, LightDesc, MeshDesc, SceneDesc, TintDesc, Vec3};
use crate::envmap::{self, BakedMap};
use instance::Shared;
use light::Background;
pub use mesh::OwnedMesh;
use microlux::bvh::{Node, max_nodes};
use microlux::camera::Camera;
use microlux::geom::Unit;
use microlux::light::{Environment, Light};
use microlux::material::{Material, Texture};
use microlux::scene::{
    self, Arrangement, Baked, BakedError, Boxed, Mesh, Parts, Scene, SceneError, Shape, Tint, arrange,
};
use microlux::shape::{Blob, Bounds, Geometry};
pub use rounding::bounds_of;
use rounding::{Rounding, choose_unit, radiance};
use std::sync::Arc;
pub use texture::OwnedTexture;
use texture::Textures;
use thiserror::Error;

/// What the fixed-point core can't take.
#[derive(Debug, Error)]
pub enum QuantiseError {
    #[error("{name}: {what}")]
    Unsupported { name: String, what: String },
    #[error("{name}: {error}")]
    Shape { name: String, error: SceneError },
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error("{0}; bake it again")]
    Baked(#[from] BakedError),
}

/// What of a scene is left out, a line each: the picture will differ by it.
pub fn losses(desc: &SceneDesc) -> Vec<String> {
    let mut lines = Vec::new();
    for shape in &desc.shapes {
        let tint = desc
            .materials
            .get(shape.material)
            .and_then(|material| material.tint.as_ref());
        let mesh = mesh_of(&shape.geometry);
        let told = match tint {
            Some(TintDesc::Vertices) if mesh.is_none_or(|mesh| mesh.colors.is_empty()) => {
                "colours of its vertices"
            }
            Some(TintDesc::Texture { .. }) if mesh.is_none_or(|mesh| mesh.uvs.is_empty()) => {
                "places in the texture"
            }
            _ => continue,
        };
        lines.push(format!(
            "{}: has no {told}: its material's own colour is left",
            shape.name
        ));
    }
    for light in &desc.lights {
        if let LightDesc::EnvMap { width, height, .. } = light
            && let Some([across, down]) = envmap::resizing(*width as usize, *height as usize)
        {
            lines.push(format!(
                "envmap: its {width} x {height} pixels become {across} x {down}, of the same mean"
            ));
        }
    }
    lines
}

/// A scene in the core's numbers, owned.
#[derive(Debug)]
pub struct CoreScene {
    pub unit: Unit,
    /// Where the scene frame's origin lies, metres.
    pub origin: Vec3,
    pub camera: Camera,
    shapes: Vec<Shape>,
    materials: Vec<Material>,
    lights: Vec<Light>,
    meshes: Vec<OwnedMesh>,
    textures: Vec<OwnedTexture>,
    /// What metaballs and smooth unions are made of.
    blobs: Vec<Blob>,
    nodes: Vec<Node>,
    arrangement: Arrangement,
    names: Vec<String>,
    background: Background,
    /// How lights are chosen, by their power.
    choice: Vec<u32>,
    /// Where meshes and textures are borrowed from, if the scene was baked.
    baked: Option<Arc<Aligned>>,
}

/// What a scene borrows and the core knows by slices.
#[derive(Clone, Debug, Default)]
pub struct Lent<'a> {
    pub meshes: Vec<Mesh<'a>>,
    pub textures: Vec<Texture<'a>>,
}

impl<'a> Lent<'a> {
    /// Of a baked scene.
    fn of(bytes: &'a Aligned) -> Result<Lent<'a>, BakedError> {
        let baked = Baked::open(bytes.bytes())?;
        let meshes = (0..baked.count()).map(|index| baked.mesh(index));
        Ok(Lent {
            meshes: meshes.collect::<Result<_, _>>()?,
            textures: baked.records()?.textures().collect::<Result<_, _>>()?,
        })
    }
}

impl CoreScene {
    /// Chooses the finest unit in which the scene fits, with the middle of the scene as origin, and rounds.
    ///
    /// A baked scene is taken as it is.
    pub fn new(desc: &SceneDesc) -> Result<CoreScene, QuantiseError> {
        if let Some(bytes) = &desc.baked {
            return Ok(CoreScene::baked(bytes)?);
        }
        let (origin, unit) = choose_unit(desc);
        let round = Rounding {
            origin,
            scale: f64::from(unit.fraction_bits()).exp2(),
        };
        let materials = desc
            .materials
            .iter()
            .map(|m| material::material(&m.name, m.two_sided, &m.bsdf));
        let materials = materials.collect::<Result<Vec<_>, _>>()?;
        let mut shapes = Vec::new();
        let mut lights = Vec::new();
        let mut meshes = Vec::new();
        let mut blobs = Vec::new();
        let mut shared = Shared::new(&round, desc);
        let mut textures = Textures::default();
        for (index, shape) in desc.shapes.iter().enumerate() {
            let light = shape.emission.map(|emission| {
                lights.push(Light::Area {
                    shape: index as u16,
                    radiance: radiance(emission),
                });
                (lights.len() - 1) as u16
            });
            let wanted = desc
                .materials
                .get(shape.material)
                .and_then(|material| material.tint.as_ref());
            let geometry = match &shape.geometry {
                GeometryDesc::Mesh(mesh) => {
                    meshes.push(round.mesh(&shape.name, mesh, wanted)?);
                    Geometry::Mesh((meshes.len() - 1) as u16)
                }
                GeometryDesc::Instance(instance) => {
                    // What emits light is no instance.
                    let placed = match light {
                        Some(_) => None,
                        None => shared.place(&round, &shape.name, instance, wanted, &mut meshes)?,
                    };
                    match placed {
                        Some(placed) => Geometry::Instance(placed),
                        None => {
                            meshes.push(round.mesh(&shape.name, &instance.placed(), wanted)?);
                            Geometry::Mesh((meshes.len() - 1) as u16)
                        }
                    }
                }
                GeometryDesc::Implicit(solid) => {
                    let solid = implicit::implicit(&round, solid, &mut blobs);
                    Geometry::Implicit(solid.map_err(|what| QuantiseError::Unsupported {
                        name: shape.name.clone(),
                        what,
                    })?)
                }
                _ => round.geometry(shape)?,
            };
            shapes.push(Shape {
                geometry,
                material: shape.material as u16,
                light,
                tint: match (wanted, mesh_of(&shape.geometry)) {
                    (Some(TintDesc::Vertices), Some(mesh)) if !mesh.colors.is_empty() => Tint::Vertices,
                    (Some(TintDesc::Texture { texture, .. }), Some(mesh)) if !mesh.uvs.is_empty() => {
                        Tint::Texture(textures.of(texture))
                    }
                    _ => Tint::None,
                },
                id: index as u16,
            });
        }
        let background = light::lights(&round, desc, &mut lights);
        let names = desc.shapes.iter().map(|shape| shape.name.clone()).collect();
        let mut nodes = vec![Node::EMPTY; max_nodes(shapes.len())];
        let mut boxes = vec![Boxed::EMPTY; shapes.len()];
        let borrowed: Vec<_> = meshes.iter().map(OwnedMesh::borrow).collect();
        let arrangement = arrange(
            &mut shapes,
            &borrowed,
            &blobs,
            &mut lights,
            &mut boxes,
            &mut nodes,
        )
        .map_err(|error| SceneError::Nodes { needed: error.needed })?;
        nodes.truncate(arrangement.nodes);
        let camera = round.camera(desc);
        let mut core = CoreScene {
            unit,
            origin,
            camera,
            shapes,
            materials,
            lights,
            meshes,
            textures: textures.list,
            blobs,
            nodes,
            arrangement,
            names,
            background,
            choice: Vec::new(),
            baked: None,
        };
        core.choose_by_power();
        Ok(core)
    }

    fn baked(bytes: &Arc<Aligned>) -> Result<CoreScene, BakedError> {
        let records = Baked::open(bytes.bytes())?.records()?;
        Lent::of(bytes)?;
        let blobs: Vec<Blob> = records.blobs().collect();
        Ok(CoreScene {
            unit: records.unit,
            origin: [0.0; 3],
            camera: records.shot.camera,
            shapes: records.shapes(&blobs).collect::<Result<_, _>>()?,
            materials: records.materials().collect::<Result<_, _>>()?,
            lights: records.lights().collect::<Result<_, _>>()?,
            meshes: Vec::new(),
            textures: Vec::new(),
            nodes: records.nodes.to_vec(),
            arrangement: Arrangement {
                bounded: records.bounded.into(),
                grid: records.grid,
                nodes: records.nodes.len(),
            },
            names: Vec::new(),
            background: match records.background {
                scene::Background::None => Background::None,
                scene::Background::Sky(sky) => Background::Sky(sky),
                scene::Background::Map(map) => Background::Map(BakedMap::of(&map.parts())),
            },
            choice: records.choice.to_vec(),
            blobs,
            baked: Some(Arc::clone(bytes)),
        })
    }

    /// Makes the table by which lights are chosen; a scene that the border refuses has none.
    fn choose_by_power(&mut self) {
        let lent = self.lend();
        let mut table = Vec::new();
        if let Ok(scene) = self.scene(&lent) {
            table = vec![0; scene.light_count().saturating_sub(1) as usize];
            scene.choose_by_power(&mut table);
        }
        self.choice = table;
    }

    /// Bytes of constant memory that a map of the environment takes.
    pub fn map_bytes(&self) -> usize {
        match &self.background {
            Background::Map(map) => map.map().map_or(0, |map| map.bytes()),
            Background::None | Background::Sky(_) => 0,
        }
    }

    /// Corners of the box around everything finite, metres.
    pub fn bounds(&self, desc: &SceneDesc) -> [Vec3; 2] {
        if self.baked.is_none() {
            return bounds_of(desc);
        }
        let boxes = self.nodes.first().into_iter().flat_map(Node::children);
        let around = boxes.map(|(bounds, _)| bounds).reduce(Bounds::union);
        let Bounds { low, high } = around.unwrap_or(Bounds {
            low: [0; 3],
            high: [0; 3],
        });
        let step = f64::from(-self.unit.fraction_bits()).exp2();
        [low, high].map(|corner| {
            let point = self.arrangement.grid.to_scene(corner);
            point.0.map(|c| f64::from(c) * step)
        })
    }

    /// The meshes, with what is known of them.
    pub fn owned_meshes(&self) -> &[OwnedMesh] {
        &self.meshes
    }

    /// The textures, with what is known of them.
    pub fn owned_textures(&self) -> &[OwnedTexture] {
        &self.textures
    }

    /// The meshes and textures as the core borrows them.
    pub fn lend(&self) -> Lent<'_> {
        match &self.baked {
            // It was opened before.
            Some(bytes) => Lent::of(bytes).unwrap_or_default(),
            None => Lent {
                meshes: self.meshes.iter().map(OwnedMesh::borrow).collect(),
                textures: self.textures.iter().map(OwnedTexture::borrow).collect(),
            },
        }
    }

    /// The checked view that is rendered, over what [`Self::lend`] lends; an error names the shape as the file does.
    pub fn scene<'a>(&'a self, lent: &'a Lent<'a>) -> Result<Scene<'a>, QuantiseError> {
        let parts = Parts {
            unit: self.unit,
            shapes: &self.shapes,
            bounded: self.arrangement.bounded as u16,
            materials: &self.materials,
            lights: &self.lights,
            environment: match &self.background {
                Background::None => Environment::None,
                Background::Sky(sky) => Environment::Sky(sky),
                Background::Map(map) => {
                    Environment::Map(map.map().map_err(|error| QuantiseError::Unsupported {
                        name: "envmap".into(),
                        what: error.to_string(),
                    })?)
                }
            },
            choice: &self.choice,
            meshes: &lent.meshes,
            textures: &lent.textures,
            blobs: &self.blobs,
            grid: self.arrangement.grid,
            nodes: &self.nodes,
        };
        Scene::new(parts).map_err(
            |error| match error.shape().and_then(|id| self.names.get(id as usize)) {
                Some(name) => QuantiseError::Shape {
                    name: name.clone(),
                    error,
                },
                None => QuantiseError::Scene(error),
            },
        )
    }
}

/// The mesh that a shape is, or an instance of.
fn mesh_of(geometry: &GeometryDesc) -> Option<&MeshDesc> {
    match geometry {
        GeometryDesc::Mesh(mesh) => Some(mesh),
        GeometryDesc::Instance(instance) => Some(&instance.mesh),
        _ => None,
    }
}
