//! `host-sim render`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use clap::CommandFactory;
use clap::error::ErrorKind;

use super::args::{Cli, RenderArgs};
use super::progress::Meter;
use super::table::short;
use super::{Failure, source, stop, terminal};
use crate::desc::{IntegratorKind, SceneDesc};
use crate::picture::{Format, Layer, Picture, Style, Target, display_pixels};
use crate::run::{self, Options, Progress, Stats};
use crate::show::{DisplayKind, Look};

pub fn render(args: &RenderArgs) -> Result<(), Failure> {
    layers_have_a_place(args);
    let desc = source::load(&args.scene, args.quiet)?;
    let options = Options {
        look: Look {
            exposure: args.exposure,
            tone_map: args.tone_map.into(),
        },
        display: args.display.map(DisplayKind::from),
        aov: !args.aov.is_empty(),
        ..args.settings.options(&desc)
    };
    let outputs = Output::check_all(&paths(&args.outputs, &desc))?;
    let stop = stop::on_ctrl_c()?;
    let (picture, stats) = picture(args, &desc, &options, &stop)?;
    let style = Style {
        exposure: args.exposure,
        layers: args.aov.iter().copied().map(Layer::from).collect(),
    };
    for output in &outputs {
        output.write(&picture, &style)?;
    }
    if args.quiet {
        return Ok(());
    }
    if args.outputs.is_empty() {
        terminal::show(
            picture.width,
            picture.height,
            &display_pixels(&picture, args.exposure),
        );
    }
    let written: Vec<String> = outputs
        .iter()
        .map(|output| output.target.path().display().to_string())
        .collect();
    writeln!(
        io::stdout(),
        "{}",
        summary(&desc.name, &options, &stats, &written)
    )?;
    Ok(())
}

/// Ends the program, as wrong usage, where `--aov` is asked for and no EXR file is.
fn layers_have_a_place(args: &RenderArgs) {
    let is_exr = |path: &PathBuf| Format::of(path) == Ok(Format::Exr);
    if !args.aov.is_empty() && !args.outputs.iter().any(is_exr) {
        let message = "--aov writes its layers into an .exr file; add -o NAME.exr";
        Cli::command().error(ErrorKind::ArgumentConflict, message).exit();
    }
}

/// The picture, made in a window if one is wanted.
fn picture(
    args: &RenderArgs,
    desc: &SceneDesc,
    options: &Options,
    stop: &AtomicBool,
) -> Result<(Picture, Stats), Failure> {
    let make = |progress: &dyn Progress| {
        if args.reference {
            run::render_reference(desc, options, progress, stop)
        } else {
            run::render_fixed(desc, options, progress, stop)
        }
    };
    let meter = Meter::new(&desc.name, args.quiet);
    #[cfg(feature = "window")]
    let result = if args.window {
        super::window::watch(desc, options, &meter, stop, make)
    } else {
        make(&meter)
    };
    #[cfg(not(feature = "window"))]
    let result = make(&meter);
    meter.finish();
    result.map_err(|error| Failure::of_run(&args.scene.scene, error))
}

/// Where the picture goes: where the user says, else NAME.png here.
fn paths(outputs: &[PathBuf], desc: &SceneDesc) -> Vec<PathBuf> {
    match outputs {
        [] => vec![PathBuf::from(format!("{}.png", desc.name))],
        given => given.to_vec(),
    }
}

/// A picture file to be written, checked beforehand.
pub struct Output {
    pub target: Target,
    format: Format,
}

impl Output {
    pub fn check(path: &Path) -> Result<Output, Failure> {
        let format = Format::of(path)?;
        Ok(Output {
            target: Target::check(path)?,
            format,
        })
    }

    pub fn check_all(paths: &[PathBuf]) -> Result<Vec<Output>, Failure> {
        paths.iter().map(|path| Output::check(path)).collect()
    }

    pub fn format(&self) -> Format {
        self.format
    }

    pub fn write(&self, picture: &Picture, style: &Style) -> Result<(), Failure> {
        let path = self.target.path().display();
        let bytes = self.format.encode(picture, style);
        let bytes = bytes.map_err(|error| Failure::Wrong(super::one_line(&format!("{path}: {error}"))))?;
        Ok(self.target.write(&bytes)?)
    }
}

/// `spheres: 320 x 240, 64 spp, path in 1.24 s, 3.10 M rays/s, written to spheres.png`
fn summary(name: &str, options: &Options, stats: &Stats, written: &[String]) -> String {
    format!(
        "{name}: {}, {:.2} s, {} rays/s, written to {}",
        settings(options),
        stats.seconds,
        short(stats.rays_per_second()),
        written.join(", ")
    )
}

/// `320 x 240, 64 spp, path`
pub fn settings(options: &Options) -> String {
    let integrator = match options.integrator {
        IntegratorKind::Ao => "ao",
        IntegratorKind::Direct => "direct",
        IntegratorKind::Path => "path",
        IntegratorKind::Bdpt => "bdpt",
        IntegratorKind::Light => "light",
    };
    let depth = options
        .max_depth
        .map_or(String::new(), |depth| format!(" of depth {depth}"));
    format!(
        "{} x {}, {} spp, {integrator}{depth}",
        options.width, options.height, options.spp
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::tests::desc;

    #[test]
    fn a_render_is_summed_up_in_a_line() {
        let options = Options::for_scene(&desc(320, 240));
        let stats = Stats {
            rays: 6_200_000,
            seconds: 2.0,
        };
        let line = summary(
            "spheres",
            &options,
            &stats,
            &["a.png".to_string(), "b.exr".to_string()],
        );
        let expected =
            "spheres: 320 x 240, 64 spp, path of depth 8, 2.00 s, 3.10 M rays/s, written to a.png, b.exr";
        assert_eq!(line, expected);
    }

    #[test]
    fn without_outputs_the_scene_names_the_file() {
        assert_eq!(paths(&[], &desc(1, 1)), [PathBuf::from("nothing.png")]);
        let given = [PathBuf::from("a.exr"), PathBuf::from("b.png")];
        assert_eq!(paths(&given, &desc(1, 1)), given);
    }
}
