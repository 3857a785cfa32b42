//! What primary rays to a mesh in a room take, and paths in the Cornell box, on three cores of QEMU's.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, anyhow, ensure};
use firmware_bake::Room;
use serde_json::{Value, json};
use xtask::board::Board;

use crate::{
    count::{self, Counts},
    machine::Machine,
    profile,
    toolchain::{self, Build},
};

/// A processor, the machine that runs its code, and the name of its cycles.
///
/// The Cortex-M0+ stands on another's board, whose flash holds the meshes: it knows all of its instructions.
struct Core {
    name: &'static str,
    machine: Machine,
    target: &'static str,
    cycles: &'static str,
}

const CORES: [Core; 3] = [
    Core {
        name: "Cortex-M0+",
        machine: Machine::Emulated(Board::Mps2An385),
        target: Board::Microbit.target(),
        cycles: "m0plus",
    },
    Core {
        name: "Cortex-M4F",
        machine: Machine::Emulated(Board::Mps2An386),
        target: Board::Mps2An386.target(),
        cycles: "m4",
    },
    Core {
        name: "RV32IMC",
        machine: Machine::Emulated(Board::Virt),
        target: Board::Virt.target(),
        cycles: "hazard3",
    },
];

/// The forms of a mesh that the program looks at: its regions are two for each, and one for paths after them.
const FORMS: [&str; 2] = ["plain", "packed"];
const PATHS: u32 = 4;

/// Counts a torus knot's rays, and those of OBJ files, and writes the rows.
pub fn run(file: &Path, meshes: &[PathBuf]) -> Result<()> {
    let plugin = count::plugin()?;
    let mut rows = Vec::new();
    let room = Room::of_knot().map_err(|error| anyhow!("torus knot: {error}"))?;
    rows.extend(of_room("knot", &room, &plugin)?);
    for mesh in meshes {
        let text = fs::read_to_string(mesh).with_context(|| mesh.display().to_string())?;
        let room = Room::of_obj(&text).map_err(|error| anyhow!("{}: {error}", mesh.display()))?;
        let name = mesh.file_stem().context("the mesh's file has no name")?;
        rows.extend(of_room(&name.to_string_lossy(), &room, &plugin)?);
    }
    fs::write(file, format!("{:#}\n", Value::from(rows))).with_context(|| file.display().to_string())
}

fn of_room(name: &str, room: &Room, plugin: &Path) -> Result<Vec<Value>> {
    let image = toolchain::work_folder()?.join("room.bin");
    fs::write(&image, room.image().map_err(|error| anyhow!("{name}: {error}"))?)?;
    let mut rows = Vec::new();
    // What there is to do is the same on all cores; where it is counted, functions are not inlined.
    let mut work = None;
    let mut first = None;
    for core in &CORES {
        eprintln!("rays, {name}, {}", core.name);
        let program = build(core, &image)?;
        let (printed, report) = profile::trace(core.machine, &program, plugin, core.cycles)?;
        let printed = Printed::parse(&printed)?;
        let first = first.get_or_insert_with(|| printed.clone());
        ensure!(
            *first == printed,
            "{name}: {printed:?} on {}, {first:?}",
            core.name
        );
        // Packed, a triangle begins with another corner, and its depth is rounded in another way.
        ensure!(
            printed.forms[0][..2] == printed.forms[1][..2],
            "{name}: packed, other hits: {printed:?}"
        );
        // The packed form's functions say how many triangles there are.
        let work: &BTreeMap<_, _> = match &mut work {
            Some(work) => work,
            none => none.insert(profile::work(&program, &report, 2)?),
        };
        let counts = count::parse(&report)?;
        let [rays, hits, _] = printed.forms[0];
        for (form, bytes) in FORMS.into_iter().zip(room.bytes()) {
            let region = if form == FORMS[0] { 0 } else { 2 };
            let [alone, whole] = [0, 1].map(|part| spent(&counts, region + part));
            rows.push(json!({
                "core": core.name,
                "scene": name,
                "form": form,
                "triangles": room.triangles(),
                "bytes": bytes,
                "rays": rays,
                "hits": hits,
                "mesh": alone?,
                "whole": whole?,
                "work": work,
            }));
        }
        rows.push(json!({
            "core": core.name,
            "scene": "paths",
            "rays": printed.paths[0],
            "whole": spent(&counts, PATHS)?,
        }));
    }
    Ok(rows)
}

fn build(core: &Core, image: &Path) -> Result<PathBuf> {
    let build = Build {
        package: "qemu",
        features: &[],
        environment: &[
            ("MACHINE", core.machine.name()),
            ("MICROLUX_ROOM", &image.to_string_lossy()),
        ],
        name: &format!("rays-{}", core.cycles),
    };
    toolchain::build(&build, core.target, "rays")
}

/// How often a region was entered, and what that took.
fn spent(counts: &Counts, region: u32) -> Result<Value> {
    let spent = counts.regions.get(&region).context("a region was not entered")?;
    Ok(json!({
        "entries": spent.entries,
        "instructions": spent.instructions,
        "cycles": spent.cycles,
    }))
}

/// What the program prints: rays, hits and CRC-32 of each form; rays and CRC-32 of the paths.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Printed {
    forms: [[u64; 3]; 2],
    paths: [u64; 2],
}

impl Printed {
    fn parse(text: &str) -> Result<Printed> {
        let number = |start: &str, name: &str| -> Result<u64> {
            let line = text.lines().find_map(|line| line.strip_prefix(start));
            let word = line.and_then(|line| line.split(' ').find_map(|word| word.strip_prefix(name)));
            let word = word.with_context(|| format!("{text:?} has no {name} of {start:?}"))?;
            Ok(u64::from_str_radix(word, if name == "crc32=" { 16 } else { 10 })?)
        };
        let form = |form: &str| -> Result<[u64; 3]> {
            let start = format!("rays {form} ");
            Ok([
                number(&start, "rays=")?,
                number(&start, "hits=")?,
                number(&start, "crc32=")?,
            ])
        };
        Ok(Printed {
            forms: [form(FORMS[0])?, form(FORMS[1])?],
            paths: [number("paths ", "rays=")?, number("paths ", "crc32=")?],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_its_lines() {
        let text = "rays plain rays=9 hits=8 crc32=0000000a\nrays packed rays=9 hits=8 crc32=0000000b\npaths rays=7 crc32=00000010\n";
        let printed = Printed::parse(text).unwrap();
        assert_eq!(printed.forms, [[9, 8, 10], [9, 8, 11]]);
        assert_eq!(printed.paths, [7, 16]);
        assert!(Printed::parse("mps2-an385: panic\n").is_err());
    }
}
