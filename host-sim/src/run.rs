//! One render of a scene: what may be asked for, what comes back, and the three questions put to it.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::time::Instant;

use crate::bake::Aligned;
use crate::clean::{self, Cleaning, Frames};
use crate::dequantise::{self, Frame};
use crate::desc::{IntegratorKind, SamplerKind, SceneDesc};
use crate::expose::SharedExposure;
use crate::quantise::{CoreScene, Lent, QuantiseError};
use crate::show::{self, DisplayKind, Look};
use crate::{primary, reference};
use embedded_graphics::geometry::{Point, Size};
use embedded_graphics::primitives::{PointsIter, Rectangle};
use microlux::color::Radiance;
use microlux::film::Tile;
use microlux::integrator::{AmbientOcclusion, Bdpt, Integrator, LightTracer, Path};
use microlux::render::{Renderer, Settings};
use microlux::sampler::{AnySampler, Cmj, Independent, PcgRxsMXs32, Sampler, Sobol, Stratified, ZSobol};
use microlux::scene::{Baked, BakedError, Cell, Scene};
use rayon::prelude::*;

mod info;

pub use crate::picture::{Aov, Picture};
pub use crate::primary::PrimaryReport;
pub use info::{Info, describe};

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
    /// Whether `Bdpt` is to do without a whole frame, as on a board that has no memory for one, and with a board's
    /// memory for vertices.
    pub tiles: bool,
    /// Paths of at most this many segments; `None`: roulette alone ends them.
    pub max_depth: Option<u32>,
    pub sampler: SamplerKind,
    pub seed: u32,
    pub threads: usize,
    /// Rows rendered at a time.
    pub tile_height: u32,
    /// Exposure and tone map of display and PNG; `Picture::rgb` is left as it is.
    pub look: Look,
    /// The display that `Picture::display` is drawn on; plain sRGB if there is none.
    pub display: Option<DisplayKind>,
    /// Whether `Picture::aov` is wanted.
    pub aov: bool,
    /// What is done about noise; of `width` and `height` only a part is rendered where it makes pictures larger.
    pub cleaning: Cleaning,
}

impl Options {
    /// What the scene asks for, else the defaults: 64 samples a pixel, stratified, seed 0, every core, 8 rows a tile.
    pub fn for_scene(desc: &SceneDesc) -> Options {
        Options {
            width: desc.width,
            height: desc.height,
            spp: desc.spp.unwrap_or(DEFAULT_SPP),
            integrator: desc.integrator.kind,
            tiles: false,
            max_depth: desc.integrator.max_depth,
            sampler: SamplerKind::Stratified,
            seed: 0,
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            tile_height: DEFAULT_TILE_HEIGHT,
            look: Look::default(),
            display: None,
            aov: false,
            cleaning: Cleaning::default(),
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
        if self.seconds > 0.0 {
            self.rays as f64 / self.seconds
        } else {
            0.0
        }
    }
}

/// Where a render tells how far it is. Called from any thread, tiles in any order.
pub trait Progress: Sync {
    /// So far `done` of `total` tiles are ready and `rays` rays were traced.
    fn advance(&self, done: usize, total: usize, rays: u64);

