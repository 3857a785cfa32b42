//! Do all machines print the same?

use std::{fmt::Write as _, fs, time::Instant};

use anyhow::{Context, Result, bail};
use xtask::shell;

use crate::{machine::Machine, stack};

/// Runs the jobs on every machine and compares line by line with the first; fails too if a stack is deeper than its bound.
///
/// Prints a table with a row for each job: its CRC where all agree, every one where not.
pub fn check(machines: &[Machine]) -> Result<()> {
    let mut columns = Vec::new();
    for &machine in machines {
        let start = Instant::now();
        let text = machine.run()?;
        if let Machine::Emulated(_) = machine {
            let depth = stack::jobs(machine.name(), &machine.build()?, &text)?;
            eprintln!(
                "{:<11} deepest stack {} bytes, {} at most, {} free",
                machine.name(),
                depth.measured,
                depth.bound.bytes,
                depth.room
            );
        }
        // What memory the jobs took differs, of course.
        let jobs = text.lines().filter(|line| !line.starts_with("memory "));
        let lines = jobs.map(parse).collect::<Result<Vec<_>>>()?;
        eprintln!(
            "{:<11} {:<10} {} jobs, built and run in {:.1} s",
            machine.name(),
            machine.core(),
            lines.len(),
            start.elapsed().as_secs_f64()
        );
        columns.push((machine, lines));
    }
    let (table, differing) = compare(&columns);
    print!("{table}");
    if let Some((_, lines)) = columns.first() {
        let path = shell::root().join("tests/golden.txt");
        let record = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        let missing = missing(&record, lines);
        if !missing.is_empty() {
            bail!("not as in tests/golden.txt: {}", missing.join(", "));
        }
    }
    if differing > 0 {
        bail!("{differing} jobs differ between the machines");
    }
    println!(
        "{} jobs are equal on {} machines, the pictures as in tests/golden.txt",
        columns.first().map_or(0, |c| c.1.len()),
        columns.len()
    );
    Ok(())
}

type Line = (String, String);

fn parse(line: &str) -> Result<Line> {
    match line.split_once(" crc32=") {
        Some((name, crc)) if crc.len() == 8 => Ok((name.to_owned(), crc.to_owned())),
        _ => bail!("not a job's line: {line:?}"),
    }
}

/// The pictures of the record that no line has.
fn missing(record: &str, lines: &[Line]) -> Vec<String> {
    let rows = record.lines().filter(|row| !row.starts_with('#'));
    rows.map(|row| row.split_whitespace().collect::<Vec<_>>().join("-"))
        .filter(|row| !lines.iter().any(|(name, crc)| format!("{name}-{crc}") == *row))
        .collect()
}

/// The table, and the number of rows that are not equal in every column.
fn compare(columns: &[(Machine, Vec<Line>)]) -> (String, usize) {
    let rows = columns.iter().map(|(_, lines)| lines.len()).max().unwrap_or(0);
    let mut table = String::new();
    let mut differing = 0;
    for row in 0..rows {
        let cells: Vec<_> = columns
            .iter()
            .map(|(machine, lines)| (machine, lines.get(row)))
            .collect();
        if let Some((name, crc)) = cells[0].1
            && cells.iter().all(|cell| cell.1 == cells[0].1)
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
    (table, differing)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str) -> Vec<Line> {
        text.lines().map(|line| parse(line).unwrap()).collect()
    }

    #[test]
    fn tells_a_different_and_a_missing_line() {
        let good = lines("a crc32=00000001\nb crc32=00000002");
        let equal = compare(&[(Machine::Host, good.clone()), (Machine::Wasm32, good.clone())]);
        assert_eq!(equal.1, 0);
        let other = lines("a crc32=00000003");
        let (table, differing) = compare(&[(Machine::Host, good), (Machine::Wasm32, other)]);
        assert_eq!(differing, 2);
        assert!(table.contains("00000003  differs  wasm32") && table.contains("(missing)"));
    }

    #[test]
    fn tells_a_picture_that_is_not_the_record() {
        let record = "# head\nbox direct sobol 1 0000000a\nbox path sobol 1 0000000b\n";
        let ours = lines("box-direct-sobol-1 crc32=0000000a\nbox-path-sobol-1 crc32=0000000c");
        assert_eq!(missing(record, &ours), ["box-path-sobol-1-0000000b"]);
    }

    #[test]
    fn refuses_other_output() {
        assert!(parse("panicked at src/main.rs").is_err());
    }
}
