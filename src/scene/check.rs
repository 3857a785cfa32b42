use super::arrange::{coarsest, finite_box, reach, rectangle_reach, shape_bounds};
use super::cells::Cells;
use super::distant::Ball;
use super::{Parts, Scene, Tint};
use crate::bvh::{CheckError, SCENE_PAD, check_mesh, check_tree};
use crate::geom::{Dir, Point, REACH};
use crate::light::{Environment, Light};
use crate::material::{MaterialError, TextureError};
use crate::num::ONE_Q16;
use crate::shape::{Blob, Geometry, Grid, ImplicitError, Layers};

/// Why a scene can't be rendered. Shapes are named by the user's number, materials and lights by their index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneError {
    /// Room for one more was wanted: `needed` would have been enough.
    Full { what: &'static str, needed: usize },
    /// The shape's material does not exist.
    NoSuchMaterial { shape: u16, material: u16 },
    /// The shape's light does not exist, or is not an area light of that shape.
    NoSuchLight { shape: u16, light: u16 },
    /// The shape reaches beyond ±[`REACH`] units; take a coarser unit.
    TooFar { shape: u16 },
    /// The shape has no extent: a radius or side under one unit, or directions that are not unit vectors.
    Degenerate { shape: u16 },
    /// The shape has parts finer than 1/256 of it, or than 64 units: split it, or take a finer unit.
    Thin { shape: u16 },
    /// The shape is made of blobs that do not exist, of none, of more than 16, or, as metaballs, of other than balls.
    Blobs { shape: u16 },
    /// An infinite plane can't be a light.
    PlaneLight { shape: u16 },
    /// An instance can't be a light: place the mesh itself.
    InstanceLight { shape: u16 },
    /// Something of the material is out of range.
    Material { material: u16, error: MaterialError },
    /// A light's shape does not exist, or does not name it as its light.
    LightShape { light: u16 },
    /// A light stands beyond ±2·[`REACH`] units.
    LightTooFar { light: u16 },
    /// The way a directional light travels is no unit vector.
    LightDirection { light: u16 },
    /// An environment must be the last light, and there can be one.
    Environment { light: u16 },
    /// Up, or the way to the sun, is no unit vector.
    SkyDirection,
    /// The table by which lights are chosen has not `needed` bounds, or they do not rise from above 0.
    Choice { needed: usize },
    /// Nothing in the scene emits light.
    NoLight,
    /// Something of the texture is wrong.
    Texture { texture: u16, error: TextureError },
    /// The shape's texture does not exist.
    NoSuchTexture { shape: u16, texture: u16 },
    /// The shape is no mesh, or one whose vertices have no colours, or no places in a texture.
    NoTint { shape: u16 },
    /// The shape's mesh does not exist.
    NoSuchMesh { shape: u16, mesh: u16 },
    /// The mesh or the tree over it is wrong.
    Mesh { mesh: u16, error: CheckError },
    /// The scene's grid is finer than this mesh's.
    Grid { mesh: u16 },
    /// The tree over the shapes is wrong, or does not fit in the memory for it.
    Tree(CheckError),
    /// Finite shapes must come first, as many as `bounded` says.
    Order { shape: u16 },
    /// Fewer shapes than `bounded` says are finite.
    Bounded { shapes: usize },
    /// The memory for nodes is too small.
    Nodes { needed: usize },
}

