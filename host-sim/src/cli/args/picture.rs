//! What a picture depends on, as it can be typed.

use clap::{Args, ValueEnum};
use microlux::film::ToneMap;

use crate::clean::{Cleaning, Denoise};
use crate::desc::{IntegratorKind, SamplerKind, SceneDesc};
use crate::picture::Layer;
use crate::run::{MAX_SIDE, Options};
use crate::show::DisplayKind;

pub(super) const MAX_SPP: i64 = 1 << 16;

/// What a picture depends on; what is not given is the scene's, or the default.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Picture")]
pub struct Settings {
    /// Pixels across [default: the scene's; keeps its shape when only --height is given]
    #[arg(long, value_name = "W", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SIDE)))]
    pub width: Option<u32>,
    /// Pixels down [default: the scene's; keeps its shape when only --width is given]
    #[arg(long, value_name = "H", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SIDE)))]
    pub height: Option<u32>,
    /// Samples a pixel [default: the scene's, else 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_SPP))]
    pub spp: Option<u32>,
    /// How light is followed [default: the scene's]
    #[arg(long, value_enum)]
    pub integrator: Option<IntegratorArg>,
    /// bdpt as on a board without memory for a whole frame: no light subpath meets the lens, and 8 vertices are kept
    #[arg(long)]
    pub tiles: bool,
    /// Longest path, in segments: 1 sees lights alone, 2 direct light [default: the scene's]
    #[arg(long, value_name = "D", value_parser = clap::value_parser!(u32).range(1..=65535))]
    pub max_depth: Option<u32>,
    /// How samples are spread [default: stratified]
    #[arg(long, value_enum)]
    pub sampler: Option<SamplerArg>,
    /// Same seed, same picture; another, another noise
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub seed: u32,
    /// Threads; the picture does not depend on it [default: one a core]
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Rows rendered at a time: fewer need less RAM; the picture does not depend on it [default: 8]
    #[arg(long, value_name = "ROWS", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SIDE)))]
    pub tile_height: Option<u32>,
    /// Take the noise away as a board would, for pictures of few samples
    #[arg(long, value_enum, default_value_t = DenoiseArg::Off, value_name = "FILTER")]
    pub denoise: DenoiseArg,
    /// Render every N-th pixel and row only, and fill in what lies between, led by what is seen there; --width and --height
    /// are multiples of N, and become so where they are not given
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=3))]
    pub upscale: u32,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum DenoiseArg {
    /// As it is rendered
    #[default]
    Off,
    /// A 3 x 3 blur again and again that stops at edges
    Atrous,
    /// A small neural network that says how far pixels may be mixed
    Neural,
}

impl From<DenoiseArg> for Denoise {
    fn from(arg: DenoiseArg) -> Self {
        match arg {
            DenoiseArg::Off => Denoise::Off,
            DenoiseArg::Atrous => Denoise::Atrous,
            DenoiseArg::Neural => Denoise::Neural,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum IntegratorArg {
    /// Emission and direct light
    Direct,
    /// All of it, bounce after bounce
    Path,
    /// From the camera and from the lights, joined everywhere
    Bdpt,
    /// From the lights alone
    Light,
    /// No light at all: how open each surface is
    Ao,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SamplerArg {
    /// Random
    Independent,
    /// One random place in each cell of a grid
    Stratified,
    /// One random place in each cell, row and column of a grid
    Cmj,
    /// A scrambled Sobol sequence
    Sobol,
    /// One Sobol sequence for all pixels, whose errors cancel between neighbours: for 1 to 4 samples
    Blue,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ToneMapArg {
    /// As it is up to 1, white beyond
    Clamp,
    /// A film's toe and shoulder (Hable)
    Filmic,
}

impl From<ToneMapArg> for ToneMap {
    fn from(arg: ToneMapArg) -> Self {
        match arg {
            ToneMapArg::Clamp => ToneMap::Clamp,
            ToneMapArg::Filmic => ToneMap::Filmic,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DisplayArg {
    /// 65,536 colours, as most small TFTs
    Rgb565,
    /// 262,144 colours
    Rgb666,
    /// 16.8 million colours
    Rgb888,
    /// 256 greys
    Gray8,
    /// Black and white, as e-paper and OLEDs
    Mono,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LayerArg {
    Albedo,
    Normal,
    Depth,
    Id,
}

impl Settings {
    /// The options for a scene, where the user, the scene, the default say something, in this order.
    pub fn options(&self, desc: &SceneDesc) -> Options {
        let own = Options::for_scene(desc);
        let scaled = |side: u32, of: u32, to: u32| {
            let exact = f64::from(side) * f64::from(to) / f64::from(of.max(1));
            (exact.round() as u32).clamp(1, MAX_SIDE)
        };
        // Sides that nobody asked for.
        let upscale = self.upscale.max(1);
        let fitting = |side: u32| match side.next_multiple_of(upscale) {
            more if more > MAX_SIDE => side - side % upscale,
            more => more,
        };
        let (width, height) = match (self.width, self.height) {
            (Some(width), Some(height)) => (width, height),
            (Some(width), None) => (width, fitting(scaled(own.height, own.width, width))),
            (None, Some(height)) => (fitting(scaled(own.width, own.height, height)), height),
            (None, None) => (fitting(own.width), fitting(own.height)),
        };
        Options {
            width,
            height,
            spp: self.spp.unwrap_or(own.spp),
            integrator: self.integrator.map_or(own.integrator, IntegratorKind::from),
            tiles: self.tiles,
            max_depth: self.max_depth.or(own.max_depth),
            sampler: self.sampler.map_or(own.sampler, SamplerKind::from),
            seed: self.seed,
            threads: self.threads.map_or(own.threads, usize::from),
            tile_height: self.tile_height.unwrap_or(own.tile_height),
            cleaning: Cleaning {
                denoise: self.denoise.into(),
                upscale,
                taa: false,
            },
            ..own
        }
    }
}

impl From<IntegratorArg> for IntegratorKind {
    fn from(arg: IntegratorArg) -> Self {
        match arg {
            IntegratorArg::Direct => IntegratorKind::Direct,
            IntegratorArg::Path => IntegratorKind::Path,
            IntegratorArg::Bdpt => IntegratorKind::Bdpt,
            IntegratorArg::Light => IntegratorKind::Light,
            IntegratorArg::Ao => IntegratorKind::Ao,
        }
    }
}

impl From<SamplerArg> for SamplerKind {
    fn from(arg: SamplerArg) -> Self {
        match arg {
            SamplerArg::Independent => SamplerKind::Independent,
            SamplerArg::Stratified => SamplerKind::Stratified,
            SamplerArg::Cmj => SamplerKind::Cmj,
            SamplerArg::Sobol => SamplerKind::Sobol,
            SamplerArg::Blue => SamplerKind::Blue,
        }
    }
}

impl From<DisplayArg> for DisplayKind {
    fn from(arg: DisplayArg) -> Self {
        match arg {
            DisplayArg::Rgb565 => DisplayKind::Rgb565,
            DisplayArg::Rgb666 => DisplayKind::Rgb666,
            DisplayArg::Rgb888 => DisplayKind::Rgb888,
            DisplayArg::Gray8 => DisplayKind::Gray8,
            DisplayArg::Mono => DisplayKind::Mono,
        }
    }
}

impl From<LayerArg> for Layer {
    fn from(arg: LayerArg) -> Self {
        match arg {
            LayerArg::Albedo => Layer::Albedo,
            LayerArg::Normal => Layer::Normal,
            LayerArg::Depth => Layer::Depth,
            LayerArg::Id => Layer::Id,
        }
    }
}
