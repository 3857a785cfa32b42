//! The Pico: its firmware in the RP2040 emulator, with the display model on its SPI bus.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    time::Duration,
};

use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;
use firmware_common::tile::{self, Frame};

use crate::{
    process,
    toolchain::{self, Build},
};

/// Longest emulation, whatever it does.
const LIMIT: Duration = Duration::from_secs(1200);

/// What is wired to the Pico.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Screen {
    #[value(name = "240x240")]
    Square,
    #[value(name = "320x240")]
    Wide,
}

impl Screen {
    const fn frame(self) -> Frame {
        match self {
            Self::Square => tile::SQUARE,
            Self::Wide => tile::WIDE,
        }
    }

    const fn size(self) -> &'static str {
        match self {
            Self::Square => "240x240",
            Self::Wide => "320x240",
        }
    }
}

/// A run of the Pico's firmware.
pub struct Run<'a> {
    pub screen: Screen,
    /// Receives what the display shows.
    pub png: Option<&'a Path>,
    /// Receives times, cycles, stacks and faults.
    pub json: Option<&'a Path>,
    /// Emulated seconds after which to give up.
    pub seconds: u32,
    pub quiet: bool,
}

/// Draws one picture and compares what the display shows with what this computer renders.
pub fn run(run: &Run) -> Result<()> {
    let program = build(run.screen, "")?;
    let rgb = scratch("pico.rgb")?;
    let mut emulator = emulator(&program)?;
    emulator
        .args(["--size", run.screen.size(), "--until", "frame", "--rgb"])
        .arg(&rgb);
    emulator.args(["--seconds", &run.seconds.to_string()]);
    if let Some(file) = run.png {
        emulator.arg("--png").arg(file);
    }
    if let Some(file) = run.json {
        emulator.arg("--json").arg(file);
    }
    if run.quiet {
        emulator.arg("--quiet");
    }
    let finished = process::run(&mut emulator, LIMIT, true)?;
    ensure!(
        finished.status.success(),
        "the emulator ended with {}\n{}",
        finished.status,
        finished.stdout
    );
    let shown = fs::read(&rgb).with_context(|| rgb.display().to_string())?;
    let expected = colours(run.screen.frame());
    if let Some((x, y)) = first_difference(&shown, &expected, run.screen.frame().width())? {
        bail!("the display differs from this computer's picture at ({x}, {y}) first");
    }
    println!("the display shows what this computer renders, bit for bit");
    Ok(())
}

/// Makes the firmware fail on purpose in each way, and checks the line and the colour it ends with.
pub fn faults() -> Result<()> {
    const RED: [u8; 3] = [255, 0, 0];
    const MAGENTA: [u8; 3] = [255, 0, 255];
    const YELLOW: [u8; 3] = [255, 255, 0];
    let cases = [
        ("panic", "stopped: panic", RED),
        ("panic-1", "stopped: panic", RED),
        ("address", "stopped: fault", MAGENTA),
        ("address-1", "stopped: fault", MAGENTA),
        ("stack", "stopped: fault", MAGENTA),
        ("stack-1", "stopped: fault", MAGENTA),
        ("hang", "stopped: watchdog", YELLOW),
    ];
    for (fault, line, colour) in cases {
        let program = build(Screen::Square, fault)?;
        let rgb = scratch("fault.rgb")?;
        let mut emulator = emulator(&program)?;
        emulator
            .args([
                "--quiet",
                "--until",
                "stopped",
                "--after",
                "200",
                "--seconds",
                "20",
                "--rgb",
            ])
            .arg(&rgb);
        let finished = process::run(&mut emulator, LIMIT, false)?;
        ensure!(
            finished.status.success(),
            "{fault}: {}\n{}",
            finished.status,
            finished.stderr
        );
        ensure!(
            finished.stdout.lines().any(|l| l == line),
            "{fault}: no line {line:?} in {:?}",
            finished.stdout
        );
        let shown = fs::read(&rgb)?;
        ensure!(
            shown.chunks_exact(3).all(|pixel| pixel == colour),
            "{fault}: the display is not all {colour:?}"
        );
        println!("{fault:<9} {line:<17} display {colour:?}");
    }
    Ok(())
}

