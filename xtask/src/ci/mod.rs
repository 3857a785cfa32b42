//! Everything that must hold before a change goes in.

mod steps;
mod summary;

use std::time::Instant;

use anyhow::{Result, bail};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};

pub use steps::STEPS;
use summary::{Outcome, Row};

#[derive(Args)]
pub struct Options {
    /// Go on after a failure and tell on all at the end
    #[arg(long)]
    keep_going: bool,
    /// Only this step; may be given several times
    #[arg(long, value_name = "STEP", value_parser = step_names())]
    only: Vec<String>,
}

fn step_names() -> PossibleValuesParser {
    STEPS
        .iter()
        .map(|step| PossibleValue::new(step.name).help(step.about))
        .collect::<Vec<_>>()
        .into()
}

/// Runs the steps that were asked for, in the order of [`STEPS`], and prints a table of them.
pub fn run(options: &Options) -> Result<()> {
    let mut rows = Vec::new();
    let mut failed = Vec::new();
    for step in &STEPS {
        let wanted = options.only.is_empty() || options.only.iter().any(|name| name == step.name);
        if !wanted || (!failed.is_empty() && !options.keep_going) {
            rows.push(Row {
                name: step.name,
                outcome: Outcome::Skipped,
            });
            continue;
        }
        println!("\n==> {}: {}", step.name, step.about);
        let start = Instant::now();
        let result = (step.run)();
        let time = start.elapsed();
        let outcome = match result {
            Ok(note) => {
                println!("{note}");
                Outcome::Passed { time, note }
            }
            Err(error) => {
                eprintln!("error: {error:#}");
                failed.push(step.name);
                Outcome::Failed { time }
            }
        };
        rows.push(Row {
            name: step.name,
            outcome,
        });
    }
    println!("\n{}", summary::table(&rows));
    if !failed.is_empty() {
        bail!(
            "failed: {} (again with `cargo xtask ci --only {}`)",
            failed.join(", "),
            failed[0]
        );
    }
    Ok(())
}