    /// Whether [`Self::rows`] should be called.
    fn wants_rows(&self) -> bool {
        false
    }

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

/// The picture as the board computes it: fixed point throughout.
pub fn render_fixed(
    desc: &SceneDesc,
    options: &Options,
    progress: &dyn Progress,
    cancel: &AtomicBool,
) -> Result<(Picture, Stats), Error> {
    let core = CoreScene::new(desc)?;
    render_core(desc, &core, &core.lend(), options, progress, cancel)
}

/// The same with the scene's meshes as they were baked.
pub fn render_baked(
    desc: &SceneDesc,
    blob: &[u8],
    options: &Options,
    progress: &dyn Progress,
    cancel: &AtomicBool,
) -> Result<(Picture, Stats), Error> {
    let wrong = |error: BakedError| Error::Scene(error.to_string());
    let bytes = Aligned::new(blob);
    let baked = Baked::open(bytes.bytes()).map_err(wrong)?;
    let meshes: Result<Vec<_>, _> = (0..baked.count()).map(|index| baked.mesh(index)).collect();
    let core = CoreScene::new(desc)?;
    let lent = Lent {
        meshes: meshes.map_err(wrong)?,
        ..core.lend()
    };
    render_core(desc, &core, &lent, options, progress, cancel)
}

fn render_core(
    desc: &SceneDesc,
    core: &CoreScene,
    lent: &Lent,
    options: &Options,
    progress: &dyn Progress,
    cancel: &AtomicBool,
) -> Result<(Picture, Stats), Error> {
    let path = integrator(desc, options);
    let mut cells = cells(options, path);
    let scene = core.scene(lent)?.foresee(&mut cells);
    let job = Job {
        core,
        scene: &scene,
        sampler: sampler(options),
        options,
        progress,
        cancel,
        done: AtomicUsize::new(0),
        rays: AtomicU64::new(0),
    };
    let started = Instant::now();
    let pixels = match options.integrator {
        _ if options.cleaning.is_on() => self::path(desc, options).and_then(|path| job.cleaned(path)),
        IntegratorKind::Direct | IntegratorKind::Path => job.in_tiles(path),
        IntegratorKind::Ao => job.in_tiles(AmbientOcclusion {
            radius: ao_radius(desc, core),
        }),
        IntegratorKind::Bdpt if options.tiles => job.in_tiles(Bdpt::<BOARD_VERTICES> {
            max_depth: path.max_depth,
            rr_depth: path.rr_depth,
            hide_emitters: path.hide_emitters,
        }),
        IntegratorKind::Bdpt => job.in_a_frame(Bdpt::<HOST_VERTICES> {
            max_depth: path.max_depth,
            rr_depth: path.rr_depth,
            hide_emitters: path.hide_emitters,
        }),
        IntegratorKind::Light if options.tiles => Err(Error::Scene(
            "light arrives anywhere in the picture: it needs a whole frame, so leave out --tiles".into(),
        )),
        IntegratorKind::Light => job.in_a_frame(LightTracer {
            max_depth: path.max_depth,
            rr_depth: path.rr_depth,
            hide_emitters: path.hide_emitters,
        }),
    }?;
    let stats = Stats {
        rays: job.rays.into_inner(),
        seconds: started.elapsed().as_secs_f64(),
    };
    let rgb = pixels
        .iter()
        .map(|p| dequantise::radiance(*p).map(|c| c as f32))
        .collect();
    let aov = if options.aov {
        let renderer = Renderer::new(
            &scene,
            core.camera,
            path,
            Independent::<PcgRxsMXs32>::new(0),
            settings(options),
        );
        Some(layers(core, &renderer, options))
    } else {
        None
    };
    let size = Size::new(options.width, options.height);
    let whole = Tile {
        area: Rectangle::new(Point::zero(), size),
        pixels: &pixels,
    };
    let display = Some(show::tiles(options.width, [whole], options.display, options.look));
    let picture = Picture {
        width: options.width as usize,
        height: options.height as usize,
        rgb,
        aov,
        display,
    };
    Ok((picture, stats))
}

/// A picture being made of the core's scene, whichever integrator makes it.
struct Job<'a> {
    core: &'a CoreScene,
    scene: &'a Scene<'a>,
    sampler: AnySampler,
    options: &'a Options,
    progress: &'a dyn Progress,
    cancel: &'a AtomicBool,
    /// Tiles, and what was asked of the scene for them.
    done: AtomicUsize,
    rays: AtomicU64,
}

impl<'a> Job<'a> {
    /// One frame, denoised.
    fn cleaned(&self, path: Path) -> Result<Vec<Radiance>, Error> {
        let (IntegratorKind::Direct | IntegratorKind::Path) = self.options.integrator else {
            return Err(Error::Scene(
                "only direct and path can be denoised; leave out --integrator, --denoise and --upscale"
                    .into(),
            ));
        };
        let frames = frames(self.options)?;
        let frame = || {
            clean::sequence(frames, |sequence| {
                let rows = frames.rows();
                let advance = |rays| {
                    let rays = self.rays.fetch_add(rays, Ordering::Relaxed) + rays;
                    let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
                    self.progress.advance(done, rows, rays);
                    !self.cancel.load(Ordering::Relaxed)
                };
                sequence.frame(self.scene, self.core.camera, path, &self.sampler, &advance)
            })
        };
        let frame = pool(self.options.threads)?.install(frame);
        frame.map(|(pixels, _)| pixels).ok_or(Error::Cancelled)
    }

    /// Each tile by itself, as on a board.
    fn in_tiles<I: Integrator + Copy + Sync>(&self, integrator: I) -> Result<Vec<Radiance>, Error> {
        let strips = self.tiles(integrator, |renderer, area| {
            let mut strip = vec![Radiance::BLACK; (area.size.width * area.size.height) as usize];
            renderer.tile(area, &mut strip);
            strip
        })?;
        Ok(strips.concat())
    }

