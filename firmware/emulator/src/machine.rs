//! Everything that runs the common jobs.

use std::{path::Path, process::Command, time::Duration};

use anyhow::{Result, bail};
use clap::ValueEnum;
use firmware_common::jobs;

use crate::{
    pico, process,
    toolchain::{self, Build},
};

/// Longest run of the jobs, on a busy machine.
const LIMIT: Duration = Duration::from_secs(900);

/// A place to run the jobs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Machine {
    /// this computer
    Host,
    /// WebAssembly in node
    Wasm32,
    /// BBC micro:bit, Cortex-M0, in QEMU
    Microbit,
    /// Raspberry Pi Pico's chip, Cortex-M0+, in its own emulator
    Rp2040,
    /// Cortex-M3 in QEMU
    Mps2An385,
    /// Cortex-M4F in QEMU
    Mps2An386,
    /// Cortex-M7 in QEMU
    Mps2An500,
    /// Cortex-M33 in QEMU
    Mps2An505,
    /// RV32IMC in QEMU
    Virt,
}

impl Machine {
    pub const ALL: [Self; 9] = [
        Self::Host,
        Self::Wasm32,
        Self::Microbit,
        Self::Rp2040,
        Self::Mps2An385,
        Self::Mps2An386,
        Self::Mps2An500,
        Self::Mps2An505,
        Self::Virt,
    ];

    /// Name on the command line, in QEMU and of the memory layout in `firmware/qemu/memory`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Host => "host",
            Self::Wasm32 => "wasm32",
            Self::Microbit => "microbit",
            Self::Rp2040 => "rp2040",
            Self::Mps2An385 => "mps2-an385",
            Self::Mps2An386 => "mps2-an386",
            Self::Mps2An500 => "mps2-an500",
            Self::Mps2An505 => "mps2-an505",
            Self::Virt => "virt",
        }
    }

    pub const fn core(self) -> &'static str {
        match self {
            Self::Host => std::env::consts::ARCH,
            Self::Wasm32 => "wasm32",
            Self::Microbit => "Cortex-M0",
            Self::Rp2040 => "Cortex-M0+",
            Self::Mps2An385 => "Cortex-M3",
            Self::Mps2An386 => "Cortex-M4F",
            Self::Mps2An500 => "Cortex-M7",
            Self::Mps2An505 => "Cortex-M33",
            Self::Virt => "RV32IMC",
        }
    }

    /// Whether QEMU emulates it, so that its instructions can be counted.
    pub const fn in_qemu(self) -> bool {
        !matches!(self, Self::Host | Self::Wasm32 | Self::Rp2040)
    }

    /// Whether the Cortex-M0+ cycle model speaks of its code.
    pub const fn is_armv6m(self) -> bool {
        matches!(self, Self::Microbit | Self::Rp2040)
    }

    const fn target(self) -> &'static str {
        match self {
            Self::Host => "",
            Self::Wasm32 => "wasm32-unknown-unknown",
            Self::Microbit | Self::Rp2040 => "thumbv6m-none-eabi",
            Self::Mps2An385 => "thumbv7m-none-eabi",
            Self::Mps2An386 | Self::Mps2An500 => "thumbv7em-none-eabihf",
            Self::Mps2An505 => "thumbv8m.main-none-eabihf",
            Self::Virt => "riscv32imc-unknown-none-elf",
        }
    }

    /// Builds the program that runs the jobs there.
    pub fn build(self) -> Result<std::path::PathBuf> {
        let (package, program) = match self {
            Self::Wasm32 => ("wasm", "firmware_wasm"),
            _ => ("qemu", "firmware-qemu"),
        };
        let build = Build {
            package,
            features: &[],
            environment: &[("MACHINE", self.name())],
            name: self.name(),
        };
        toolchain::build(&build, self.target(), program)
    }

    /// QEMU for this machine, up to the program and plugins.
    pub fn qemu(self) -> Command {
        let mut qemu = match self {
            Self::Virt => {
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
            Self::Host => Ok(jobs::all()
                .map(|job| format!("{} crc32={:08x}\n", job.name, job.run()))
                .collect()),
            Self::Wasm32 => {
                let script = toolchain::firmware().join("wasm/run.mjs");
                self.lines(Command::new("node").arg(script).arg(self.build()?))
            }
            Self::Rp2040 => self.lines(&mut pico::bare(&self.build()?)?),
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
