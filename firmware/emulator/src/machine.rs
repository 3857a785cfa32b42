//! Everything that runs the common jobs.

use std::{path::Path, process::Command, time::Duration};

use anyhow::{Result, bail};
use clap::{ValueEnum, builder::PossibleValue};
use firmware_common::jobs::{self, Job, Means};
use xtask::{board::Board, setup::Part};

use crate::{
    pico, process,
    toolchain::{self, Build},
};

/// Longest run of the jobs, on a busy machine.
const LIMIT: Duration = Duration::from_secs(900);

/// A place to run the jobs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Machine {
    /// This computer.
    Host,
    /// WebAssembly in node.
    Wasm32,
    /// A board or machine in an emulator.
    Emulated(Board),
}

/// The one with the least memory.
pub const MICROBIT: Machine = Machine::Emulated(Board::Microbit);

/// The Pico's chip without a display, core 0 alone.
pub const RP2040: Machine = Machine::Emulated(Board::Rp2040);

impl Machine {
    pub const ALL: [Self; 9] = [
        Self::Host,
        Self::Wasm32,
        MICROBIT,
        Self::Emulated(Board::Rp2040),
        Self::Emulated(Board::Mps2An385),
        Self::Emulated(Board::Mps2An386),
        Self::Emulated(Board::Mps2An500),
        Self::Emulated(Board::Mps2An505),
        Self::Emulated(Board::Virt),
    ];

    /// Name on the command line, in QEMU and of the memory layout in `firmware/qemu/memory`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Host => "host",
            Self::Wasm32 => "wasm32",
            Self::Emulated(board) => board.name(),
        }
    }

    pub const fn core(self) -> &'static str {
        match self {
            Self::Host => std::env::consts::ARCH,
            Self::Wasm32 => "wasm32",
            Self::Emulated(board) => board.core(),
        }
    }

    /// Whether QEMU emulates it, so that its instructions can be counted.
    pub fn in_qemu(self) -> bool {
        matches!(self, Self::Emulated(board) if board.emulated_by() == Some(Part::Qemu))
    }

    /// Whether the Cortex-M0+ cycle model speaks of its code.
    pub fn is_armv6m(self) -> bool {
        self.target().starts_with("thumbv6m")
    }

    /// Whether the job is among those that run there.
    pub fn runs(self, job: &Job) -> bool {
        Means::of(self.name()).reach(job)
    }

    pub const fn target(self) -> &'static str {
        match self {
            Self::Host => "",
            Self::Wasm32 => "wasm32-unknown-unknown",
            Self::Emulated(board) => board.target(),
        }
    }

    /// Builds the program that runs the jobs there.
    pub fn build(self) -> Result<std::path::PathBuf> {
        let (package, program) = match self {
            Self::Wasm32 => ("wasm", "firmware_wasm"),
            _ => ("qemu", "firmware-qemu"),
        };
        let features: &[_] = match self {
            Self::Emulated(_) if Means::of(self.name()).roomy => &["roomy"],
            _ => &[],
        };
        let build = Build {
            package,
            features,
            environment: &toolchain::machine(self.name()),
            name: self.name(),
        };
        toolchain::build(&build, self.target(), program)
    }

    /// QEMU for this machine, up to the program and plugins.
    pub fn qemu(self) -> Command {
        let mut qemu = match self {
            Self::Emulated(Board::Virt) => {
                let mut qemu = Command::new("qemu-system-riscv32");
                qemu.args(["-bios", "none"]);
                qemu
            }
            _ => Command::new("qemu-system-arm"),
        };
        qemu.args([
            "-machine",
            self.name(),
            "-nographic",
            "-monitor",
            "none",
            "-serial",
            "none",
        ]);
        qemu.args(["-semihosting-config", "enable=on,target=native"]);
        qemu
    }

    /// Runs all jobs and returns their lines.
    pub fn run(self) -> Result<String> {
        match self {
            Self::Host => Ok((0..)
                .zip(jobs::all())
                .map(|(id, job)| format!("{} crc32={:08x}\n", job.name, job.run(id)))
                .collect()),
            Self::Wasm32 => {
                let script = toolchain::firmware().join("wasm/run.mjs");
                self.lines(Command::new("node").arg(script).arg(self.build()?))
            }
            Self::Emulated(Board::Rp2040) => self.lines(&mut pico::bare(&self.build()?)?),
            _ => self.run_in_qemu(&self.build()?, &[]),
        }
    }

    /// Runs a built program in QEMU, with further arguments.
    pub fn run_in_qemu(self, program: &Path, arguments: &[String]) -> Result<String> {
        self.lines(self.qemu().args(arguments).arg("-kernel").arg(program))
    }

    fn lines(self, command: &mut Command) -> Result<String> {
        let finished = process::run(command, LIMIT, false)?;
        if !finished.status.success() {
            bail!(
                "{}: {}\n{}{}",
                self.name(),
                finished.status,
                finished.stdout,
                finished.stderr
            );
        }
        Ok(finished.stdout)
    }
}

impl ValueEnum for Machine {
    fn value_variants<'a>() -> &'a [Self] {
        &Self::ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.name()).help(self.core()))
    }
}
