//! One case's numbers, from host-sim and from Mitsuba.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use serde_json::{Map, Value};

use super::case::{Case, MitsubaScene};
use crate::shell;

/// What came of a case.
pub enum Outcome {
    Measured(Box<Numbers>),
    /// host-sim cannot render the scene, and says why.
    Refused(String),
}

/// Errors; shares, not per cent.
pub struct Numbers {
    pub width: u32,
    pub height: u32,
    pub between: Error,
    pub rmse: f64,
    pub psnr_db: f64,
    pub hit_miss: f64,
    pub hit_point_p99: f64,
    pub hit_point_p9999: f64,
    pub against: Option<Against>,
}

/// Errors against Mitsuba's picture.
pub struct Against {
    pub fixed: Error,
    pub reference: Error,
    /// Of Mitsuba with as many samples as we took; none where it is not installed.
    pub mitsuba: Option<Error>,
}

#[derive(Clone, Copy)]
pub struct Error {
    pub bias: f64,
    pub flip: f64,
}

impl Outcome {
    pub fn line(&self) -> String {
        match self {
            Outcome::Measured(numbers) => {
                let Error { bias, flip } = numbers.between;
                format!("bias {:+.3} %, FLIP {flip:.4}", 100.0 * bias)
            }
            Outcome::Refused(line) => format!("refused: {line}"),
        }
    }
}

/// Runs `host-sim compare`, against Mitsuba's picture if there is one.
pub fn compare(mut host_sim: Command, case: &Case, spp: u32, mitsuba: Option<Error>) -> Result<Outcome> {
    let folder = tempfile::tempdir()?;
    let json = folder.path().join("numbers.json");
    host_sim
        .current_dir(&case.folder)
        .args(["compare", &case.scene, "--quiet"]);
    host_sim.args(["--spp", &spp.to_string(), "--json"]).arg(&json);
    if let Some((name, value)) = &case.definition {
        host_sim.args(["-D", &format!("{name}={value}")]);
    }
    if let Some(integrator) = case.integrator {
        host_sim.args(["--integrator", integrator]);
    }
    let reference = case.reference.as_deref().filter(|file| file.is_file());
    if let Some(file) = reference {
        host_sim.arg("--against").arg(file.canonicalize()?);
    }
    let output = host_sim.output().context("cannot start host-sim")?;
    match output.status.code() {
        Some(0) => Ok(Outcome::Measured(Box::new(numbers(&read(&json)?, mitsuba)?))),
        // The scene is one that host-sim has no means for.
        Some(1) => {
            let line = String::from_utf8_lossy(&output.stderr);
            let line = line.trim();
            Ok(Outcome::Refused(
                line.strip_prefix("error: ").unwrap_or(line).to_string(),
            ))
        }
        _ => bail!(
            "host-sim on {} ended with {}: {}",
            case.name,
            output.status,
            String::from_utf8_lossy(&output.stderr).trim()
        ),
    }
}

fn read(json: &Path) -> Result<Map<String, Value>> {
    let text = std::fs::read_to_string(json).context("host-sim wrote no numbers")?;
    Ok(serde_json::from_str(&text)?)
}

fn numbers(json: &Map<String, Value>, mitsuba: Option<Error>) -> Result<Numbers> {
    let number = |key: &str| {
        let value = json.get(key).and_then(Value::as_f64);
        value.with_context(|| format!("host-sim told no {key}"))
    };
    let error = |prefix: &str| -> Result<Error> {
        Ok(Error {
            bias: number(&format!("{prefix}bias"))?,
            flip: number(&format!("{prefix}flip"))?,
        })
    };
    let against = match json.contains_key("against_fixed_bias") {
        true => Some(Against {
            fixed: error("against_fixed_")?,
            reference: error("against_reference_")?,
            mitsuba,
        }),
        false => None,
    };
    Ok(Numbers {
        width: number("width")? as u32,
        height: number("height")? as u32,
        between: error("")?,
        rmse: number("rmse")?,
        psnr_db: number("psnr_db")?,
        hit_miss: number("hit_miss_disagreement")?,
        hit_point_p99: number("hit_point_error_p99")?,
        hit_point_p9999: number("hit_point_error_p9999")?,
        against,
    })
}

