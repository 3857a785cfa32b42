//! The program `host-sim`: arguments in, files and a few lines out, one line where something is wrong.

mod animate;
mod args;
mod bake;
mod compare;
mod info;
mod polygon;
mod progress;
mod render;
mod report;
mod source;
mod stop;
pub(crate) mod table;
mod terminal;
#[cfg(feature = "window")]
mod window;

use std::fmt;
use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;

use crate::picture::FileError;
use crate::run;
use args::{Cli, Command};

/// Reads the command line and does what it says. Exit status: 0; 1 for a scene or file that is wrong; 2 for wrong usage;
/// 130 when stopped by Ctrl-C.
pub fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Render(args) => render::render(&args),
        Command::Compare(args) => compare::compare(&args),
        Command::Animate(args) => animate::animate(&args),
        Command::Info(args) => info::info(&args),
        Command::Bake(args) => bake::bake(&args),
        Command::Polygon(args) => polygon::polygon(&args),
        Command::Report(args) => report::report(&args),
        Command::Scenes => scenes(),
    };
    match result {
        Ok(()) | Err(Failure::NobodyListens) => ExitCode::SUCCESS,
        Err(Failure::Wrong(line)) => {
            complain("error", &line);
            ExitCode::FAILURE
        }
        Err(Failure::Stopped) => {
            complain("stopped", "no file was written");
            ExitCode::from(130)
        }
    }
}

/// Why a command did not do what it should.
#[derive(Debug, PartialEq, Eq)]
enum Failure {
    /// One line: where, what, what to do.
    Wrong(String),
    /// By Ctrl-C.
    Stopped,
    /// The reader of the standard output has gone (`host-sim scenes | head -1`); that is no error.
    NobodyListens,
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        Failure::Wrong(error.to_string())
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Failure::NobodyListens,
            _ => Failure::Wrong(format!("standard output: {error}; write to another place")),
        }
    }
}

impl Failure {
    /// A render of `scene` that came to nothing.
    fn of_run(scene: &str, error: run::Error) -> Failure {
        match error {
            run::Error::Cancelled => Failure::Stopped,
            run::Error::Scene(message) => Failure::Wrong(one_line(&format!("{scene}: {message}"))),
        }
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A line on the standard error; if nobody reads it, there is nobody to tell.
fn complain(kind: &str, line: &(impl fmt::Display + ?Sized)) {
    let _ = writeln!(io::stderr(), "{kind}: {line}");
}

/// List the built-in scenes, one line each.
fn scenes() -> Result<(), Failure> {
    let scenes = crate::builtin::all();
    let widest = scenes.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let mut out = io::stdout().lock();
    for (name, description) in scenes {
        writeln!(out, "{name:widest$}  {description}")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::{CameraDesc, IntegratorDesc, IntegratorKind, SceneDesc};

    /// A scene with nothing in it.
    pub fn desc(width: u32, height: u32) -> SceneDesc {
        SceneDesc {
            name: "nothing".to_string(),
            width,
            height,
            spp: None,
            sampler: None,
            integrator: IntegratorDesc {
                kind: IntegratorKind::Path,
                max_depth: Some(8),
                rr_depth: 5,
                hide_emitters: false,
                ao_radius: None,
            },
            camera: CameraDesc {
                origin: [0.0; 3],
                right: [1.0, 0.0, 0.0],
                up: [0.0, 1.0, 0.0],
                forward: [0.0, 0.0, -1.0],
                fov_x: 45.0,
                lens: None,
            },
            materials: Vec::new(),
            shapes: Vec::new(),
            lights: Vec::new(),
            baked: None,
        }
    }

    #[test]
    fn failures_are_one_line() {
        let failure = Failure::of_run("room.xml", run::Error::Scene("no light:\n add one".to_string()));
        assert_eq!(failure, Failure::Wrong("room.xml: no light: add one".to_string()));
        assert_eq!(
            Failure::of_run("room.xml", run::Error::Cancelled),
            Failure::Stopped
        );
    }

    #[test]
    fn a_closed_pipe_is_no_error() {
        assert_eq!(
            Failure::from(io::Error::from(io::ErrorKind::BrokenPipe)),
            Failure::NobodyListens
        );
    }
}
