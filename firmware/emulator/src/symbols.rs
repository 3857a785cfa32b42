//! Where a program's marker functions lie.

use std::{fs, path::Path};

use anyhow::{Context, Result};
use object::{Object, ObjectSymbol};

/// The plugin's `begin`, `end` and `regions` arguments for the ELF file `program`.
pub fn markers(program: &Path) -> Result<String> {
    let bytes = fs::read(program)?;
    let elf = object::File::parse(&*bytes).with_context(|| program.display().to_string())?;
    let place = |name: &str| {
        let symbol = elf
            .symbol_by_name(name)
            .filter(|symbol| symbol.size() > 0)
            .with_context(|| format!("{} has no symbol {name}", program.display()))?;
        // Bit 0 of a Thumb function's address is its instruction set.
        let address = if elf.architecture() == object::Architecture::Arm {
            symbol.address() & !1
        } else {
            symbol.address()
        };
        anyhow::Ok(format!("{address:#x}:{}", symbol.size()))
    };
    Ok(format!(
        "begin={},end={},regions={}",
        place("microlux_region_begin")?,
        place("microlux_region_end")?,
        place("MICROLUX_REGIONS")?
    ))
}
