//! What each stage of the denoiser takes, on four cores.

use std::{fs, path::Path};

use anyhow::{Context, Result, ensure};
use firmware_common::cost::{self, FILTER, STAGES};
use microlux::scene::builtin::Builtin;
use serde_json::{Value, json};
use xtask::board::Board;

use crate::{
    count,
    machine::Machine,
    toolchain::{self, Build},
};

/// A core's code, and the machine that runs it.
struct Core {
    name: &'static str,
    machine: Board,
    target: &'static str,
}

/// The micro:bit has no room for a frame: a Cortex-M3, which has every instruction of a Cortex-M0+, runs that code.
const CORES: [Core; 4] = [
    Core {
        name: "Cortex-M0+",
        machine: Board::Mps2An385,
        target: Board::Pico.target(),
    },
    Core {
        name: Board::Mps2An386.core(),
        machine: Board::Mps2An386,
        target: Board::Mps2An386.target(),
    },
    Core {
        name: Board::Mps2An505.core(),
        machine: Board::Mps2An505,
        target: Board::Mps2An505.target(),
    },
    Core {
        name: Board::Virt.core(),
        machine: Board::Virt,
        target: Board::Virt.target(),
    },
];

/// Runs that must agree.
const RUNS: u32 = 2;

/// Builds, counts, compares with this computer, and writes a row for each core.
pub fn run(file: &Path) -> Result<()> {
    let plugin = count::plugin()?;
    let expected = cost::run(Builtin::Cornell);
    ensure!(expected != 0, "the denoiser refuses the frame");
    let rows = CORES.iter().map(|core| row(core, &plugin, expected));
    let rows = rows.collect::<Result<Vec<_>>>()?;
    let text = format!("{:#}\n", Value::from(rows));
    fs::write(file, text).with_context(|| file.display().to_string())
}

fn row(core: &Core, plugin: &Path, expected: u32) -> Result<Value> {
    eprintln!("denoiser, {}", core.name);
    let machine = Machine::Emulated(core.machine);
    let build = Build {
        package: "qemu",
        features: &["roomy"],
        environment: &[("MACHINE", machine.name())],
        name: &format!("denoiser-{}", core.target),
    };
    let program = toolchain::build(&build, core.target, "denoiser")?;
    let counts = count::agreed(machine, &program, plugin, RUNS)?;
    let printed = machine.run_in_qemu(&program, &[])?;
    let pixels = cost::SIZE.pixels();
    let line = format!("denoiser pixels={pixels} crc32={expected:08x}");
    ensure!(
        printed.lines().any(|printed| printed == line),
        "{}: {printed:?}, not {line:?} as on this computer",
        core.name
    );
    let has_cycles = core.target.starts_with("thumbv6m");
    let spent = |id: u32| {
        let spent = counts
            .regions
            .get(&id)
            .with_context(|| format!("no region {id}"))?;
        anyhow::Ok([spent.instructions, spent.cycles])
    };
    let stages = (0..).zip(STAGES).map(|(id, stage)| {
        let mut own = spent(id)?;
        if id == FILTER.0 {
            let part = spent(FILTER.1)?;
            own = [own[0] - part[0], own[1] - part[1]];
        }
        Ok(json!({
            "stage": stage,
            "instructions": own[0],
            "m0plus_cycles": has_cycles.then_some(own[1]),
        }))
    });
    Ok(json!({
        "core": core.name,
        "pixels": pixels,
        "crc": expected,
        "stages": stages.collect::<Result<Vec<_>>>()?,
    }))
}
