//! What a picture costs on each core, as a table, as JSON and as the record `docs/device.md`.

mod costs;
mod space;

use std::{
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context, Result, ensure};
use firmware_common::{
    stage::NAMES,
    tile::{self, PASSES},
};
use microlux::num::Crc;
use serde_json::Value;
use xtask::{shell, toolchain::Embedded};

use crate::{
    pico::{self, Goal, Screen},
    stack::Depth,
};
use costs::{Row, RowKind};

/// Where and how to report.
pub struct Options<'a> {
    /// Runs that must agree.
    pub runs: u32,
    pub json: Option<&'a Path>,
    /// The record to write.
    pub record: Option<&'a Path>,
}

/// The Pico's whole program up to the end of a scene's first full pass.
struct Frame {
    scene: &'static str,
    /// From the start, emulated.
    first_ms: f64,
    preview_ms: f64,
    last_ms: f64,
    row: Row,
}

pub fn run(options: &Options) -> Result<()> {
    let mut text = String::new();
    let programs = space::check_symbols()?;
    let mut counted = costs::count(options.runs)?;
    let mut frames = Vec::new();
    for scene in 0..NAMES.len() {
        let (frame, depths) = pico_frame(scene, options.runs)?;
        frames.push(frame);
        counted.depths.extend(depths);
    }
    costs::tables(&mut text, &counted.rows)?;
    display(&mut text, &frames)?;
    space::sizes(&mut text)?;
    space::stacks(&mut text, &counted)?;
    writeln!(
        text,
        "\nNo soft-float routine and no formatting code among the symbols of {}.",
        programs.join(", ")
    )?;
    print!("{text}");
    if let Some(file) = options.json {
        let rows = counted.rows.iter().chain(frames.iter().map(|frame| &frame.row));
        let rows: Vec<_> = rows.map(Row::json).collect();
        write(file, &format!("{:#}\n", Value::from(rows)))?;
    }
    if let Some(file) = options.record {
        write(file, &format!("{}\n{text}", heading(options.runs)?))?;
    }
    Ok(())
}

/// Runs the Pico's program up to the end of a scene's first full pass, `runs` times, which must agree.
fn pico_frame(scene: usize, runs: u32) -> Result<(Frame, Vec<Depth>)> {
    eprintln!("pico, {}", NAMES[scene]);
    let goal = Goal::Still {
        scene,
        pass: PASSES[1],
    };
    let once = || {
        pico::run(&pico::Run {
            screen: Screen::Square,
            goal,
            mesh: None,
            png: None,
            json: None,
            seconds: 60,
            quiet: true,
        })
    };
    let shown = once()?;
    for _ in 1..runs {
        let again = once()?;
        for key in [
            "cycles",
            "instructions",
            "frame_ms",
            "first_pixel_ms",
            "stack_bytes",
        ] {
            ensure!(
                again.report[key] == shown.report[key],
                "pico, {}: two runs differ in {key}",
                NAMES[scene]
            );
        }
    }
    let number = |value: &Value| value.as_f64().context("not a number in the emulator's report");
    let whole = |value: &Value| {
        value
            .as_u64()
            .context("not a whole number in the emulator's report")
    };
    let report = &shown.report;
    let mut crc = Crc::new();
    crc.bytes(&shown.rgb);
    let pixels = u64::from(tile::SQUARE.width() * tile::SQUARE.height());
    let row = Row {
        core: "2 x Cortex-M0+",
        scene: format!("{}-240x240", NAMES[scene]),
        kind: RowKind::Program,
        instructions: whole(&report["instructions"][0])? + whole(&report["instructions"][1])?,
        m0plus_cycles: Some(2 * whole(&report["cycles"])?),
        pixels,
        samples: pixels,
        rays: u64::from(shown.rays),
        crc: crc.value(),
    };
    let frame = Frame {
        scene: NAMES[scene],
        first_ms: number(&report["first_pixel_ms"])?,
        preview_ms: number(&report["frame_ms"][0])?,
        last_ms: number(&report["frame_ms"][1])?,
        row,
    };
    Ok((frame, shown.depths))
}

