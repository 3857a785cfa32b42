//! What a picture costs on each core, as a table, as JSON and as the record `docs/device.md`.

use std::{
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context, Result, ensure};
use firmware_common::{
    crc::Crc,
    golden::{self, Case, Outcome, Pattern},
    jobs::{self, Work},
    stage::NAMES,
    tile::{self, PASSES},
};
use serde_json::{Value, json};
use xtask::{
    no_float::symbols::{self, SoftFloat},
    shell,
    toolchain::Embedded,
};

use crate::{
    count,
    machine::Machine,
    pico::{self, Goal, Screen},
    size::{self, BOARDS},
};

/// Where and how to report.
pub struct Options<'a> {
    /// Runs that must agree.
    pub runs: u32,
    pub json: Option<&'a Path>,
    /// The record to write.
    pub record: Option<&'a Path>,
}

/// A picture on a core.
struct Row {
    core: &'static str,
    scene: String,
    instructions: u64,
    /// Of cores that the model speaks of.
    m0plus_cycles: Option<u64>,
    pixels: u64,
    samples: u64,
    rays: u64,
    crc: u32,
}

/// The Pico's whole program.
struct Frame {
    scene: &'static str,
    /// From the start, emulated.
    first_ms: f64,
    preview_ms: f64,
    last_ms: f64,
    stacks: [u64; 2],
}

/// Bytes of either core's stack on the Pico: `memory.x` and `firmware/pico/src/app.rs`.
const PICO_STACK: u64 = 16 * 1024;

pub fn run(options: &Options) -> Result<()> {
    let mut text = String::new();
    let programs = check_symbols()?;
    let (mut rows, memories) = pictures(options.runs)?;
    let mut frames = Vec::new();
    for scene in 0..NAMES.len() {
        let (frame, row) = pico_frame(scene)?;
        frames.push(frame);
        rows.push(row);
    }
    costs(&mut text, &rows)?;
    display(&mut text, &frames)?;
    space(&mut text, &memories, &frames)?;
    writeln!(
        text,
        "\nNo soft-float routine and no formatting code among the symbols of {}.",
        programs.join(", ")
    )?;
    print!("{text}");
    if let Some(file) = options.json {
        let rows: Vec<_> = rows.iter().map(Row::json).collect();
        write(file, &format!("{:#}\n", Value::from(rows)))?;
    }
    if let Some(file) = options.record {
        write(file, &format!("{}\n{text}", heading(options.runs)?))?;
    }
    Ok(())
}

impl Row {
    fn json(&self) -> Value {
        json!({
            "core": self.core,
            "scene": self.scene,
            "instructions": self.instructions,
            "m0plus_cycles": self.m0plus_cycles,
            "pixels": self.pixels,
            "samples": self.samples,
            "rays": self.rays,
            "crc": self.crc,
        })
    }
}

/// Each scene by each integrator on each machine of QEMU's, and what memory the micro:bit took for each.
fn pictures(runs: u32) -> Result<(Vec<Row>, Vec<Memory>)> {
    let plugin = count::plugin()?;
    let cases: Vec<(u32, &str, Case)> = (0..)
        .zip(jobs::all())
        .filter_map(|(id, job)| match job.work {
            Work::Picture(case) if case.sampler == Pattern::Independent && case.seed == 1 => {
                Some((id, job.name, case))
            }
            _ => None,
        })
        .collect();
    let outcomes: Vec<Outcome> = cases.iter().map(|(_, _, case)| case.run()).collect();
    let (mut rows, mut memories) = (Vec::new(), Vec::new());
    for machine in Machine::ALL.into_iter().filter(|machine| machine.in_qemu()) {
        eprintln!("{}", machine.name());
        let program = machine.build()?;
        let printed = machine.run_in_qemu(&program, &[])?;
        if machine == Machine::Microbit {
            for (_, name, _) in &cases {
                memories.push(Memory::find(&printed, name)?);
            }
        }
        let counts = count::agreed(machine, &program, &plugin, runs)?;
        for ((id, name, case), outcome) in cases.iter().zip(&outcomes) {
            let line = format!("{name} crc32={:08x}", outcome.crc);
            ensure!(
                printed.lines().any(|printed| printed == line),
                "{}: no line {line:?}",
                machine.name()
            );
            let spent = counts.regions.get(id).context("a job was not counted")?;
            let pixels = u64::from(golden::SETTINGS.width) * u64::from(golden::SETTINGS.height);
            rows.push(Row {
                core: machine.core(),
                scene: format!("{}-{}", case.scene.name(), case.integrator.name()),
                instructions: spent.instructions,
                m0plus_cycles: machine.is_armv6m().then_some(spent.cycles),
                pixels,
                samples: pixels * u64::from(golden::SETTINGS.spp),
                rays: u64::from(outcome.rays),
                crc: outcome.crc,
            });
        }
    }
    Ok((rows, memories))
}

