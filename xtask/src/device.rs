//! Firmware without a board: runs `firmware/emulator`, which builds, emulates, compares and counts.

use std::ffi::OsString;
use std::path::{Path, PathBuf, absolute};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;

use crate::board::Board;
use crate::setup::Part;
use crate::shell;
use crate::toolchain::Embedded;

#[derive(Args)]
pub struct Options {
    /// Which board; pico draws on its display, the others run the jobs of `firmware/common`
    #[arg(long, value_enum, default_value_t = Board::Pico)]
    board: Board,
    /// File for what the Pico's display shows [default: target/pico.png]
    #[arg(long)]
    png: Option<PathBuf>,
    /// File for the Pico's times, cycles, stacks and faults
    #[arg(long)]
    json: Option<PathBuf>,
    /// The Pico's display
    #[arg(long, default_value = "240x240", value_parser = ["240x240", "320x240"])]
    screen: String,
    /// What the Pico draws; flights are past the first scene, denoised by the à-trous filter or by the network
    #[arg(long, default_value = "cornell", value_parser = ["cornell", "mesh", "flight", "flight-neural"])]
    scene: String,
    /// Frames of a flight
    #[arg(long, default_value_t = 3)]
    frames: u32,
    /// Flights fill 240 x 240 pixels, 3 x 3 for each rendered one, instead of 160 x 120, 2 x 2 for each
    #[arg(long)]
    full: bool,
    /// Samples a pixel after which to stop, 1 to 16 by powers of two; 0 for the preview
    #[arg(long, default_value_t = 1)]
    spp: u32,
    /// OBJ file for the mesh's place in the flash
    #[arg(long)]
    mesh: Option<PathBuf>,
    /// No progress
    #[arg(long)]
    quiet: bool,
}

/// Runs one board's firmware.
pub fn run(options: &Options) -> Result<()> {
    let board = options.board;
    Embedded::find(board.target())?;
    let Some(part) = board.emulated_by() else {
        emulate(&["size"])?;
        bail!(
            "{}: it is built and fits, but no emulator here runs it",
            board.name()
        );
    };
    require(part)?;
    if board != Board::Pico {
        return emulate(&["run", "--board", board.name()]);
    }
    let png = match &options.png {
        Some(file) => file.clone(),
        None => shell::target_dir().join("pico.png"),
    };
    let mut words: Vec<OsString> = vec!["run".into(), "--png".into(), whole(&png)?.into()];
    for (name, value) in [("--screen", &options.screen), ("--scene", &options.scene)] {
        words.extend([name.into(), value.into()]);
    }
    for (name, value) in [("--spp", options.spp), ("--frames", options.frames)] {
        words.extend([name.into(), value.to_string().into()]);
    }
    for (name, file) in [("--json", &options.json), ("--mesh", &options.mesh)] {
        if let Some(file) = file {
            words.extend([name.into(), whole(file)?.into()]);
        }
    }
    for (name, is_on) in [("--full", options.full), ("--quiet", options.quiet)] {
        if is_on {
            words.push(name.into());
        }
    }
    emulate(&words)?;
    println!("what the display shows: {}", png.display());
    Ok(())
}

#[derive(Args)]
pub struct BenchOptions {
    /// File for the rows: core, scene, instructions, m0plus_cycles, pixels, crc
    #[arg(long)]
    json: Option<PathBuf>,
    /// The record
    #[arg(long, default_value = "docs/device.md")]
    record: PathBuf,
}

/// Measures what pictures cost on each core and writes the record.
pub fn bench(options: &BenchOptions) -> Result<()> {
    for part in [Part::Qemu, Part::Node] {
        require(part)?;
    }
    let record = shell::root().join(&options.record);
    let mut words: Vec<OsString> = vec!["bench".into(), "--record".into(), record.into()];
    if let Some(file) = &options.json {
        words.extend(["--json".into(), whole(file)?.into()]);
    }
    emulate(&words)
}

/// The step of `cargo xtask ci`.
pub fn check() -> Result<String> {
    for part in [Part::Qemu, Part::Node] {
        require(part)?;
    }
    for package in ["bake", "common", "emulator"] {
        let manifest = format!("firmware/{package}/Cargo.toml");
        let mut test = shell::cargo("test");
        test.args([
            "--release",
            "--quiet",
            "--locked",
            "--manifest-path",
            &manifest,
            "--target-dir",
        ]);
        shell::run(test.arg(shell::target_dir()))?;
    }
    emulate(&["size"])?;
    emulate(&["identity"])?;
    emulate(&["run", "--quiet"])?;
    for flight in ["flight", "flight-neural"] {
        emulate(&["run", "--quiet", "--scene", flight, "--frames", "2"])?;
    }
    emulate(&[
        "run",
        "--quiet",
        "--scene",
        "flight-neural",
        "--full",
        "--frames",
        "2",
    ])?;
    emulate(&["faults"])?;
    Ok(
        "nine machines agree, the Pico's display shows this computer's pictures, every fault is caught"
            .to_string(),
    )
}

/// Builds the emulator, if need be, and runs it.
pub(crate) fn emulate(words: &[impl AsRef<std::ffi::OsStr>]) -> Result<()> {
    let mut cargo = shell::cargo("run");
    cargo.args([
        "--release",
        "--quiet",
        "--locked",
        "--manifest-path",
        "firmware/emulator/Cargo.toml",
    ]);
    cargo.arg("--target-dir").arg(shell::target_dir());
    shell::run(cargo.arg("--").args(words))
}

/// Says what is missing of a part, and how to get it.
pub(crate) fn require(part: Part) -> Result<()> {
    let programs: &[&str] = match part {
        Part::Qemu => &["qemu-system-arm", "qemu-system-riscv32"],
        Part::Node => &["node", "npm"],
        _ => &[],
    };
    let missing: Vec<_> = programs
        .iter()
        .filter(|program| !shell::have(program))
        .copied()
        .collect();
    ensure!(
        missing.is_empty(),
        "missing: {}; run `cargo xtask setup --what {}`",
        missing.join(", "),
        if part == Part::Qemu { "qemu" } else { "node" }
    );
    Ok(())
}

/// The file as seen from anywhere.
pub(crate) fn whole(file: &Path) -> Result<PathBuf> {
    absolute(file).with_context(|| file.display().to_string())
}