impl core::fmt::Display for SceneError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Full { what, needed } => write!(f, "no room for {what}: {needed} are needed"),
            Self::NoSuchMaterial { shape, material } => {
                write!(f, "shape {shape}: there is no material {material}")
            }
            Self::NoSuchLight { shape, light } => {
                write!(f, "shape {shape}: light {light} is not its area light")
            }
            Self::TooFar { shape } => {
                write!(f, "shape {shape}: reaches beyond 2^22 units; take a coarser unit")
            }
            Self::Degenerate { shape } => write!(f, "shape {shape}: has no extent"),
            Self::Thin { shape } => write!(
                f,
                "shape {shape}: a part is finer than 1/256 of it, or than 64 units; make it thicker, or several shapes of it"
            ),
            Self::Blobs { shape } => {
                write!(
                    f,
                    "shape {shape}: wants 1 to 16 of the scene's blobs, metaballs only balls"
                )
            }
            Self::PlaneLight { shape } => write!(f, "shape {shape}: an infinite plane can't be a light"),
            Self::InstanceLight { shape } => {
                write!(
                    f,
                    "shape {shape}: an instance can't be a light; place the mesh itself"
                )
            }
            Self::Material { material, error } => write!(f, "material {material}: {error}"),
            Self::LightShape { light } => write!(f, "light {light}: its shape does not name it"),
            Self::LightTooFar { light } => write!(f, "light {light}: stands beyond 2^23 units"),
            Self::LightDirection { light } => write!(f, "light {light}: its direction is no unit vector"),
            Self::Environment { light } => {
                write!(f, "light {light}: one environment, after all other lights")
            }
            Self::SkyDirection => write!(f, "the sky: up and the way to the sun must be unit vectors"),
            Self::Choice { needed } => {
                write!(
                    f,
                    "the choice of lights: {needed} bounds that rise are needed, or none"
                )
            }
            Self::Texture { texture, error } => write!(f, "texture {texture}: {error}"),
            Self::NoSuchTexture { shape, texture } => {
                write!(f, "shape {shape}: there is no texture {texture}")
            }
            Self::NoTint { shape } => write!(
                f,
                "shape {shape}: only a mesh with colours or uvs can have other colours than its material's"
            ),
            Self::NoSuchMesh { shape, mesh } => write!(f, "shape {shape}: there is no mesh {mesh}"),
            Self::Mesh { mesh, error } => write!(f, "mesh {mesh}: {error}"),
            Self::Grid { mesh } => write!(f, "mesh {mesh}: its grid is coarser than the scene's"),
            Self::Tree(error) => write!(f, "the tree over the shapes: {error}"),
            Self::Order { shape } => write!(f, "shape {shape}: finite shapes come first, then planes"),
            Self::Bounded { shapes } => {
                write!(f, "{shapes} shapes are fewer than are said to be finite")
            }
            Self::Nodes { needed } => write!(f, "too few nodes: {needed} are enough"),
            Self::NoLight => write!(f, "nothing in the scene emits light"),
        }
    }
}

impl core::error::Error for SceneError {}

impl SceneError {
    /// The user's number of the shape at fault, if it is one.
    pub fn shape(&self) -> Option<u16> {
        match *self {
            Self::NoSuchMaterial { shape, .. }
            | Self::NoSuchLight { shape, .. }
            | Self::TooFar { shape }
            | Self::Degenerate { shape }
            | Self::Thin { shape }
            | Self::Blobs { shape }
            | Self::NoSuchMesh { shape, .. }
            | Self::NoSuchTexture { shape, .. }
            | Self::NoTint { shape }
            | Self::Order { shape }
            | Self::PlaneLight { shape }
            | Self::InstanceLight { shape } => Some(shape),
            _ => None,
        }
    }
}

