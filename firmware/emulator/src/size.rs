//! Flash and RAM that each board's program takes.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result};
use object::{Object, ObjectSection, SectionFlags, elf};

use xtask::board::Board;

use crate::{
    machine::MICROBIT,
    pico, profile,
    toolchain::{self, Build},
};

/// A board's own firmware; the micro:bit's is the jobs.
pub struct Program {
    pub board: Board,
    package: &'static str,
    name: &'static str,
}

pub const PROGRAMS: [Program; 4] = [
    Program {
        board: Board::Microbit,
        package: "qemu",
        name: "firmware-qemu",
    },
    Program {
        board: Board::Pico,
        package: "pico",
        name: "firmware-pico",
    },
    Program {
        board: Board::Pico2,
        package: "pico2",
        name: "firmware-pico2",
    },
    Program {
        board: Board::Esp32c3,
        package: "esp32c3",
        name: "firmware-esp32c3",
    },
];

/// Bytes that a program takes, without the stack of its first core and without code that is copied to RAM.
#[derive(Debug, PartialEq, Eq)]
pub struct Size {
    pub flash: u64,
    pub ram: u64,
}

/// Builds every board's program, which fails if one or the stacks of two cores do not fit, and prints a table.
pub fn table() -> Result<()> {
    println!("board      flash bytes   ram bytes");
    for program in &PROGRAMS {
        let (file, name) = (program.build()?, program.board.name());
        let size = of(&file)?;
        println!("{name:<9} {:>12} {:>11}", size.flash, size.ram);
        if matches!(program.board, Board::Pico | Board::Pico2) {
            pico::bounds(&file, name)?;
            let (file, name) = (program.build_with(&["full"])?, format!("{name}, full"));
            let size = of(&file)?;
            println!("{name:<11} {:>10} {:>11}", size.flash, size.ram);
            pico::bounds(&file, &name)?;
        }
    }
    // No board's, but it shall build, too.
    profile::program(MICROBIT)?;
    Ok(())
}

impl Program {
    /// Builds it as it is flashed.
    pub fn build(&self) -> Result<PathBuf> {
        self.build_with(&[])
    }

    fn build_with(&self, features: &[&str]) -> Result<PathBuf> {
        let environment = ["MICROLUX_PROVOKE", "MICROLUX_MESH", "MICROLUX_FIRST"].map(|name| (name, ""));
        let build = Build {
            package: self.package,
            features,
            environment: &[&environment[..], &toolchain::machine(self.board.name())].concat(),
            name: self.board.name(),
        };
        toolchain::build(&build, self.board.target(), self.name)
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
