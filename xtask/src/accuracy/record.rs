//! The page that people read.

use std::process::Command;

use anyhow::{Context, Result};

use super::measure::{Against, Error, Numbers, Outcome};
use crate::shell;

pub struct Row {
    pub scene: String,
    pub integrator: String,
    pub outcome: Outcome,
}

/// Under what the numbers were taken.
pub struct Header {
    pub spp: u32,
    pub date: String,
    pub commit: String,
    pub tools: String,
}

impl Header {
    pub fn now(spp: u32) -> Result<Header> {
        let said = |program: &str, args: &[&str]| {
            let told = shell::ask(Command::new(program).args(args).current_dir(shell::root()));
            told.with_context(|| format!("`{program} {}` failed", args.join(" ")))
        };
        let mut commit = said("git", &["rev-parse", "--short", "HEAD"])?;
        if !said("git", &["status", "--porcelain", "--untracked-files=no"])?.is_empty() {
            commit += " with changes";
        }
        let rustc = said("rustc", &["--version"])?;
        let oracle = shell::target_dir().join("oracle/bin/python");
        let version = "import mitsuba; print('Mitsuba', mitsuba.__version__)";
        let mitsuba = shell::ask(Command::new(oracle).args(["-c", version]));
        Ok(Header {
            spp,
            date: said("date", &["-u", "+%Y-%m-%d"])?,
            commit,
            tools: std::iter::once(rustc)
                .chain(mitsuba)
                .collect::<Vec<_>>()
                .join(", "),
        })
    }
}

const WORDS: &str = "\
Both renderers take the same number of samples a pixel and their own random numbers, so RMSE, PSNR and FLIP show the
noise of both as well as their difference; bias is what noise does not explain.

- bias: the picture's mean over the reference's, less 1 (light above 8 counts as 8)
- RMSE: of linear light, capped the same way; PSNR: of sRGB signals clipped to 0..1
- FLIP: mean of the map, 67 pixels a degree, sRGB clipped to 0..1
- hit or miss: share of primary rays that meet something in one of the two alone
- hit point: distance between the two points that one primary ray meets, as a share of the scene's extent (the diagonal
  of the box around all finite shapes), or of the way there where that is longer, which it is far out on infinite planes:
  99th percentile of all rays, and 99.99th of those away from silhouettes
";

/// The whole page.
pub fn text(header: &Header, rows: &[Row]) -> String {
    let mut page = String::from("# Accuracy\n\n");
    page += "Written by `cargo xtask accuracy`; not to be edited.\n\n";
    page += &format!(
        "{} samples a pixel. {}, commit {}, {}.\n\n",
        header.spp, header.date, header.commit, header.tools
    );
    page += "## Fixed point against the f64 reference\n\n";
    page += WORDS;
    page += "\n| scene | integrator | size | bias | RMSE | PSNR | FLIP | hit or miss | hit point p99 | p99.99 |\n";
    page += "|---|---|---|--:|--:|--:|--:|--:|--:|--:|\n";
    for row in rows {
        if let Outcome::Measured(numbers) = &row.outcome {
            page += &between(row, numbers);
        }
    }
    page += &third(rows);
    let refused = rows.iter().filter_map(|row| match &row.outcome {
        Outcome::Refused(line) => Some(format!("- {line}\n")),
        Outcome::Measured(_) => None,
    });
    let refused: String = refused.collect();
    if !refused.is_empty() {
        page += &format!("\n## Not rendered yet\n\n{refused}");
    }
    page
}

fn between(row: &Row, numbers: &Numbers) -> String {
    format!(
        "| {} | {} | {} × {} | {} | {:.5} | {:.1} dB | {:.4} | {} | {:.1e} | {:.1e} |\n",
        row.scene,
        row.integrator,
        numbers.width,
        numbers.height,
        percent(numbers.between.bias),
        numbers.rmse,
        numbers.psnr_db,
        numbers.between.flip,
        share(numbers.hit_miss),
        numbers.hit_point_p99,
        numbers.hit_point_p9999,
    )
}

/// The table against Mitsuba; nothing if there was no picture of its.
fn third(rows: &[Row]) -> String {
    let mut lines = String::new();
    for row in rows {
        let Outcome::Measured(numbers) = &row.outcome else {
            continue;
        };
        if let Some(Against {
            fixed,
            reference,
            mitsuba,
        }) = &numbers.against
        {
            let cells = |error: &Error| format!("{} | {:.4}", percent(error.bias), error.flip);
            let mitsuba = mitsuba.as_ref().map_or("- | -".to_string(), cells);
            lines += &format!(
                "| {} | {} | {} | {mitsuba} |\n",
                row.scene,
                cells(fixed),
                cells(reference)
            );
        }
    }
    if lines.is_empty() {
        return lines;
    }
    let head = "| scene | fixed: bias | FLIP | f64: bias | FLIP | Mitsuba: bias | FLIP |\n|---|--:|--:|--:|--:|--:|--:|\n";
    format!(
        "\n## Against Mitsuba 3\n\nAgainst Mitsuba's pictures of the same files at 4096 samples a pixel (`scalar_rgb`): \
         the fixed-point picture, our f64\nreference's, and Mitsuba's own, at the number of samples above.\n\n{head}{lines}"
    )
}

fn percent(x: f64) -> String {
    format!("{:+.3} %", 100.0 * x)
}

fn share(x: f64) -> String {
    if x == 0.0 {
        "0".to_string()
    } else {
        format!("{:.4} %", 100.0 * x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_a_row_for_each_case() {
        let error = |bias, flip| Error { bias, flip };
        let numbers = |against| {
            Outcome::Measured(Box::new(Numbers {
                width: 128,
                height: 96,
                between: error(-0.0012, 0.0213),
                rmse: 0.034,
                psnr_db: 31.46,
                hit_miss: 2.6e-5,
                hit_point_p99: 3e-6,
                hit_point_p9999: 7e-6,
                against,
            }))
        };
        let against = Against {
            fixed: error(0.001, 0.02),
            reference: error(-0.002, 0.03),
            mitsuba: Some(error(0.0, 0.01)),
        };
        let row = |scene: &str, outcome| Row {
            scene: scene.into(),
            integrator: "path".into(),
            outcome,
        };
        let rows = [
            row("spheres", numbers(None)),
            row("room.xml", numbers(Some(against))),
            row("rough.xml", Outcome::Refused("rough.xml:3: no roughness".into())),
        ];
        let header = Header {
            spp: 256,
            date: "2000-02-29".into(),
            commit: "abc".into(),
            tools: "rustc 1".into(),
        };
        let page = text(&header, &rows);
        let lines = [
            "256 samples a pixel. 2000-02-29, commit abc, rustc 1.",
            "| spheres | path | 128 × 96 | -0.120 % | 0.03400 | 31.5 dB | 0.0213 | 0.0026 % | 3.0e-6 | 7.0e-6 |",
            "| room.xml | +0.100 % | 0.0200 | -0.200 % | 0.0300 | +0.000 % | 0.0100 |",
            "- rough.xml:3: no roughness",
        ];
        for line in lines {
            assert!(page.lines().any(|l| l == line), "{line}\nis not in\n{page}");
        }
        let alone = text(&header, &rows[..1]);
        assert!(
            !alone.contains("Mitsuba") && !alone.contains("Not rendered"),
            "{alone}"
        );
    }
}
