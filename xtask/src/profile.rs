//! Where the instructions of the boards' pictures go: a section of `docs/performance.md`.

use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use serde_json::Value;

use crate::accuracy::Header;
use crate::setup::Part;
use crate::{bench_host, device, rays, shell};

#[derive(Args)]
pub struct Options {
    /// File for the rows: core, scene, pixels, rays, crc, stages, helpers, work
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// OBJ file whose primary rays are counted beside those of a torus knot; any number of times
    #[arg(long, value_name = "FILE")]
    mesh: Vec<PathBuf>,
}

pub(crate) const TITLE: &str = "## Where the instructions go";

/// Cycles of a Cortex-M0+ below which no form of the algorithm that we know of gets, counted by hand: what a ray takes to
/// be brought into a grid, a node of four children, a shape or triangle that is asked, one that is met.
const FLOOR: [(&str, u64); 5] = [
    ("set-ups", 60),
    ("nodes", 208),
    ("shapes", 115),
    ("triangles", 115),
    ("hits", 120),
];

/// Instructions of one such path by the first record's core, commit 0637617: its own job of the Cornell box, set to this
/// picture and counted by that commit's `emulator count`; without tone map and display.
const FIRST: [(&str, u64); 3] = [("Cortex-M0", 20_937), ("Cortex-M4F", 12_016), ("RV32IMC", 14_558)];

/// The stages that the floor speaks of.
const TRACING: [&str; 3] = ["traversal", "unpacking", "intersection"];

/// Runs the emulator, prints the tables and writes them.
pub fn run(options: &Options) -> Result<()> {
    device::require(Part::Qemu)?;
    let file = match &options.json {
        Some(file) => device::whole(file)?,
        None => shell::target_dir().join("profile.json"),
    };
    device::emulate(&["profile".as_ref(), "--json".as_ref(), file.as_os_str()])?;
    let rows: Value = serde_json::from_str(&std::fs::read_to_string(&file)?)?;
    let section = text(&Header::now(0)?, rows.as_array().context("no rows")?)?;
    println!("{section}");
    bench_host::put(TITLE, &section)?;
    rays::run(&options.mesh)
}

fn text(header: &Header, rows: &[Value]) -> Result<String> {
    let mut text = format!(
        "Written by `cargo xtask profile`, {}, commit {}, {}, opt-level 3.\n\n",
        header.date, header.commit, header.tools
    );
    text += "What a Pico draws, 240 × 240 pixels, `direct`, one sample a pixel, by one core; *paths*: the Cornell box by `path`,\n\
        five segments at most, by `Scene::foresee` with 4 KB, which counts. Instructions a pixel, and cycles of a Cortex-M0+\n\
        without wait states, counted in QEMU. Each instruction belongs to the stage of the function that it was inlined into;\n\
        arithmetic belongs to who asked for it.\n\
        *Surface*: what a hit's place is like, and where rays leave it; *film, display*: loop over pixels, tone map, dither,\n\
        RGB565; *none*: what the compiler names no function for.\n";
    let mut scenes: Vec<&str> = Vec::new();
    for row in rows {
        let scene = row["scene"].as_str().context("a row without a scene")?;
        if !scenes.contains(&scene) {
            scenes.push(scene);
        }
    }
    for scene in scenes {
        let rows: Vec<_> = rows.iter().filter(|row| row["scene"] == scene).collect();
        table(&mut text, scene, &rows)?;
        for row in &rows {
            work(&mut text, row)?;
        }
        if scene == "paths" {
            since_first(&mut text, &rows)?;
        }
    }
    Ok(text)
}

fn number(value: &Value) -> Result<u64> {
    value.as_u64().with_context(|| format!("{value} is no number"))
}

fn stages(row: &Value) -> Result<&[Value]> {
    Ok(row["stages"].as_array().context("a row without stages")?)
}

/// A line for each stage, a column for each core, and one for the M0+'s cycles.
fn table(text: &mut String, scene: &str, rows: &[&Value]) -> Result<()> {
    let [first, ..] = rows else { return Ok(()) };
    let rays = number(&first["rays"])? as f64 / number(&first["pixels"])? as f64;
    write!(text, "\n### {scene}: {rays:.2} rays a pixel\n\n| stage |")?;
    for row in rows {
        write!(text, " {} |", row["core"].as_str().unwrap_or_default())?;
        if has_cycles(row) {
            text.push_str(" M0+ cycles | of them |");
        }
    }
    text.push_str("\n|---|");
    for row in rows {
        text.push_str(if has_cycles(row) { "--:|--:|--:|" } else { "--:|" });
    }
    text.push('\n');
    let names = stages(first)?
        .iter()
        .map(|stage| stage["stage"].as_str().unwrap_or_default());
    for (place, name) in names.enumerate().chain([(usize::MAX, "**all**")]) {
        write!(text, "| {name} |")?;
        for row in rows {
            let pixels = number(&row["pixels"])?;
            let sum = |key: &str, all: bool| -> Result<u64> {
                let stages = stages(row)?.iter().enumerate();
                stages
                    .filter(|(at, _)| all || *at == place)
                    .map(|(_, stage)| number(&stage[key]))
                    .sum()
            };
            let all = place == usize::MAX;
            write!(text, " {} |", sum("instructions", all)? / pixels)?;
            if has_cycles(row) {
                let (own, whole) = (sum("m0plus_cycles", all)?, sum("m0plus_cycles", true)?);
                write!(
                    text,
                    " {} | {:.1} % |",
                    own / pixels,
                    100.0 * own as f64 / whole as f64
                )?;
            }
        }
        text.push('\n');
    }
    Ok(())
}