    /// Into a whole frame, where light may arrive in any pixel.
    fn in_a_frame<I: Integrator + Copy + Sync>(&self, integrator: I) -> Result<Vec<Radiance>, Error> {
        let (width, height) = (self.options.width, self.options.height);
        let frame = SharedExposure::new(width as u16, height as u16);
        self.tiles(integrator, |renderer, area| {
            let mut splats = &frame;
            for place in area.points() {
                renderer.expose(place.x as u16, place.y as u16, &mut splats);
            }
            // So far: what else arrives there is yet to come.
            let from = area.top_left.y as usize * width as usize;
            frame.means(
                from,
                (area.size.width * area.size.height) as usize,
                self.options.spp,
            )
        })?;
        Ok(frame.means(0, (width * height) as usize, self.options.spp))
    }

    /// What `render` makes of each tile, on all threads, from top to bottom.
    fn tiles<I: Integrator + Copy + Sync>(
        &self,
        integrator: I,
        render: impl Fn(&mut Renderer<'a, AnySampler, I>, Rectangle) -> Vec<Radiance> + Sync,
    ) -> Result<Vec<Vec<Radiance>>, Error> {
        let options = self.options;
        let rows = options.tile_height.max(1);
        let (tile_pixels, tiles) = (options.width * rows, options.height.div_ceil(rows));
        let render_tile = |number: u32| {
            if self.cancel.load(Ordering::Relaxed) {
                return Err(Error::Cancelled);
            }
            let sampler = self.sampler.clone();
            let mut renderer = Renderer::new(
                self.scene,
                self.core.camera,
                integrator,
                sampler,
                settings(options),
            );
            let Some(area) = renderer.area(number * tile_pixels, tile_pixels) else {
                return Ok(Vec::new());
            };
            let strip = render(&mut renderer, area);
            let more = u64::from(renderer.rays());
            let rays = self.rays.fetch_add(more, Ordering::Relaxed) + more;
            let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
            self.progress.advance(done, tiles as usize, rays);
            if self.progress.wants_rows() {
                let tile = Tile { area, pixels: &strip };
                let shown = show::tiles(options.width, [tile], options.display, options.look);
                self.progress.rows(area.top_left.y as usize, &shown);
            }
            Ok(strip)
        };
        pool(options.threads)?.install(|| (0..tiles).into_par_iter().map(render_tile).collect())
    }
}

/// The picture as the independent f64 renderer sees it; without `aov` and `display`.
///
/// It renders the scene as the core's integers say it.
pub fn render_reference(
    desc: &SceneDesc,
    options: &Options,
    progress: &dyn Progress,
    cancel: &AtomicBool,
) -> Result<(Picture, Stats), Error> {
    let scene = dequantise::scene(&CoreScene::new(desc)?)?;
    let path = integrator(desc, options);
    let settings = reference::Settings {
        width: options.width,
        height: options.height,
        spp: options.spp,
        max_depth: (path.max_depth < UNLIMITED).then_some(u32::from(path.max_depth)),
        rr_depth: u32::from(path.rr_depth),
        hide_emitters: path.hide_emitters,
        seed: u64::from(options.seed),
        estimator: match options.integrator {
            IntegratorKind::Ao => reference::Estimator::AmbientOcclusion {
                radius: desc.integrator.ao_radius.unwrap_or(f64::INFINITY),
            },
            _ => reference::Estimator::Guided,
        },
    };
    let rows = options.height as usize;
    let started = Instant::now();
    let rendering = pool(options.threads)?
        .install(|| reference::render(&scene, &settings, &|done| progress.advance(done, rows, 0), cancel))
        .ok_or(Error::Cancelled)?;
    let stats = Stats {
        rays: rendering.rays,
        seconds: started.elapsed().as_secs_f64(),
    };
    let rgb = rendering
        .image
        .pixels
        .iter()
        .map(|p| p.map(|c| c as f32))
        .collect();
    let (width, height) = (options.width as usize, options.height as usize);
    Ok((
        Picture {
            width,
            height,
            rgb,
            aov: None,
            display: None,
        },
        stats,
    ))
}

/// A grid of primary rays through each pixel, in both arithmetics.
pub fn compare_primary_rays(
    desc: &SceneDesc,
    options: &Options,
    cancel: &AtomicBool,
) -> Result<PrimaryReport, Error> {
    let core = CoreScene::new(desc)?;
    let compare = || primary::compare(&core, options.width, options.height, cancel);
    pool(options.threads)?.install(compare)?.ok_or(Error::Cancelled)
}

fn settings(options: &Options) -> Settings {
    Settings {
        width: options.width as u16,
        height: options.height as u16,
        spp: options.spp,
    }
}

/// The path tracer that denoised frames are rendered by; an error for other integrators.
pub(crate) fn path(desc: &SceneDesc, options: &Options) -> Result<Path, Error> {
    match options.integrator {
        IntegratorKind::Direct | IntegratorKind::Path => Ok(integrator(desc, options)),
        _ => Err(Error::Scene(
            "only direct and path can be denoised or animated; choose one of them by --integrator".into(),
        )),
    }
}

/// Refused where no whole number of rendered pixels is the picture: it would be a part of one that is seen a little wider.
pub(crate) fn frames(options: &Options) -> Result<Frames, Error> {
    let Options { width, height, .. } = *options;
    let upscale = options.cleaning.upscale;
    if !width.is_multiple_of(upscale) || !height.is_multiple_of(upscale) {
        let [wide, high] = [width, height].map(|side| side.next_multiple_of(upscale));
        return Err(Error::Scene(format!(
            "--upscale {upscale} makes pictures whose width and height are multiples of {upscale}: {width} x {height} are not, \
             --width {wide} --height {high} would be"
        )));
    }
    Ok(Frames {
        width: width as u16,
        height: height as u16,
        spp: options.spp,
        cleaning: options.cleaning,
    })
}

/// Segments that no path reaches: roulette ends it long before.
pub(crate) const UNLIMITED: u16 = u16::MAX;

/// Camera vertices that [`Bdpt`] keeps on a board, and here: paths of two more segments are found by every strategy.
const BOARD_VERTICES: usize = 8;
const HOST_VERTICES: usize = 62;

/// How far ambient occlusion looks, units.
pub(crate) fn ao_radius(desc: &SceneDesc, core: &CoreScene) -> i32 {
    let all = f64::from(AmbientOcclusion::FULL);
    match desc.integrator.ao_radius {
        Some(metres) => (metres * f64::from(core.unit.fraction_bits()).exp2()).clamp(1.0, all) as i32,
        None => AmbientOcclusion::FULL,
    }
}

pub(crate) fn integrator(desc: &SceneDesc, options: &Options) -> Path {
    let max_depth = match options.integrator {
        IntegratorKind::Direct => 2,
        _ => options
            .max_depth
            .map_or(UNLIMITED, |depth| depth.min(u32::from(UNLIMITED)) as u16),
    };
    let rr_depth = desc.integrator.rr_depth.min(u32::from(u16::MAX)) as u16;
    Path {
        max_depth,
        rr_depth,
        hide_emitters: desc.integrator.hide_emitters,
    }
}

/// Memory for what is told of a scene once, where paths go on from what the camera sees.
pub(crate) fn cells(options: &Options, path: Path) -> Vec<Cell> {
    let goes_on = options.integrator == IntegratorKind::Path && path.max_depth > 2;
    vec![Cell::UNKNOWN; if goes_on { 1 << 12 } else { 0 }]
}

pub(crate) fn sampler(options: &Options) -> AnySampler {
    match options.sampler {
        SamplerKind::Independent => Independent::new(options.seed).into(),
        SamplerKind::Stratified => Stratified::new(options.seed, options.spp).into(),
        SamplerKind::Cmj => Cmj::new(options.seed, options.spp).into(),
        SamplerKind::Sobol => Sobol::new(options.seed).into(),
        SamplerKind::Blue => ZSobol::new(options.seed, options.spp).into(),
    }
}

pub(crate) fn pool(threads: usize) -> Result<rayon::ThreadPool, Error> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| Error::Scene(format!("{threads} threads: {error}")))
}

fn layers<S: Sampler>(core: &CoreScene, renderer: &Renderer<S>, options: &Options) -> Aov {
    let frame = Frame::of(core);
    let mut aov = Aov::default();
    for y in 0..options.height as u16 {
        for x in 0..options.width as u16 {
            let found = renderer.features(x, y);
            let normal = found.map_or([0.0; 3], |f| f.normal.0.map(|c| c as f32 / 65536.0));
            aov.albedo
                .push(found.map_or([0.0; 3], |f| dequantise::albedo(f.albedo).map(|c| c as f32)));
            aov.normal.push(normal);
            aov.depth
                .push(found.map_or(0.0, |f| frame.length(f.depth) as f32));
            aov.id.push(found.map_or(0, |f| u32::from(f.id) + 1));
        }
    }
    aov
}

impl From<QuantiseError> for Error {
    fn from(error: QuantiseError) -> Error {
        Error::Scene(error.to_string())
    }
}