/// Mitsuba's own error with `spp` samples; makes the picture of 4096 samples where it is missing.
///
/// `None` if Mitsuba is not installed (`cargo xtask setup --what oracle`).
pub fn mitsuba(scene: &MitsubaScene, spp: u32) -> Result<Option<Error>> {
    let python = shell::target_dir().join("oracle/bin/python");
    if !python.is_file() {
        return Ok(None);
    }
    if let Some(folder) = scene.reference.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let mut command = Command::new(python);
    command.args(["-c", include_str!("oracle.py")]);
    command.arg(&scene.file).arg(scene.reference).arg(spp.to_string());
    command.args(scene.definition.map(|(name, value)| format!("{name}={value}")));
    let output = command.output().context("cannot start the oracle's Python")?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(
        output.status.success(),
        "Mitsuba on {}: {}",
        scene.file.display(),
        said.trim()
    );
    let json: Map<String, Value> = serde_json::from_slice(&output.stdout)?;
    let number = |key: &str| {
        json.get(key)
            .and_then(Value::as_f64)
            .context("the oracle told no number")
    };
    Ok(Some(Error {
        bias: number("bias")?,
        flip: number("flip")?,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLD: &str = r#"{"scene": "x", "width": 64, "height": 48, "spp": 4, "bias": -0.001, "rmse": 0.02,
        "psnr_db": 40.0, "flip": 0.01, "hit_miss_disagreement": 1e-5, "hit_point_error_p99": 2e-5,
        "hit_point_error_p9999": 3e-4}"#;

    fn told(more: &[(&str, f64)]) -> Map<String, Value> {
        let mut map: Map<String, Value> = serde_json::from_str(TOLD).unwrap();
        map.extend(more.iter().map(|(key, value)| (key.to_string(), (*value).into())));
        map
    }

    #[test]
    fn each_number_comes_from_its_own_key() {
        let n = numbers(&told(&[]), None).unwrap();
        assert_eq!((n.width, n.height, n.rmse, n.psnr_db), (64, 48, 0.02, 40.0));
        assert_eq!((n.between.bias, n.between.flip), (-0.001, 0.01));
        assert_eq!(
            (n.hit_miss, n.hit_point_p99, n.hit_point_p9999),
            (1e-5, 2e-5, 3e-4)
        );
        assert!(n.against.is_none());
        let third = [
            ("against_fixed_bias", 0.1),
            ("against_fixed_flip", 0.2),
            ("against_reference_bias", 0.3),
            ("against_reference_flip", 0.4),
        ];
        let against = numbers(&told(&third), None).unwrap().against.unwrap();
        assert_eq!((against.fixed.bias, against.fixed.flip), (0.1, 0.2));
        assert_eq!((against.reference.bias, against.reference.flip), (0.3, 0.4));
    }

    #[test]
    fn a_missing_number_is_named() {
        let mut map = told(&[]);
        map.remove("flip");
        assert_eq!(
            numbers(&map, None).err().unwrap().to_string(),
            "host-sim told no flip"
        );
    }

    #[test]
    fn a_scene_without_means_is_refused_and_a_crash_is_not() {
        let case = Case {
            name: "x".into(),
            scene: "x".into(),
            folder: ".".into(),
            definition: None,
            integrator: None,
            reference: None,
        };
        let ends = |script: &str| {
            let mut command = Command::new("sh");
            command.args(["-c", script]);
            compare(command, &case, 1, None)
        };
        let refused = ends("echo 'error: x.xml:3: no such plugin' >&2; exit 1").unwrap();
        assert_eq!(refused.line(), "refused: x.xml:3: no such plugin");
        assert!(
            ends("echo oops >&2; exit 101")
                .err()
                .unwrap()
                .to_string()
                .contains("oops")
        );
        assert!(
            ends("exit 0")
                .err()
                .unwrap()
                .to_string()
                .contains("wrote no numbers")
        );
    }
}