/// The emulator for a program of `firmware/qemu`, which prints by semihosting and exits.
pub fn bare(program: &Path) -> Result<Command> {
    let mut emulator = emulator(program)?;
    emulator.arg("--quiet");
    Ok(emulator)
}

/// Builds the firmware; `provoke` names a fault that it then has.
fn build(screen: Screen, provoke: &str) -> Result<PathBuf> {
    let features: &[_] = if screen == Screen::Wide { &["wide"] } else { &[] };
    let build = Build {
        package: "pico",
        features,
        environment: &[("MICROLUX_PROVOKE", provoke)],
        name: "pico",
    };
    toolchain::build(&build, "thumbv6m-none-eabi", "firmware-pico")
}

/// Node with the emulator's script; installs its two packages the first time.
fn emulator(program: &Path) -> Result<Command> {
    let folder = toolchain::firmware().join("emulator/rp2040");
    if !folder.join("node_modules").is_dir() {
        let mut npm = Command::new("npm");
        npm.args(["ci", "--no-audit", "--no-fund"]).current_dir(&folder);
        let finished = process::run(&mut npm, LIMIT, false)?;
        ensure!(
            finished.status.success(),
            "npm ci: {}\n{}",
            finished.status,
            finished.stderr
        );
    }
    let mut node = Command::new("node");
    node.arg(folder.join("run.mjs")).arg(program);
    Ok(node)
}

/// A file among the build's, not there yet.
fn scratch(name: &str) -> Result<PathBuf> {
    let file = toolchain::work_folder()?.join(name);
    match fs::remove_file(&file) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error.into()),
        _ => Ok(file),
    }
}

/// The frame as the panel shows it: 8 bits a channel, the highest bits repeated below.
fn colours(frame: Frame) -> Vec<u8> {
    let (width, height) = (frame.width() as usize, frame.height() as usize);
    let mut colours = vec![0; 3 * width * height];
    let mut pixels = [0; tile::PIXELS];
    for index in 0..frame.tiles() {
        frame.render(index, &mut pixels);
        let (left, top) = frame.origin(index);
        for (place, &pixel) in (0..).zip(&pixels) {
            let x = (left + place % tile::SIDE) as usize;
            let y = (top + place / tile::SIDE) as usize;
            let (red, green, blue) = (pixel >> 11, (pixel >> 5) & 63, pixel & 31);
            let wide = [
                red << 3 | red >> 2,
                green << 2 | green >> 4,
                blue << 3 | blue >> 2,
            ];
            colours[3 * (y * width + x)..][..3].copy_from_slice(&wide.map(|channel| channel as u8));
        }
    }
    colours
}

/// Where two pictures of equal size differ first.
fn first_difference(shown: &[u8], expected: &[u8], width: u32) -> Result<Option<(u32, u32)>> {
    ensure!(
        shown.len() == expected.len(),
        "{} bytes on the display, {} expected",
        shown.len(),
        expected.len()
    );
    let pixels = shown.chunks_exact(3).zip(expected.chunks_exact(3));
    Ok((0..)
        .zip(pixels)
        .find(|(_, (a, b))| a != b)
        .map(|(place, _)| (place % width, place / width)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_first_difference() {
        let expected = colours(tile::SQUARE);
        let mut shown = expected.clone();
        assert_eq!(first_difference(&shown, &expected, 240).unwrap(), None);
        shown[3 * (5 * 240 + 7) + 1] ^= 1;
        assert_eq!(first_difference(&shown, &expected, 240).unwrap(), Some((7, 5)));
        assert!(first_difference(&shown[3..], &expected, 240).is_err());
    }
}
