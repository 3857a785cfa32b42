//! `cargo xtask fuzz`: the targets of `fuzz/`, each for a while, from the corpus that is kept.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;

use crate::shell;

/// The targets, one file of `fuzz/fuzz_targets` each.
const TARGETS: [&str; 4] = ["blob", "mesh", "polygon", "import"];

/// A longer input is none; the kept corpus has none, either.
const LONGEST: u32 = 16_384;

#[derive(Args)]
pub struct Options {
    /// Seconds for each target
    #[arg(long, default_value_t = 60)]
    seconds: u32,
    /// Only this target; may be given several times
    #[arg(long, value_name = "TARGET", value_parser = TARGETS)]
    only: Vec<String>,
    /// Keep what covers more than the corpus did: cut it to the least that covers as much, and write fuzz/corpus/
    #[arg(long)]
    keep: bool,
}

/// How long a target runs.
#[derive(Clone, Copy)]
enum Effort {
    /// Other inputs each time.
    Seconds(u32),
    /// So many, the same each time.
    Inputs(u32),
}

impl Effort {
    fn arguments(self) -> [String; 2] {
        match self {
            Effort::Seconds(seconds) => [format!("-max_total_time={seconds}"), "-seed=0".to_string()],
            Effort::Inputs(count) => [format!("-runs={count}"), "-seed=1".to_string()],
        }
    }
}

/// Runs the targets that were asked for.
pub fn run(options: &Options) -> Result<()> {
    let wanted = |target: &&str| options.only.is_empty() || options.only.iter().any(|only| only == target);
    let note = all(Effort::Seconds(options.seconds), wanted, options.keep)?;
    println!("{note}");
    Ok(())
}

/// The short run of `ci`: what it finds, it finds again.
pub fn check() -> Result<String> {
    all(Effort::Inputs(20_000), |_| true, false)
}

fn all(effort: Effort, wanted: impl Fn(&&str) -> bool, keep: bool) -> Result<String> {
    ensure!(
        shell::ask(Command::new("cargo").args(["fuzz", "--version"])).is_some(),
        "`cargo fuzz` is missing: run `cargo xtask setup --what fuzz`"
    );
    // No sanitizer: it takes a nightly compiler, and there is no unsafe code of ours for it to look at.
    // Not one unit, which keeps one core busy: the build is longer than the runs.
    let build = ["fuzz", "build", "--sanitizer", "none", "--codegen-units", "16"];
    shell::run(Command::new("cargo").args(build).current_dir(shell::root()))?;
    let mut runs = 0;
    for target in TARGETS.into_iter().filter(wanted) {
        runs += fuzz(target, effort, keep).with_context(|| {
            format!(
                "target {target}; the input lies in {}",
                findings(target).display()
            )
        })?;
    }
    Ok(format!("{runs} inputs, none of them found anything"))
}

fn folder(name: &str, target: &str) -> PathBuf {
    shell::root().join("fuzz").join(name).join(target)
}

fn findings(target: &str) -> PathBuf {
    folder("artifacts", target)
}

/// Runs one target; answers how many inputs it saw.
fn fuzz(target: &str, effort: Effort, keep: bool) -> Result<u64> {
    let (corpus, artifacts) = (folder("working", target), findings(target));
    if matches!(effort, Effort::Inputs(_)) && corpus.exists() {
        fs::remove_dir_all(&corpus)?;
    }
    fs::create_dir_all(&corpus)?;
    fs::create_dir_all(&artifacts)?;
    shell::run(
        Command::new("tar")
            .arg("-xzf")
            .arg(kept(target))
            .arg("-C")
            .arg(&corpus),
    )?;
    let program = shell::root()
        .join("fuzz/target")
        .join(host()?)
        .join("release")
        .join(target);
    let mut command = Command::new(&program);
    command
        .args(effort.arguments())
        .arg(format!("-max_len={LONGEST}"))
        .arg(format!("-artifact_prefix={}/", artifacts.display()))
        .args([
            "-rss_limit_mb=4096",
            "-timeout=20",
            "-print_final_stats=1",
            "-verbosity=0",
        ])
        .arg(&corpus);
    let log = command
        .output()
        .with_context(|| format!("cannot start {target}"))?;
    let text = String::from_utf8_lossy(&log.stderr);
    if !log.status.success() {
        println!("{text}");
        bail!("it found something");
    }
    let inputs = text
        .lines()
        .find_map(|line| line.strip_prefix("stat::number_of_executed_units:"))
        .and_then(|count| count.trim().parse().ok())
        .context("the fuzzer did not say how much it did")?;
    ensure!(inputs > 0, "no input ran");
    println!("{target}: {inputs} inputs, nothing found");
    if keep {
        pack(target, &program, &corpus)?;
    }
    Ok(inputs)
}

/// Where a target's corpus is kept.
fn kept(target: &str) -> PathBuf {
    shell::root().join("fuzz/corpus").join(format!("{target}.tar.gz"))
}

/// Cuts a corpus to the least that covers as much, and keeps that.
fn pack(target: &str, program: &Path, corpus: &Path) -> Result<()> {
    let least = folder("least", target);
    if least.exists() {
        fs::remove_dir_all(&least)?;
    }
    fs::create_dir_all(&least)?;
    let merge = Command::new(program)
        .args(["-merge=1", "-verbosity=0", "-rss_limit_mb=4096"])
        .args([&least, corpus])
        .output()?;
    ensure!(merge.status.success(), "the corpus could not be cut");
    shell::run(
        Command::new("tar")
            .args(["--sort=name", "--mtime=@0", "--owner=0", "--group=0", "-czf"])
            .arg(kept(target))
            .arg("-C")
            .arg(&least)
            .arg("."),
    )
}

/// This computer's target triple.
fn host() -> Result<String> {
    let version = shell::ask(Command::new("rustc").arg("-vV")).context("`rustc` is missing")?;
    let line = version.lines().find_map(|line| line.strip_prefix("host: "));
    line.map(str::to_string).context("rustc does not say its host")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_target_has_a_file_and_a_corpus() {
        let files = fs::read_dir(shell::root().join("fuzz/fuzz_targets")).unwrap();
        let mut names: Vec<_> = files
            .map(|file| file.unwrap().file_name().into_string().unwrap())
            .collect();
        let mut expected = TARGETS.map(|target| format!("{target}.rs"));
        names.sort();
        expected.sort();
        assert_eq!(names, expected);
        assert!(TARGETS.iter().all(|target| kept(target).is_file()));
    }
}
