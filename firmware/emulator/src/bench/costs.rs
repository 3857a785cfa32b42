//! What pictures, rays and paths cost on the machines of QEMU's.

use std::fmt::Write as _;

use anyhow::{Context, Result, ensure};
use firmware_common::{
    golden::{self, Pattern},
    jobs::{self, Job, Reach, Work},
    rays::Kind,
    tile,
};
use serde_json::{Value, json};

use crate::{
    count,
    machine::{MICROBIT, Machine, RP2040},
    segments,
    stack::{self, Depth, Memory},
};

/// A job on a core.
pub struct Row {
    pub core: &'static str,
    pub scene: String,
    pub kind: RowKind,
    pub instructions: u64,
    /// Of cores that the model speaks of.
    pub m0plus_cycles: Option<u64>,
    pub pixels: u64,
    pub samples: u64,
    pub rays: u64,
    pub crc: u32,
}

/// What a row counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowKind {
    /// A whole picture, its scene's set-up included.
    Picture,
    /// Camera rays alone.
    Primary,
    /// Paths alone, of so many segments in all.
    Paths { segments: u64 },
    /// A board's whole program.
    Program,
}

impl Row {
    pub fn json(&self) -> Value {
        let mut row = json!({
            "core": self.core,
            "scene": self.scene,
            "instructions": self.instructions,
            "m0plus_cycles": self.m0plus_cycles,
            "pixels": self.pixels,
            "samples": self.samples,
            "rays": self.rays,
            "crc": self.crc,
        });
        if let RowKind::Paths { segments } = self.kind {
            row["segments"] = segments.into();
        }
        row
    }

    /// Instructions, and cycles if they are known, of one of `parts`.
    fn each(&self, parts: u64) -> (u64, String) {
        let cycles = self.m0plus_cycles;
        let cycles = cycles.map_or_else(|| "-".to_owned(), |cycles| (cycles / parts).to_string());
        (self.instructions / parts, cycles)
    }
}

/// A job that is worth a row: what it comes to on this computer.
struct Entry {
    /// Its region.
    id: u32,
    job: &'static Job,
    scene: String,
    kind: RowKind,
    samples: u64,
    rays: u64,
    crc: u32,
}

/// Pictures by the independent sampler with the first seed, and all bundles of rays.
fn entries() -> Result<Vec<Entry>> {
    let pixels = pixels();
    let measured = |(id, job): (u32, &'static Job)| -> Result<Option<Entry>> {
        Ok(match job.work {
            Work::Picture(case) if case.sampler == Pattern::Independent && case.seed == 1 => {
                let outcome = case.run();
                Some(Entry {
                    id,
                    job,
                    scene: format!("{}-{}", case.scene.name(), case.integrator.name()),
                    kind: RowKind::Picture,
                    samples: pixels * u64::from(case.settings().spp),
                    rays: outcome.rays.into(),
                    crc: outcome.crc,
                })
            }
            Work::Rays(bundle) => {
                let traced = bundle.run(id);
                let kind = match bundle.kind {
                    Kind::Primary => RowKind::Primary,
                    Kind::Path => RowKind::Paths {
                        segments: segments::count(bundle.motif)?.into(),
                    },
                };
                Some(Entry {
                    id,
                    job,
                    scene: job.name.to_owned(),
                    kind,
                    samples: traced.entries.into(),
                    rays: traced.rays.into(),
                    crc: traced.crc,
                })
            }
            _ => None,
        })
    };
    let all = (0..).zip(jobs::all()).map(measured);
    all.filter_map(Result::transpose).collect()
}

fn pixels() -> u64 {
    u64::from(golden::SETTINGS.width) * u64::from(golden::SETTINGS.height)
}

/// What was counted, and measured besides.
pub struct Counted {
    pub rows: Vec<Row>,
    /// What each counted job takes on the micro:bit.
    pub memories: Vec<Memory>,
    /// What each job takes on the RP2040 that the micro:bit has no room for.
    pub roomy: Vec<Memory>,
    /// The deepest stack of each machine.
    pub depths: Vec<Depth>,
}

