//! The numbers as JSON.

use serde_json::{Map, Value, json};

use super::check::checks;
use super::{DOMAIN, Part, Report, Summary, Tried, Uncovered, still_spp};
use crate::metrics::Metrics;

/// All of the numbers; what was not measured is not there.
pub fn json(report: &Report) -> Value {
    let checks = checks(report);
    let checks = checks.iter().map(|check| {
        json!({
            "of": check.kind.key(),
            "what": check.what,
            "bar": check.bar(),
            "value": check.value,
            "mark": check.mark().name(),
        })
    });
    let scenes = report.scenes.iter().map(|scene| {
        let mut map = Map::new();
        map.insert("scene".to_string(), scene.name.as_str().into());
        map.insert("width".to_string(), scene.width.into());
        map.insert("height".to_string(), scene.height.into());
        match &scene.outcome {
            Err(reason) => map.insert("skipped".to_string(), reason.as_str().into()),
            Ok(parts) => map.insert("parts".to_string(), parts.iter().map(part).collect()),
        };
        Value::from(map)
    });
    json!({
        "domain": DOMAIN,
        "oidn": report.has_oidn,
        "reference_spp": report.reference_spp,
        "still_reference_spp": still_spp(report.reference_spp),
        "seed": report.seed,
        "checks": checks.collect::<Vec<_>>(),
        "means": report.summaries().iter().map(summary).collect::<Vec<_>>(),
        "scenes": scenes.collect::<Vec<_>>(),
    })
}

fn summary(summary: &Summary) -> Value {
    let rows = summary.rows.iter().map(|row| {
        let mut map = Map::new();
        map.insert("method".to_string(), row.method.key().into());
        map.insert("psnr_db".to_string(), row.psnr_db.into());
        map.insert("ssim".to_string(), row.ssim.into());
        map.insert("flip".to_string(), row.flip.into());
        if let Some(flicker) = row.flicker {
            map.insert("last_psnr_db".to_string(), row.last_db.into());
            map.insert("flicker".to_string(), flicker.into());
        }
        Value::from(map)
    });
    json!({
        "of": summary.kind.key(),
        "methods": rows.collect::<Vec<_>>(),
        "uncovered": summary.uncovered.map(uncovered),
    })
}

fn part(part: &Part) -> Value {
    json!({
        "of": part.kind.key(),
        "reference_psnr_db": part.reference_db,
        "methods": part.tried.iter().map(tried).collect::<Vec<_>>(),
        "uncovered": part.uncovered.map(uncovered),
    })
}

fn tried(tried: &Tried) -> Value {
    let each = |value: fn(&Metrics) -> f64| tried.metrics.iter().map(value).collect::<Vec<f64>>();
    json!({
        "method": tried.method.key(),
        "psnr_db": each(|m| m.psnr_db),
        "ssim": each(|m| m.ssim),
        "flip": each(|m| m.flip),
        "flicker": tried.flicker,
    })
}

fn uncovered(found: Uncovered) -> Value {
    json!({
        "pixels": found.pixels,
        "share": found.share,
        "psnr_db": found.with_history,
        "psnr_db_without_history": found.without,
    })
}
