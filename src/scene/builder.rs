use super::arrange::{Boxed, arrange};
use super::{Mesh, Parts, Scene, SceneError, Shape, Tint};
use crate::bvh::Node;
use crate::color::Radiance;
use crate::geom::Unit;
use crate::light::{Environment, Light};
use crate::material::{Material, Texture};
use crate::shape::{Blob, Geometry};
use heapless::Vec;

/// Names a material of a [`SceneBuilder`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaterialId(u16);

/// What a scene borrows beside what its builder holds.
#[derive(Clone, Copy, Debug, Default)]
pub struct Borrowed<'a> {
    /// Shapes name them as [`Geometry::Mesh`].
    pub meshes: &'a [Mesh<'a>],
    /// Shapes name them as [`Tint::Texture`].
    pub textures: &'a [Texture<'a>],
    /// What metaballs and smooth unions are made of.
    pub blobs: &'a [Blob],
    /// A sky or a map; a constant environment is a [`Light`].
    pub environment: Environment<'a>,
    /// How lights are chosen: [`super::Parts::choice`].
    pub choice: &'a [u32],
}

/// A scene on the stack: room for `SHAPES`, `MATERIALS` and `LIGHTS` (an emitting shape takes one of each).
#[derive(Clone, Debug)]
pub struct SceneBuilder<const SHAPES: usize, const MATERIALS: usize, const LIGHTS: usize> {
    unit: Unit,
    shapes: Vec<Shape, SHAPES>,
    materials: Vec<Material, MATERIALS>,
    lights: Vec<Light, LIGHTS>,
    environment: Option<Light>,
}

impl<const SHAPES: usize, const MATERIALS: usize, const LIGHTS: usize>
    SceneBuilder<SHAPES, MATERIALS, LIGHTS>
{
    const NO_ROOM_FOR_LIGHTS: SceneError = SceneError::Full {
        what: "lights",
        needed: LIGHTS + 1,
    };

    /// An empty scene in the default unit.
    pub const fn new() -> Self {
        Self::with_unit(Unit::DEFAULT)
    }

    /// An empty scene in a unit of one's own.
    pub const fn with_unit(unit: Unit) -> Self {
        SceneBuilder {
            unit,
            shapes: Vec::new(),
            materials: Vec::new(),
            lights: Vec::new(),
            environment: None,
        }
    }

    pub const fn unit(&self) -> Unit {
        self.unit
    }

    /// A material for shapes to name.
    pub fn material(&mut self, material: Material) -> Result<MaterialId, SceneError> {
        let id = self.materials.len();
        let full = |_| SceneError::Full {
            what: "materials",
            needed: MATERIALS + 1,
        };
        self.materials.push(material).map_err(full)?;
        Ok(MaterialId(id as u16))
    }

    /// A shape that does not emit light. Shapes are numbered as they come.
    pub fn shape(&mut self, geometry: impl Into<Geometry>, material: MaterialId) -> Result<(), SceneError> {
        self.push(geometry.into(), material, None)
    }

    /// A mesh, or an instance of one, in the colours of its vertices or of a texture.
    pub fn tinted(
        &mut self,
        geometry: impl Into<Geometry>,
        material: MaterialId,
        tint: Tint,
    ) -> Result<(), SceneError> {
        self.push(geometry.into(), material, None)?;
        if let Some(shape) = self.shapes.last_mut() {
            shape.tint = tint;
        }
        Ok(())
    }

    /// A shape that emits `radiance` on the side of its normal.
    pub fn emitter(
        &mut self,
        geometry: impl Into<Geometry>,
        material: MaterialId,
        radiance: Radiance,
    ) -> Result<(), SceneError> {
        let (shape, light) = (self.shapes.len() as u16, self.lights.len() as u16);
        if self.lights.is_full() {
            return Err(Self::NO_ROOM_FOR_LIGHTS);
        }
        self.push(geometry.into(), material, Some(light))?;
        self.light(Light::Area { shape, radiance })
    }

    /// A light that is no shape. An environment may be given once.
    pub fn light(&mut self, light: Light) -> Result<(), SceneError> {
        if matches!(light, Light::Environment { .. }) {
            if self.environment.replace(light).is_some() {
                return Err(SceneError::Environment {
                    light: self.lights.len() as u16,
                });
            }
            return Ok(());
        }
        self.lights.push(light).map_err(|_| Self::NO_ROOM_FOR_LIGHTS)
    }

    fn push(
        &mut self,
        geometry: Geometry,
        material: MaterialId,
        light: Option<u16>,
    ) -> Result<(), SceneError> {
        let id = self.shapes.len() as u16;
        let shape = Shape {
            geometry,
            material: material.0,
            light,
            tint: Tint::None,
            id,
        };
        self.shapes.push(shape).map_err(|_| SceneError::Full {
            what: "shapes",
            needed: SHAPES + 1,
        })
    }

    /// The border: builds the tree over the shapes in `nodes`, checks everything, and lends the scene out.
    ///
    /// [`crate::bvh::max_nodes`] says how many nodes are enough.
    pub fn build<'a>(&'a mut self, nodes: &'a mut [Node]) -> Result<Scene<'a>, SceneError> {
        self.build_with(&[], nodes)
    }

    /// The same with meshes, which shapes name as [`Geometry::Mesh`].
    pub fn build_with<'a>(
        &'a mut self,
        meshes: &'a [Mesh<'a>],
        nodes: &'a mut [Node],
    ) -> Result<Scene<'a>, SceneError> {
        let borrowed = Borrowed {
            meshes,
            ..Borrowed::default()
        };
        self.build_from(borrowed, nodes)
    }

    /// The same with all that can be borrowed.
    pub fn build_from<'a>(
        &'a mut self,
        borrowed: Borrowed<'a>,
        nodes: &'a mut [Node],
    ) -> Result<Scene<'a>, SceneError> {
        let Borrowed {
            meshes,
            textures,
            blobs,
            environment,
            choice,
        } = borrowed;
        if let Some(environment) = self.environment.take() {
            self.lights
                .push(environment)
                .map_err(|_| Self::NO_ROOM_FOR_LIGHTS)?;
        }
        let mut boxes = [Boxed::EMPTY; SHAPES];
        let found = arrange(
            &mut self.shapes,
            meshes,
            blobs,
            &mut self.lights,
            &mut boxes,
            nodes,
        )
        .map_err(|error| SceneError::Nodes { needed: error.needed })?;
        Scene::new(Parts {
            unit: self.unit,
            shapes: &self.shapes,
            bounded: found.bounded as u16,
            materials: &self.materials,
            lights: &self.lights,
            environment,
            choice,
            meshes,
            textures,
            blobs,
            grid: found.grid,
            nodes: nodes.get(..found.nodes).unwrap_or(&[]),
        })
    }
}

impl<const SHAPES: usize, const MATERIALS: usize, const LIGHTS: usize> Default
    for SceneBuilder<SHAPES, MATERIALS, LIGHTS>
{
    fn default() -> Self {
        Self::new()
    }
}
