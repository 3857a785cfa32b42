//! The golden pictures: rendered again and compared with the record, or blessed.

use anyhow::Result;
use clap::Args;

use crate::shell;

#[derive(Args)]
pub struct Options {
    /// Take what is rendered now as the record; commit it alone, with its line under "Pictures" in CHANGELOG.md
    #[arg(long)]
    bless: bool,
}

/// Runs the test `golden`; it rewrites its record when `MICROLUX_BLESS` is set.
pub fn run(options: &Options) -> Result<()> {
    let mut test = shell::cargo("test");
    test.args(["--workspace", "--test", "golden"]);
    if options.bless {
        test.env("MICROLUX_BLESS", "1");
    }
    shell::run(&mut test)
}
