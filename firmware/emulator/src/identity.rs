//! Do all machines print the same?

use std::{fmt::Write as _, fs, time::Instant};

use anyhow::{Context, Result, bail};
use firmware_common::jobs::{self, Job};
use rayon::prelude::*;
use xtask::shell;

use crate::{machine::Machine, stack};

/// Runs on every machine the jobs that are for it, as many machines at once as there are cores, and compares; fails too if a
/// stack is deeper than its bound.
///
/// Prints a table with a row for each job: its CRC where all agree, every one where not.
pub fn check(machines: &[Machine]) -> Result<()> {
    let columns = machines
        .par_iter()
        .map(|&machine| Ok((machine, lines_of(machine)?)))
        .collect::<Result<Vec<_>>>()?;
    let (table, differing) = compare(&columns);
    print!("{table}");
    for (machine, lines) in &columns {
        let mut missing = Vec::new();
        for name in RECORDS {
            let path = shell::root().join(name);
            let record = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
            missing.extend(not_as(&record, lines, |job| machine.runs(job)));
        }
        if !missing.is_empty() {
            bail!(
                "{}: not as in {}: {}",
                machine.name(),
                RECORDS.join(", "),
                missing.join(", ")
            );
        }
    }
    if differing > 0 {
        bail!("{differing} jobs differ between the machines");
    }
    println!(
        "{} jobs are equal on {} machines, or on those with room and time for them, the pictures as in {}",
        jobs::all().count(),
        columns.len(),
        RECORDS.join(", ")
    );
    Ok(())
}

/// What a machine prints, and on standard error how deep its stack got and how long it took.
fn lines_of(machine: Machine) -> Result<Vec<Line>> {
    let start = Instant::now();
    let text = machine.run()?;
    let mut report = String::new();
    if let Machine::Emulated(_) = machine {
        let depth = stack::jobs(machine.name(), &machine.build()?, &text)?;
        let _ = writeln!(
            report,
            "{:<11} deepest stack {} bytes, {} at most, {} free",
            machine.name(),
            depth.measured,
            depth.bound.bytes,
            depth.room
        );
    }
    // What memory the jobs took differs, of course.
    let printed = text.lines().filter(|line| !line.starts_with("memory "));
    let lines = printed.map(parse).collect::<Result<Vec<_>>>()?;
    eprintln!(
        "{report}{:<11} {:<10} {} jobs, built and run in {:.1} s",
        machine.name(),
        machine.core(),
        lines.len(),
        start.elapsed().as_secs_f64()
    );
    Ok(lines)
}

/// What the pictures are held to.
const RECORDS: [&str; 3] = [
    "tests/golden.txt",
    "tests/golden_transport.txt",
    "tests/golden_denoise.txt",
];

type Line = (String, String);

fn parse(line: &str) -> Result<Line> {
    match line.split_once(" crc32=") {
        Some((name, crc)) if crc.len() == 8 => Ok((name.to_owned(), crc.to_owned())),
        _ => bail!("not a job's line: {line:?}"),
    }
}

/// The pictures of the record that no line has, though there is no such job, or one that runs there.
fn not_as(record: &str, lines: &[Line], runs: impl Fn(&Job) -> bool) -> Vec<String> {
    let rows = record.lines().filter(|row| !row.starts_with('#'));
    let mut missing = Vec::new();
    for row in rows {
        let row = row.split_whitespace().collect::<Vec<_>>().join("-");
        let is_there = lines.iter().any(|(name, crc)| format!("{name}-{crc}") == row);
        let name = row.rsplit_once('-').map_or("", |(name, _)| name);
        let job = jobs::all().find(|job| job.name == name);
        if !is_there && job.is_none_or(&runs) {
            missing.push(row);
        }
    }
    missing
}

/// The table, and the number of jobs that are not equal wherever they should run. Lines come in the jobs' order.
fn compare(columns: &[(Machine, Vec<Line>)]) -> (String, usize) {
    compare_jobs(jobs::all(), columns)
}

