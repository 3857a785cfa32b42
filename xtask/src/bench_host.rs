//! The record of the host's costs: `docs/performance.md`, in instructions, which the machine's load cannot move.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use clap::Args;
use serde_json::json;

use crate::accuracy::{Case, Header, built_in, bunny, files};
use crate::{bench_seed, growth, peers, profile, rays, raystones, section, shell};

#[derive(Args)]
pub struct Options {
    /// Mitsuba scenes; none are taken if there is no such folder
    #[arg(long, value_name = "DIR", default_value = "../shared/scenes")]
    scenes: PathBuf,
    /// A mesh without a scene of its own: the Stanford bunny; left out if there is no such file
    #[arg(
        long,
        value_name = "FILE",
        default_value = "../shared/meshes/stanford-bunny.obj"
    )]
    bunny: PathBuf,
    /// Sources of the program that comes with the paper (1110011/SoftwareRayTracing), outside this repository: run it beside
    /// ours, and say how many queries of the scene each makes a second; else what the record says of it is left
    #[arg(long, value_name = "DIR")]
    seed_program: Option<PathBuf>,
    /// Instead of all that: trace rays with other people's ray tracers, too, and write what each makes a second
    #[arg(long)]
    peers: bool,
    /// Library of Embree 4 (libembree4.so, as in PyPI's wheel `embreex`) for `--peers`; left out without it
    #[arg(long, value_name = "FILE", requires = "peers")]
    embree: Option<PathBuf>,
    /// Write the rows as JSON, too
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

const RECORD: &str = "docs/performance.md";
/// Sections that a run may leave as they are.
const BESIDE: &str = "## Beside the program of the paper's author";
const TRIED: &str = "## Tried";
/// Sections that others write, in this order, and the one that is written by hand.
const KEPT: [&str; 6] = [
    peers::TITLE,
    raystones::TITLE,
    profile::TITLE,
    rays::TITLE,
    growth::TITLE,
    TRIED,
];
/// The first record, 2026-11-23 at commit 0637617: scene, a primary ray, a path.
const FIRST: [(&str, u64, u64); 12] = [
    ("cornell", 2143, 15679),
    ("seed", 1625, 10621),
    ("spheres", 1305, 4416),
    ("torus-knot", 3334, 11634),
    ("furnace", 1024, 1543),
    ("bidir-room.xml", 2287, 21244),
    ("cornell-glass.xml", 1927, 14158),
    ("cornell.xml", 2463, 17811),
    ("point-lights.xml", 1416, 3068),
    ("seed-scene.xml", 1707, 9983),
    ("spot-sun-sky.xml", 3766, 10952),
    ("bunny.xml", 4044, 13437),
];
/// Pixels a side, and samples a pixel of the two renders whose difference is counted.
const SIDE: u64 = 64;
const SAMPLES: [u64; 2] = [1, 5];

/// Instructions of one scene.
struct Row {
    scene: String,
    /// A primary ray with all that belongs to it: sample, camera, nearest hit, emission, film.
    primary: u64,
    /// A whole path as the scene wants it.
    path: u64,
}

/// Counts every scene and writes the record.
pub fn run(options: &Options) -> Result<()> {
    ensure!(
        shell::have("valgrind"),
        "valgrind is missing: `apt-get install valgrind`"
    );
    if options.peers {
        let bunny = shell::root().join(&options.bunny);
        let section = peers::run(options.embree.as_deref(), &bunny)?;
        println!("{section}");
        return put(peers::TITLE, &section);
    }
    shell::run(shell::cargo("build").args(["--release", "--package", "host-sim", "--bin", "host-sim"]))?;
    let host_sim = shell::target_dir().join("release/host-sim");
    let folder = tempfile::tempdir()?;
    let mut cases = built_in(&host_sim)?;
    cases.retain(|case| case.integrator == Some("path"));
    cases.extend(files(&shell::root().join(&options.scenes))?);
    cases.extend(bunny(&shell::root().join(&options.bunny), folder.path())?);
    let header = Header::now(0)?;
    let mut rows = Vec::new();
    for case in &cases {
        let Some(path) = difference(&host_sim, case, &[])? else {
            println!("{}: not rendered yet", case.name);
            continue;
        };
        let primary =
            difference(&host_sim, case, &["--max-depth", "1"])?.context("one depth, not the other")?;
        println!("{}: {primary} a primary ray, {path} a path", case.name);
        rows.push(Row {
            scene: case.name.clone(),
            primary,
            path,
        });
    }
    let path = shell::root().join(RECORD);
    let before = std::fs::read_to_string(&path).unwrap_or_default();
    let beside = match &options.seed_program {
        Some(sources) => Some(bench_seed::run(sources)?.text()),
        None => section::of(&before, BESIDE).map(str::to_string),
    };
    let mut page = text(&header, &rows);
    let others = KEPT.map(|title| (title, section::of(&before, title)));
    for (title, body) in [(BESIDE, beside.as_deref())].into_iter().chain(others) {
        if let Some(body) = body {
            page += &format!("\n{title}\n\n{}\n", body.trim());
        }
    }
    std::fs::write(&path, page).with_context(|| path.display().to_string())?;
    println!("written to {RECORD}");
    if let Some(file) = &options.json {
        let row = |row: &Row| {
            json!({ "core": "x86-64", "scene": row.scene, "instructions": row.primary,
                "instructions_path": row.path, "pixels": SIDE * SIDE })
        };
        let rows: Vec<_> = rows.iter().map(row).collect();
        std::fs::write(file, serde_json::to_string_pretty(&rows)?)
            .with_context(|| file.display().to_string())?;
    }
    Ok(())
}