/// The Pico's program up to the end of a scene's first full pass.
fn pico_frame(scene: usize) -> Result<(Frame, Row)> {
    eprintln!("pico, {}", NAMES[scene]);
    let goal = Goal {
        scene,
        pass: PASSES[1],
    };
    let shown = pico::run(&pico::Run {
        screen: Screen::Square,
        goal,
        mesh: None,
        png: None,
        json: None,
        seconds: 60,
        quiet: true,
    })?;
    let number = |value: &Value| value.as_f64().context("not a number in the emulator's report");
    let whole = |value: &Value| {
        value
            .as_u64()
            .context("not a whole number in the emulator's report")
    };
    let report = &shown.report;
    let frame = Frame {
        scene: NAMES[scene],
        first_ms: number(&report["first_pixel_ms"])?,
        preview_ms: number(&report["frame_ms"][0])?,
        last_ms: number(&report["frame_ms"][1])?,
        stacks: [
            whole(&report["stack_bytes"][0])?,
            whole(&report["stack_bytes"][1])?,
        ],
    };
    let mut crc = Crc::new();
    crc.bytes(&shown.rgb);
    let pixels = u64::from(tile::SQUARE.width() * tile::SQUARE.height());
    let row = Row {
        core: "2 x Cortex-M0+",
        scene: format!("{}-240x240", NAMES[scene]),
        instructions: whole(&report["instructions"][0])? + whole(&report["instructions"][1])?,
        m0plus_cycles: Some(2 * whole(&report["cycles"])?),
        pixels,
        samples: pixels,
        rays: u64::from(shown.rays),
        crc: crc.value(),
    };
    Ok((frame, row))
}

fn costs(text: &mut String, rows: &[Row]) -> Result<()> {
    text.push_str(
        "## Instructions and cycles\n\n\
        Pictures of `tests/golden.txt`: 30 x 25 pixels, 4 samples each, independent sampler, seed 1, scene set-up \
        included. A ray: a path segment or a shadow ray. Frame: 240 x 240 pixels of one sample each, by the mean. \
        `2 x Cortex-M0+`: the Pico's whole program from reset to the end of the first full pass, preview, display \
        and waiting included, cycles of both cores.\n\n\
        | core | scene | instructions | a sample | a ray | a frame | M0+ cycles | a sample | a ray | a pixel | CRC-32 |\n\
        | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |\n",
    );
    let frame = u64::from(tile::SQUARE.width() * tile::SQUARE.height());
    for row in rows {
        let cycles = |divisor: u64| {
            row.m0plus_cycles
                .map_or_else(|| "-".to_owned(), |cycles| (cycles / divisor).to_string())
        };
        writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {:08x} |",
            row.core,
            row.scene,
            row.instructions,
            row.instructions / row.samples,
            row.instructions / row.rays,
            row.instructions * frame / row.samples,
            cycles(1),
            cycles(row.samples),
            cycles(row.rays),
            cycles(row.pixels),
            row.crc
        )?;
    }
    Ok(())
}

fn display(text: &mut String, frames: &[Frame]) -> Result<()> {
    text.push_str(
        "\n## The Pico's display, emulated at 133 MHz\n\n\
        `direct`, both cores. Milliseconds from reset to the first pixel, to the last one of the preview of 60 x 60 \
        blocks, to the last one at one sample a pixel.\n\n\
        | scene | first pixel | preview | 1 spp |\n| --- | ---: | ---: | ---: |\n",
    );
    for frame in frames {
        writeln!(
            text,
            "| {} | {:.1} | {:.1} | {:.1} |",
            frame.scene, frame.first_ms, frame.preview_ms, frame.last_ms
        )?;
    }
    Ok(())
}

