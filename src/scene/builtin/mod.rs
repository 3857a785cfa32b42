//! Small scenes that come with the crate: for a first picture, for demonstrations, and to hold every target to the
//! same bits (`tests/golden.txt`).
//!
//! Each is made by a function of its own, so that a program carries only those it names; [`Builtin`] names all.

mod cornell;
mod implicits;
mod map;
mod materials;
mod mesh;
mod sky;
mod spheres;
mod torus;

use super::{Borrowed, Scene, SceneError};
use crate::bvh::{Node, max_nodes};
use crate::camera::Camera;
use crate::geom::{Dir, Point};
use crate::light::Environment;
use crate::num::Turn;

pub use cornell::cornell;
pub use implicits::{blobs, implicits};
pub use map::studio;
pub use materials::materials;
pub use mesh::OwnedMesh;
pub use sky::{open, sky};
pub use spheres::spheres;
pub use torus::{Lamp, Torus, lamp, torus, torus_mesh};

/// A built-in scene, chosen at run time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Builtin {
    /// See [`cornell`].
    Cornell,
    /// See [`spheres`].
    Spheres,
    /// See [`torus`].
    Torus,
    /// See [`materials`].
    Materials,
    /// [`open`] under [`sky`].
    Sky,
    /// [`open`] in [`studio`], an environment map.
    Map,
    /// See [`implicits`].
    Implicits,
}

impl Builtin {
    pub const ALL: [Builtin; 7] = [
        Builtin::Cornell,
        Builtin::Spheres,
        Builtin::Torus,
        Builtin::Materials,
        Builtin::Sky,
        Builtin::Map,
        Builtin::Implicits,
    ];

    pub const fn name(self) -> &'static str {
        match self {
            Builtin::Cornell => "cornell",
            Builtin::Spheres => "spheres",
            Builtin::Torus => "torus",
            Builtin::Materials => "materials",
            Builtin::Sky => "sky",
            Builtin::Map => "map",
            Builtin::Implicits => "implicits",
        }
    }

    /// The scene of that name.
    pub fn named(name: &str) -> Option<Builtin> {
        Builtin::ALL.into_iter().find(|scene| scene.name() == name)
    }

    /// Builds the scene on the stack and lends it out with its camera. The torus takes most: 3.2 KiB of meshes.
    pub fn with<R>(self, render: impl FnOnce(&Scene, Camera) -> R) -> Result<R, SceneError> {
        match self {
            Builtin::Cornell => with_cornell(render),
            Builtin::Spheres => with_spheres(render),
            Builtin::Torus => with_torus(render),
            Builtin::Materials => with_materials(render),
            Builtin::Sky => with_open(Environment::Sky(&sky()), render),
            Builtin::Map => with_open(studio().map_or(Environment::None, Environment::Map), render),
            Builtin::Implicits => with_implicits(render),
        }
    }
}

/// From `eye` at `target`, y up.
fn look(eye: Point, target: Point, field_of_view: Turn) -> Camera {
    let half = Camera::tan_half(field_of_view);
    let camera = Camera::look_at(eye, target, Dir::Y.0, half);
    camera.unwrap_or(Camera::from_frame(eye, [Dir::X, Dir::Y, -Dir::Z], half))
}

// Not inlined into one another: each has a stack frame for its own scene alone.

#[inline(never)]
fn with_cornell<R>(render: impl FnOnce(&Scene, Camera) -> R) -> Result<R, SceneError> {
    let (mut builder, camera) = cornell()?;
    let mut nodes = [Node::EMPTY; max_nodes(16)];
    Ok(render(&builder.build(&mut nodes)?, camera))
}

#[inline(never)]
fn with_spheres<R>(render: impl FnOnce(&Scene, Camera) -> R) -> Result<R, SceneError> {
    let (mut builder, camera) = spheres()?;
    let mut nodes = [Node::EMPTY; max_nodes(10)];
    Ok(render(&builder.build(&mut nodes)?, camera))
}

#[inline(never)]
fn with_torus<R>(render: impl FnOnce(&Scene, Camera) -> R) -> Result<R, SceneError> {
    let (mut builder, camera) = torus()?;
    let (ring, lamp) = (torus_mesh()?, lamp()?);
    let meshes = [ring.mesh(), lamp.mesh()];
    let mut nodes = [Node::EMPTY; max_nodes(3)];
    Ok(render(&builder.build_with(&meshes, &mut nodes)?, camera))
}

#[inline(never)]
fn with_materials<R>(render: impl FnOnce(&Scene, Camera) -> R) -> Result<R, SceneError> {
    let (mut builder, camera) = materials()?;
    let mut nodes = [Node::EMPTY; max_nodes(12)];
    Ok(render(&builder.build(&mut nodes)?, camera))
}

#[inline(never)]
fn with_open<R>(environment: Environment, render: impl FnOnce(&Scene, Camera) -> R) -> Result<R, SceneError> {
    let (mut builder, camera) = open()?;
    let mut nodes = [Node::EMPTY; max_nodes(5)];
    let borrowed = Borrowed {
        environment,
        ..Borrowed::default()
    };
    Ok(render(&builder.build_from(borrowed, &mut nodes)?, camera))
}

#[inline(never)]
fn with_implicits<R>(render: impl FnOnce(&Scene, Camera) -> R) -> Result<R, SceneError> {
    let (mut builder, camera) = implicits()?;
    let blobs = blobs();
    let mut nodes = [Node::EMPTY; max_nodes(8)];
    let borrowed = Borrowed {
        blobs: &blobs,
        ..Borrowed::default()
    };
    Ok(render(&builder.build_from(borrowed, &mut nodes)?, camera))
}
