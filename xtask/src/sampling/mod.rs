//! The record of what the samplers are worth: `docs/sampling.md` and its curves.
//!
//! The error of a picture is its spread over seeds, so that no reference picture's own noise is in it; what a sampler
//! would add to the mean is not in it either, which the record of accuracy and the z-tests look at.

mod plot;
mod spread;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Args;
use serde_json::json;

use crate::accuracy::{Case, Header, built_in, files};
use crate::picture::{self, Picture};
use crate::shell;
use spread::{Blocks, Spread, far, slope};

#[derive(Args)]
pub struct Options {
    /// Mitsuba scenes; none are taken if there is no such folder
    #[arg(long, value_name = "DIR", default_value = "../shared/scenes")]
    scenes: PathBuf,
    /// Only this scene, shown and not recorded; may be given several times
    #[arg(long, value_name = "SCENE")]
    only: Vec<String>,
    /// Write the numbers as JSON, too
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

const RECORD: &str = "docs/sampling.md";
const CURVES: &str = "docs/img/sampling.svg";
/// As host-sim names them; all are measured by the first.
const SAMPLERS: [&str; 5] = ["independent", "stratified", "cmj", "sobol", "blue"];
/// Samples a pixel.
const LEVELS: [u32; 7] = [1, 2, 4, 8, 16, 32, 64];
/// Renders that a spread is of.
const BLOCK: u32 = 8;
/// At the last level, blocks of them: at least, and at most while a share of independent samples' error is not yet so
/// many standard errors from 1.
const BLOCKS: [usize; 2] = [4, 128];
const CLEAR: f64 = 3.0;
const WIDTH: u32 = 64;
/// Levels from which a slope is fitted: strata have not begun before.
const SLOPE_FROM: u32 = 4;
/// Levels at which the error is looked at from a distance.
const FAR_TO: u32 = 4;

/// One scene with one integrator: errors by sampler and level.
struct Row {
    scene: String,
    integrator: &'static str,
    near: [[Spread; LEVELS.len()]; SAMPLERS.len()],
    /// Of the pictures blurred.
    far: [[Spread; LEVELS.len()]; SAMPLERS.len()],
    /// Of the last level.
    blocks: [Blocks; SAMPLERS.len()],
}

impl Row {
    fn label(&self) -> String {
        format!("{}, {}", self.scene, self.integrator)
    }

    /// Errors at the last level over independent samples'.
    fn share(&self, sampler: usize, of: fn(&Spread) -> f64) -> f64 {
        let last = LEVELS.len() - 1;
        of(&self.near[sampler][last]) / of(&self.near[0][last])
    }

    /// Standard error of the RMSE's share.
    fn error(&self, sampler: usize) -> f64 {
        let [own, independent] = [sampler, 0].map(|i| self.blocks[i].error());
        self.share(sampler, |spread| spread.rmse) * own.hypot(independent)
    }

    /// Whether it is clear of each sampler that its RMSE is another than independent samples'.
    fn is_clear(&self) -> bool {
        (1..SAMPLERS.len())
            .all(|i| (self.share(i, |spread| spread.rmse) - 1.0).abs() >= CLEAR * self.error(i))
    }

