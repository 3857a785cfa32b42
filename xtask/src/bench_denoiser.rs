//! What each stage of the denoiser takes: a section of `docs/denoiser.md`.

use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use serde_json::Value;

use crate::accuracy::Header;
use crate::setup::Part;
use crate::{device, section, shell};

#[derive(Args)]
pub struct Options {
    /// File for the rows: core, pixels, crc, stages
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

const RECORD: &str = "docs/denoiser.md";
const TITLE: &str = "## Cost";

/// What stands between a rendered frame and one twice as large, by the places of the emulator's stages.
const WAYS: [(&str, &[usize]); 2] = [
    ("**with à-trous, 1 sample**", &[0, 1, 5]),
    ("**with the network**", &[0, 3, 4, 5]),
];

/// Runs the emulator, prints the table and writes it.
pub fn run(options: &Options) -> Result<()> {
    device::require(Part::Qemu)?;
    let file = match &options.json {
        Some(file) => device::whole(file)?,
        None => shell::target_dir().join("denoiser.json"),
    };
    device::emulate(&["denoiser".as_ref(), "--json".as_ref(), file.as_os_str()])?;
    let rows: Value = serde_json::from_str(&std::fs::read_to_string(&file)?)?;
    let section = text(&Header::now(0)?, rows.as_array().context("no rows")?)?;
    println!("{section}");
    section::put(RECORD, &[TITLE], TITLE, &section)
}

fn text(header: &Header, rows: &[Value]) -> Result<String> {
    let mut text = format!(
        "Written by `cargo xtask bench-denoiser`, {}, commit {}, {}, opt-level 3.\n\n",
        header.date, header.commit, header.tools
    );
    text += "The second of two frames of the Cornell box, 80 × 60 pixels, *direct*, one sample each, the camera moving, by one core,\n\
        counted in QEMU: instructions a rendered pixel, and cycles of a Cortex-M0+ without wait states. Four pixels are shown for\n\
        each, or nine. Two runs were equal, and every core's picture is this computer's, by its CRC-32. What is not of the\n\
        denoiser stands below the sums, and what a picture takes that is shown at the size it is rendered. All have the feature\n\
        `asm`.\n\n| stage |";
    let mut lines = Vec::new();
    for row in rows {
        write!(
            text,
            " {} |",
            row["core"].as_str().context("a row without a core")?
        )?;
        if has_cycles(row) {
            text.push_str(" M0+ cycles |");
        }
    }
    text.push_str("\n|---|");
    for row in rows {
        text.push_str(if has_cycles(row) { "--:|--:|" } else { "--:|" });
    }
    text.push('\n');
    let names = rows.first().map(stages).transpose()?.unwrap_or_default();
    for (place, stage) in names.iter().enumerate() {
        lines.push((
            stage["stage"].as_str().context("a stage without a name")?,
            vec![place],
        ));
    }
    let sums = WAYS.map(|(name, places)| (name, places.to_vec()));
    lines.splice(6..6, sums);
    for (name, places) in lines {
        write!(text, "| {name} |")?;
        for row in rows {
            let pixels = row["pixels"].as_u64().context("a row without pixels")?;
            let sum = |key: &str| -> Result<u64> {
                let stages = stages(row)?;
                let numbers = places.iter().map(|place| stages.get(*place)?[key].as_u64());
                let sum: Option<u64> = numbers.sum();
                Ok(sum.with_context(|| format!("no {key} of {name}"))? / pixels)
            };
            write!(text, " {} |", sum("instructions")?)?;
            if has_cycles(row) {
                write!(text, " {} |", sum("m0plus_cycles")?)?;
            }
        }
        text.push('\n');
    }
    Ok(text)
}

fn stages(row: &Value) -> Result<&[Value]> {
    Ok(row["stages"].as_array().context("a row without stages")?)
}

fn has_cycles(row: &Value) -> bool {
    row["stages"][0]["m0plus_cycles"].is_u64()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn stages_add_up_by_the_pixel() {
        let row = |core: &str, cycles: Option<u64>| {
            let stage = |i: u64| json!({ "stage": format!("s{i}"), "instructions": 10 * i, "m0plus_cycles": cycles.map(|c| c * i) });
            json!({ "core": core, "pixels": 10, "stages": (0..10).map(stage).collect::<Vec<_>>() })
        };
        let header = Header {
            spp: 0,
            date: String::new(),
            commit: String::new(),
            tools: String::new(),
        };
        let text = text(&header, &[row("A", Some(20)), row("B", None)]).unwrap();
        for line in [
            "| stage | A | M0+ cycles | B |",
            "| s3 | 3 | 6 | 3 |",
            "| **with à-trous, 1 sample** | 6 | 12 | 6 |",
            "| **with the network** | 12 | 24 | 12 |",
        ] {
            assert!(text.lines().any(|found| found == line), "{line}\n{text}");
        }
    }
}
