//! The record of the picture's errors: `docs/accuracy.md`.
//!
//! Each case is rendered by host-sim in fixed point and by its f64 reference; scene files that Mitsuba 3 has rendered
//! are compared with its picture too, and with what Mitsuba itself makes of as few samples.

mod case;
mod measure;
mod record;

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};
use clap::Args;

use crate::shell;
pub(crate) use case::{Case, built_in, bunny, files};
use measure::Outcome;
pub(crate) use measure::{Error, mitsuba};
pub(crate) use record::Header;
use record::Row;

#[derive(Args)]
pub struct Options {
    /// Samples a pixel, of both renderers
    #[arg(long, value_name = "N", default_value_t = 256)]
    spp: u32,
    /// Mitsuba scenes, with pictures of theirs in reference/NAME.exr; none are taken if there is no such folder
    #[arg(long, value_name = "DIR", default_value = "../shared/scenes")]
    scenes: PathBuf,
    /// A mesh without a scene of its own: the Stanford bunny; left out if there is no such file
    #[arg(
        long,
        value_name = "FILE",
        default_value = "../shared/meshes/stanford-bunny.obj"
    )]
    bunny: PathBuf,
    /// Only this scene, shown and not recorded; may be given several times
    #[arg(long, value_name = "SCENE")]
    only: Vec<String>,
}

const RECORD: &str = "docs/accuracy.md";

/// Measures every case and writes the record, or shows it.
pub fn run(options: &Options) -> Result<()> {
    shell::run(shell::cargo("build").args(["--release", "--package", "host-sim", "--bin", "host-sim"]))?;
    let host_sim = shell::target_dir().join("release/host-sim");
    let folder = tempfile::tempdir()?;
    let scenes = shell::root().join(&options.scenes);
    let bunny = shell::root().join(&options.bunny);
    let mut cases = case::built_in(&host_sim)?;
    cases.extend(case::files(&scenes)?);
    cases.extend(case::bunny(&bunny, folder.path())?);
    cases.retain(|case| options.only.is_empty() || options.only.contains(&case.name));

    // Now, since the tree may change while this runs.
    let header = Header::now(options.spp)?;
    let mut rows = Vec::new();
    for case in &cases {
        println!("{}", case.label());
        let outcome = measured(&host_sim, case, options.spp)?;
        println!("    {}", outcome.line());
        rows.push(Row {
            scene: case.name.clone(),
            integrator: case.integrator.unwrap_or("its own").to_string(),
            outcome,
        });
    }
    let text = record::text(&header, &rows);
    if options.only.is_empty() {
        let path = shell::root().join(RECORD);
        std::fs::write(&path, text).with_context(|| path.display().to_string())?;
        println!("written to {RECORD}");
    } else {
        print!("\n{text}");
    }
    Ok(())
}

fn measured(host_sim: &std::path::Path, case: &Case, spp: u32) -> Result<Outcome> {
    // First Mitsuba: it also makes the picture to compare with where there is none.
    let mitsuba = match case.mitsuba() {
        Some(scene) => measure::mitsuba(&scene, spp)?,
        None => None,
    };
    measure::compare(Command::new(host_sim), case, spp, mitsuba)
}