fn has_cycles(row: &Value) -> bool {
    row["stages"][0]["m0plus_cycles"].is_u64()
}

/// Instructions of all stages beside those of the first record.
fn since_first(text: &mut String, rows: &[&Value]) -> Result<()> {
    let mut parts = Vec::new();
    for (core, first) in FIRST {
        let Some(row) = rows.iter().find(|row| row["core"] == core) else {
            continue;
        };
        let all = stages(row)?.iter().map(|stage| number(&stage["instructions"]));
        let now = all.sum::<Result<u64>>()? / number(&row["pixels"])?;
        parts.push(format!(
            "{core} {first}, now {:.2} of it",
            now as f64 / first as f64
        ));
    }
    writeln!(
        text,
        "\nFirst, commit 0637617, instructions a path without tone map and display: {}.",
        parts.join("; ")
    )?;
    Ok(())
}

/// How much there was to do, the floor of that, and what the compiler's library was called for.
fn work(text: &mut String, row: &Value) -> Result<()> {
    let (core, pixels) = (row["core"].as_str().unwrap_or_default(), number(&row["pixels"])?);
    let share = |count: u64| format!("{:.2}", count as f64 / pixels as f64);
    if let Some(work) = row["work"].as_object() {
        let mut parts = Vec::new();
        let mut floor = 0;
        for (what, cycles) in FLOOR {
            let count = number(work.get(what).with_context(|| format!("no {what}"))?)?;
            floor += count * cycles;
            if count > 0 {
                parts.push(format!("{} {what} of {cycles}", share(count)));
            }
        }
        let tracing = stages(row)?
            .iter()
            .filter(|stage| TRACING.iter().any(|name| stage["stage"] == *name));
        let spent: u64 = tracing
            .map(|stage| number(&stage["m0plus_cycles"]))
            .sum::<Result<_>>()?;
        writeln!(
            text,
            "\nTracing alone ({}), {core}: {} cycles a pixel. Below that lies a floor of {}, counted by hand: {}. Ratio {:.2}.",
            TRACING.join(", "),
            spent / pixels,
            floor / pixels,
            parts.join(", "),
            spent as f64 / floor as f64
        )?;
    }
    let helpers = row["helpers"].as_object().context("a row without helpers")?;
    let calls: Vec<_> = helpers
        .iter()
        .filter_map(|(name, count)| Some(format!("`{name}` {}", share(count.as_u64()?))))
        .collect();
    let calls = if calls.is_empty() {
        "none".to_string()
    } else {
        calls.join(", ")
    };
    writeln!(
        text,
        "\nCalls of the compiler's library a pixel, {core}: {calls}."
    )?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn tables_are_by_the_pixel() {
        let stage = |name: &str, instructions: u64, cycles: Option<u64>| json!({ "stage": name, "instructions": instructions, "m0plus_cycles": cycles });
        let row = |core: &str, cycles: Option<u64>| {
            json!({ "core": core, "scene": "box", "pixels": 10, "rays": 25, "crc": 1,
                "stages": [stage("traversal", 100, cycles), stage("none", 300, cycles.map(|c| 3 * c))],
                "helpers": { "memcpy": 5 },
                "work": cycles.map(|_| json!({ "set-ups": 1, "nodes": 2, "shapes": 0, "triangles": 0, "hits": 0 })) })
        };
        let header = Header {
            spp: 0,
            date: String::new(),
            commit: String::new(),
            tools: String::new(),
        };
        let mut paths = row("RV32IMC", None);
        paths["scene"] = json!("paths");
        paths["pixels"] = json!(1);
        paths["stages"] = json!([stage("none", 14_558 / 4, None)]);
        let text = text(&header, &[row("A", Some(200)), row("B", None), paths]).unwrap();
        for line in [
            "### box: 2.50 rays a pixel",
            "| stage | A | M0+ cycles | of them | B |",
            "| traversal | 10 | 20 | 25.0 % | 10 |",
            "| **all** | 40 | 80 | 100.0 % | 40 |",
            "Calls of the compiler's library a pixel, A: `memcpy` 0.50.",
            "First, commit 0637617, instructions a path without tone map and display: RV32IMC 14558, now 0.25 of it.",
        ] {
            assert!(text.lines().any(|found| found == line), "{line}\n{text}");
        }
        assert!(
            text.contains("20 cycles a pixel. Below that lies a floor of 47,"),
            "{text}"
        );
    }
}