    /// Of the pixels' mean error: a power of the number of samples.
    fn slope(&self, sampler: usize) -> f64 {
        let points = LEVELS.iter().zip(&self.near[sampler]);
        let late = points.filter(|(spp, _)| **spp >= SLOPE_FROM);
        let point = |(spp, spread): (&u32, &Spread)| (f64::from(*spp), spread.mean);
        slope(&late.map(point).collect::<Vec<_>>())
    }
}

/// Measures every scene and writes the record, or shows it.
pub fn run(options: &Options) -> Result<()> {
    shell::run(shell::cargo("build").args(["--release", "--package", "host-sim", "--bin", "host-sim"]))?;
    let host_sim = shell::target_dir().join("release/host-sim");
    let mut cases = built_in(&host_sim)?;
    cases.extend(files(&shell::root().join(&options.scenes))?);
    cases.retain(|case| options.only.is_empty() || options.only.contains(&case.name));
    ensure!(
        !cases.is_empty(),
        "there is no such scene; `host-sim scenes` lists them"
    );
    // Now, since the tree may change while this runs.
    let header = Header::now(LEVELS[LEVELS.len() - 1])?;
    let mut rows = Vec::new();
    for case in &cases {
        let row = measure(&host_sim, case)?;
        let shares: Vec<_> = (1..SAMPLERS.len())
            .map(|i| format!("{} {}", SAMPLERS[i], rmse(&row, i)))
            .collect();
        println!(
            "{}: {}; {} renders",
            row.label(),
            shares.join(", "),
            renders(&row)
        );
        rows.push(row);
    }
    let text = text(&header, &rows);
    if options.only.is_empty() {
        let write = |name: &str, text: &str| {
            std::fs::write(shell::root().join(name), text).with_context(|| name.to_string())
        };
        write(RECORD, &text)?;
        write(CURVES, &plot::curves(&rows)?)?;
        println!("written to {RECORD} and {CURVES}");
    } else {
        print!("\n{text}");
    }
    if let Some(file) = &options.json {
        let numbers = json!({ "samplers": SAMPLERS, "spp": LEVELS, "rows": rows.iter().map(|row| json!({
            "scene": row.scene, "integrator": row.integrator,
            "rmse": row.near.map(|levels| levels.map(|spread| spread.rmse)),
            "mean": row.near.map(|levels| levels.map(|spread| spread.mean)),
            "relative_error_of_last_rmse": row.blocks.each_ref().map(Blocks::error),
            "renders_of_last": renders(row),
            "mean_from_afar": row.far.map(|levels| levels.map(|spread| spread.mean)),
        })).collect::<Vec<_>>() });
        std::fs::write(file, serde_json::to_string_pretty(&numbers)?)
            .with_context(|| file.display().to_string())?;
    }
    Ok(())
}

fn measure(host_sim: &Path, case: &Case) -> Result<Row> {
    let mut row = Row {
        scene: case.name.clone(),
        integrator: case.integrator.unwrap_or("its own"),
        near: Default::default(),
        far: Default::default(),
        blocks: Default::default(),
    };
    let last = LEVELS.len() - 1;
    for i in 0..SAMPLERS.len() {
        for j in 0..last {
            let pictures = block(host_sim, case, i, j, 0)?;
            row.near[i][j] = Spread::of(&pictures);
            row.far[i][j] = Spread::of(&pictures.iter().map(far).collect::<Vec<_>>());
        }
    }
    let mut wanted = BLOCKS[0];
    loop {
        for i in 0..SAMPLERS.len() {
            for number in row.blocks[i].count()..wanted {
                let pictures = block(host_sim, case, i, last, number as u32)?;
                row.blocks[i].push(Spread::of(&pictures));
            }
            row.near[i][last] = row.blocks[i].spread();
        }
        if row.is_clear() || wanted >= BLOCKS[1] {
            return Ok(row);
        }
        wanted *= 2;
    }
}

/// Renders that differ by their seed; other numbers, other seeds.
fn block(host_sim: &Path, case: &Case, sampler: usize, level: usize, number: u32) -> Result<Vec<Picture>> {
    let (width, spp) = (WIDTH.to_string(), LEVELS[level].to_string());
    let integrator = case.integrator.map(|name| ["--integrator", name]);
    (number * BLOCK + 1..=(number + 1) * BLOCK)
        .map(|seed| {
            let seed = seed.to_string();
            let mut arguments = vec!["--width", &width, "--spp", &spp, "--seed", &seed];
            arguments.extend(["--sampler", SAMPLERS[sampler]]);
            arguments.extend(integrator.iter().flatten());
            picture::render(host_sim, case, &arguments)
        })
        .collect()
}

const WORDS: &str = "\
The error of a pixel is its standard deviation over renders, 64 pixels wide, that differ by their seed, so no
reference's noise is in it (linear light, above 8 counts as 8). *RMSE* is that of all pixels, in which the few at a
lamp's rim and in caustics decide, with its standard error; *mean* is that of the pixels' standard deviations over
8 renders each. At 64 samples there are 32 renders at least, and twice as many, up to 1024, until each RMSE is three
standard errors from independent samples'. Whether samplers agree in light is asked by `tests/sampler.rs`,
`tests/closed_form.rs` and docs/accuracy.md.

No placement of 64 samples helps against what fewer than one in 64 of them finds: whatever the strata, it is found once
or not at all. So it is with the sun of `sky` when path tracing meets it by chance by way of the glass or the metal: these
few paths carry almost all of its RMSE, which samplers lower by little, while the mean falls.
";

/// The share of independent samples' RMSE, with its standard error.
fn rmse(row: &Row, sampler: usize) -> String {
    format!(
        "{:.3} ±{:.3}",
        row.share(sampler, |spread| spread.rmse),
        row.error(sampler)
    )
}

/// Renders at the last level.
fn renders(row: &Row) -> usize {
    row.blocks[0].count() * BLOCK as usize
}

fn text(header: &Header, rows: &[Row]) -> String {
    let mut page = String::from("# Samplers\n\nWritten by `cargo xtask sampling`; not to be edited.\n\n");
    page += &format!(
        "{}, commit {}, {}.\n\n{WORDS}",
        header.date, header.commit, header.tools
    );
    page += &format!(
        "\n## Error at {} samples a pixel, over independent samples'\n\n",
        header.spp
    );
    let columns = SAMPLERS[1..].iter();
    let mut columns: Vec<String> = columns
        .flat_map(|name| ["RMSE", "mean"].map(|what| format!("{name}: {what}")))
        .collect();
    columns.push("renders".to_string());
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    page += &table(rows, &columns, |row, i| match (1 + i / 2, i % 2) {
        (sampler, _) if sampler == SAMPLERS.len() => renders(row).to_string(),
        (sampler, 0) => rmse(row, sampler),
        (sampler, _) => format!("{:.3}", row.share(sampler, |spread| spread.mean)),
    });
    page += &format!(
        "\n## How fast it falls\n\nThe mean error of a pixel goes as this power of the number of samples, \
        fitted to {SLOPE_FROM} to {}:\nindependent samples have -0.5 in theory.\n\n![Error against samples]({})\n\n",
        header.spp,
        CURVES.trim_start_matches("docs/")
    );
    page += &table(rows, &SAMPLERS, |row, i| format!("{:+.2}", row.slope(i)));
    page += "\n## From a distance\n\nWhat is left of the mean error when a picture is blurred (Gaussian, standard deviation \
        1.5 pixels), as an eye\nfar off does: over independent samples' at as many samples. `blue` is the sampler made \
        for this: its errors cancel\nbetween neighbours (Ahmed and Wonka 2020).\n\n";
    let levels = LEVELS.iter().filter(|spp| **spp <= FAR_TO).count();
    let columns: Vec<String> = (0..levels)
        .flat_map(|j| ["sobol", "blue"].map(|name| format!("{name}, {} spp", LEVELS[j])))
        .collect();
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    page += &table(rows, &columns, |row, i| {
        let sampler = SAMPLERS.len() - 2 + i % 2;
        format!("{:.3}", row.far[sampler][i / 2].mean / row.far[0][i / 2].mean)
    });
    page
}

/// A row for each scene; no mean of them, which over unlike scenes says little.
fn table(rows: &[Row], columns: &[&str], cell: impl Fn(&Row, usize) -> String) -> String {
    let mut table = format!("| scene | integrator | {} |\n|---|---|", columns.join(" | "));
    table += &"--:|".repeat(columns.len());
    table.push('\n');
    for row in rows {
        let cells: Vec<String> = (0..columns.len()).map(|i| cell(row, i)).collect();
        table += &format!("| {} | {} | {} |\n", row.scene, row.integrator, cells.join(" | "));
    }
    table
}
