//! The steps, cheap ones first.

use anyhow::{Context, Result, ensure};

use super::summary;
use crate::setup::Part;
use crate::toolchain::Embedded;
use crate::{device, fuzz, layers, no_float, shell};

/// One check.
pub struct Step {
    pub name: &'static str,
    pub about: &'static str,
    /// What `cargo xtask setup` installs for it.
    pub needs: &'static [Part],
    /// Does it; a line for the table if it holds.
    pub run: fn() -> Result<String>,
}

/// All of them, in their order.
pub const STEPS: [Step; 10] = [
    Step {
        name: "fmt",
        about: "the text is as rustfmt leaves it",
        needs: &[Part::Host],
        run: fmt,
    },
    Step {
        name: "layers",
        about: "the core's modules use what stands to their left",
        needs: &[],
        run: || layers::check(&shell::root()),
    },
    Step {
        name: "clippy",
        about: "no lint on the host, none in the core for the Cortex-M0+, where floats are banned",
        needs: &[Part::Host, Part::Targets],
        run: clippy,
    },
    Step {
        name: "no-float",
        about: "no soft-float routine in a linked Cortex-M0+ program",
        needs: &[Part::Targets],
        run: || no_float::check(&shell::root()),
    },
    Step {
        name: "test",
        about: "host tests and doc tests; an overflow is an error",
        needs: &[Part::Host],
        run: || test(&[]),
    },
    Step {
        name: "test-release",
        about: "the same tests, but for the longest, as the chip runs the code: optimised, arithmetic that wraps",
        needs: &[Part::Host],
        run: || test(&["--release"]),
    },
    Step {
        name: "doc",
        about: "the documentation builds, every link leads somewhere",
        needs: &[Part::Host],
        run: doc,
    },
    Step {
        name: "fuzz",
        about: "20,000 inputs for each target of fuzz/, from the corpus that is kept",
        needs: &[Part::Host, Part::Fuzz],
        run: fuzz::check,
    },
    Step {
        name: "beside",
        about: "the workspaces beside the code: tests of trainer/, and peers/ builds",
        needs: &[Part::Host],
        run: beside,
    },
    Step {
        name: "firmware",
        about: "every board's program fits; nine machines give one picture; the Pico's display and its faults",
        needs: &[Part::Host, Part::Targets, Part::Qemu, Part::Node],
        run: device::check,
    },
];

fn fmt() -> Result<String> {
    component("fmt", "rustfmt")?;
    // Workspaces of their own: the program that `no-float` links, the fuzz targets, and those of `beside`.
    for workspace in [
        "Cargo.toml",
        "tests/no-float/Cargo.toml",
        "fuzz/Cargo.toml",
        "trainer/Cargo.toml",
        "peers/Cargo.toml",
    ] {
        let mut fmt = shell::cargo("fmt");
        fmt.args([
            "--all",
            "--manifest-path",
            workspace,
            "--check",
            "--",
            "--files-with-diff",
        ]);
        shell::run(&mut fmt).with_context(|| format!("run `cargo fmt --all --manifest-path {workspace}`"))?;
    }
    Ok("formatted".to_string())
}

fn clippy() -> Result<String> {
    component("clippy", "clippy")?;
    shell::run(shell::cargo("clippy").args(["--workspace", "--all-targets", "--", "-D", "warnings"]))?;
    let embedded = Embedded::find("thumbv6m-none-eabi")?;
    for features in ["--no-default-features", "--all-features"] {
        let mut clippy = embedded.cargo("clippy");
        shell::run(clippy.args(["--package", "microlux", "--lib", features, "--", "-D", "warnings"]))?;
    }
    Ok("no lint".to_string())
}

fn test(extra: &[&str]) -> Result<String> {
    // Not every feature: host-sim's window needs SDL.
    let features = ["--features", "microlux/micromath"];
    let output = shell::run_teed(shell::cargo("test").arg("--workspace").args(features).args(extra))?;
    let total = summary::test_total(&output);
    ensure!(total.passed > 0, "no test ran");
    Ok(total.to_string())
}

fn doc() -> Result<String> {
    shell::run(
        shell::cargo("doc")
            .args(["--workspace", "--no-deps", "--features", "microlux/micromath"])
            .env("RUSTDOCFLAGS", "-D warnings"),
    )?;
    Ok("no warning".to_string())
}

/// What no other step builds, so that it does not go stale; crates that the tests were built with are not built again.
fn beside() -> Result<String> {
    let cargo = |command: &str, workspace: &str| {
        let mut cargo = shell::cargo(command);
        cargo.args(["--locked", "--manifest-path", workspace, "--target-dir"]);
        cargo.arg(shell::target_dir());
        cargo
    };
    let output = shell::run_teed(cargo("test", "trainer/Cargo.toml").arg("--release"))?;
    let total = summary::test_total(&output);
    ensure!(total.passed > 0, "no test of trainer/ ran");
    shell::run(&mut cargo("check", "peers/Cargo.toml"))?;
    Ok(format!("trainer: {total}; peers builds"))
}

/// Complains if cargo lacks a subcommand that a rustup component brings.
fn component(subcommand: &str, component: &str) -> Result<()> {
    let answer = shell::ask(shell::cargo(subcommand).arg("--version"));
    ensure!(
        answer.is_some(),
        "`cargo {subcommand}` is missing: run `rustup component add {component}`"
    );
    Ok(())
}
