//! Builds firmware: the one place of this crate that calls cargo.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    sync::{Mutex, PoisonError},
};

use anyhow::{Context, Result, bail};
use xtask::{shell, toolchain::Embedded};

/// The folder that holds every firmware crate.
pub fn firmware() -> PathBuf {
    shell::root().join("firmware")
}

/// Programs, plugins and what the emulators write.
pub fn work_folder() -> Result<PathBuf> {
    let folder = shell::target_dir().join("emulator");
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    Ok(folder)
}

/// What to build: a crate in `firmware/`, with settings in its environment.
pub struct Build<'a> {
    pub package: &'a str,
    pub features: &'a [&'a str],
    pub environment: &'a [(&'a str, &'a str)],
    /// Name of the copy, which a build with other settings does not overwrite.
    pub name: &'a str,
}

/// What a program's environment says of the machine it is for.
///
/// All jobs in one program do not fit the micro:bit's 256 KiB of flash when they are built for speed.
pub fn machine(name: &str) -> Vec<(&'static str, &str)> {
    let mut settings = vec![("MACHINE", name)];
    if name == "microbit" {
        settings.push(("CARGO_PROFILE_RELEASE_OPT_LEVEL", "s"));
    }
    settings
}

/// Held from a build to the copy of what it left, which another one would overwrite.
static BUILDING: Mutex<()> = Mutex::new(());

/// Builds in release mode for `target` and returns a copy of the program named `program`.
///
/// An ELF file also says what stack each function takes and which of its words are addresses, in sections that are not
/// loaded ([`crate::stack`]).
pub fn build(build: &Build, target: &str, program: &str) -> Result<PathBuf> {
    let embedded = Embedded::find(target)?;
    let _alone = BUILDING.lock().unwrap_or_else(PoisonError::into_inner);
    if target.starts_with("wasm") {
        compile(embedded.cargo("build"), build, &[])?;
    } else {
        let mut cargo = embedded.cargo("rustc");
        // Stack sizes are an unstable option of the compiler's.
        cargo.env("RUSTC_BOOTSTRAP", "1").args(["--bin", program]);
        let last = ["--", "-Zemit-stack-sizes", "-Clink-arg=--emit-relocs"];
        compile(cargo, build, &last)?;
    }
    copy(&embedded.program("release", program), build.name)
}

/// Builds for the machine that this runs on; `artifact` is the file that the build leaves.
pub fn build_for_host(build: &Build, artifact: &str) -> Result<PathBuf> {
    let target_folder = shell::target_dir();
    let _alone = BUILDING.lock().unwrap_or_else(PoisonError::into_inner);
    let mut cargo = shell::cargo("build");
    cargo.arg("--target-dir").arg(&target_folder);
    compile(cargo, build, &[])?;
    copy(&target_folder.join("release").join(artifact), build.name)
}

/// `last` are cargo's last arguments.
fn compile(mut cargo: Command, build: &Build, last: &[&str]) -> Result<()> {
    cargo
        .current_dir(firmware().join(build.package))
        .args(["--release", "--quiet", "--locked"]);
    if !build.features.is_empty() {
        cargo.arg("--features").arg(build.features.join(","));
    }
    cargo.envs(build.environment.iter().copied());
    let status = cargo
        .args(last)
        .status()
        .with_context(|| format!("{:?} does not start", cargo.get_program()))?;
    if !status.success() {
        bail!("firmware/{} does not build for {}", build.package, build.name);
    }
    Ok(())
}

fn copy(made: &Path, name: &str) -> Result<PathBuf> {
    let copy = work_folder()?.join(name);
    fs::copy(made, &copy).with_context(|| made.display().to_string())?;
    Ok(copy)
}
