//! The compiler for the chips.
//!
//! Either the toolchain in use has the target's library (`rustup target add`), or Debian's compiler builds `core`
//! from its sources. `MICROLUX_EMBEDDED=toolchain` or `=debian` insists on one of the two.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, bail};

use crate::shell;

/// Every target that the firmware and the wasm build need.
pub const TARGETS: [&str; 7] = [
    "thumbv6m-none-eabi",
    "thumbv7m-none-eabi",
    "thumbv7em-none-eabi",
    "thumbv7em-none-eabihf",
    "thumbv8m.main-none-eabihf",
    "riscv32imc-unknown-none-elf",
    "wasm32-unknown-unknown",
];

/// The Debian packages that stand in for rustup's targets.
pub const DEBIAN_PACKAGES: [&str; 5] = ["rustc-web", "cargo-web", "rust-web-src", "rust-web-clippy", "lld"];

const DEBIAN_BIN: &str = "/usr/bin";

/// Where a target's library comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The toolchain in use has it, compiled.
    Toolchain,
    /// Debian's compiler, in /usr/bin, with the library's sources; `-Zbuild-std` through the environment.
    Debian,
}

/// A way to compile for one target.
#[derive(Clone, Debug)]
pub struct Embedded {
    target: String,
    source: Source,
}

impl Embedded {
    /// Finds a compiler for `target`, or says how to get one.
    pub fn find(target: &str) -> Result<Embedded> {
        let wish = std::env::var("MICROLUX_EMBEDDED").ok();
        let candidates: &[Source] = match wish.as_deref() {
            None | Some("") => &[Source::Toolchain, Source::Debian],
            Some("toolchain") => &[Source::Toolchain],
            Some("debian") => &[Source::Debian],
            Some(other) => bail!("MICROLUX_EMBEDDED is `{other}`: `toolchain` and `debian` are known"),
        };
        match candidates.iter().find(|source| source.has(target)) {
            Some(&source) => Ok(Embedded {
                target: target.to_string(),
                source,
            }),
            None => bail!("no compiler for {target}: run `cargo xtask setup --what targets`"),
        }
    }

    pub fn source(&self) -> Source {
        self.source
    }

    /// `cargo SUBCOMMAND --target TARGET`, with the environment that it takes.
    ///
    /// Output goes to [`Embedded::target_dir`], one for all packages, so that they share what they have in common.
    /// `RUSTFLAGS` is left to the caller; if it is set, cargo ignores the flags in its configuration files.
    pub fn cargo(&self, subcommand: &str) -> Command {
        let mut command = match self.source {
            Source::Toolchain => Command::new("cargo"),
            Source::Debian => debian_cargo(&self.target),
        };
        command.args([subcommand, "--target", &self.target]);
        command
            .env("CARGO_TARGET_DIR", self.target_dir())
            .current_dir(shell::root());
        command
    }

    /// Cargo's target folder for the chips; the two compilers do not wipe each other's work.
    pub fn target_dir(&self) -> PathBuf {
        shell::target_dir().join(match self.source {
            Source::Toolchain => "embedded",
            Source::Debian => "embedded-debian",
        })
    }

    /// The program `name` after a build with `profile` ("release", "debug" or a profile of the package's own).
    pub fn program(&self, profile: &str, name: &str) -> PathBuf {
        let extension = if self.target.starts_with("wasm32") {
            "wasm"
        } else {
            ""
        };
        self.target_dir()
            .join(&self.target)
            .join(profile)
            .join(name)
            .with_extension(extension)
    }
}

impl Source {
    /// Whether it can compile for the target.
    fn has(self, target: &str) -> bool {
        match self {
            Source::Toolchain => {
                let rustc = std::env::var_os("RUSTC").unwrap_or("rustc".into());
                shell::ask(
                    Command::new(rustc)
                        .args(["--print", "sysroot"])
                        .current_dir(shell::root()),
                )
                .is_some_and(|sysroot| has_library(Path::new(&sysroot), target))
            }
            Source::Debian => {
                let sources = Path::new("/usr/lib/rustlib/src/rust/library/core/Cargo.toml");
                let bin = Path::new(DEBIAN_BIN);
                let programs = ["cargo", "rustc", linker(target)];
                sources.is_file() && programs.iter().all(|program| bin.join(program).is_file())
            }
        }
    }
}

/// Whether a sysroot holds a compiled `core` for the target; an empty folder stays behind when rustup removes one.
fn has_library(sysroot: &Path, target: &str) -> bool {
    let library = sysroot.join("lib/rustlib").join(target).join("lib");
    let Ok(entries) = library.read_dir() else {
        return false;
    };
    entries
        .flatten()
        .any(|entry| entry.file_name().to_string_lossy().starts_with("libcore-"))
}

/// Debian's lld, under the name by which it understands the target's objects.
fn linker(target: &str) -> &'static str {
    if target.starts_with("wasm32") {
        "wasm-ld"
    } else {
        "ld.lld"
    }
}

/// Debian's cargo, shielded from the rustup toolchain that may have started this program.
fn debian_cargo(target: &str) -> Command {
    let bin = Path::new(DEBIAN_BIN);
    let mut command = Command::new(bin.join("cargo"));
    for variable in [
        "RUSTUP_TOOLCHAIN",
        "LD_LIBRARY_PATH",
        "CARGO",
        "RUSTC",
        "RUSTDOC",
        "RUSTC_WRAPPER",
    ] {
        command.env_remove(variable);
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::iter::once(bin.to_path_buf()).chain(std::env::split_paths(&path));
    if let Ok(path) = std::env::join_paths(path) {
        command.env("PATH", path);
    }
    let upper = target.to_uppercase().replace(['-', '.'], "_");
    command
        .env(format!("CARGO_TARGET_{upper}_LINKER"), linker(target))
        .env("RUSTC_BOOTSTRAP", "1")
        .env("CARGO_UNSTABLE_BUILD_STD", "core");
    command
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    #[test]
    fn a_target_is_there_when_its_core_is() {
        let sysroot = tempfile::tempdir().unwrap();
        let library = sysroot.path().join("lib/rustlib/thumbv6m-none-eabi/lib");
        assert!(!has_library(sysroot.path(), "thumbv6m-none-eabi"));
        std::fs::create_dir_all(&library).unwrap();
        assert!(!has_library(sysroot.path(), "thumbv6m-none-eabi"));
        std::fs::write(library.join("libcore-0123.rlib"), "").unwrap();
        assert!(has_library(sysroot.path(), "thumbv6m-none-eabi"));
        assert!(!has_library(sysroot.path(), "thumbv7m-none-eabi"));
    }

    #[test]
    fn debian_gets_its_linker_and_forgets_rustup() {
        let embedded = Embedded {
            target: "thumbv8m.main-none-eabihf".into(),
            source: Source::Debian,
        };
        let command = embedded.cargo("build");
        let env: HashMap<_, _> = command
            .get_envs()
            .map(|(name, value)| (name.to_str().unwrap(), value))
            .collect();
        assert_eq!(
            env["CARGO_TARGET_THUMBV8M_MAIN_NONE_EABIHF_LINKER"],
            Some("ld.lld".as_ref())
        );
        assert_eq!(env["RUSTUP_TOOLCHAIN"], None);
        assert_eq!(env["CARGO_UNSTABLE_BUILD_STD"], Some("core".as_ref()));
        assert_eq!(
            command.get_args().collect::<Vec<_>>(),
            ["build", "--target", "thumbv8m.main-none-eabihf"]
        );
        assert!(
            embedded
                .program("release", "x")
                .ends_with("thumbv8m.main-none-eabihf/release/x")
        );
    }
}
