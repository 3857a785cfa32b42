//! Where the instructions of a picture go: what each stage takes, on each core of QEMU's.
//!
//! Every address of the program gets a stage by the source files of the functions that were inlined there, the innermost
//! first that belongs to a stage. Arithmetic belongs to none: it counts for who asked for it, inlined or called.

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    fs,
    ops::Range,
    path::{Path, PathBuf},
};

use addr2line::Loader;
use anyhow::{Context, Result, anyhow, ensure};
use firmware_common::stage::COUNTED;
use object::{Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};
use serde_json::{Value, json};
use xtask::board::Board;

use crate::{
    count,
    machine::{MICROBIT, Machine},
    raystones, symbols,
    toolchain::{self, Build},
};

/// Stages, and the sources that each is in. Stage 0 is what has none: the caller's.
const STAGES: [(&str, &[&str]); 10] = [
    ("camera", &["src/camera.rs"]),
    ("sampling", &["src/sampler/"]),
    (
        "traversal",
        &[
            "src/bvh/",
            "src/shape/grid.rs",
            "src/shape/sight.rs",
            "src/scene/query.rs",
        ],
    ),
    ("unpacking", &["src/shape/packed.rs", "src/shape/treelet.rs"]),
    ("surface", &["src/scene/", "src/shape/triangles.rs"]),
    ("intersection", &["src/shape/"]),
    ("lights", &["src/light/"]),
    ("materials", &["src/material/"]),
    ("integrator", &["src/integrator/"]),
    ("film, display", &["src/render.rs", "src/film/", "firmware/"]),
];

/// Functions that are about something else than their file: where a ray goes on from, a leaf's corners.
const APART: [(&str, usize); 4] = [
    ("::surface", SURFACE),
    ("::leave", SURFACE),
    ("::onto_plane", SURFACE),
    ("::of_leaf", UNPACKING),
];
const TRAVERSAL: usize = 3;
const UNPACKING: usize = 4;
const SURFACE: usize = 5;
const INTERSECTION: usize = 6;

/// Modules of `microlux_asm`, of which no source is known.
const ASSEMBLY: [(&str, usize); 3] = [
    ("::walk::", TRAVERSAL),
    ("::facets::", INTERSECTION),
    ("::rectangle::", INTERSECTION),
];

/// Sources that serve several stages.
const SERVING: [&str; 4] = ["src/num/", "src/geom/", "src/color/", "src/sampler/warp.rs"];

const CORES: [Machine; 4] = [
    MICROBIT,
    Machine::Emulated(Board::Mps2An385),
    Machine::Emulated(Board::Mps2An386),
    Machine::Emulated(Board::Virt),
];

/// Functions (and places in assembly) whose calls say how much there was to do, by two parts of their names, between
/// which types may stand.
const WORK: [(&str, [&str; 2]); 6] = [
    ("set-ups", ["microlux_asm", "walk::begin"]),
    ("nodes", ["microlux_walk", "_node"]),
    ("shapes", ["shape::Geometry", "::intersect"]),
    ("shapes", ["microlux_asm", "rectangle::meet"]),
    ("triangles", ["microlux_facets", "_corners"]),
    ("hits", ["microlux_facets", "_met"]),
];

/// Profiles each core and writes the rows.
pub fn run(file: &Path) -> Result<()> {
    let plugin = count::plugin()?;
    let mut rows = Vec::new();
    for machine in CORES {
        eprintln!("profile, {}", machine.core());
        rows.extend(profile(machine, &plugin)?);
    }
    fs::write(file, format!("{:#}\n", Value::from(rows))).with_context(|| file.display().to_string())
}

fn profile(machine: Machine, plugin: &Path) -> Result<Vec<Value>> {
    let program = program(machine)?;
    let elf = fs::read(&program)?;
    let elf = object::File::parse(&*elf)?;
    let (printed, report) = trace(machine, &program, plugin, "m0plus")?;
    let report = Report::parse(&report)?;
    let functions = functions(&elf);
    let scenes = (0..).zip(COUNTED);
    scenes
        .map(|(region, scene)| {
            let drawn = drawn(&printed, scene)?;
            report.row(machine, region, scene, drawn, &functions)
        })
        .collect()
}

