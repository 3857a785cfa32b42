//! What can be typed.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

mod picture;

use crate::run::MAX_SIDE;
use picture::MAX_SPP;
pub use picture::{DisplayArg, IntegratorArg, LayerArg, SamplerArg, Settings, ToneMapArg};

const EXAMPLES: &str = "\
Examples:
  host-sim scenes                              what there is to render
  host-sim render spheres                      a first picture: spheres.png, and here if this is a terminal
  host-sim render cornell --spp 16 --display rgb565 -o small.png
                                               what a 16-bit display would show
  host-sim compare cornell --diff diff.png     fixed point against f64, in numbers and as a picture
  host-sim animate cornell --spp 1 --denoise atrous --orbit 20 -o cornell.png
                                               a camera that moves, and noise taken away
  host-sim info bunny.obj                      how much flash and RAM a board needs for it
  host-sim bake bunny.obj -o bunny.mlx         its bytes for the board
  host-sim polygon star -o star.svg            how a polygon becomes triangles, step by step
  host-sim report -o report                    everything at once, on a page: report/report.html

Each command has its own help, with more examples: host-sim render --help";

/// microlux on the host: the renderer that runs on microcontrollers, in fixed point, bit for bit the same, beside an
/// independent f64 one that says how right it is.
#[derive(Debug, Parser)]
#[command(name = "host-sim", version, after_help = EXAMPLES, arg_required_else_help = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    Render(RenderArgs),
    Compare(CompareArgs),
    Animate(AnimateArgs),
    Info(InfoArgs),
    Bake(BakeArgs),
    Polygon(PolygonArgs),
    Report(ReportArgs),
    /// List the built-in scenes, one line each
    Scenes,
}

const RENDER_EXAMPLES: &str = "\
SCENE is a built-in name (host-sim scenes lists them) or a file: .xml (Mitsuba 3), .gltf and .glb, .obj and \
.ply. A model without a camera is framed, one without lights lit by a sky and a sun; what the file means and the \
renderer lacks is told, a line each.

Without -o the picture is written to NAME.png in the current directory, NAME being the scene's, over a file of that \
name if there is one, and also shown here where the standard output is a terminal.

Files appear when they are complete. Ctrl-C stops the render and leaves none (exit status 130). Exit status 1 says that \
the scene or a file is wrong, 2 that the command line is.

Examples:
  host-sim render spheres --width 320 --spp 16
  host-sim render model.glb --spp 256
  host-sim render room.xml -o room.png -o room.exr --aov albedo,normal,depth,id
  host-sim render cornell --display mono -o e-paper.png
  host-sim render cornell --spp 4 --denoise atrous --upscale 2 -o clean.png
  host-sim render cornell --reference --spp 1024 -o truth.exr";

/// Render a scene in fixed point, as the board would.
#[derive(Debug, Args)]
#[command(after_help = RENDER_EXAMPLES, after_long_help = RENDER_EXAMPLES)]
pub struct RenderArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Write the picture; .png (8-bit sRGB), .exr or .pfm (linear light). May be given several times.
    #[arg(short, long = "output", value_name = "OUT")]
    pub outputs: Vec<PathBuf>,
    /// Render with the f64 reference instead.
    #[arg(long, conflicts_with_all = ["display", "aov", "tone_map"])]
    pub reference: bool,
    /// Brighten PNG and display by this many stops (1 doubles the light); .exr and .pfm stay as they are.
    #[arg(long, value_name = "EV", default_value_t = 0.0, value_parser = exposure, allow_negative_numbers = true)]
    pub exposure: f64,
    /// Draw on a simulated display: tone mapped and dithered as on the board; .png is what it shows.
    #[arg(long, value_enum)]
    pub display: Option<DisplayArg>,
    /// How light without bound becomes a colour, for PNG and display
    #[arg(long, value_enum, default_value_t = ToneMapArg::Clamp, value_name = "CURVE")]
    pub tone_map: ToneMapArg,
    /// Add layers of the first non-specular hit to .exr: albedo.R/G/B, normal.X/Y/Z, depth.Z (metres), id.I.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "LAYERS")]
    pub aov: Vec<LayerArg>,
    /// Show the picture in a window while it is made; closing the window stops the render.
    #[cfg(feature = "window")]
    #[arg(long, conflicts_with = "reference")]
    pub window: bool,
    /// Say nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
    #[command(flatten)]
    pub settings: Settings,
}

const POLYGON_EXAMPLES: &str = "\
POLYGON is convex, comb, hole, star or spiral, or a text file: a point a line, x and y, an empty line between rings. What \
an odd number of rings goes around is inside. The picture has a frame for each step (of more than 60, for some): the lines \
that cells are cut along, the strictly convex pieces that are left, and the triangles that are peeled off each.

