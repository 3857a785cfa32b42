//! One render of a scene: what may be asked for, what comes back, and the three questions put to it.

use std::sync::atomic::AtomicBool;

use crate::desc::{IntegratorKind, SamplerKind, SceneDesc, Vec3};
use crate::metrics::Percentiles;
use crate::show::DisplayKind;

pub use crate::picture::{Aov, Picture};

/// Samples a pixel where neither the scene nor the user names a number.
pub const DEFAULT_SPP: u32 = 64;
/// Rows rendered at a time where the user names no number.
pub const DEFAULT_TILE_HEIGHT: u32 = 8;
/// Widest and highest picture, in pixels: three `f32` each still fit into 1 GiB.
pub const MAX_SIDE: u32 = 8192;

/// Everything a render depends on beside the scene. The picture depends on all but `threads` and `tile_height`.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    pub width: u32,
    pub height: u32,
    /// Samples a pixel.
    pub spp: u32,
    pub integrator: IntegratorKind,
    /// Paths of at most this many segments; `None`: roulette alone ends them.
    pub max_depth: Option<u32>,
    pub sampler: SamplerKind,
    pub seed: u32,
    pub threads: usize,
    /// Rows rendered at a time.
    pub tile_height: u32,
    /// Stops of exposure for the display (`x * 2^exposure`); `Picture::rgb` is left as it is.
    pub exposure: f64,
    /// The display that `Picture::display` is drawn on.
    pub display: Option<DisplayKind>,
    /// Whether `Picture::aov` is wanted.
    pub aov: bool,
}

impl Options {
    /// What the scene asks for, else the defaults: 64 samples a pixel, stratified, seed 0, every core, 8 rows a tile.
    pub fn for_scene(desc: &SceneDesc) -> Options {
        Options {
            width: desc.width,
            height: desc.height,
            spp: desc.spp.unwrap_or(DEFAULT_SPP),
            integrator: desc.integrator.kind,
            max_depth: desc.integrator.max_depth,
            sampler: desc.sampler.unwrap_or(SamplerKind::Stratified),
            seed: 0,
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            tile_height: DEFAULT_TILE_HEIGHT,
            exposure: 0.0,
            display: None,
            aov: false,
        }
    }
}

/// What a render cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stats {
    /// Rays asked of the scene: nearest hits and shadow tests together.
    pub rays: u64,
    /// Wall clock of the rendering alone.
    pub seconds: f64,
}

impl Stats {
    /// 0 where no time could be measured.
    pub fn rays_per_second(&self) -> f64 {
        if self.seconds > 0.0 { self.rays as f64 / self.seconds } else { 0.0 }
    }
}

/// Where a render tells how far it is. Called from any thread, tiles in any order.
pub trait Progress: Sync {
    /// So far `done` of `total` tiles are ready and `rays` rays were traced.
    fn advance(&self, done: usize, total: usize, rays: u64);

    /// Rows from `first_row` on as the display shows them (plain sRGB without one), for a live picture.
    fn rows(&self, _first_row: usize, _rgb8: &[[u8; 3]]) {}
}

/// Tells nobody.
impl Progress for () {
    fn advance(&self, _done: usize, _total: usize, _rays: u64) {}
}

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// `cancel` was set; it is looked at before every tile.
    #[error("stopped")]
    Cancelled,
    /// The scene cannot be rendered: one line that names the offender and what would have been right.
    #[error("{0}")]
    Scene(String),
}

/// How far the fixed-point primary rays are from the f64 ones.
#[derive(Clone, Debug, PartialEq)]
pub struct PrimaryReport {
    pub rays: u64,
    /// Share of the rays where one side hits and the other misses.
    pub hit_miss_disagreement: f64,
    /// Distance between the two hit points where both hit, as a share of the scene's extent.
    pub hit_point_error: Percentiles,
    /// The same without the pixels whose 3×3 neighbourhood has a depth discontinuity in the f64 picture.
    pub hit_point_error_away: Percentiles,
}

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

/// The picture as the board computes it: fixed point throughout.
pub fn render_fixed(
    desc: &SceneDesc,
    options: &Options,
    progress: &dyn Progress,
    cancel: &AtomicBool,
) -> Result<(Picture, Stats), Error> {
    let _ = (desc, options, progress, cancel);
    Err(unconnected())
}

/// The picture as the independent f64 renderer sees it; without `aov` and `display`.
pub fn render_reference(
    desc: &SceneDesc,
    options: &Options,
    progress: &dyn Progress,
    cancel: &AtomicBool,
) -> Result<(Picture, Stats), Error> {
    let _ = (desc, options, progress, cancel);
    Err(unconnected())
}

/// One primary ray through the middle of each pixel, in both arithmetics.
pub fn compare_primary_rays(desc: &SceneDesc, options: &Options, cancel: &AtomicBool) -> Result<PrimaryReport, Error> {
    let _ = (desc, options, cancel);
    Err(unconnected())
}

/// What the scene becomes in the core's formats, and the RAM that rendering it with these options takes.
pub fn describe(desc: &SceneDesc, options: &Options) -> Result<Info, Error> {
    let _ = (desc, options);
    Err(unconnected())
}

fn unconnected() -> Error {
    Error::Scene("this build has no renderer; take one in which run.rs is connected".to_string())
}
