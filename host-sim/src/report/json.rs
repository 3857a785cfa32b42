//! All of the numbers, for other programs.

use serde_json::{Map, Value, json};

use super::{
    Against, BATCHES, Cell, Estimate, Group, Mark, Measured, Report, SceneReport, Trial, Tried, Truth, bar,
    count, primary_marks,
};
use crate::metrics::Metrics;
use crate::primary::PrimaryReport;

type Object = Map<String, Value>;

/// The report as one object. What `compare` has, too, has its names.
pub fn json(report: &Report) -> Value {
    let marks = report.marks();
    json!({
        "spp": report.spp,
        "reference_spp": report.reference_spp,
        "seed": report.seed,
        "batches": BATCHES,
        "batch_spp": report.batch_spp,
        "integrators": report.integrators,
        "samplers": report.samplers,
        "bars": {
            "bias": bar::BIAS,
            "hit_miss_disagreement": bar::HIT_MISS,
            "hit_point_error_p99": bar::HIT_P99,
            "hit_point_error_p9999": bar::HIT_P9999,
            "standard_errors_to_be_sure": bar::SURE,
        },
        "checks": {
            "ok": count(&marks, Mark::Ok),
            "noise": count(&marks, Mark::Noise),
            "off": count(&marks, Mark::Off),
        },
        "scenes": report.scenes.iter().map(scene).collect::<Vec<_>>(),
    })
}

fn scene(scene: &SceneReport) -> Value {
    let mut map = match &scene.outcome {
        Ok(measured) => measured_scene(measured),
        Err(reason) => skipped(reason),
    };
    map.insert("scene".to_string(), scene.name.as_str().into());
    map.into()
}

fn skipped(reason: &str) -> Object {
    Object::from_iter([("skipped".to_string(), reason.into())])
}

fn measured_scene(measured: &Measured) -> Object {
    let mut map = Object::new();
    let options = &measured.options;
    let sizes = [
        ("width", options.width as usize),
        ("height", options.height as usize),
        ("shapes", measured.info.shapes),
        ("triangles", measured.info.triangles),
        ("lights", measured.info.lights),
        ("bytes_total", measured.info.bytes_total()),
    ];
    map.extend(sizes.map(|(key, value)| (key.to_string(), value.into())));
    map.insert("primary_rays".to_string(), measured.primary.rays.into());
    map.extend(primary(&measured.primary));
    if let Some(reason) = &measured.elsewhere_left_out {
        map.insert("against_skipped".to_string(), reason.as_str().into());
    }
    map.insert("groups".to_string(), measured.groups.iter().map(group).collect());
    map
}

fn primary(report: &PrimaryReport) -> Object {
    let [hit_miss, p99, p9999] = primary_marks(report).map(Mark::name);
    let marks = [
        ("hit_miss_mark", hit_miss),
        ("hit_point_error_p99_mark", p99),
        ("hit_point_error_p9999_mark", p9999),
    ];
    let numbers = report
        .entries()
        .map(|(key, value)| (key.to_string(), value.into()));
    let marks = marks.map(|(key, value)| (key.to_string(), value.into()));
    numbers.into_iter().chain(marks).collect()
}

/// Integrators of one light, with what the reference says of it.
fn group(group: &Group) -> Value {
    let reference = match &group.truth {
        Ok(truth) => truth_of(truth).into(),
        Err(reason) => Value::from(skipped(reason)),
    };
    json!({
        "title": group.title,
        "reference": reference,
        "integrators": group.trials.iter().map(trial).collect::<Vec<_>>(),
    })
}

fn truth_of(truth: &Truth) -> Object {
    let mut map = estimate("mean_light", Some(truth.light));
    map.insert("noise_rmse".to_string(), truth.noise.into());
    map.insert(
        "reference_rays_per_second".to_string(),
        truth.stats.rays_per_second().into(),
    );
    map.extend(against("against_", truth.against.as_ref()));
    map
}

fn trial(trial: &Trial) -> Value {
    let mut map = match &trial.outcome {
        Ok(tried) => tried_integrator(trial, tried),
        Err(reason) => skipped(reason),
    };
    map.insert("integrator".to_string(), trial.integrator.as_str().into());
    map.extend(trial.caveat.map(|caveat| ("caveat".to_string(), caveat.into())));
    map.into()
}

fn tried_integrator(trial: &Trial, tried: &Tried) -> Object {
    let mut map = estimate("mean_bias", tried.bias);
    map.insert("mean_bias_mark".to_string(), trial.bias_mark().name().into());
    map.insert("mean_bias_sampler".to_string(), tried.sampler.as_str().into());
    map.insert("ram_bytes".to_string(), tried.ram_bytes.into());
    map.extend(against("against_", tried.against.as_ref()));
    if tried.against.is_some() {
        let mark = trial.against_mark().name();
        map.insert("against_mean_bias_mark".to_string(), mark.into());
    }
    map.insert("samplers".to_string(), tried.cells.iter().map(cell).collect());
    map
}

fn cell(cell: &Cell) -> Value {
    let mut map = match &cell.outcome {
        Err(reason) => skipped(reason),
        Ok(measurement) => {
            let mut map = measurement
                .metrics
                .as_ref()
                .map_or(Object::new(), |m| metrics("", m));
            let speed = measurement.stats.rays_per_second();
            map.insert("fixed_rays".to_string(), measurement.stats.rays.into());
            map.insert("fixed_seconds".to_string(), measurement.stats.seconds.into());
            map.insert("fixed_rays_per_second".to_string(), speed.into());
            map.insert("slope".to_string(), measurement.slope.into());
            let levels = measurement
                .levels
                .iter()
                .map(|level| json!({ "spp": level.spp, "rmse_without_reference_noise": level.rmse }));
            map.insert("levels".to_string(), levels.collect());
            map
        }
    };
    map.insert("sampler".to_string(), cell.sampler.as_str().into());
    map.into()
}

fn metrics(prefix: &str, metrics: &Metrics) -> Object {
    let entries = metrics
        .entries()
        .map(|(key, value)| (format!("{prefix}{key}"), value.into()));
    entries.into_iter().collect()
}

fn against(prefix: &str, against: Option<&Against>) -> Object {
    let Some(against) = against else {
        return Object::new();
    };
    let mut map = metrics(prefix, &against.metrics);
    map.extend(estimate(&format!("{prefix}mean_bias"), against.bias));
    map
}

fn estimate(key: &str, estimate: Option<Estimate>) -> Object {
    let value = estimate.map(|e| e.value);
    let error = estimate.map(|e| e.standard_error);
    [
        (key.to_string(), value.into()),
        (format!("{key}_standard_error"), error.into()),
    ]
    .into_iter()
    .collect()
}