Examples:
  host-sim polygon comb -o comb.svg
  host-sim polygon outline.txt -o steps.svg";

/// Cut a polygon into triangles as the core does, and draw each step.
#[derive(Debug, Args)]
#[command(after_help = POLYGON_EXAMPLES, after_long_help = POLYGON_EXAMPLES)]
pub struct PolygonArgs {
    /// A name, or a file.
    #[arg(value_name = "POLYGON")]
    pub polygon: String,
    /// Write the steps; .svg.
    #[arg(short, long, value_name = "FILE", default_value = "polygon.svg")]
    pub output: PathBuf,
    /// Say nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
}

const ANIMATE_EXAMPLES: &str = "\
flicker is the mean change of a place's signal (8-bit sRGB, 0 to 1) from frame to frame, followed as the camera moves. With \
--reference-spp the same flight is rendered once more, without denoising, and the frames are compared with it.

Examples:
  host-sim animate cornell --spp 1 --denoise atrous --upscale 2 --orbit 20 -o cornell.png
                                               an animated PNG
  host-sim animate spheres --frames 48 --dolly 1 -o frames
                                               frames/000.png, frames/001.png, ...
  host-sim animate cornell --spp 4 --denoise neural --taa --orbit 10 --reference-spp 256 -o clip.png";

/// Render a camera's flight through a scene, frame by frame.
#[derive(Debug, Args)]
#[command(after_help = ANIMATE_EXAMPLES, after_long_help = ANIMATE_EXAMPLES)]
pub struct AnimateArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Frames of the flight.
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub frames: u32,
    /// Go around what is in the middle of the picture, by so many degrees from first to last frame.
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    pub orbit: f64,
    /// Go forward by so many metres from first to last frame.
    #[arg(
        long,
        value_name = "METRES",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    pub dolly: f64,
    /// Frames a second of an animated PNG.
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub fps: u16,
    /// Show half of each denoised frame and half of what was shown before, followed as the camera moves: calmer. A board needs
    /// 8 bytes more for each pixel that is shown.
    #[arg(long)]
    pub taa: bool,
    /// Write an animated PNG (NAME.png), or the frames into a folder.
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Render the flight with so many samples a pixel, too, and compare with it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_SPP))]
    pub reference_spp: Option<u32>,
    /// Say nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
    #[command(flatten)]
    pub settings: Settings,
}

const COMPARE_EXAMPLES: &str = "\
bias      mean of the picture over the reference's, less 1 (light above 8 counts as 8)
rmse      root of the mean squared difference of linear light (capped as above)
psnr      of the sRGB signals clipped to 0..1, in dB (200: equal)
ssim      structural similarity of their luma: 1 equal (windows of 11x11)
flip      mean FLIP of the same signals: 0 equal, 1 as different as can be (67 pixels a degree)
block p95 95th percentile of the relative error of 8x8 blocks

With --denoise the picture is what the filter left, and the noisy one of as many samples stands below it.

Both renders are noisy: at few samples a pixel rmse, psnr and flip show noise, not error. --reference-spp gives the \
reference more samples.

--diff: .png has white where the pictures agree, red where fixed is brighter and blue where it is darker, full colour \
from 50 % on; .exr and .pfm have the signed difference of linear light.

Examples:
  host-sim compare spheres
  host-sim compare cornell --spp 256 --reference-spp 1024 --json cornell.json --diff cornell-diff.png
  host-sim compare cornell --spp 4 --denoise atrous --reference-spp 1024
  host-sim compare cornell.xml --against mitsuba.exr";

/// Render in fixed point and in f64, and say how far apart they are.
#[derive(Debug, Args)]
#[command(after_help = COMPARE_EXAMPLES, after_long_help = COMPARE_EXAMPLES)]
pub struct CompareArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Samples a pixel of the f64 reference, where it shall have others than the fixed-point render.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_SPP))]
    pub reference_spp: Option<u32>,
    /// Also compare both with a picture made elsewhere, linear, of the same size.
    #[arg(long, value_name = "IMAGE.exr")]
    pub against: Option<PathBuf>,
    /// Write the fixed-point picture; .png, .exr or .pfm. May be given several times.
    #[arg(short, long = "output", value_name = "OUT")]
    pub outputs: Vec<PathBuf>,
    /// Write the numbers as one flat JSON object.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the difference of the two as a picture.
    #[arg(long, value_name = "FILE")]
    pub diff: Option<PathBuf>,
    /// Say nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
    #[command(flatten)]
    pub settings: Settings,
}

