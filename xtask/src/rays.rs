//! What primary rays to a mesh in a room take: a section of `docs/performance.md`, which `profile` writes.

use std::ffi::OsString;
use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::{Context, Result};
use serde_json::Value;

use crate::accuracy::Header;
use crate::{bench_host, device, shell};

pub(crate) const TITLE: &str = "## Primary rays to a mesh in a room";

/// By core: cycles below which no form of the algorithm that we know of gets, counted by hand, for what a ray takes to be
/// brought into the mesh's grid, a node of four children, a triangle that is asked, one that is met.
const FLOORS: [(&str, [(&str, u64); 4]); 3] = [
    (
        "Cortex-M0+",
        [("set-ups", 60), ("nodes", 208), ("triangles", 115), ("hits", 120)],
    ),
    (
        "Cortex-M4F",
        [("set-ups", 30), ("nodes", 130), ("triangles", 65), ("hits", 45)],
    ),
    (
        "RV32IMC",
        [("set-ups", 25), ("nodes", 115), ("triangles", 60), ("hits", 45)],
    ),
];

/// Runs the emulator, prints the table and writes it.
pub(crate) fn run(meshes: &[PathBuf]) -> Result<()> {
    let file = shell::target_dir().join("rays.json");
    let mut words: Vec<OsString> = vec!["rays".into(), "--json".into(), file.clone().into()];
    for mesh in meshes {
        words.extend(["--mesh".into(), device::whole(mesh)?.into()]);
    }
    device::emulate(&words)?;
    let rows: Value = serde_json::from_str(&std::fs::read_to_string(&file)?)?;
    let section = text(&Header::now(0)?, rows.as_array().context("no rows")?)?;
    println!("{section}");
    bench_host::put(TITLE, &section)
}

fn text(header: &Header, rows: &[Value]) -> Result<String> {
    let mut text = format!(
        "Written by `cargo xtask profile`, {}, commit {}, {}, opt-level 3.\n\n",
        header.date, header.commit, header.tools
    );
    text += "A mesh in flash in the middle of a room of twelve triangles, one mesh of both, the room two and a half times as\n\
        wide; two cameras in the room, 96 × 80 rays of each. *Mesh*: `bvh::closest` with what it takes to quantise the ray; *scene*:\n\
        `Scene::closest` of a scene that is this mesh alone. Cycles: of a Cortex-M0+ and a Cortex-M4 without wait states and of a\n\
        Hazard3 (`firmware/emulator/plugin/src/cycles.rs`), of what QEMU executes. *Floor*: what is visited, times cycles counted by hand;\n\
        the visits are the same on all cores. Distances are the same, too: a CRC-32 of them all.\n\n\
        | mesh | form | flash, bytes | core | mesh, instructions | cycles | floor | ratio | scene, instructions | cycles |\n\
        |---|---|--:|---|--:|--:|--:|--:|--:|--:|\n";
    let mut visits: Vec<String> = Vec::new();
    let mut paths: Vec<String> = Vec::new();
    for row in rows {
        let core = row["core"].as_str().context("a row without a core")?;
        let name = row["scene"].as_str().context("a row without a scene")?;
        let [whole_instructions, whole_cycles] = each(&row["whole"])?;
        let Some(form) = row["form"].as_str() else {
            let line = format!("| {core} | {whole_instructions} | {whole_cycles} |\n");
            if !paths.contains(&line) {
                paths.push(line);
            }
            continue;
        };
        let rays = number(&row["rays"])? as f64;
        let (_, floors) = FLOORS
            .iter()
            .find(|(known, _)| *known == core)
            .context("no floor of the core")?;
        let mut floor = 0.0;
        let mut parts = Vec::new();
        for (what, cycles) in floors {
            let count = number(&row["work"][what]).with_context(|| format!("no {what}"))? as f64 / rays;
            floor += count * *cycles as f64;
            parts.push(format!("{count:.2} {what}"));
        }
        let triangles = number(&row["triangles"])?;
        let line = format!("{name}, {triangles} triangles: {}", parts.join(", "));
        if !visits.contains(&line) {
            visits.push(line);
        }
        let [instructions, cycles] = each(&row["mesh"])?;
        writeln!(
            text,
            "| {name} | {form} | {} | {core} | {instructions} | {cycles} | {floor:.0} | {:.2} | {whole_instructions} | {whole_cycles} |",
            number(&row["bytes"])?,
            cycles as f64 / floor,
        )?;
    }
    writeln!(text, "\nA ray: {}.", visits.join("; "))?;
    text += "\nBeside them, paths of up to five segments in the Cornell box, one through each of 96 × 80 pixels: `Path::radiance` alone.\n\n\
        | core | instructions a path | cycles |\n|---|--:|--:|\n";
    text.extend(paths);
    Ok(text)
}

fn number(value: &Value) -> Result<u64> {
    value.as_u64().with_context(|| format!("{value} is no number"))
}

/// Instructions and cycles of one of those that were counted.
fn each(spent: &Value) -> Result<[u64; 2]> {
    let entries = number(&spent["entries"])?.max(1);
    Ok([
        number(&spent["instructions"])? / entries,
        number(&spent["cycles"])? / entries,
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_ray_has_a_floor() {
        let spent =
            |cycles: u64| json!({ "entries": 10, "instructions": 10 * cycles, "cycles": 20 * cycles });
        let ray = json!({ "core": "Cortex-M0+", "scene": "knot", "form": "plain", "triangles": 12, "bytes": 99, "rays": 10,
            "hits": 9, "mesh": spent(100), "whole": spent(150),
            "work": { "set-ups": 10, "nodes": 5, "triangles": 0, "hits": 0, "shapes": 0 } });
        let path = json!({ "core": "Cortex-M0+", "scene": "paths", "rays": 3, "whole": spent(7) });
        let header = Header {
            spp: 0,
            date: String::new(),
            commit: String::new(),
            tools: String::new(),
        };
        let text = text(&header, &[ray, path]).unwrap();
        for line in [
            "| knot | plain | 99 | Cortex-M0+ | 100 | 200 | 164 | 1.22 | 150 | 300 |",
            "A ray: knot, 12 triangles: 1.00 set-ups, 0.50 nodes, 0.00 triangles, 0.00 hits.",
            "| Cortex-M0+ | 7 | 14 |",
        ] {
            assert!(text.lines().any(|found| found == line), "{line}\n{text}");
        }
    }
}