fn display(text: &mut String, frames: &[Frame]) -> Result<()> {
    text.push_str(
        "\n## The Pico's display, emulated at 133 MHz\n\n\
        `direct`, both cores. Milliseconds from reset to the first pixel, to the last one of the preview of 60 x 60 \
        blocks, to the last one at one sample a pixel; *frame*: of these, the last pass alone. Instructions and cycles are those of both cores until then and of \
        the whole program: start-up, preview, tone map, display and waiting for one another are in them, so that they \
        tell what a picture takes and not what a ray does.\n\n\
        | scene | first pixel | preview | 1 spp | frame | instructions | cycles | cycles a pixel | CRC-32 of the display |\n\
        | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |\n",
    );
    for frame in frames {
        let row = &frame.row;
        let cycles = row.m0plus_cycles.context("the Pico's cycles are not known")?;
        writeln!(
            text,
            "| {} | {:.1} | {:.1} | {:.1} | {:.1} | {} | {cycles} | {} | {:08x} |",
            frame.scene,
            frame.first_ms,
            frame.preview_ms,
            frame.last_ms,
            frame.last_ms - frame.preview_ms,
            row.instructions,
            cycles / row.pixels,
            row.crc
        )?;
    }
    Ok(())
}

fn heading(runs: u32) -> Result<String> {
    let ask = |program: &str, arguments: &[&str]| {
        let mut command = Command::new(program);
        shell::ask(command.args(arguments).current_dir(shell::root()))
            .map(|text| text.lines().next().unwrap_or_default().to_owned())
            .with_context(|| format!("`{program}` does not answer"))
    };
    let targets = ["thumbv6m-none-eabi", "riscv32imc-unknown-none-elf"];
    let mut compilers = Vec::new();
    for target in targets {
        let rustc = match Embedded::find(target)?.source() {
            xtask::toolchain::Source::Toolchain => ask("rustc", &["--version"])?,
            xtask::toolchain::Source::Debian => ask("/usr/bin/rustc", &["--version"])?,
        };
        if !compilers.contains(&rustc) {
            compilers.push(rustc);
        }
    }
    let state = ask("git", &["describe", "--always", "--dirty", "--abbrev=10"])?;
    Ok(format!(
        "# On the chip\n\n\
        Written by `cargo xtask bench-device`; {runs} runs of each count were equal.\n\n\
        - date: {}\n- commit: {state}\n- flags: opt-level 3 (the micro:bit's jobs: s), fat LTO, one codegen unit, panic = abort\n\
        - compiler: {}\n- emulators: {}; node {}, rp2040js {}\n\n\
        Cycles are those of a Cortex-M0+ with the single-cycle multiplier and memory without wait states \
        (`firmware/emulator/plugin/src/cycles.rs`): no misses of the Pico's flash cache.\n",
        ask("date", &["-u", "+%F"])?,
        compilers.join(", "),
        ask("qemu-system-arm", &["--version"])?,
        ask("node", &["--version"])?,
        rp2040js()?
    ))
}

/// The version that the lock file pins.
fn rp2040js() -> Result<String> {
    let file = shell::root().join("firmware/emulator/rp2040/package-lock.json");
    let lock: Value = serde_json::from_str(&fs::read_to_string(&file)?)?;
    let version = &lock["packages"]["node_modules/rp2040js"]["version"];
    Ok(version
        .as_str()
        .context("rp2040js is not in the lock file")?
        .to_owned())
}

fn write(file: &Path, text: &str) -> Result<()> {
    let parent: PathBuf = file.parent().map(Path::to_path_buf).unwrap_or_default();
    if !parent.as_os_str().is_empty() {
        fs::create_dir_all(&parent).with_context(|| parent.display().to_string())?;
    }
    fs::write(file, text).with_context(|| file.display().to_string())
}