/// What the program prints, and the plugin's report of it: cycles of `core`, stages and blocks.
pub fn trace(machine: Machine, program: &Path, plugin: &Path, core: &str) -> Result<(String, String)> {
    let elf = fs::read(program)?;
    let elf = object::File::parse(&*elf)?;
    let table = toolchain::work_folder()?.join(format!("{}.stages", machine.name()));
    fs::write(&table, stages(program, &elf)?)?;
    let report = table.with_extension("report");
    let argument = format!(
        "{},report={},stages={},core={core},{}",
        plugin.display(),
        report.display(),
        table.display(),
        symbols::markers(program)?
    );
    let printed = machine.run_in_qemu(program, &["-plugin".to_owned(), argument])?;
    Ok((printed, fs::read_to_string(&report)?))
}

/// How much there was to do in a region, by [`WORK`], of what a program of Armv6-M left in the plugin's report.
pub fn work(program: &Path, report: &str, region: u64) -> Result<BTreeMap<&'static str, u64>> {
    let elf = fs::read(program)?;
    let functions = functions(&object::File::parse(&*elf)?);
    Ok(Report::parse(report)?.work(region, &functions))
}

/// Builds what is profiled.
pub fn program(machine: Machine) -> Result<PathBuf> {
    let build = Build {
        package: "qemu",
        features: &[],
        environment: &[("MACHINE", machine.name())],
        name: &format!("profile-{}", machine.name()),
    };
    toolchain::build(&build, machine.target(), "profile")
}

/// Pixels, rays and the CRC-32 of the line that the program prints of a scene.
fn drawn(printed: &str, scene: &str) -> Result<[u64; 3]> {
    let line = printed
        .lines()
        .find_map(|line| line.strip_prefix("profile ")?.strip_prefix(scene));
    let line = line.with_context(|| format!("no line of {scene}"))?;
    let word = |name: &str| {
        let word = line.split(' ').find_map(|word| word.strip_prefix(name));
        word.with_context(|| format!("{line:?} has no {name}"))
    };
    Ok([
        word("pixels=")?.parse()?,
        word("rays=")?.parse()?,
        u64::from_str_radix(word("crc32=")?, 16)?,
    ])
}

/// The plugin's table: the stage of each piece of code.
fn stages(program: &Path, elf: &object::File) -> Result<String> {
    let loader = Loader::new(program).map_err(|error| anyhow!("{}: {error}", program.display()))?;
    let mut text = String::new();
    let mut open: Option<(Range<u64>, usize)> = None;
    let assembly = assembly(elf);
    let code = elf
        .sections()
        .filter(|section| section.kind() == SectionKind::Text);
    for address in code.flat_map(|section| (section.address()..section.address() + section.size()).step_by(2))
    {
        let stage = match assembly.iter().find(|(range, _)| range.contains(&address)) {
            Some((_, stage)) => *stage,
            None => stage_at(&loader, address)?,
        };
        match &mut open {
            Some((range, last)) if *last == stage && range.end == address => range.end = address + 2,
            _ => {
                line(&mut text, open.replace((address..address + 2, stage)))?;
            }
        }
    }
    line(&mut text, open)?;
    Ok(text)
}

/// Where the functions of assembly lie, with their stages.
fn assembly(elf: &object::File) -> Vec<(Range<u64>, usize)> {
    let one = |symbol: object::Symbol| {
        let name = format!("{:#}", rustc_demangle::demangle(symbol.name().ok()?));
        let place = name.strip_prefix("microlux_asm")?;
        let (_, stage) = ASSEMBLY.iter().find(|(module, _)| place.contains(module))?;
        let start = symbol.address() & !1;
        (symbol.size() > 0).then_some((start..start + symbol.size(), *stage))
    };
    elf.symbols().filter_map(one).collect()
}

