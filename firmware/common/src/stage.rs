//! What the boards show: scenes that stay in memory while they are drawn.

use microlux::{
    bvh::{Node, max_nodes},
    camera::Camera,
    color::{Radiance, albedo},
    geom::{Dir, point},
    light::Light,
    material::Material,
    num::{Share, Turn},
    q,
    scene::{Mesh, Scene, SceneBuilder, SceneError, builtin},
    shape::{Geometry, Rectangle},
};

/// Scenes by the name that the firmware prints, in the order in which it shows them.
pub const NAMES: [&str; 2] = ["cornell", "mesh"];

/// A scene with the camera that looks at it.
#[derive(Clone, Copy)]
pub struct Stage<'s> {
    pub scene: &'s Scene<'s>,
    pub camera: Camera,
}

/// Room for the Cornell box, in a variable of the program's.
pub struct Cornell {
    builder: SceneBuilder<16, 4, 1>,
    camera: Camera,
    nodes: [Node; max_nodes(16)],
}

impl Cornell {
    pub fn new() -> Result<Cornell, SceneError> {
        let (builder, camera) = builtin::cornell()?;
        Ok(Cornell {
            builder,
            camera,
            nodes: [Node::EMPTY; max_nodes(16)],
        })
    }

    pub fn scene(&mut self) -> Result<(Scene<'_>, Camera), SceneError> {
        Ok((self.builder.build(&mut self.nodes)?, self.camera))
    }
}

/// Room for the mesh's surroundings: a floor, a lamp, a dim sky.
pub struct Pedestal<'m> {
    builder: SceneBuilder<3, 3, 2>,
    camera: Camera,
    meshes: [Mesh<'m>; 1],
    nodes: [Node; max_nodes(3)],
}

impl<'m> Pedestal<'m> {
    /// Puts up a mesh in the cube of [`crate::mesh::mesh`].
    pub fn new(mesh: Mesh<'m>) -> Result<Pedestal<'m>, SceneError> {
        let mut b = SceneBuilder::new();
        let unit = b.unit();
        let gray = albedo(q!(0.5, Share), q!(0.5, Share), q!(0.5, Share));
        let floor = b.material(Material::lambert(gray))?;
        let clay = albedo(q!(0.66, Share), q!(0.40, Share), q!(0.24, Share));
        let clay = b.material(Material::lambert(clay))?;
        let black = b.material(Material::Black)?;
        let ground = Rectangle {
            center: point(q!(0), q!(0), q!(0)),
            u: Dir::Z,
            v: Dir::X,
            normal: Dir::Y,
            half: [unit.length(q!(4)); 2],
        };
        let lamp = Rectangle {
            center: point(q!(0.4), q!(3.2), q!(1.2)),
            u: Dir::X,
            v: Dir::Z,
            normal: -Dir::Y,
            half: [unit.length(q!(0.5)); 2],
        };
        b.shape(ground, floor)?;
        b.shape(Geometry::Mesh(0), clay)?;
        b.emitter(lamp, black, Radiance::new(q!(17), q!(15.5), q!(13)))?;
        b.light(Light::Environment {
            radiance: Radiance::new(q!(0.1), q!(0.12), q!(0.15)),
        })?;
        let camera = Camera::from_frame(
            point(q!(0), q!(0.95), q!(4.4)),
            [Dir::X, Dir::Y, -Dir::Z],
            Camera::tan_half(q!(0.09, Turn)),
        );
        Ok(Pedestal {
            builder: b,
            camera,
            meshes: [mesh],
            nodes: [Node::EMPTY; max_nodes(3)],
        })
    }

    pub fn scene(&mut self) -> Result<(Scene<'_>, Camera), SceneError> {
        let scene = self.builder.build_with(&self.meshes, &mut self.nodes)?;
        Ok((scene, self.camera))
    }
}