/// Instructions of one more sample a pixel, or `None` if host-sim refuses the scene.
pub(crate) fn difference(host_sim: &Path, case: &Case, more: &[&str]) -> Result<Option<u64>> {
    let mut counts = [0; 2];
    for (count, spp) in counts.iter_mut().zip(SAMPLES) {
        let Some(total) = instructions(host_sim, case, spp, more)? else {
            return Ok(None);
        };
        *count = total;
    }
    Ok(Some(
        (counts[1] - counts[0]) / ((SAMPLES[1] - SAMPLES[0]) * SIDE * SIDE),
    ))
}

fn instructions(host_sim: &Path, case: &Case, spp: u64, more: &[&str]) -> Result<Option<u64>> {
    let folder = tempfile::tempdir()?;
    let side = SIDE.to_string();
    let mut valgrind = Command::new("valgrind");
    valgrind
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(host_sim);
    valgrind.args([
        "render",
        &case.scene,
        "--width",
        &side,
        "--height",
        &side,
        "--spp",
        &spp.to_string(),
    ]);
    valgrind.args(["--threads", "1", "--sampler", "independent", "--quiet", "-o"]);
    valgrind
        .arg(folder.path().join("picture.pfm"))
        .args(more)
        .current_dir(&case.folder);
    if let Some((name, value)) = &case.definition {
        valgrind.arg("-D").arg(format!("{name}={value}"));
    }
    let output = valgrind.output().context("valgrind does not start")?;
    if !output.status.success() {
        return Ok(None);
    }
    let told = String::from_utf8_lossy(&output.stderr);
    let line = told.lines().find_map(|line| line.split("Collected :").nth(1));
    Ok(Some(line.context("valgrind counted nothing")?.trim().parse()?))
}

fn text(header: &Header, rows: &[Row]) -> String {
    let mut page = String::from(
        "# Performance on the host\n\nWritten by `cargo xtask bench-host`; not to be edited, but for the section *Tried*, which it leaves.\n\n",
    );
    page += &format!(
        "{}, commit {}, {}, release profile.\n\n",
        header.date, header.commit, header.tools
    );
    page += "Instructions of x86-64, counted by callgrind on one thread: the difference of two renders of 64 × 64 pixels at\n\
        1 and 5 independent samples a pixel, for one more sample. A primary ray is `--max-depth 1`: random numbers, camera,\n\
        nearest hit, emission and film. A path is the scene's own depth with light samples and shadow rays.\n\n";
    page += "First: the record of 2026-11-23, commit 0637617.\n\n";
    page += "| scene | a primary ray | first | a path | first | of it |\n|---|--:|--:|--:|--:|--:|\n";
    for Row { scene, primary, path } in rows {
        let first = FIRST.iter().find(|(name, ..)| name == scene);
        page += &match first {
            Some((_, ray, first)) => {
                let share = *path as f64 / *first as f64;
                format!("| {scene} | {primary} | {ray} | {path} | {first} | {share:.3} |\n")
            }
            None => format!("| {scene} | {primary} | | {path} | | |\n"),
        };
    }
    page
}

/// Writes a section of the record that another chore measures.
pub(crate) fn put(title: &str, body: &str) -> Result<()> {
    section::put(RECORD, &KEPT, title, body)
}