/// Each entry on each machine of QEMU's, counted `runs` times.
pub fn count(runs: u32) -> Result<Counted> {
    let plugin = count::plugin()?;
    let entries = entries()?;
    let mut counted = Counted {
        rows: Vec::new(),
        memories: Vec::new(),
        roomy: Vec::new(),
        depths: Vec::new(),
    };
    for machine in Machine::ALL.into_iter().filter(|machine| machine.in_qemu()) {
        eprintln!("{}", machine.name());
        let program = machine.build()?;
        let printed = machine.run_in_qemu(&program, &[])?;
        counted
            .depths
            .push(stack::jobs(machine.name(), &program, &printed)?);
        if machine == MICROBIT {
            let mut memories = Memory::read(&printed)?;
            memories.retain(|memory| entries.iter().any(|entry| entry.job.name == memory.name));
            counted.memories = memories;
        }
        let counts = count::agreed(machine, &program, &plugin, runs)?;
        for entry in entries.iter().filter(|entry| machine.runs(entry.job)) {
            let line = format!("{} crc32={:08x}", entry.job.name, entry.crc);
            ensure!(
                printed.lines().any(|printed| printed == line),
                "{}: no line {line:?}",
                machine.name()
            );
            let spent = counts.regions.get(&entry.id).context("a job was not counted")?;
            counted.rows.push(Row {
                core: machine.core(),
                scene: entry.scene.clone(),
                kind: entry.kind,
                instructions: spent.instructions,
                m0plus_cycles: machine.is_armv6m().then_some(spent.cycles),
                pixels: pixels(),
                samples: entry.samples,
                rays: entry.rays,
                crc: entry.crc,
            });
        }
    }
    on_the_rp2040(&mut counted)?;
    Ok(counted)
}

/// Stacks of the jobs on a bare RP2040; each must come to what it is on this computer.
fn on_the_rp2040(counted: &mut Counted) -> Result<()> {
    eprintln!("{}", RP2040.name());
    let printed = RP2040.run()?;
    counted
        .depths
        .push(stack::jobs(RP2040.name(), &RP2040.build()?, &printed)?);
    let memories = Memory::read(&printed)?;
    for (id, job) in (0..)
        .zip(jobs::all())
        .filter(|(_, job)| job.reach == Reach::Roomy)
    {
        let line = format!("{} crc32={:08x}", job.name, job.run(id));
        ensure!(
            printed.lines().any(|printed| printed == line),
            "{}: no line {line:?}",
            RP2040.name()
        );
    }
    let is_roomy = |name: &str| jobs::all().any(|job| job.name == name && job.reach == Reach::Roomy);
    counted.roomy = memories
        .into_iter()
        .filter(|memory| is_roomy(&memory.name))
        .collect();
    Ok(())
}

/// The tables of rays and of pictures.
pub fn tables(text: &mut String, rows: &[Row]) -> Result<()> {
    text.push_str(
        "## A ray, a segment\n\n\
        Each by itself, over the pixels of the pictures below. Primary ray: the camera's ray and its nearest hit. Path: up \
        to 8 segments by `integrator::Path`; a segment is a nearest hit and what its end takes: the surface, a light \
        sample with its shadow ray, a BSDF sample, weights, roulette. `mesh`: the knot of 3,072 triangles in flash.\n\n\
        | core | scene | a primary ray | a segment | a path | M0+ cycles: a primary ray | a segment | a path | \
        segments a path | CRC-32 of hits | of paths |\n\
        | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- | --- |\n",
    );
    let primaries = rows.iter().filter(|row| row.kind == RowKind::Primary);
    let paths = rows.iter().filter_map(|row| match row.kind {
        RowKind::Paths { segments } => Some((row, segments)),
        _ => None,
    });
    for (primary, (paths, segments)) in primaries.zip(paths) {
        let (ray, ray_cycles) = primary.each(primary.samples);
        let (segment, segment_cycles) = paths.each(segments);
        let (path, path_cycles) = paths.each(paths.samples);
        writeln!(
            text,
            "| {} | {} | {ray} | {segment} | {path} | {ray_cycles} | {segment_cycles} | {path_cycles} | {:.2} | {:08x} | \
             {:08x} |",
            primary.core,
            primary.scene.trim_end_matches("-primary"),
            segments as f64 / paths.samples as f64,
            primary.crc,
            paths.crc
        )?;
    }
    text.push_str(
        "\n## Pictures\n\n\
        Pictures of `tests/golden.txt`: 30 x 25 pixels, 4 samples each, independent sampler, seed 1, scene set-up \
        included. A ray: a path segment or a shadow ray. Frame: 240 x 240 pixels of one sample each, by the mean.\n\n\
        | core | scene | instructions | a sample | a ray | a frame | M0+ cycles | a sample | a ray | a pixel | CRC-32 |\n\
        | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |\n",
    );
    let frame = u64::from(tile::SQUARE.width() * tile::SQUARE.height());
    for row in rows.iter().filter(|row| row.kind == RowKind::Picture) {
        let (whole, whole_cycles) = row.each(1);
        let (sample, sample_cycles) = row.each(row.samples);
        let (ray, ray_cycles) = row.each(row.rays);
        writeln!(
            text,
            "| {} | {} | {whole} | {sample} | {ray} | {} | {whole_cycles} | {sample_cycles} | {ray_cycles} | {} | {:08x} |",
            row.core,
            row.scene,
            row.instructions * frame / row.samples,
            row.each(row.pixels).1,
            row.crc
        )?;
    }
    Ok(())
}