fn line(text: &mut String, range: Option<(Range<u64>, usize)>) -> Result<()> {
    match range {
        Some((range, stage)) if stage > 0 => Ok(writeln!(text, "{:x} {:x} {stage}", range.start, range.end)?),
        _ => Ok(()),
    }
}

fn stage_at(loader: &Loader, address: u64) -> Result<usize> {
    let fault = |error| anyhow!("{address:#x}: {error}");
    let mut frames = loader.find_frames(address).map_err(fault)?;
    while let Some(frame) = frames.next().map_err(|error| anyhow!("{address:#x}: {error}"))? {
        let file = frame.location.and_then(|location| location.file);
        if let Some(stage) = file.and_then(stage_of) {
            let name = frame
                .function
                .as_ref()
                .and_then(|function| function.demangle().ok());
            return Ok(name.and_then(|name| stage_of_function(&name)).unwrap_or(stage));
        }
    }
    Ok(0)
}

/// The stage of a source file of this repository.
fn stage_of(file: &str) -> Option<usize> {
    let is_ours = !file.contains("/.cargo/") && !file.contains("/rustc/") && !file.contains("/rustlib/");
    if !is_ours || SERVING.iter().any(|serving| file.contains(serving)) {
        return None;
    }
    let place = |(_, sources): &(&str, &[&str])| sources.iter().any(|source| file.contains(source));
    STAGES.iter().position(place).map(|place| place + 1)
}

fn stage_of_function(name: &str) -> Option<usize> {
    let apart = APART.iter().find(|(part, _)| name.contains(part));
    apart.map(|&(_, stage)| stage)
}

/// Whether a function's name has both parts, in this order.
fn is_named(name: &str, [first, last]: [&str; 2]) -> bool {
    let after = name.find(first).map(|at| &name[at + first.len()..]);
    after.is_some_and(|rest| rest.contains(last))
}

/// Names of functions by their first address.
fn functions(elf: &object::File) -> BTreeMap<u64, String> {
    let is_arm = elf.architecture() == object::Architecture::Arm;
    // A place in assembly is no function.
    let is_place = |symbol: &object::Symbol| symbol.name().is_ok_and(|name| name.starts_with("microlux_"));
    let symbols = elf
        .symbols()
        .filter(|symbol| symbol.kind() == SymbolKind::Text || is_place(symbol));
    symbols
        .filter_map(|symbol| {
            let address = if is_arm {
                symbol.address() & !1
            } else {
                symbol.address()
            };
            let name = rustc_demangle::demangle(symbol.name().ok()?);
            Some((address, format!("{name:#}").replace(['<', '>'], "")))
        })
        .collect()
}

/// What the plugin says of regions: by stage, and how often blocks began.
#[derive(Default)]
struct Report {
    stages: BTreeMap<(u64, u64), (u64, u64)>,
    blocks: BTreeMap<(u64, u64), u64>,
}

impl Report {
    fn parse(text: &str) -> Result<Report> {
        let mut report = Report::default();
        for line in text.lines() {
            let mut words = line.split(' ');
            let kind = words.next();
            let numbers = words.map(str::parse).collect::<Result<Vec<u64>, _>>()?;
            match (kind, &*numbers) {
                (Some("stage"), &[region, stage, instructions, cycles]) => {
                    report.stages.insert((region, stage), (instructions, cycles));
                }
                (Some("block"), &[region, address, count]) => {
                    report.blocks.insert((region, address), count);
                }
                _ => {}
            }
        }
        ensure!(!report.stages.is_empty(), "no stages in the plugin's report");
        Ok(report)
    }

