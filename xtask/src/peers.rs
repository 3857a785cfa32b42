//! Other people's ray tracers beside ours, on the same rays: a section of `docs/performance.md`.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::accuracy::Header;
use crate::shell;

pub(crate) const TITLE: &str = "## Beside other ray tracers";

/// A tube of our own, as many triangles as one mesh of the scene in the other half of the table has.
const KNOT: &str = "knot:500x20";
/// Rays whose time is taken, and rays whose instructions are counted.
const TIMED: &str = "200000";
const COUNTED: u64 = 20_000;

/// Builds the program `peers`, which is a workspace of its own for its crates.
pub(crate) fn build() -> Result<PathBuf> {
    let folder = shell::target_dir().join("peers");
    let mut cargo = shell::cargo("build");
    cargo.args([
        "--release",
        "--quiet",
        "--locked",
        "--manifest-path",
        "peers/Cargo.toml",
        "--target-dir",
    ]);
    shell::run(cargo.arg(&folder))?;
    Ok(folder.join("release/peers"))
}

/// Instructions that callgrind counts in a function of `peers`, and what it printed.
pub(crate) fn count(peers: &Path, function: &str, arguments: &[&str]) -> Result<(u64, String)> {
    let toggle = format!("--toggle-collect={function}");
    let mut valgrind = Command::new("valgrind");
    valgrind.args([
        "--tool=callgrind",
        "--callgrind-out-file=/dev/null",
        "--collect-atstart=no",
        &toggle,
    ]);
    let output = valgrind
        .arg(peers)
        .args(arguments)
        .output()
        .context("valgrind does not start")?;
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    ensure!(output.status.success(), "peers {}: {told}", arguments.join(" "));
    let line = told.lines().find_map(|line| line.split("Collected :").nth(1));
    let counted = line.context("valgrind counted nothing")?.trim().parse()?;
    Ok((counted, String::from_utf8_lossy(&output.stdout).into_owned()))
}

/// Traces the meshes with everybody; `embree` is Embree 4's library.
pub fn run(embree: Option<&Path>, bunny: &Path) -> Result<String> {
    ensure!(
        shell::have("valgrind"),
        "valgrind is missing: `apt-get install valgrind`"
    );
    let peers = build()?;
    let mut library = Vec::new();
    if let Some(file) = embree {
        let file = file.to_str().context("the library's name is not UTF-8")?;
        ensure!(Path::new(file).is_file(), "{file}: no such library");
        library = vec!["--embree", file];
    }
    let mut meshes = vec![("knot".to_owned(), KNOT.to_owned())];
    if bunny.is_file() {
        let file = bunny.to_str().context("the mesh's name is not UTF-8")?;
        meshes.insert(0, ("bunny".to_owned(), file.to_owned()));
    }
    let mut text = words(&Header::now(0)?);
    for (name, mesh) in meshes {
        println!("{name}");
        let mut command = Command::new(&peers);
        command.args([&*mesh, "--rays", TIMED]).args(&library);
        let told = shell::ask(&mut command).with_context(|| format!("peers {mesh} failed"))?;
        let row: Value = serde_json::from_str(&told)?;
        let mut counts = Vec::new();
        for tracer in row["tracers"].as_array().context("no tracers")? {
            let tracer = tracer["name"].as_str().context("a tracer without a name")?;
            let rays = COUNTED.to_string();
            let mut arguments = vec![&*mesh, "--rays", &rays, "--only", tracer];
            arguments.extend(&library);
            counts.push(count(&peers, "counted", &arguments)?.0 / COUNTED);
        }
        table(&mut text, &name, &row, &counts)?;
    }
    Ok(text)
}

fn words(header: &Header) -> String {
    format!(
        "Written by `cargo xtask bench-host --peers`, {}, commit {}, {}.\n\n\
        Nearest hits of {TIMED} rays, half of them from around the mesh into its box, half from anywhere in it, by one thread:\n\
        rays a second, medians of five turns of each in turn, and the median of the turns\' ratios; wall clock, so that the\n\
        machine\'s load moves the rates, and the ratios less. Instructions of x86-64 a ray, counted by callgrind over the first\n\
        {COUNTED} rays (Embree: as it runs there). Coordinates are integers, the same and exact for all. `bvh` 0.12 is a\n\
        binary tree in f32: all boxes that are met, or the nearest first up to the hit; Embree 4 is asked by rtcIntersect1 in\n\
        its default settings, vectorised and in single precision. *Same*: the same triangle, or none; *distance*: another\n\
        number at the same distance to three steps of the grid and 1e-4 (our packed mesh has numbers of its own); *rim*: one\n\
        goes by within three steps of an edge where the other hits; *other*: what is neither.\n",
        header.date, header.commit, header.tools
    )
}

fn table(text: &mut String, name: &str, row: &Value, counts: &[u64]) -> Result<()> {
    let number = |value: &Value| value.as_f64().with_context(|| format!("{value} is no number"));
    let rays = number(&row["rays"])?;
    writeln!(
        text,
        "\n### {name}: {} triangles, {:.0} % of the rays hit\n\n\
        | | million rays/s | ours over it | instructions a ray | of ours | same | distance | rim | other |\n\
        |---|--:|--:|--:|--:|--:|--:|--:|--:|",
        row["triangles"],
        100.0 * number(&row["hits"])? / rays
    )?;
    let tracers = row["tracers"].as_array().context("no tracers")?;
    let ours = *counts.first().context("nothing counted")? as f64;
    for (tracer, count) in tracers.iter().zip(counts) {
        writeln!(
            text,
            "| {} | {:.2} | {:.2} | {count} | {:.2} | {} | {} | {} | {} |",
            tracer["name"].as_str().unwrap_or_default(),
            number(&tracer["rays_per_second"])? / 1e6,
            number(&tracer["ours_over_it"])?,
            *count as f64 / ours,
            tracer["same_triangle"],
            tracer["same_distance"],
            tracer["rim"],
            tracer["other"]
        )?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_table_has_a_line_for_each() {
        let tracer = |name: &str, rate: u32, ratio: f64| {
            json!({ "name": name, "rays_per_second": rate, "ours_over_it": ratio, "same_triangle": 9, "same_distance": 1,
                "rim": 0, "other": 0 })
        };
        let row = json!({ "triangles": 12, "rays": 10, "hits": 5,
            "tracers": [tracer("ours", 2_000_000, 1.0), tracer("theirs", 500_000, 4.0)] });
        let mut text = String::new();
        table(&mut text, "cube", &row, &[300, 900]).unwrap();
        assert!(
            text.contains("### cube: 12 triangles, 50 % of the rays hit\n"),
            "{text}"
        );
        assert!(
            text.contains("| theirs | 0.50 | 4.00 | 900 | 3.00 | 9 | 1 | 0 | 0 |\n"),
            "{text}"
        );
    }
}
