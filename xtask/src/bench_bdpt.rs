//! The record of what bidirectional path tracing is worth: `docs/transport.md`.
//!
//! Variance is counted between two renders that differ by their seed, so that no reference picture's own noise is in it;
//! cost is counted in instructions, which the machine's load cannot move.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use clap::Args;
use serde_json::{Map, Value};

use crate::accuracy::{Case, Error, Header, files, mitsuba};
use crate::bench_host::difference;
use crate::picture::{self, CAP, Picture};
use crate::shell;

#[derive(Args)]
pub struct Options {
    /// Mitsuba scenes, with pictures of theirs in reference/NAME.exr
    #[arg(long, value_name = "DIR", default_value = "../shared/scenes")]
    scenes: PathBuf,
}

const RECORD: &str = "docs/transport.md";
const SCENES: [&str; 3] = ["bidir-room.xml", "cornell-glass.xml", "veach-mis.xml"];
const WAYS: [(&str, &[&str]); 3] = [
    ("path", &["--integrator", "path"]),
    ("bdpt", &["--integrator", "bdpt"]),
    ("bdpt --tiles", &["--integrator", "bdpt", "--tiles"]),
];
/// Samples a pixel of each of the two renders.
const SPP: u32 = 64;

/// One way of rendering one scene.
struct Row {
    scene: String,
    way: &'static str,
    instructions: u64,
    /// Of a pixel's channel, a sample: of the whole picture, and of what only matt surfaces show.
    variance: [f64; 2],
    /// Against Mitsuba's picture.
    fixed: Error,
    mitsuba: Option<Error>,
}

/// Measures and writes the record.
pub fn run(options: &Options) -> Result<()> {
    ensure!(
        shell::have("valgrind"),
        "valgrind is missing: `apt-get install valgrind`"
    );
    shell::run(shell::cargo("build").args(["--release", "--package", "host-sim", "--bin", "host-sim"]))?;
    let host_sim = shell::target_dir().join("release/host-sim");
    let folder = shell::root().join(&options.scenes);
    let mut cases = files(&folder)?;
    cases.retain(|case| SCENES.contains(&case.name.as_str()));
    ensure!(
        cases.len() == SCENES.len(),
        "{} has not {} with their pictures in reference/: name the folder by --scenes",
        folder.display(),
        SCENES.join(" and ")
    );
    let header = Header::now(SPP)?;
    let mut rows = Vec::new();
    for case in &cases {
        let (width, matt) = matt(&host_sim, case)?;
        let theirs = match case.mitsuba() {
            Some(scene) => mitsuba(&scene, SPP)?,
            None => None,
        };
        for (way, arguments) in WAYS {
            let seeds = [1, 2].map(|seed| render(&host_sim, case, seed, arguments));
            let [one, other] = seeds;
            let (one, other) = (one?.pixels, other?.pixels);
            let all = vec![true; matt.len()];
            let variance = [&all, &matt].map(|mask| variance(&one, &other, mask) * f64::from(SPP));
            let instructions = difference(&host_sim, case, arguments)?
                .with_context(|| format!("{} is refused", case.name))?;
            let fixed = against(&host_sim, case, arguments)?;
            println!(
                "{}, {way}: {instructions} instructions, variance {variance:?}",
                case.name
            );
            rows.push(Row {
                scene: case.name.clone(),
                way,
                instructions,
                variance,
                fixed,
                mitsuba: theirs,
            });
        }
        ensure!(width > 0, "{} has no picture", case.name);
    }
    let path = shell::root().join(RECORD);
    std::fs::write(&path, text(&header, &rows)).with_context(|| path.display().to_string())?;
    println!("written to {RECORD}");
    Ok(())
}

fn render(host_sim: &Path, case: &Case, seed: u32, more: &[&str]) -> Result<Picture> {
    let (spp, seed) = (SPP.to_string(), seed.to_string());
    let ours = ["--sampler", "independent", "--spp", &spp, "--seed", &seed];
    picture::render(host_sim, case, &[&ours, more].concat())
}

/// Half the mean squared difference of two renders: the variance of one.
fn variance(one: &[[f32; 3]], other: &[[f32; 3]], mask: &[bool]) -> f64 {
    let pairs = one.iter().zip(other).zip(mask).filter(|(_, wanted)| **wanted);
    let (mut sum, mut count) = (0.0, 0);
    for ((a, b), _) in pairs {
        for (a, b) in a.iter().zip(b) {
            sum += f64::from(a.min(CAP) - b.min(CAP)).powi(2) / 2.0;
            count += 1;
        }
    }
    sum / f64::from(count.max(1))
}