const INFO_EXAMPLES: &str = "\
Flash is what the scene's constant data take. RAM is for the given settings: a strip of the picture, the path's scratch \
and the renderer's state, without the program's own stack.

Examples:
  host-sim info cornell
  host-sim info bunny.obj --width 240 --tile-height 4 --json bunny.json";

/// Say what a scene is made of and what it needs on a board.
#[derive(Debug, Args)]
#[command(after_help = INFO_EXAMPLES, after_long_help = INFO_EXAMPLES)]
pub struct InfoArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Write the numbers as one flat JSON object.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    #[command(flatten)]
    pub settings: Settings,
}

const BAKE_EXAMPLES: &str = "\
A whole scene goes into one file: packed meshes with their trees, shapes, materials, lights, textures, what surrounds it, \
and how it wants to be rendered. A board opens it where it lies, with a room as large as the report says:

  static SCENE: &[u8] = microlux::include_baked!(\"room.mlx\");
  let mut room = Room::<20, 9, 2, 1>::new();
  let Whole { scene, shot } = Baked::open(SCENE)?.scene(&mut room)?;

Of an .obj or .ply, or with --meshes-only, meshes alone are baked, for a scene of your own: Baked::open(BUNNY)?.mesh(0)?. \
With --scene-rust all else of SCENE becomes Rust source, which you may change:

  let (mut builder, camera) = room::scene()?;
  let scene = builder.build_from(room::borrowed(&meshes), &mut nodes)?;

The preview is rendered from the baked bytes. Baked files are scenes, too: host-sim render room.mlx.

Examples:
  host-sim bake room.xml -o room.mlx --preview room.png
  host-sim bake bunny.obj -o bunny.mlx --rust bunny.rs";

/// Write a scene, or its meshes, as they lie in a board's flash.
#[derive(Debug, Args)]
#[command(after_help = BAKE_EXAMPLES, after_long_help = BAKE_EXAMPLES)]
pub struct BakeArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Write what is baked, .mlx.
    #[arg(short, long, value_name = "BLOB")]
    pub output: PathBuf,
    /// Bake the meshes alone. Those of .obj and .ply files always are.
    #[arg(long)]
    pub meshes_only: bool,
    /// Write the same as Rust source, too.
    #[arg(long, value_name = "FILE")]
    pub rust: Option<PathBuf>,
    /// Write all but the meshes as Rust source: materials, shapes, lights, textures, camera. Bakes the meshes alone.
    #[arg(long, value_name = "FILE")]
    pub scene_rust: Option<PathBuf>,
    /// Write the numbers as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write a picture of what was baked, .png.
    #[arg(long, value_name = "FILE")]
    pub preview: Option<PathBuf>,
    /// Say nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
}

const REPORT_EXAMPLES: &str = "\
DIR/report.html shows everything, with its pictures inside, and needs nothing else; DIR/report.json has all of the \
numbers. DIR is made if it is not there; both files appear when everything is done, and Ctrl-C leaves none.

For each scene, integrator and sampler: the fixed-point picture beside the f64 reference's (and Mitsuba's, where there is \
one), what they differ by, the bias with its standard error, and how the error falls with the number of samples. What is \
beyond the project's bars is marked, and an overview stands at the top.

Pictures by Mitsuba are found as reference/NAME.exr beside a scene file NAME.xml, or as NAME.exr in --reference-dir. They \
may be larger by a whole factor.

With --denoisers the page is DIR/denoisers.html, about what is left of one to four samples a pixel: noisy, à-trous, joint \
bilateral, the network and Open Image Denoise side by side, in single frames, clips and pictures of twice the size; \
denoisers.json has the numbers, denoisers.md their means as tables. Open Image Denoise is its own program, oidnDenoise \
(pip install pyoidn, the folder pyoidn/oidn of its site-packages); where it is not there the page says so.

