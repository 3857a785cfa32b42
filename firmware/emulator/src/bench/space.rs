//! Flash, RAM, stacks and symbols of each board's program.

use std::{fmt::Write as _, fs};

use anyhow::{Result, ensure};
use xtask::no_float::symbols::{self, SoftFloat};

use super::costs::Counted;
use crate::{
    size::{self, PROGRAMS},
    stack::{Depth, Memory},
};

/// The table of flash and RAM.
pub fn sizes(text: &mut String) -> Result<()> {
    text.push_str(
        "\n## Flash and RAM, bytes\n\n\
        RAM: variables, core 1's stack among them; core 0's stack comes on top.\n\n\
        | board | flash | RAM |\n| --- | ---: | ---: |\n",
    );
    for program in &PROGRAMS {
        let size = size::of(&program.build()?)?;
        writeln!(
            text,
            "| {} | {} | {} |",
            program.board.name(),
            size.flash,
            size.ram
        )?;
    }
    Ok(())
}

/// The tables of stacks: each program's deepest beside its bound, and what each job takes on the two boards.
pub fn stacks(text: &mut String, counted: &Counted) -> Result<()> {
    let depths = &counted.depths;
    text.push_str(
        "\n## Deepest stacks, bytes\n\n\
        Measured: painted, on the Pico the lowest stack pointer. Bound: no input takes more; from what the compiler says \
        of each function and from the calls in the linked code (`firmware/emulator/src/stack`). Exception: what one \
        interrupt or fault takes on top; the programs enable no interrupt. Margin: what is left under the bound and an \
        exception.\n\n\
        | program | measured | bound | exception | room | margin |\n| --- | ---: | ---: | ---: | ---: | ---: |\n",
    );
    for depth in depths {
        let Depth {
            name,
            measured,
            bound,
            room,
        } = depth;
        depth.check()?;
        writeln!(
            text,
            "| {name} | {measured} | {} | {} | {room} | {} |",
            bound.bytes,
            bound.exception,
            room - bound.bytes - bound.exception
        )?;
    }
    for depth in depths.iter().filter(|depth| !depth.bound.by_pointer.is_empty()) {
        writeln!(
            text,
            "\n{}: calls by pointer, each bounded by the deepest function whose address the program holds, in {}.",
            depth.name,
            depth.bound.by_pointer.join(", ")
        )?;
    }
    text.push_str("\nMeasured on the micro:bit, picture by picture:\n\n");
    jobs(text, &counted.memories)?;
    text.push_str(
        "\nMeasured on the RP2040, the pictures that a micro:bit has no room for, each with its film and the scene's tree; \
        `bdpt-8x8` joins each of 8 surfaces on the camera's path with each of 8 on the light's:\n\n",
    );
    jobs(text, &counted.roomy)
}

fn jobs(text: &mut String, memories: &[Memory]) -> Result<()> {
    text.push_str("| job | stack | of |\n| --- | ---: | ---: |\n");
    for memory in memories {
        let room = memory.room - memory.variables;
        writeln!(text, "| {} | {} | {room} |", memory.name, memory.stack)?;
    }
    Ok(())
}

/// Fails if a board's own program has soft-float routines or `core`'s formatting; returns the boards.
pub fn check_symbols() -> Result<Vec<&'static str>> {
    let soft_float = SoftFloat::new();
    let mut clean = Vec::new();
    for program in &PROGRAMS {
        let board = program.board.name();
        let names = symbols::names(&fs::read(program.build()?)?)?;
        let floats: Vec<_> = names.iter().filter(|name| soft_float.is(name)).collect();
        ensure!(floats.is_empty(), "{board}: soft-float symbols {floats:?}");
        let formatting: Vec<_> = names.iter().filter(|name| is_formatting(name)).collect();
        ensure!(formatting.is_empty(), "{board}: formatting code {formatting:?}");
        clean.push(board);
    }
    Ok(clean)
}

/// Whether the name, in either mangling, is of a function in `core::fmt`, or of an implementation of its traits.
fn is_formatting(name: &str) -> bool {
    name.contains("4core3fmt") || (name.contains("4core") && name.contains("3fmt"))
}

#[cfg(test)]
mod tests {
    use super::*;

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
