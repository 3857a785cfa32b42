//! The one place that calls cargo for a device.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context, Result, bail};

/// The folder that holds every firmware crate.
pub fn firmware() -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.parent()
        .expect("the emulator lives inside firmware/")
        .to_owned()
}

/// Build folder of all firmware crates.
pub fn target_folder() -> PathBuf {
    firmware().join("target")
}

/// `cargo` as it must be called to build for an embedded target.
///
/// By itself that is the cargo that runs this program, with the targets that rustup installed. Where there is no
/// rustup, `MICROLUX_EMBEDDED_CARGO` names another (Debian's), `MICROLUX_EMBEDDED_CARGO_ARGS` what stands behind
/// `build` (`-Zbuild-std=core`), and cargo's own variables (`RUSTC_BOOTSTRAP`, `CARGO_TARGET_..._LINKER`) do the rest.
fn embedded_cargo() -> (Command, Vec<String>) {
    let program = env::var_os("MICROLUX_EMBEDDED_CARGO")
        .or_else(|| env::var_os("CARGO"))
        .unwrap_or_else(|| "cargo".into());
    let arguments = env::var("MICROLUX_EMBEDDED_CARGO_ARGS").unwrap_or_default();
    (
        Command::new(program),
        arguments.split_whitespace().map(str::to_owned).collect(),
    )
}

/// What to build: a crate in `firmware/`, for a target, with settings in its environment.
pub struct Build<'a> {
    pub package: &'a str,
    /// The file that the build leaves, without a folder.
    pub artifact: &'a str,
    pub target: &'a str,
    pub features: &'a [&'a str],
    pub environment: &'a [(&'a str, &'a str)],
    /// Name of the copy, which a build with other settings does not overwrite.
    pub name: &'a str,
}

/// Builds in release mode and returns the copy of the artifact.
pub fn build(build: &Build) -> Result<PathBuf> {
    let (mut cargo, arguments) = embedded_cargo();
    cargo
        .args(["build", "--release", "--quiet", "--target", build.target])
        .args(arguments);
    if !build.features.is_empty() {
        cargo.arg("--features").arg(build.features.join(","));
    }
    finish(cargo, build, Some(build.target))
}

/// Builds for the machine that this runs on.
pub fn build_for_host(build: &Build) -> Result<PathBuf> {
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(["build", "--release", "--quiet"]);
    finish(cargo, build, None)
}

fn finish(mut cargo: Command, build: &Build, target: Option<&str>) -> Result<PathBuf> {
    cargo
        .current_dir(firmware().join(build.package))
        .env("CARGO_TARGET_DIR", target_folder());
    cargo.envs(build.environment.iter().copied());
    let status = cargo
        .status()
        .with_context(|| format!("{:?} does not start", cargo.get_program()))?;
    if !status.success() {
        bail!(
            "firmware/{} does not build for {}",
            build.package,
            build.name
        );
    }
    let mut made = target_folder();
    made.extend(target);
    made.extend(["release", build.artifact]);

    let copies = target_folder().join("emulator");
    fs::create_dir_all(&copies)?;
    let copy = copies.join(build.name);
    fs::copy(&made, &copy).with_context(|| made.display().to_string())?;
    Ok(copy)
}
