//! What a scene is made of, and what it takes of a board.

use super::{Error, Options, integrator, sampler, settings};
use crate::desc::{SceneDesc, Vec3};
use crate::quantise::CoreScene;
use microlux::bvh::Node;
use microlux::color::Radiance;
use microlux::render::Renderer;

/// What a scene is made of once it is in the core's formats.
#[derive(Clone, Debug, PartialEq)]
pub struct Info {
    /// Primitives and instances of the scene itself.
    pub shapes: usize,
    pub meshes: usize,
    /// Triangles of all meshes.
    pub triangles: usize,
    pub materials: usize,
    pub lights: usize,
    /// BVH nodes of the scene and of its meshes.
    pub nodes: usize,
    /// Levels of the deepest way from the scene's root to a leaf.
    pub bvh_depth: usize,
    /// Corners of the box around everything finite, metres.
    pub bounds: [Vec3; 2],
    /// Metres of one step of the scene frame.
    pub unit: f64,
    /// Number formats by role, such as `("position", "i32, 2^-20 m")`.
    pub formats: Vec<(&'static str, String)>,
    /// Constant data (flash) by part.
    pub bytes_geometry: usize,
    pub bytes_bvh: usize,
    pub bytes_normals: usize,
    /// Materials, lights, and what else the parts above leave out.
    pub bytes_rest: usize,
    /// RAM by part for the given options, such as `("tile", 11520)`.
    pub ram: Vec<(&'static str, usize)>,
}

impl Info {
    pub fn bytes_total(&self) -> usize {
        self.bytes_geometry + self.bytes_bvh + self.bytes_normals + self.bytes_rest
    }

    pub fn ram_bytes(&self) -> usize {
        self.ram.iter().map(|&(_, bytes)| bytes).sum()
    }
}

/// What the scene becomes in the core's formats, and the RAM that rendering it with these options takes.
pub fn describe(desc: &SceneDesc, options: &Options) -> Result<Info, Error> {
    let core = CoreScene::new(desc)?;
    let lent = core.lend();
    let meshes = &lent.meshes;
    let scene = core.scene(&lent)?;
    let parts = scene.parts();
    let mesh_nodes: usize = meshes.iter().map(|mesh| mesh.nodes.len()).sum();
    let nodes = parts.nodes.len() + mesh_nodes;
    let bits = core.unit.fraction_bits();
    let renderer = Renderer::new(
        &scene,
        core.camera,
        integrator(desc, options),
        sampler(options),
        settings(options),
    );
    let plain = meshes.iter().filter_map(|mesh| mesh.triangles.plain());
    let bytes_normals = plain.map(|mesh| size_of_val(mesh.attributes.normals)).sum();
    let bytes_textures: usize = lent.textures.iter().map(|texture| texture.bytes()).sum();
    Ok(Info {
        shapes: parts.shapes.len(),
        meshes: meshes.len(),
        triangles: meshes.iter().map(|mesh| mesh.triangles.count()).sum(),
        materials: parts.materials.len(),
        lights: parts.lights.len(),
        nodes,
        bvh_depth: scene.depth(),
        bounds: core.bounds(desc),
        unit: f64::from(-bits).exp2(),
        formats: vec![
            ("position", format!("i32, steps of 2^{} m", -bits)),
            ("mesh vertex", "3 × u16 in the mesh's own cube".to_string()),
            ("direction", "3 × I16F16".to_string()),
            ("radiance", "3 × u16 mantissa, i16 exponent".to_string()),
            ("density", "u16 mantissa, i16 exponent".to_string()),
        ],
        bytes_geometry: size_of_val(parts.shapes)
            + meshes.iter().map(|mesh| mesh.triangles.bytes()).sum::<usize>()
            - bytes_normals,
        bytes_bvh: nodes * size_of::<Node>(),
        bytes_normals,
        bytes_rest: size_of_val(parts.materials)
            + size_of_val(parts.lights)
            + core.map_bytes()
            + bytes_textures
            + size_of_val(&scene),
        ram: vec![
            (
                "tile",
                (options.width * options.tile_height) as usize * size_of::<Radiance>(),
            ),
            ("renderer", size_of_val(&renderer)),
        ],
    })
}