fn space(text: &mut String, memories: &[Memory], frames: &[Frame]) -> Result<()> {
    text.push_str(
        "\n## Flash and RAM, bytes\n\n\
        RAM: variables, core 1's stack among them; core 0's stack comes on top.\n\n\
        | board | flash | RAM |\n| --- | ---: | ---: |\n",
    );
    for board in &BOARDS {
        let size = size::of(&board.build()?)?;
        writeln!(text, "| {} | {} | {} |", board.name, size.flash, size.ram)?;
    }
    text.push_str(
        "\n## Deepest stacks, bytes\n\n\
        Measured: painted on the micro:bit, the lowest stack pointer on the Pico.\n\n\
        | program | deepest | room | margin |\n| --- | ---: | ---: | ---: |\n",
    );
    for Memory {
        name,
        variables,
        stack,
        room,
    } in memories
    {
        let free = room - variables;
        let margin = free
            .checked_sub(*stack)
            .context("a stack is larger than its room")?;
        writeln!(text, "| micro:bit, {name} | {stack} | {free} | {margin} |")?;
    }
    for frame in frames {
        for (core, deepest) in frame.stacks.iter().enumerate() {
            let margin = PICO_STACK
                .checked_sub(*deepest)
                .context("a stack is larger than its room")?;
            writeln!(
                text,
                "| Pico, {}, core {core} | {deepest} | {PICO_STACK} | {margin} |",
                frame.scene
            )?;
        }
    }
    Ok(())
}

/// Bytes of RAM that a job took on the micro:bit.
#[derive(Debug, PartialEq, Eq)]
struct Memory {
    name: String,
    variables: u64,
    stack: u64,
    /// What there is for both.
    room: u64,
}

impl Memory {
    /// From the line `memory NAME variables=.. stack=.. room=..`.
    fn find(printed: &str, name: &str) -> Result<Memory> {
        let line = printed
            .lines()
            .find_map(|line| {
                line.strip_prefix("memory ")?
                    .strip_prefix(name)?
                    .strip_prefix(' ')
            })
            .with_context(|| format!("no line about the memory of {name}"))?;
        let mut words = line.split(' ');
        let mut next = |key: &str| -> Result<u64> {
            let value = words
                .next()
                .and_then(|word| word.strip_prefix(key)?.strip_prefix('='));
            Ok(value.with_context(|| format!("no {key} in {line:?}"))?.parse()?)
        };
        Ok(Memory {
            name: name.to_owned(),
            variables: next("variables")?,
            stack: next("stack")?,
            room: next("room")?,
        })
    }
}

/// Fails if a board's own program has soft-float routines or `core`'s formatting; returns the boards.
///
/// The micro:bit's runs the jobs and prints by `core`'s formatting, so that only floats count there.
fn check_symbols() -> Result<Vec<&'static str>> {
    let soft_float = SoftFloat::new();
    let mut clean = Vec::new();
    for board in &BOARDS {
        let names = symbols::names(&fs::read(board.build()?)?)?;
        let floats: Vec<_> = names.iter().filter(|name| soft_float.is(name)).collect();
        ensure!(floats.is_empty(), "{}: soft-float symbols {floats:?}", board.name);
        let formatting: Vec<_> = names.iter().filter(|name| is_formatting(name)).collect();
        ensure!(
            board.name == "microbit" || formatting.is_empty(),
            "{}: formatting code {formatting:?}",
            board.name
        );
        clean.push(board.name);
    }
    Ok(clean)
}

/// Whether the name, in either mangling, is of a function in `core::fmt`, or of an implementation of its traits.
fn is_formatting(name: &str) -> bool {
    name.contains("4core3fmt") || (name.contains("4core") && name.contains("3fmt"))
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
        - date: {}\n- commit: {state}\n- flags: opt-level 3, fat LTO, one codegen unit, panic = abort\n\
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_the_memory_line() {
        let printed = "memory a-1 variables=1 stack=2 room=3\nmemory a variables=128 stack=5688 room=16384\n";
        let memory = Memory::find(printed, "a").unwrap();
        assert_eq!((memory.variables, memory.stack, memory.room), (128, 5688, 16384));
        assert!(Memory::find(printed, "b").is_err());
    }

    #[test]
    fn knows_formatting_by_its_name() {
        assert!(is_formatting("_ZN4core3fmt5write17h0123456789abcdefE"));
        assert!(is_formatting("_RNvMsa_NtCs12_4core3fmtNtB5_9Formatter3pad"));
        assert!(is_formatting(
            "_RNvXs_NtNtCs12_4core3fmt3num3impmNtB8_7Display3fmt"
        ));
        assert!(!is_formatting("_RNvNtCseold96UKqg_4core9panicking9panic_fmt"));
        assert!(!is_formatting(
            "_ZN8microlux6render8Renderer4tile17h2496300b2046248cE"
        ));
    }
}
