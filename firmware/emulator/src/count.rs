//! Exact instruction counts, and Cortex-M0+ cycles by model, of each job and region.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail, ensure};
use firmware_common::{jobs, region};

use crate::{
    machine::Machine,
    symbols,
    toolchain::{self, Build},
};

/// What a program executed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spent {
    /// How often the region was entered; 1 for the whole.
    pub entries: u64,
    pub instructions: u64,
    /// By the model of `plugin/src/cycles.rs`; means something on ARMv6-M alone.
    pub cycles: u64,
}

/// One run's counts: the whole and each region, less what the region markers cost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Counts {
    pub total: Spent,
    pub regions: BTreeMap<u32, Spent>,
}

/// Builds the plugin for this computer's QEMU.
pub fn plugin() -> Result<PathBuf> {
    let build = Build {
        package: "emulator/plugin",
        features: &[],
        environment: &[],
        name: "libqemu_count.so",
    };
    toolchain::build_for_host(&build, "libqemu_count.so")
}

/// Runs `program` once and reads the plugin's report; `histogram` receives a CSV of every address executed.
pub fn run(machine: Machine, program: &Path, plugin: &Path, histogram: Option<&Path>) -> Result<Counts> {
    ensure!(machine.in_qemu(), "{} does not run in QEMU", machine.name());
    let report = toolchain::work_folder()?.join(format!("{}.report", machine.name()));
    let mut argument = format!(
        "{},report={},{}",
        plugin.display(),
        report.display(),
        symbols::markers(program)?
    );
    if let Some(file) = histogram {
        argument += &format!(",histogram={}", file.display());
    }
    machine.run_in_qemu(program, &["-plugin".to_owned(), argument])?;
    let text = fs::read_to_string(&report).with_context(|| report.display().to_string())?;
    fs::remove_file(&report)?;
    parse(&text)
}

/// Reads the plugin's report but for its lines about stages.
pub fn parse(report: &str) -> Result<Counts> {
    let mut total = None;
    let mut regions = BTreeMap::new();
    for line in report.lines() {
        let (kind, numbers) = line
            .split_once(' ')
            .with_context(|| format!("report line {line:?}"))?;
        let numbers = numbers
            .split(' ')
            .map(str::parse::<u64>)
            .collect::<Result<Vec<_>, _>>()?;
        match (kind, &*numbers) {
            ("total", &[instructions, cycles]) => {
                total = Some(Spent {
                    entries: 1,
                    instructions,
                    cycles,
                })
            }
            ("region", &[id, entries, instructions, cycles]) => {
                regions.insert(
                    u32::try_from(id)?,
                    Spent {
                        entries,
                        instructions,
                        cycles,
                    },
                );
            }
            ("stage" | "block", _) => {}
            _ => bail!("report line {line:?}"),
        }
    }
    let markers = regions
        .remove(&region::EMPTY)
        .context("the firmware does not run the empty region")?;
    ensure!(
        markers.entries == 1,
        "the empty region ran {} times",
        markers.entries
    );
    for spent in regions.values_mut() {
        spent.instructions -= spent.entries * markers.instructions;
        spent.cycles -= spent.entries * markers.cycles;
    }
    Ok(Counts {
        total: total.context("no total in the report")?,
        regions,
    })
}

/// Counts one program `runs` times; all must agree.
pub fn agreed(machine: Machine, program: &Path, plugin: &Path, runs: u32) -> Result<Counts> {
    let counts = run(machine, program, plugin, None)?;
    for _ in 1..runs {
        ensure!(
            run(machine, program, plugin, None)? == counts,
            "{}: two runs differ",
            machine.name()
        );
    }
    Ok(counts)
}

/// Counts the jobs on `machines`, each `runs` times, which must agree, and prints a table.
///
/// `histograms` is a folder, made if need be, for a CSV of each machine.
pub fn table(machines: &[Machine], runs: u32, histograms: Option<&Path>) -> Result<()> {
    let plugin = plugin()?;
    if let Some(folder) = histograms {
        fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    println!(
        "machine     core       region                                entries  instructions    m0+ cycles"
    );
    for &machine in machines {
        let program = machine.build()?;
        let histogram = histograms.map(|folder| folder.join(format!("{}.csv", machine.name())));
        let counts = run(machine, &program, &plugin, histogram.as_deref())?;
        for _ in 1..runs {
            ensure!(
                run(machine, &program, &plugin, None)? == counts,
                "{}: two runs differ",
                machine.name()
            );
        }
        let names = (0..).zip(jobs::all()).map(|(id, job)| (id, job.name));
        let rows = names.filter_map(|(id, name)| Some((name, counts.regions.get(&id)?)));
        for (name, spent) in rows.chain([("(whole)", &counts.total)]) {
            let cycles = if machine.is_armv6m() {
                spent.cycles.to_string()
            } else {
                "-".to_owned()
            };
            println!(
                "{:<11} {:<10} {name:<37} {:>7}  {:>12}  {cycles:>12}",
                machine.name(),
                machine.core(),
                spent.entries,
                spent.instructions,
            );
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subtracts_the_markers() {
        let empty = region::EMPTY;
        let counts = parse(&format!(
            "total 900 1000\nregion 2 3 160 250\nregion {empty} 1 10 15\n"
        ))
        .unwrap();
        assert_eq!(
            counts.total,
            Spent {
                entries: 1,
                instructions: 900,
                cycles: 1000
            }
        );
        assert_eq!(
            counts.regions[&2],
            Spent {
                entries: 3,
                instructions: 130,
                cycles: 205
            }
        );
        assert_eq!(counts.regions.len(), 1);
    }

    #[test]
    fn refuses_a_report_without_the_empty_region() {
        assert!(parse("total 900 1000\n").is_err());
    }
}
