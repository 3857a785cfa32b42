//! What the boards show: scenes that stay in memory while they are drawn.

#[cfg(not(feature = "roomy"))]
use microlux::scene::Mesh;
#[cfg(feature = "roomy")]
use microlux::scene::{Room, Whole};
use microlux::{
    bvh::{Node, max_nodes},
    camera::Camera,
    scene::{Baked, BakedError, Scene, SceneBuilder, SceneError, builtin},
};

#[cfg(not(feature = "roomy"))]
#[path = "../../bake/src/pedestal.rs"]
mod pedestal;

/// Scenes by the name that the firmware prints, in the order in which it shows them.
pub const NAMES: [&str; 2] = ["cornell", "mesh"];

/// What is counted stage by stage: those scenes, and the Cornell box by paths of up to five segments.
pub const COUNTED: [&str; 3] = [NAMES[0], NAMES[1], "paths"];

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

/// Room for the scene that the firmware carries: a mesh on a floor, a lamp, a dim sky.
#[cfg(feature = "roomy")]
pub struct Pedestal<'m> {
    baked: Baked<'m>,
    room: Room<'m, 3, 3, 2, 1>,
}

#[cfg(feature = "roomy")]
impl<'m> Pedestal<'m> {
    /// Of what `firmware-bake` made.
    pub const fn new(baked: Baked<'m>) -> Pedestal<'m> {
        Pedestal {
            baked,
            room: Room::new(),
        }
    }

    pub fn scene(&mut self) -> Result<(Scene<'_>, Camera), BakedError> {
        let Whole { scene, shot } = self.baked.scene(&mut self.room)?;
        Ok((scene, shot.camera))
    }
}

/// The same without what opens whole scenes, 9 KiB of flash: of the baked one's mesh alone.
#[cfg(not(feature = "roomy"))]
pub struct Pedestal<'m> {
    baked: Baked<'m>,
    meshes: Option<[Mesh<'m>; 1]>,
    builder: pedestal::Builder,
    nodes: [Node; max_nodes(3)],
}

#[cfg(not(feature = "roomy"))]
impl<'m> Pedestal<'m> {
    pub const fn new(baked: Baked<'m>) -> Pedestal<'m> {
        Pedestal {
            baked,
            meshes: None,
            builder: pedestal::Builder::new(),
            nodes: [Node::EMPTY; max_nodes(3)],
        }
    }

    pub fn scene(&mut self) -> Result<(Scene<'_>, Camera), BakedError> {
        let (builder, camera) = pedestal::pedestal().map_err(BakedError::Scene)?;
        self.builder = builder;
        let meshes = self.meshes.insert([self.baked.mesh(0)?]);
        let scene = self.builder.build_with(meshes, &mut self.nodes);
        Ok((scene.map_err(BakedError::Scene)?, camera))
    }
}
