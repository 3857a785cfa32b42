//! Installing what is missing, each part only for what needs it.

mod apt;
mod oracle;

use std::path::Path;
use std::process::Command;

use anyhow::{Result, bail, ensure};
use clap::{Args, ValueEnum};

use crate::ci::STEPS;
use crate::shell;
use crate::toolchain::{DEBIAN_PACKAGES, Embedded, TARGETS};

#[derive(Args)]
pub struct Options {
    /// Which part; may be given several times
    #[arg(long, value_enum, value_name = "PART", default_values_t = [What::Ci])]
    what: Vec<What>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum What {
    /// Whatever `cargo xtask ci` needs
    Ci,
    /// rustfmt, clippy, a C++ compiler
    Host,
    /// Compilers for the chips and for wasm32, by rustup or else from Debian
    Targets,
    /// The machines that firmware runs in
    Qemu,
    /// The RP2040 emulator's packages
    Node,
    /// cargo-fuzz
    Fuzz,
    /// Mitsuba 3 and FLIP in a Python environment of their own
    Oracle,
    /// Every part
    All,
}

/// What a chore may need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    Host,
    Targets,
    Qemu,
    Node,
    Fuzz,
    Oracle,
}

const PARTS: [Part; 6] = [
    Part::Host,
    Part::Targets,
    Part::Qemu,
    Part::Node,
    Part::Fuzz,
    Part::Oracle,
];

/// Installs the parts that were asked for, each once.
pub fn run(options: &Options) -> Result<()> {
    for part in wanted(&options.what) {
        println!("==> {part:?}");
        match part {
            Part::Host => host()?,
            Part::Targets => targets()?,
            Part::Qemu => apt::install(&["qemu-system-arm", "qemu-system-misc"])?,
            Part::Node => node()?,
            Part::Fuzz => fuzz()?,
            Part::Oracle => oracle::install()?,
        }
    }
    Ok(())
}

fn wanted(what: &[What]) -> Vec<Part> {
    let is_wanted = |part: &Part| {
        what.iter().any(|what| match what {
            What::All => true,
            What::Ci => STEPS.iter().any(|step| step.needs.contains(part)),
            What::Host => *part == Part::Host,
            What::Targets => *part == Part::Targets,
            What::Qemu => *part == Part::Qemu,
            What::Node => *part == Part::Node,
            What::Fuzz => *part == Part::Fuzz,
            What::Oracle => *part == Part::Oracle,
        })
    };
    PARTS.into_iter().filter(is_wanted).collect()
}

fn host() -> Result<()> {
    for (subcommand, component) in [("fmt", "rustfmt"), ("clippy", "clippy")] {
        if shell::ask(shell::cargo(subcommand).arg("--version")).is_some() {
            println!("{component}: there");
        } else {
            shell::run(Command::new("rustup").args(["component", "add", component]))?;
        }
    }
    // host-sim's picture metric is C++.
    if shell::have("c++") {
        println!("c++: there");
        return Ok(());
    }
    apt::install(&["g++"])
}

fn targets() -> Result<()> {
    let missing: Vec<_> = TARGETS
        .into_iter()
        .filter(|target| Embedded::find(target).is_err())
        .collect();
    if missing.is_empty() {
        for target in TARGETS {
            println!("{target}: there ({:?})", Embedded::find(target)?.source());
        }
        return Ok(());
    }
    let mut rustup = Command::new("rustup");
    rustup
        .args(["target", "add"])
        .args(&missing)
        .env("RUSTUP_MAX_RETRIES", "1");
    if let Err(error) = shell::run(&mut rustup) {
        println!("{error:#}; taking Debian's compiler and the library's sources instead");
        apt::install(&DEBIAN_PACKAGES)?;
    }
    for target in missing {
        Embedded::find(target)?;
    }
    Ok(())
}

/// `npm ci` wherever the repository has a lock file.
fn node() -> Result<()> {
    ensure!(
        shell::have("npm"),
        "`npm` is missing: install Node.js 20 or newer (Debian: `apt-get install nodejs npm`)"
    );
    let mut git = Command::new("git");
    git.args(["ls-files", "*package-lock.json"])
        .current_dir(shell::root());
    let Some(locks) = shell::ask(&mut git) else {
        bail!("`git ls-files` failed: is this a clone?")
    };
    for lock in locks.lines() {
        let folder = shell::root()
            .join(lock)
            .parent()
            .unwrap_or(Path::new("."))
            .to_path_buf();
        println!(
            "{}",
            folder.strip_prefix(shell::root()).unwrap_or(&folder).display()
        );
        shell::run(
            Command::new("npm")
                .args(["ci", "--no-audit", "--no-fund"])
                .current_dir(&folder),
        )?;
    }
    Ok(())
}

fn fuzz() -> Result<()> {
    if shell::ask(Command::new("cargo").args(["fuzz", "--version"])).is_some() {
        println!("cargo-fuzz: there");
        return Ok(());
    }
    shell::run(shell::cargo("install").args(["cargo-fuzz", "--locked", "--version", "^0.13"]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_part_is_wanted_once() {
        assert_eq!(wanted(&[What::All, What::Host]), PARTS);
        assert_eq!(
            wanted(&[What::Qemu, What::Host, What::Qemu]),
            [Part::Host, Part::Qemu]
        );
    }

    #[test]
    fn ci_wants_what_its_steps_need() {
        let ci = wanted(&[What::Ci]);
        assert!(ci.contains(&Part::Host) && ci.contains(&Part::Targets), "{ci:?}");
        assert!(!ci.contains(&Part::Oracle), "{ci:?}");
    }
}
