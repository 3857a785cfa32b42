//! Debian packages.

use std::process::Command;

use anyhow::{Result, bail};

use crate::shell;

/// Installs those of the packages that are missing; without the right to, says how.
pub fn install(packages: &[&str]) -> Result<()> {
    let missing: Vec<_> = packages
        .iter()
        .copied()
        .filter(|package| !is_installed(package))
        .collect();
    if missing.is_empty() {
        println!("{}: there", packages.join(", "));
        return Ok(());
    }
    let by_hand = format!("apt-get install {}", missing.join(" "));
    if !shell::have("apt-get") {
        bail!(
            "this machine has no apt-get; install what Debian calls {}",
            missing.join(", ")
        );
    }
    let Some(apt) = privileged() else {
        bail!("installing takes root; run\n  sudo {by_hand}");
    };
    shell::run(apt_get(apt).args(["update", "--quiet"]))?;
    shell::run(
        apt_get(apt)
            .args(["install", "--yes", "--quiet", "--no-install-recommends"])
            .args(missing),
    )
}

/// The words that start apt-get with the rights it needs, if there are any.
fn privileged() -> Option<&'static [&'static str]> {
    if shell::ask(Command::new("id").arg("-u")).as_deref() == Some("0") {
        Some(&["apt-get"])
    } else if shell::ask(Command::new("sudo").args(["-n", "true"])).is_some() {
        Some(&["sudo", "-n", "apt-get"])
    } else {
        None
    }
}

fn apt_get(words: &[&str]) -> Command {
    let mut command = Command::new(words[0]);
    command.args(&words[1..]).env("DEBIAN_FRONTEND", "noninteractive");
    command
}

fn is_installed(package: &str) -> bool {
    let mut query = Command::new("dpkg-query");
    query.args(["--show", "--showformat=${db:Status-Abbrev}", package]);
    shell::ask(&mut query).is_some_and(|status| status.starts_with("ii"))
}