    /// How often each of the functions that are wanted was called.
    fn calls<'f>(
        &self,
        region: u64,
        functions: &'f BTreeMap<u64, String>,
        wanted: &dyn Fn(&str) -> bool,
    ) -> BTreeMap<&'f str, u64> {
        let mut calls = BTreeMap::new();
        for ((_, address), count) in self.blocks.range((region, 0)..(region + 1, 0)) {
            if let Some(name) = functions.get(address).filter(|name| wanted(name)) {
                *calls.entry(name.as_str()).or_default() += count;
            }
        }
        calls
    }

    fn work(&self, region: u64, functions: &BTreeMap<u64, String>) -> BTreeMap<&'static str, u64> {
        let mut work = BTreeMap::new();
        for (what, parts) in WORK {
            let calls = self.calls(region, functions, &|name| is_named(name, parts));
            *work.entry(what).or_default() += calls.values().sum::<u64>();
        }
        work
    }

    fn row(
        &self,
        machine: Machine,
        region: u64,
        scene: &str,
        [pixels, rays, crc]: [u64; 3],
        functions: &BTreeMap<u64, String>,
    ) -> Result<Value> {
        let of_region = |stage: usize| {
            self.stages
                .get(&(region, stage as u64))
                .copied()
                .unwrap_or_default()
        };
        let has_cycles = machine.is_armv6m();
        let stage = |name: &str, (instructions, cycles): (u64, u64)| json!({ "stage": name, "instructions": instructions, "m0plus_cycles": has_cycles.then_some(cycles) });
        let names = STAGES.iter().map(|(name, _)| *name).chain(["none"]);
        let numbers = (1..=STAGES.len()).chain([0]);
        let stages: Vec<_> = numbers
            .zip(names)
            .map(|(number, name)| stage(name, of_region(number)))
            .collect();
        let work = self.work(region, functions);
        let helpers = self.calls(region, functions, &|name| raystones::is_helper(name));
        ensure!(pixels > 0, "{scene}: no pixels");
        Ok(json!({
            "core": machine.core(),
            "scene": scene,
            "pixels": pixels,
            "rays": rays,
            "crc": crc,
            "stages": stages,
            "helpers": helpers,
            "work": if has_cycles { json!(work) } else { Value::Null },
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_have_stages() {
        assert_eq!(
            (STAGES[SURFACE - 1].0, STAGES[UNPACKING - 1].0),
            ("surface", "unpacking")
        );
        let leaf = "<microlux::shape::triangles::Triangles>::of_leaf";
        assert_eq!(
            [stage_of_function(leaf), stage_of_function("main")],
            [Some(UNPACKING), None]
        );
        let name = |file| stage_of(file).map(|stage| STAGES[stage - 1].0);
        for (file, stage) in [
            ("/somewhere/src/camera.rs", Some("camera")),
            ("/somewhere/src/sampler/pcg.rs", Some("sampling")),
            ("/somewhere/src/sampler/warp.rs", None),
            ("/somewhere/src/shape/grid.rs", Some("traversal")),
            ("/somewhere/src/shape/planar.rs", Some("intersection")),
            ("/somewhere/src/scene/mod.rs", Some("surface")),
            ("/somewhere/src/num/recip.rs", None),
            ("/home/.cargo/registry/src/heapless/src/render.rs", None),
            ("/rustc/1/library/core/src/film/mod.rs", None),
        ] {
            assert_eq!(name(file), stage, "{file}");
        }
    }

    #[test]
    fn functions_are_known_whatever_their_types() {
        let name = "microlux::shape::Geometry::intersect";
        let found: Vec<_> = WORK.iter().filter(|(_, parts)| is_named(name, *parts)).collect();
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].0, "shapes");
    }

    #[test]
    fn a_report_is_read() {
        let report = Report::parse("total 5 6\nstage 0 3 10 12\nblock 0 64 7\n").unwrap();
        assert_eq!(report.stages[&(0, 3)], (10, 12));
        let functions = BTreeMap::from([(64, "memcpy".to_owned())]);
        let row = report.row(MICROBIT, 0, "cornell", [1, 2, 3], &functions).unwrap();
        assert_eq!(row["helpers"]["memcpy"], 7);
        assert_eq!(row["stages"][2]["m0plus_cycles"], 12);
        assert!(Report::parse("total 5 6\n").is_err());
    }
}
