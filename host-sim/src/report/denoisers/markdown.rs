//! The means as tables for a document.

use std::fmt::Write;

use super::check::checks;
use super::{DOMAIN, Report};

/// What was measured over all scenes, and the bars.
pub fn markdown(report: &Report) -> String {
    let mut text = String::new();
    // Writing into a string cannot fail.
    let _ = write(&mut text, report);
    text
}

fn write(text: &mut String, report: &Report) -> std::fmt::Result {
    writeln!(text, "**{DOMAIN}**\n")?;
    let scenes = report.scenes.iter().filter(|scene| scene.outcome.is_ok()).count();
    writeln!(text, "{scenes} scenes, references of {}.", report.references())?;
    for summary in report.summaries() {
        let is_clip = summary.kind.is_clip();
        writeln!(text, "\n{}:\n", summary.kind.title())?;
        let (names, lines) = match is_clip {
            true => (" last frame | flicker |", "--:|--:|"),
            false => ("", ""),
        };
        writeln!(text, "| | PSNR, dB | SSIM | FLIP |{names}")?;
        writeln!(text, "|---|--:|--:|--:|{lines}")?;
        for row in &summary.rows {
            let title = row.method.title();
            write!(
                text,
                "| {title} | {:.2} | {:.4} | {:.4} |",
                row.psnr_db, row.ssim, row.flip
            )?;
            if let Some(flicker) = row.flicker {
                write!(text, " {:.2} | {flicker:.4} |", row.last_db)?;
            }
            writeln!(text)?;
        }
        if let Some(found) = summary.uncovered {
            writeln!(
                text,
                "\nWhere nothing is remembered ({:.1} % of the pixels): {:.2} dB, without any history {:.2} dB.",
                100.0 * found.share,
                found.with_history,
                found.without
            )?;
        }
    }
    writeln!(text, "\n| ours | | bar | measured | |\n|---|---|--:|--:|---|")?;
    for check in checks(report) {
        writeln!(
            text,
            "| {} | {} | {} | {} | {} |",
            check.kind.short(),
            check.what,
            check.bar(),
            check.measured(),
            check.mark().sign()
        )?;
    }
    Ok(())
}
