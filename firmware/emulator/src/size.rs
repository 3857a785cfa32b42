//! Flash and RAM that each board's program takes.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result};
use object::{Object, ObjectSection, SectionFlags, elf};

use crate::toolchain::{self, Build};

/// A board's own firmware; the micro:bit's is the jobs.
pub struct Board {
    pub name: &'static str,
    package: &'static str,
    program: &'static str,
    target: &'static str,
}

pub const BOARDS: [Board; 4] = [
    Board {
        name: "microbit",
        package: "qemu",
        program: "firmware-qemu",
        target: "thumbv6m-none-eabi",
    },
    Board {
        name: "pico",
        package: "pico",
        program: "firmware-pico",
        target: "thumbv6m-none-eabi",
    },
    Board {
        name: "pico2",
        package: "pico2",
        program: "firmware-pico2",
        target: "thumbv8m.main-none-eabihf",
    },
    Board {
        name: "esp32c3",
        package: "esp32c3",
        program: "firmware-esp32c3",
        target: "riscv32imc-unknown-none-elf",
    },
];

/// Bytes that a program takes, without the stack of its first core and without code that is copied to RAM.
#[derive(Debug, PartialEq, Eq)]
pub struct Size {
    pub flash: u64,
    pub ram: u64,
}

/// Builds every board's program, which fails if one does not fit, and prints a table.
pub fn table() -> Result<()> {
    println!("board      flash bytes   ram bytes");
    for board in &BOARDS {
        let size = of(&board.build()?)?;
        println!("{:<9} {:>12} {:>11}", board.name, size.flash, size.ram);
    }
    Ok(())
}

impl Board {
    /// Builds it as it is flashed.
    pub fn build(&self) -> Result<PathBuf> {
        let environment = ["MICROLUX_PROVOKE", "MICROLUX_MESH", "MICROLUX_FIRST"].map(|name| (name, ""));
        let build = Build {
            package: self.package,
            features: &[],
            environment: &[&environment[..], &[("MACHINE", self.name)]].concat(),
            name: self.name,
        };
        toolchain::build(&build, self.target, self.program)
    }
}

/// Adds up the sections of an ELF file: those with contents lie in flash, those that can be written in RAM.
pub fn of(program: &Path) -> Result<Size> {
    let bytes = fs::read(program)?;
    let file = object::File::parse(&*bytes).with_context(|| program.display().to_string())?;
    let mut size = Size { flash: 0, ram: 0 };
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags } = section.flags() else {
            continue;
        };
        let has = |flag: u32| sh_flags & u64::from(flag) != 0;
        let is_reserve = section
            .name()
            .is_ok_and(|name| name.contains("stack") || name.contains("heap"));
        if !has(elf::SHF_ALLOC) || is_reserve {
            continue;
        }
        if has(elf::SHF_WRITE) {
            size.ram += section.size();
        }
        if section.file_range().is_some() {
            size.flash += section.size();
        }
    }
    Ok(size)
}
