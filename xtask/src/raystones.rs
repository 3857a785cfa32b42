//! The record of the example `raystones`: a section of `docs/performance.md`.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use serde_json::Value;

use crate::accuracy::Header;
use crate::setup::Part;
use crate::{bench_host, device, shell};

#[derive(Args)]
pub struct Options {
    /// File for the rows: core, scene, instructions, m0plus_cycles, pixels, crc
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub(crate) const TITLE: &str = "## Raystones";

/// Counts of raystones.c a pixel, 120 x 60, the whole program on the same machines of QEMU's by the same plugin:
/// arm-none-eabi-gcc 12.2 -O3 -ffast-math -fsingle-precision-constant, newlib 3.3.
struct Float {
    core: &'static str,
    soft: Option<u64>,
    hard: Option<u64>,
}

const FLOATS: [Float; 4] = [
    Float {
        core: "Cortex-M0",
        soft: Some(51_722),
        hard: None,
    },
    Float {
        core: "Cortex-M3",
        soft: Some(25_719),
        hard: None,
    },
    Float {
        core: "Cortex-M4F",
        soft: Some(25_674),
        hard: Some(1_104),
    },
    Float {
        core: "Cortex-M7",
        soft: None,
        hard: Some(1_065),
    },
];

/// Runs the emulator, prints the table and writes it.
pub fn run(options: &Options) -> Result<()> {
    device::require(Part::Qemu)?;
    let file = match &options.json {
        Some(file) => device::whole(file)?,
        None => shell::target_dir().join("raystones.json"),
    };
    device::emulate(&["raystones".as_ref(), "--json".as_ref(), file.as_os_str()])?;
    let rows: Value = serde_json::from_str(&std::fs::read_to_string(&file)?)?;
    let rows = rows.as_array().context("no rows")?;
    let section = text(&Header::now(0)?, rows)?;
    println!("{section}");
    bench_host::put(TITLE, &section)
}

fn text(header: &Header, rows: &[Value]) -> Result<String> {
    let mut text = format!(
        "Written by `cargo xtask raystones`, {}, commit {}, {}, opt-level 3.\n\n",
        header.date, header.commit, header.tools
    );
    text += "The scene of raystones.c (BrunoLevy/learn-fpga), 120 × 60: `examples/raystones`, in integers on every core, a\n\
        CRC-32 of the picture included. Instructions and Cortex-M0+ cycles a pixel, counted in QEMU; two runs were equal. Floats:\n\
        the C program, counted in the same way, arm-none-eabi-gcc 12.2 -O3 -ffast-math. It follows rays of no weight too, ours does not:\n\
        without them its instructions on x86-64 are 6.00 of 9.59 million (gcc 12.2 -O3 -ffast-math, callgrind), the picture the same.\n\n";
    text += "| core | instructions | M0+ cycles | pixels/s/MHz | floats, soft | floats, FPU | ours of it | CRC-32 |\n\
        |---|--:|--:|--:|--:|--:|--:|---|\n";
    let mut helpers = Vec::new();
    for row in rows {
        text += &line(row)?;
        helpers.extend(
            row["helpers"]
                .as_array()
                .into_iter()
                .flatten()
                .filter_map(Value::as_str),
        );
    }
    helpers.sort_unstable();
    helpers.dedup();
    text += "\nSoft float on the Cortex-M0+: 66688 cycles a pixel, 15.0 pixels/s/MHz. Published for soft cores: 18.2 the best without\n\
        an FPU, 45 to 124 with one.\n\n";
    text += &match &*helpers {
        [] => "No routine of the compiler's library is in any of the programs.".to_string(),
        names => format!(
            "Routines of the compiler's library in the programs: {}.",
            names.join(", ")
        ),
    };
    Ok(text)
}

fn line(row: &Value) -> Result<String> {
    let number = |key: &str| row[key].as_u64().with_context(|| format!("{key} of {row}"));
    let core = row["core"].as_str().context("a row without a core")?;
    let pixels = number("pixels")?;
    let ours = number("instructions")? / pixels;
    let cycles = row["m0plus_cycles"].as_u64();
    let float = FLOATS.iter().find(|float| float.core == core);
    let hard = float.and_then(|float| float.hard);
    let cell = |value: Option<String>| value.unwrap_or_default();
    Ok(format!(
        "| {core} | {ours} | {} | {} | {} | {} | {} | {:08x} |\n",
        cell(cycles.map(|cycles| (cycles / pixels).to_string())),
        cell(cycles.map(|cycles| format!("{:.0}", 1e6 * pixels as f64 / cycles as f64))),
        cell(float.and_then(|float| float.soft).map(|soft| soft.to_string())),
        cell(hard.map(|hard| hard.to_string())),
        cell(hard.map(|hard| format!("{:.2}", ours as f64 / hard as f64))),
        number("crc")?
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_line_is_by_the_pixel() {
        let row = json!({ "core": "Cortex-M4F", "instructions": 7200 * 552, "pixels": 7200, "crc": 10 });
        let expected = "| Cortex-M4F | 552 |  |  | 25674 | 1104 | 0.50 | 0000000a |\n";
        assert_eq!(line(&row).unwrap(), expected);
        let row = json!({ "core": "Cortex-M0", "instructions": 7200, "m0plus_cycles": 57_600_000, "pixels": 7200, "crc": 0 });
        assert!(line(&row).unwrap().contains("| 8000 | 125 |"));
    }
}
