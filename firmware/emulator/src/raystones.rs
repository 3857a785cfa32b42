//! What the example `raystones` takes on each core of QEMU's.

use std::{fs, path::Path};

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};
use xtask::no_float::symbols;

use crate::{
    count,
    machine::Machine,
    toolchain::{self, Build},
};

/// Runs that must agree.
const RUNS: u32 = 2;

/// Builds, counts and compares, and writes a row for each core.
pub fn run(file: &Path) -> Result<()> {
    let plugin = count::plugin()?;
    let mut rows = Vec::new();
    for machine in Machine::ALL.into_iter().filter(|machine| machine.in_qemu()) {
        eprintln!("raystones, {}", machine.core());
        rows.push(row(machine, &plugin)?);
    }
    let crcs: Vec<_> = rows.iter().map(|row| &row["crc"]).collect();
    ensure!(
        crcs.windows(2).all(|pair| pair[0] == pair[1]),
        "the cores' pictures differ: {crcs:?}"
    );
    let text = format!("{:#}\n", Value::from(rows));
    fs::write(file, text).with_context(|| file.display().to_string())
}

fn row(machine: Machine, plugin: &Path) -> Result<Value> {
    let name = format!("raystones-{}", machine.name());
    let build = Build {
        package: "qemu",
        features: &[],
        environment: &[("MACHINE", machine.name())],
        name: &name,
    };
    let program = toolchain::build(&build, machine.target(), "raystones")?;
    let helpers = helpers(&fs::read(&program)?)?;
    let counts = count::agreed(machine, &program, plugin, RUNS)?;
    let spent = counts.regions.get(&0).context("region 0 was not entered")?;
    let (pixels, crc) = parse(&machine.run_in_qemu(&program, &[])?)?;
    Ok(json!({
        "core": machine.core(),
        "scene": "raystones",
        "instructions": spent.instructions,
        "m0plus_cycles": machine.is_armv6m().then_some(spent.cycles),
        "pixels": pixels,
        "crc": crc,
        "helpers": helpers,
    }))
}

/// What the compiler's own library put into the program: divisions, floats, products of 64 bits, copies.
fn helpers(elf: &[u8]) -> Result<Vec<String>> {
    let names = symbols::names(elf)?;
    Ok(names.into_iter().filter(|name| is_helper(name)).collect())
}

pub(crate) fn is_helper(name: &str) -> bool {
    let by_bits = ["di3", "ti3", "si3", "si4", "di4", "df3", "sf3", "di2", "si2"];
    let arithmetic = name.starts_with("__") && by_bits.iter().any(|end| name.ends_with(end));
    arithmetic || name.starts_with("__aeabi_") || ["memcpy", "memset", "memmove", "memcmp"].contains(&name)
}

/// Pixels and CRC-32 of the program's line.
fn parse(output: &str) -> Result<(u64, u32)> {
    let line = output.strip_prefix("raystones pixels=");
    let (pixels, crc) = line
        .and_then(|line| line.trim_end().split_once(" crc32="))
        .with_context(|| format!("{output:?} is not its line"))?;
    Ok((pixels.parse()?, u32::from_str_radix(crc, 16)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_its_line() {
        assert_eq!(
            parse("raystones pixels=7200 crc32=0000000a\n").unwrap(),
            (7200, 10)
        );
        assert!(parse("mps2-an385: panic\n").is_err());
    }

    #[test]
    fn knows_the_compilers_helpers() {
        let names = [
            "__aeabi_uidiv",
            "__udivsi3",
            "__muldi3",
            "__mulsf3",
            "memcpy",
            "__aeabi_memclr4",
        ];
        assert!(names.into_iter().all(is_helper));
        assert!(
            !["main", "__sdata", "_ZN4core9panicking5panic17h0E"]
                .into_iter()
                .any(is_helper)
        );
    }
}
