//! Running other programs: shown before they start, explained when they are missing.

use std::ffi::OsStr;
use std::io::{BufRead, BufReader, ErrorKind};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

/// The root of the repository.
pub fn root() -> PathBuf {
    // `cargo run` sets the variable, for any of our packages; a binary started by hand knows where it was built.
    let package = std::env::var_os("CARGO_MANIFEST_DIR")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
    let root = package
        .ancestors()
        .find(|folder| folder.join("xtask/Cargo.toml").is_file());
    root.unwrap_or(&package).to_path_buf()
}

/// Cargo's target folder of the main workspace.
pub fn target_dir() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), |dir| root().join(dir))
}

/// `cargo SUBCOMMAND` for the host, in the root.
pub fn cargo(subcommand: &str) -> Command {
    let mut command = Command::new("cargo");
    command.arg(subcommand).current_dir(root());
    command
}

/// Shows the command and runs it.
pub fn run(command: &mut Command) -> Result<()> {
    show(command);
    let status = command.status().map_err(|error| unstartable(command, error))?;
    if !status.success() {
        bail!("`{}` failed ({status})", words(command));
    }
    Ok(())
}

/// Shows the command and runs it; its standard output is printed as it comes and returned.
pub fn run_teed(command: &mut Command) -> Result<String> {
    show(command);
    let mut child = command
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| unstartable(command, error))?;
    let mut output = String::new();
    for line in BufReader::new(child.stdout.take().context("no pipe to read from")?).lines() {
        let line = line?;
        println!("{line}");
        output.push_str(&line);
        output.push('\n');
    }
    let status = child.wait()?;
    if !status.success() {
        bail!("`{}` failed ({status})", words(command));
    }
    Ok(output)
}

/// Runs the command in silence: its standard output if it succeeds, `None` if it fails or is missing.
pub fn ask(command: &mut Command) -> Option<String> {
    let output = command.stdin(Stdio::null()).stderr(Stdio::null()).output().ok()?;
    output
        .status
        .success()
        .then(|| String::from_utf8_lossy(&output.stdout).trim().to_string())
}

/// Whether `program --version` runs.
pub fn have(program: impl AsRef<OsStr>) -> bool {
    ask(Command::new(program).arg("--version")).is_some()
}

fn show(command: &Command) {
    println!("$ {}", words(command));
}

/// The command as one would type it, without its environment.
fn words(command: &Command) -> String {
    let program = Path::new(command.get_program())
        .file_name()
        .unwrap_or(command.get_program());
    std::iter::once(program)
        .chain(command.get_args())
        .map(|word| {
            let word = word.to_string_lossy();
            if word.is_empty() || word.contains(' ') {
                format!("'{word}'")
            } else {
                word.into_owned()
            }
        })
        .collect::<Vec<_>>()
        .join(" ")
}

fn unstartable(command: &Command, error: std::io::Error) -> anyhow::Error {
    let program = command.get_program().to_string_lossy().into_owned();
    match error.kind() {
        ErrorKind::NotFound => anyhow::anyhow!("`{program}` is missing: {}", how_to_get(&program)),
        _ => anyhow::Error::new(error).context(format!("cannot start `{program}`")),
    }
}

/// What to do about a missing program.
fn how_to_get(program: &str) -> &'static str {
    match Path::new(program)
        .file_name()
        .and_then(OsStr::to_str)
        .unwrap_or(program)
    {
        "cargo" | "rustc" | "rustup" => "install Rust from https://rustup.rs",
        "qemu-system-arm" | "qemu-system-riscv32" => "run `cargo xtask setup --what qemu`",
        "npm" | "node" => "install Node.js 20 or newer (Debian: `apt-get install nodejs npm`)",
        "python3" => "install Python 3.9 or newer (Debian: `apt-get install python3 python3-venv`)",
        "git" => "install git (Debian: `apt-get install git`)",
        _ => "install it and put it in PATH",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_program_is_named_with_its_cure() {
        let command = Command::new("/nowhere/qemu-system-arm");
        let error = unstartable(&command, ErrorKind::NotFound.into()).to_string();
        assert_eq!(
            error,
            "`/nowhere/qemu-system-arm` is missing: run `cargo xtask setup --what qemu`"
        );
    }

    #[test]
    fn a_failure_shows_the_command() {
        let error = run(Command::new("sh").args(["-c", "exit 3"]))
            .unwrap_err()
            .to_string();
        assert!(error.starts_with("`sh -c 'exit 3'` failed"), "{error}");
    }

    #[test]
    fn the_teed_output_is_returned() {
        let output = run_teed(Command::new("sh").args(["-c", "echo one; echo two"])).unwrap();
        assert_eq!(output, "one\ntwo\n");
    }

    #[test]
    fn the_root_holds_the_core() {
        assert!(root().join("src/lib.rs").is_file());
    }
}
