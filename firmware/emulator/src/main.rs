//! `emulator run`, `emulator identity`, `emulator count`.

use std::{path::PathBuf, process::ExitCode};

use anyhow::Result;
use clap::{Parser, Subcommand};
use emulator::{count, identity, machine::Machine, pico};

/// Runs the firmware without a board
#[derive(Parser)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Runs the Pico's firmware and writes what its display shows
    Run(pico::Options),
    /// Runs the jobs on every machine; fails unless all agree
    Identity {
        /// Machines to compare, all if none is given
        #[arg(long, value_delimiter = ',')]
        machine: Vec<Machine>,
    },
    /// Counts instructions and Cortex-M0+ cycles of each job in QEMU; fails unless every run gives the same
    Count {
        /// Machines to count on, all of QEMU's if none is given
        #[arg(long, value_delimiter = ',')]
        machine: Vec<Machine>,
        /// Number of runs that must agree
        #[arg(long, default_value_t = 2)]
        runs: u32,
        /// Folder for a CSV of every address executed
        #[arg(long)]
        histograms: Option<PathBuf>,
    },
}

fn execute(command: Command) -> Result<()> {
    match command {
        Command::Run(options) => pico::run(&options),
        Command::Identity { machine } => {
            identity::check(if machine.is_empty() { &Machine::ALL } else { &machine })
        }
        Command::Count { machine, runs, histograms } => {
            let machines = if machine.is_empty() {
                Machine::ALL.into_iter().filter(|machine| machine.in_qemu()).collect()
            } else {
                machine
            };
            count::table(&machines, runs, histograms.as_deref())
        }
    }
}

fn main() -> ExitCode {
    match execute(Arguments::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("emulator: {error:#}");
            ExitCode::FAILURE
        }
    }
}
