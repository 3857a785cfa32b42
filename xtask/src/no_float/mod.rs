//! No float at run time, proven on a linked program.
//!
//! Clippy bans the float types in the core's text (`ci`, step `clippy`). Here `tests/no-float`, which calls the public
//! renderer, is linked for the Cortex-M0+: that core has no float instruction, so any float shows as a routine's name.

pub mod symbols;

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};

use crate::shell;
use crate::toolchain::Embedded;
use symbols::SoftFloat;

const TARGET: &str = "thumbv6m-none-eabi";
const PROGRAM: &str = "no-float";
/// The program's feature that adds two floats at run time.
const PLANT: &str = "planted-float";

/// Links the program as it is, which must be free of soft-float routines, and with a float planted, which must not.
pub fn check(root: &Path) -> Result<String> {
    let names = linked_names(root, &[])?;
    let ours = names.iter().filter(|name| name.contains("8microlux")).count();
    ensure!(
        ours > 0,
        "the program holds no function of microlux: it proves nothing"
    );
    let found = soft_float(&names);
    if !found.is_empty() {
        bail!(
            "the linked renderer has {} soft-float symbols:\n  {}\nfind the callers with `arm-none-eabi-objdump -d`",
            found.len(),
            found.join("\n  ")
        );
    }
    let control = linked_names(root, &["--features", PLANT])?;
    let planted = soft_float(&control);
    ensure!(
        !planted.is_empty(),
        "a planted float was not found: the check is blind"
    );
    Ok(format!(
        "no soft-float among {} symbols, {ours} of them the core's; a planted float shows as {}",
        names.len(),
        planted.join(", ")
    ))
}

fn soft_float(names: &BTreeSet<String>) -> Vec<&str> {
    let soft_float = SoftFloat::new();
    names
        .iter()
        .map(String::as_str)
        .filter(|name| soft_float.is(name))
        .collect()
}

/// Builds the program with the extra arguments; the names in its symbol table.
fn linked_names(root: &Path, extra: &[&str]) -> Result<BTreeSet<String>> {
    let embedded = Embedded::find(TARGET)?;
    let mut build = embedded.cargo("build");
    build
        .args(["--release", "--quiet"])
        .args(extra)
        .current_dir(root.join("tests").join(PROGRAM));
    // No start-up code, no memory map: the program is read, not run. Set here, the flags replace those of the
    // root's .cargo/config.toml, which are for firmware.
    shell::run(build.env("RUSTFLAGS", "-Clink-arg=--entry=start"))?;
    let program = embedded.program("release", PROGRAM);
    let elf = std::fs::read(&program).with_context(|| program.display().to_string())?;
    symbols::names(&elf)
}