/// Width of the picture, and which pixels show matt surfaces alone: light tracing leaves mirrors and glass black, and what
/// shines by itself is brighter than the cap. Pixels beside others count as those.
fn matt(host_sim: &Path, case: &Case) -> Result<(usize, Vec<bool>)> {
    let Picture { width, pixels } = render(host_sim, case, 3, &["--integrator", "light"])?;
    let fits = |p: &[f32; 3]| p.iter().any(|c| *c > 0.0) && p.iter().all(|c| *c < 0.95 * CAP);
    let own: Vec<bool> = pixels.iter().map(fits).collect();
    let at = |x: isize, y: isize| {
        let inside = x >= 0 && y >= 0 && (x as usize) < width;
        !inside || own.get(y as usize * width + x as usize).copied().unwrap_or(true)
    };
    let around = |i: usize| {
        let (x, y) = ((i % width) as isize, (i / width) as isize);
        (-1..=1).all(|dy| (-1..=1).all(|dx| at(x + dx, y + dy)))
    };
    Ok((width, (0..own.len()).map(around).collect()))
}

/// The picture's error against Mitsuba's.
fn against(host_sim: &Path, case: &Case, more: &[&str]) -> Result<Error> {
    let folder = tempfile::tempdir()?;
    let json = folder.path().join("numbers.json");
    let picture = case
        .reference
        .as_deref()
        .context("there is no picture to compare with")?;
    let mut command = Command::new(host_sim);
    command.args(["compare", &case.scene, "--quiet", "--reference-spp", "1", "--spp"]);
    command
        .arg(SPP.to_string())
        .arg("--against")
        .arg(picture.canonicalize()?);
    command
        .arg("--json")
        .arg(&json)
        .args(more)
        .current_dir(&case.folder);
    shell::run(&mut command)?;
    let numbers: Map<String, Value> = serde_json::from_str(&std::fs::read_to_string(&json)?)?;
    let number = |key: &str| {
        let value = numbers.get(key).and_then(Value::as_f64);
        value.with_context(|| format!("host-sim told no {key}"))
    };
    Ok(Error {
        bias: number("against_fixed_bias")?,
        flip: number("against_fixed_flip")?,
    })
}

const WORDS: &str = "\
Variance is that of a pixel's channel (light above 8 counts as 8), for one sample, from two renders with 64 independent
samples a pixel that differ by their seed; *on matt surfaces* leaves out what is seen in mirrors and glass, the lamp, and
pixels beside them, so that of specular paths only caustics are in it. Instructions are x86-64's for one sample
(callgrind). *RMSE at equal instructions* is the root of variance times instructions, over path's; *variance at equal
paths* is over path's as well. bdpt renders into a whole frame, `bdpt --tiles` as a board without memory for one. Bias
and FLIP are against Mitsuba's picture of 4096 samples, beside those of Mitsuba's `path` with 64.
";

fn text(header: &Header, rows: &[Row]) -> String {
    let mut page = String::from(
        "# Bidirectional path tracing\n\nWritten by `cargo xtask bench-bdpt`; not to be edited.\n\n",
    );
    page += &format!(
        "{}, commit {}, {}.\n\n{WORDS}",
        header.date, header.commit, header.tools
    );
    page += "\n| scene | integrator | instructions | variance | on matt surfaces | variance at equal paths | on matt surfaces | \
        RMSE at equal instructions | on matt surfaces |\n|---|---|--:|--:|--:|--:|--:|--:|--:|\n";
    for row in rows {
        let path = rows.iter().find(|other| other.scene == row.scene).unwrap_or(row);
        let share = [0, 1].map(|i| row.variance[i] / path.variance[i]);
        let cost = row.instructions as f64 / path.instructions as f64;
        let rmse = share.map(|share| (share * cost).sqrt());
        page += &format!(
            "| {} | {} | {} | {:.4} | {:.4} | {:.3} | {:.3} | {:.2} | {:.2} |\n",
            row.scene,
            row.way,
            row.instructions,
            row.variance[0],
            row.variance[1],
            share[0],
            share[1],
            rmse[0],
            rmse[1]
        );
    }
    page += "\n| scene | integrator | bias | FLIP | Mitsuba's bias | Mitsuba's FLIP |\n|---|---|--:|--:|--:|--:|\n";
    for row in rows {
        let theirs = match row.mitsuba {
            Some(Error { bias, flip }) => format!("{:+.2} % | {flip:.4}", 100.0 * bias),
            None => "- | -".to_string(),
        };
        let Error { bias, flip } = row.fixed;
        page += &format!(
            "| {} | {} | {:+.2} % | {flip:.4} | {theirs} |\n",
            row.scene,
            row.way,
            100.0 * bias
        );
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variance_is_that_of_one_render() {
        // Two draws of ±1 differ by 0 or 2: half the mean square is 1.
        let one = vec![[1.0; 3], [1.0; 3], [20.0; 3]];
        let other = vec![[-1.0; 3], [1.0; 3], [9.0; 3]];
        assert_eq!(variance(&one, &other, &[true, true, false]), 1.0);
        assert_eq!(variance(&one, &other, &[false, true, true]), 0.0);
    }
}