fn compare_jobs<'j>(
    jobs: impl Iterator<Item = &'j Job>,
    columns: &[(Machine, Vec<Line>)],
) -> (String, usize) {
    let mut table = String::new();
    let mut differing = 0;
    let mut rest: Vec<_> = columns
        .iter()
        .map(|(machine, lines)| (*machine, lines.iter()))
        .collect();
    for job in jobs {
        let here = rest.iter_mut().filter(|(machine, _)| machine.runs(job));
        let cells: Vec<_> = here.map(|(machine, lines)| (*machine, lines.next())).collect();
        let Some((_, first)) = cells.first() else {
            continue;
        };
        if let Some((name, crc)) = first
            && name == job.name
            && cells.iter().all(|cell| cell.1 == *first)
        {
            let _ = writeln!(table, "{name:<16} {crc}");
            continue;
        }
        differing += 1;
        for (machine, line) in cells {
            let (name, crc) = line.map_or(("(missing)", ""), |(name, crc)| (name, crc));
            let _ = writeln!(table, "{name:<16} {crc:<8}  differs  {}", machine.name());
        }
    }
    for (machine, lines) in rest {
        for (name, crc) in lines {
            differing += 1;
            let _ = writeln!(table, "{name:<16} {crc:<8}  too many {}", machine.name());
        }
    }
    (table, differing)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::MICROBIT;
    use firmware_common::jobs::{Reach, Work};
    use xtask::board::Board;

    fn lines(text: &str) -> Vec<Line> {
        text.lines().map(|line| parse(line).unwrap()).collect()
    }

    const fn job(name: &'static str, reach: Reach) -> Job {
        Job {
            name,
            work: Work::Machine(|| 0),
            reach,
        }
    }

    const JOBS: [Job; 3] = [
        job("a", Reach::All),
        job("b", Reach::Roomy),
        job("c", Reach::Quick),
    ];

    fn differing(columns: &[(Machine, Vec<Line>)]) -> usize {
        compare_jobs(JOBS.iter(), columns).1
    }

    #[test]
    fn tells_a_different_and_a_missing_line() {
        let good = lines("a crc32=00000001\nb crc32=00000002\nc crc32=00000003");
        let with = |other: Vec<Line>| [(Machine::Host, good.clone()), (Machine::Wasm32, other)];
        assert_eq!(differing(&with(good.clone())), 0);
        let (table, count) = compare_jobs(JOBS.iter(), &with(lines("a crc32=00000003")));
        assert_eq!(count, 3);
        assert!(table.contains("00000003  differs  wasm32") && table.contains("(missing)"));
        assert_eq!(differing(&with([good.clone(), good.clone()].concat())), 3);
    }

    /// What a machine has no room or time for is not missed there, and everything else is.
    #[test]
    fn a_machine_runs_what_is_for_it() {
        let all = lines("a crc32=00000001\nb crc32=00000002\nc crc32=00000003");
        let rp2040 = Machine::Emulated(Board::Rp2040);
        let with = |machine, count| [(Machine::Host, all.clone()), (machine, all[..count].to_vec())];
        assert_eq!(differing(&with(MICROBIT, 1)), 0);
        assert_eq!(differing(&with(rp2040, 2)), 0);
        assert_eq!(differing(&with(rp2040, 1)), 1);
        assert_eq!(differing(&with(MICROBIT, 2)), 1);
        assert_eq!(differing(&with(MICROBIT, 0)), 1);
    }

    #[test]
    fn tells_a_picture_that_is_not_the_record() {
        let record =
            "# head\ncornell path sobol 1 0000000a\ncornell bdpt sobol 0000000b\nnew path sobol 0000000c\n";
        let ours = lines("cornell-path-sobol-1 crc32=0000000a\ncornell-bdpt-sobol crc32=0000000c");
        let missing = not_as(record, &ours, |_| true);
        assert_eq!(
            missing,
            ["cornell-bdpt-sobol-0000000b", "new-path-sobol-0000000c"]
        );
        // A picture without a job is missed even where nothing of the kind runs.
        let missing = not_as(record, &ours, |job| job.reach == Reach::All);
        assert_eq!(missing, ["new-path-sobol-0000000c"]);
    }

    #[test]
    fn refuses_other_output() {
        assert!(parse("panicked at src/main.rs").is_err());
    }
}