Examples:
  host-sim report -o report                    the built-in scenes, in a few minutes
  host-sim report --denoisers --oidn venv/lib/python3.11/site-packages/pyoidn/oidn -o report
                                               what the denoiser is worth
  host-sim report --quick -o report            a first look
  host-sim report scenes/*.xml --spp 64 --samplers stratified,sobol -o report";

/// Write a page that shows what is right and what is not: scenes, integrators and samplers beside the reference.
#[derive(Debug, Args)]
#[command(after_help = REPORT_EXAMPLES, after_long_help = REPORT_EXAMPLES)]
pub struct ReportArgs {
    /// Built-in scenes or files: .xml (Mitsuba 3), .gltf, .glb, .obj, .ply [default: all built-in scenes]
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// Write report.html and report.json into this folder.
    #[arg(short, long = "output", value_name = "DIR")]
    pub output: PathBuf,
    /// A first look: smaller pictures, fewer samples.
    #[arg(long)]
    pub quick: bool,
    /// Compare what takes noise away, instead: denoisers.html, denoisers.json and denoisers.md.
    #[arg(long, conflicts_with_all = ["spp", "integrators", "samplers", "reference_dir"])]
    pub denoisers: bool,
    /// Where oidnDenoise is: a folder with bin/oidnDenoise [default: looked for in PATH]
    #[arg(long, value_name = "FOLDER", requires = "denoisers")]
    pub oidn: Option<PathBuf>,
    /// Samples a pixel; the error is shown at every power of two up to this one [default: 16; 4 with --quick]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_SPP))]
    pub spp: Option<u32>,
    /// Samples a pixel of the f64 reference, which is rendered twice to know its noise [default: 4 times --spp]; of the
    /// fixed-point one with --denoisers [default: 256; 32 with --quick], 16 times as many for the still camera
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_SPP))]
    pub reference_spp: Option<u32>,
    /// Pixels across [default: the scene's, at most 128, 64 with --quick; with --denoisers 80, 40 with --quick]
    #[arg(long, value_name = "W", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SIDE)))]
    pub width: Option<u32>,
    /// Integrators to look at [default: all]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "NAMES")]
    pub integrators: Vec<IntegratorArg>,
    /// Samplers to look at [default: all]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "NAMES")]
    pub samplers: Vec<SamplerArg>,
    /// Look for pictures by Mitsuba here, as NAME.exr [default: the folder reference beside the scene file]
    #[arg(long, value_name = "FOLDER")]
    pub reference_dir: Option<PathBuf>,
    /// Same seed, same pictures; another, another noise
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub seed: u32,
    /// Threads; nothing but the speed depends on it [default: one a core]
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Warn about what a scene file has that is not supported, and go on without it.
    #[arg(long)]
    pub lenient: bool,
    /// Say nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
}

/// Which scene, and how to read it.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// A built-in scene, or a file: .xml (Mitsuba 3), .gltf, .glb, .obj, .ply, .mlx (baked).
    #[arg(value_name = "SCENE")]
    pub scene: String,
    /// Warn about what a scene file has that is not supported, and go on without it.
    #[arg(long)]
    pub lenient: bool,
    /// Set a $NAME of a scene file.
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = definition)]
    pub definitions: Vec<(String, String)>,
}

fn exposure(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(stops) if (-64.0..=64.0).contains(&stops) => Ok(stops),
        _ => Err("a number of stops from -64 to 64 is wanted, such as 1.5".to_string()),
    }
}

fn definition(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.to_string(), value.to_string())),
        _ => Err("NAME=VALUE is wanted, such as spp=16".to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::SamplerKind;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn one_side_keeps_the_shape() {
        let desc = crate::cli::tests::desc(320, 240);
        let sides = |width, height| {
            let options = Settings {
                width,
                height,
                ..Settings::default()
            }
            .options(&desc);
            (options.width, options.height)
        };
        assert_eq!(sides(None, None), (320, 240));
        assert_eq!(sides(Some(160), None), (160, 120));
        assert_eq!(sides(None, Some(480)), (640, 480));
        assert_eq!(sides(Some(7), Some(9)), (7, 9));
        assert_eq!(sides(Some(1), None), (1, 1));
    }

    #[test]
    fn the_users_word_goes_before_the_scenes() {
        let mut desc = crate::cli::tests::desc(4, 4);
        desc.spp = Some(17);
        let line = [
            "host-sim",
            "render",
            "x",
            "--max-depth",
            "3",
            "--sampler",
            "sobol",
            "--seed",
            "9",
        ];
        let Command::Render(args) = Cli::parse_from(line).command else {
            panic!()
        };
        let options = args.settings.options(&desc);
        assert_eq!((options.spp, options.max_depth, options.seed), (17, Some(3), 9));
        assert_eq!(options.sampler, SamplerKind::Sobol);
        let options = Settings {
            spp: Some(2),
            ..Settings::default()
        }
        .options(&desc);
        assert_eq!((options.spp, options.sampler), (2, SamplerKind::Stratified));
    }

    #[test]
    fn several_outputs_and_layers() {
        let line = [
            "host-sim",
            "render",
            "x",
            "-o",
            "a.png",
            "-o",
            "a.exr",
            "--aov",
            "depth,id",
            "--exposure",
            "-1.5",
        ];
        let Command::Render(args) = Cli::parse_from(line).command else {
            panic!()
        };
        assert_eq!(args.outputs.len(), 2);
        assert_eq!(args.aov, [LayerArg::Depth, LayerArg::Id]);
        assert_eq!(args.exposure, -1.5);
    }
}
