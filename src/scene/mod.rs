//! The scene: borrowed, checked once at [`Scene::new`], then safe to render.
//!
//! What its words mean, here as in Mitsuba 3: right-handed coordinates. A path of n segments meets n − 1 surfaces before
//! the one it ends on: depth 1 is emission, 2 direct light. Pixel (x, y) covers [x, x + 1) × [y, y + 1), y down. An
//! area light emits on the side of its normal, spheres outwards; a dielectric's inside is where its normal does not
//! point. Light is W·sr⁻¹·m⁻² a channel, linear sRGB; a point light's intensity falls off by 1/d², d in metres; a
//! directional light is irradiance on a plane that faces it.

mod ahead;
mod arrange;
mod baked;
mod builder;
pub mod builtin;
mod cells;
mod check;
mod distant;
mod emit;
mod lights;
mod power;
mod prospect;
mod query;
mod vertex;

use crate::bvh::Node;
use crate::geom::Unit;
use crate::light::{Environment, Light};
use crate::material::{Material, Texture};
use crate::shape::{Blob, Geometry, Grid, Triangles};

use cells::Cells;
use distant::Ball;

pub use ahead::{Ahead, ShapeSet};
pub use arrange::{Arrangement, Boxed, arrange};
pub use baked::{
    Background, Baked, BakedError, BlobRecord, Entry as BakedEntry, Field as BakedField, Head as BakedHead,
    LightRecord, MapRecord, MaterialRecord, Records, Room, ShapeRecord, Shot, SkyRecord, Technique,
    TextureRecord, Whole, WholeHead,
};
pub use builder::{Borrowed, MaterialId, SceneBuilder};
pub use cells::Cell;
pub use check::SceneError;
pub use prospect::Prospect;
pub use query::Seen;
pub use vertex::{Told, Vertex};

/// A shape with what it is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    pub geometry: Geometry,
    /// Index into the scene's materials.
    pub material: u16,
    /// Index of the area light that the shape is.
    pub light: Option<u16>,
    pub tint: Tint,
    /// The user's number for it: what errors and the `id` layer name.
    pub id: u16,
}

/// What the material's own colour is multiplied by ([`Material::tinted`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tint {
    #[default]
    None,
    /// The colours of the mesh's vertices.
    Vertices,
    /// Index into the scene's textures; the mesh's vertices say where in it they are.
    Texture(u16),
}

/// A triangle mesh with the tree over it.
#[derive(Clone, Copy, Debug)]
pub struct Mesh<'a> {
    pub triangles: Triangles<'a>,
    pub nodes: &'a [Node],
}

/// What a scene is made of; [`Scene::new`] checks it.
#[derive(Clone, Copy, Debug)]
pub struct Parts<'a> {
    pub unit: Unit,
    /// Finite ones first, in the order of the tree over them ([`arrange`]), then infinite planes.
    pub shapes: &'a [Shape],
    /// How many shapes are finite.
    pub bounded: u16,
    pub materials: &'a [Material],
    /// A constant environment, if there is one, last.
    pub lights: &'a [Light],
    /// Any other environment: the last of the lights to choose from.
    pub environment: Environment<'a>,
    /// How lights are chosen: bounds between them, in 2^-32 and rising, one fewer than there are lights to choose from
    /// ([`Scene::choose_by_power`] makes them); evenly if there are none.
    pub choice: &'a [u32],
    pub meshes: &'a [Mesh<'a>],
    pub textures: &'a [Texture<'a>],
    /// What metaballs and smooth unions are made of.
    pub blobs: &'a [Blob],
    /// Around the finite shapes.
    pub grid: Grid,
    /// The tree over the finite shapes.
    pub nodes: &'a [Node],
}

/// A scene that can be rendered: everything in it was checked.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    parts: Parts<'a>,
    /// How many lights are drawn from; a constant environment stands after them.
    light_count: u32,
    environment: Environment<'a>,
    depth: usize,
    /// Around the finite shapes.
    ball: Option<Ball>,
    cells: Cells<'a>,
}

/// Where a ray met something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hit {
    /// Distance along the ray, units.
    pub t: i32,
    /// Index into the scene's shapes.
    pub shape: u16,
    /// Number of the triangle, in a mesh.
    pub triangle: u32,
    /// Weights of the triangle's second and third corner, Q16.
    pub barycentric: [i32; 2],
}

impl<'a> Scene<'a> {
    pub fn unit(&self) -> Unit {
        self.parts.unit
    }

    pub fn parts(&self) -> &Parts<'a> {
        &self.parts
    }

    /// Levels of nodes on the longest way from the scene's root to a leaf, the mesh's own included.
    pub fn depth(&self) -> usize {
        self.depth
    }
}