impl<'a> Scene<'a> {
    /// Checks everything once; after this, rendering can't fail.
    pub fn new(parts: Parts<'a>) -> Result<Scene<'a>, SceneError> {
        for (index, material) in parts.materials.iter().enumerate() {
            material.check().map_err(|error| SceneError::Material {
                material: index as u16,
                error,
            })?;
        }
        for (index, texture) in parts.textures.iter().enumerate() {
            texture.check().map_err(|error| SceneError::Texture {
                texture: index as u16,
                error,
            })?;
        }
        for (index, shape) in parts.shapes.iter().enumerate() {
            check_geometry(&shape.geometry, shape.id, parts.blobs)?;
            if matches!(shape.geometry, Geometry::Plane(_)) != (index >= parts.bounded as usize) {
                return Err(SceneError::Order { shape: shape.id });
            }
            if let Some(mesh) = mesh_of(&shape.geometry) {
                if mesh as usize >= parts.meshes.len() {
                    return Err(SceneError::NoSuchMesh {
                        shape: shape.id,
                        mesh,
                    });
                }
                let far = |geometry: &Geometry| {
                    let reach = reach(geometry, parts.meshes, parts.blobs);
                    reach.is_some_and(|(low, high)| is_far(low) || is_far(high))
                };
                // As it is placed, and an instance's in its own frame, too.
                let is_instance = matches!(shape.geometry, Geometry::Instance(_));
                if far(&shape.geometry) || (is_instance && far(&Geometry::Mesh(mesh))) {
                    return Err(SceneError::TooFar { shape: shape.id });
                }
            }
            let mesh = mesh_of(&shape.geometry).and_then(|mesh| parts.meshes.get(mesh as usize));
            let has = |layer| mesh.is_some_and(|mesh| mesh.triangles.layers().has(layer));
            match shape.tint {
                Tint::None => {}
                Tint::Vertices if has(Layers::COLORS) => {}
                Tint::Texture(texture) if has(Layers::UVS) => {
                    if texture as usize >= parts.textures.len() {
                        return Err(SceneError::NoSuchTexture {
                            shape: shape.id,
                            texture,
                        });
                    }
                }
                Tint::Vertices | Tint::Texture(_) => return Err(SceneError::NoTint { shape: shape.id }),
            }
            if shape.material as usize >= parts.materials.len() {
                return Err(SceneError::NoSuchMaterial {
                    shape: shape.id,
                    material: shape.material,
                });
            }
            if let Some(light) = shape.light {
                let named = matches!(parts.lights.get(light as usize),
                    Some(Light::Area { shape, .. }) if *shape as usize == index);
                if !named {
                    return Err(SceneError::NoSuchLight {
                        shape: shape.id,
                        light,
                    });
                }
                match shape.geometry {
                    Geometry::Plane(_) => return Err(SceneError::PlaneLight { shape: shape.id }),
                    Geometry::Instance(_) => return Err(SceneError::InstanceLight { shape: shape.id }),
                    _ => {}
                }
            }
        }
        let mut mesh_depth = 0;
        for (index, mesh) in parts.meshes.iter().enumerate() {
            let wrong = |error| SceneError::Mesh {
                mesh: index as u16,
                error,
            };
            mesh_depth = mesh_depth.max(check_mesh(&mesh.triangles, mesh.nodes).map_err(wrong)?);
        }
        if let Some((shift, mesh)) = coarsest(parts.shapes, parts.meshes)
            && shift > parts.grid.shift()
        {
            return Err(SceneError::Grid { mesh });
        }
        let finite = parts
            .shapes
            .get(..parts.bounded as usize)
            .ok_or(SceneError::Bounded {
                shapes: parts.shapes.len(),
            })?;
        let bounds = |i: u32| {
            let shape = finite.get(i as usize)?;
            let inside = reach(&shape.geometry, parts.meshes, parts.blobs)
                .is_none_or(|(low, high)| holds(&parts.grid, low, high));
            inside.then(|| shape_bounds(shape, parts.meshes, parts.blobs, &parts.grid).pad(SCENE_PAD))
        };
        let depth = mesh_depth + check_tree(finite.len(), bounds, parts.nodes).map_err(SceneError::Tree)?;
        let mut light_count = 0;
        let mut environment = None;
        let mut emits = false;
        for (index, light) in parts.lights.iter().enumerate() {
            let index = index as u16;
            if environment.is_some() {
                return Err(SceneError::Environment { light: index - 1 });
            }
            light_count += 1;
            emits |= match light {
                Light::Point { position, intensity } => {
                    if position.0.iter().any(|c| c.unsigned_abs() > 2 * REACH as u32) {
                        return Err(SceneError::LightTooFar { light: index });
                    }
                    !intensity.is_black()
                }
                Light::Directional {
                    direction,
                    irradiance,
                } => {
                    if !is_unit(*direction) {
                        return Err(SceneError::LightDirection { light: index });
                    }
                    !irradiance.is_black()
                }
                Light::Area { shape, radiance } => {
                    if parts
                        .shapes
                        .get(*shape as usize)
                        .is_none_or(|s| s.light != Some(index))
                    {
                        return Err(SceneError::LightShape { light: index });
                    }
                    !radiance.is_black()
                }
                Light::Environment { radiance } => {
                    if !matches!(parts.environment, Environment::None) {
                        return Err(SceneError::Environment { light: index });
                    }
                    environment = Some(Environment::Constant(*radiance));
                    light_count -= 1;
                    !radiance.is_black()
                }
            };
        }
        if let Environment::Sky(sky) = parts.environment
            && !sky.directions().into_iter().all(is_unit)
        {
            return Err(SceneError::SkyDirection);
        }
        let environment = environment.unwrap_or(parts.environment);
        light_count += u32::from(environment.is_sampled());
        if !emits && environment.is_black() {
            return Err(SceneError::NoLight);
        }
        let needed = (light_count as usize).saturating_sub(1);
        let rises = core::iter::once(&0).chain(parts.choice).zip(parts.choice);
        if !parts.choice.is_empty()
            && (parts.choice.len() != needed || !rises.into_iter().all(|(before, bound)| before < bound))
        {
            return Err(SceneError::Choice { needed });
        }
        Ok(Scene {
            parts,
            light_count,
            environment,
            depth,
            ball: finite_box(&parts).map(Ball::around),
            cells: Cells::NONE,
        })
    }
}

/// To 2^-13, and in components that no product of two directions overflows with.
pub(super) fn is_unit(d: Dir) -> bool {
    d.0.iter().all(|c| c.unsigned_abs() <= 2 << 16) && (d.dot_q24(d) - (1 << 24)).abs() <= 1 << 12
}

fn mesh_of(geometry: &Geometry) -> Option<u16> {
    match geometry {
        Geometry::Mesh(mesh) => Some(*mesh),
        Geometry::Instance(instance) => Some(instance.mesh),
        _ => None,
    }
}

fn is_far(p: Point) -> bool {
    p.0.iter().any(|c| c.unsigned_abs() > REACH as u32)
}

/// Whether a grid holds a box, so far as that is within reach, with the margin by which the tree's boxes grow.
fn holds(grid: &Grid, low: Point, high: Point) -> bool {
    let first = grid.to_scene([SCENE_PAD; 3]);
    let last = grid.to_scene([u16::MAX - SCENE_PAD; 3]);
    (0..3).all(|i| first.0[i] <= low.0[i].max(-REACH) && high.0[i].min(REACH) <= last.0[i])
}

fn check_geometry(geometry: &Geometry, shape: u16, blobs: &[Blob]) -> Result<(), SceneError> {
    let far = |p: Point, reach: [i32; 3]| {
        p.0.iter()
            .zip(reach)
            .any(|(c, r)| c.unsigned_abs() as u64 + r.unsigned_abs() as u64 > REACH as u64)
    };
    let size = |r: i32| (1..=REACH).contains(&r);
    let (fits, extent) = match *geometry {
        Geometry::Sphere(s) => (!far(s.center, [s.radius; 3]), size(s.radius)),
        Geometry::Plane(p) => (!far(p.point, [0; 3]), is_unit(p.normal)),
        Geometry::Disk(d) => (!far(d.center, [d.radius; 3]), size(d.radius) && is_unit(d.normal)),
        Geometry::Rectangle(r) => {
            let [a, b] = r.half;
            let unit = is_unit(r.u) && is_unit(r.v) && is_unit(r.normal);
            // The normal is u × v, not its opposite.
            let square =
                || r.u.dot(r.v).abs() <= 16 && r.u.cross(r.v).is_some_and(|n| n.dot(r.normal) > ONE_Q16 - 16);
            (
                !far(r.center, rectangle_reach(&r)),
                size(a) && size(b) && unit && square(),
            )
        }
        Geometry::Implicit(solid) => {
            solid.check(blobs).map_err(|error| match error {
                ImplicitError::Degenerate => SceneError::Degenerate { shape },
                ImplicitError::Thin => SceneError::Thin { shape },
                ImplicitError::Blobs => SceneError::Blobs { shape },
            })?;
            let (low, high) = solid.bounds(blobs);
            let square = solid
                .axes()
                .is_none_or(|[x, y]| is_unit(x) && is_unit(y) && x.dot(y).abs() <= 16);
            (!is_far(low) && !is_far(high), square)
        }
        // Asked with its vertices.
        Geometry::Mesh(_) => (true, true),
        // Its mesh may lie far from its own frame's origin.
        Geometry::Instance(instance) => (
            instance
                .at
                .0
                .iter()
                .all(|c| c.unsigned_abs() <= (REACH as u32) << 5),
            instance.rotation.is_valid(),
        ),
    };
    if !extent {
        return Err(SceneError::Degenerate { shape });
    }
    if !fits {
        return Err(SceneError::TooFar { shape });
    }
    Ok(())
}
