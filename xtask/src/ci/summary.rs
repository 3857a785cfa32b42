//! What the steps came to.

use std::fmt;
use std::time::Duration;

/// One step's line in the table.
pub struct Row {
    pub name: &'static str,
    pub outcome: Outcome,
}

pub enum Outcome {
    Passed { time: Duration, note: String },
    Failed { time: Duration },
    Skipped,
}

/// The table: step, outcome, time, note.
pub fn table(rows: &[Row]) -> String {
    let width = rows.iter().map(|row| row.name.len()).max().unwrap_or(0);
    let mut total = Duration::ZERO;
    let mut lines = Vec::new();
    for Row { name, outcome } in rows {
        let (word, time, note) = match outcome {
            Outcome::Passed { time, note } => ("ok", Some(time), note.as_str()),
            Outcome::Failed { time } => ("FAILED", Some(time), ""),
            Outcome::Skipped => ("not run", None, ""),
        };
        total += time.copied().unwrap_or_default();
        let time = time.map_or_else(String::new, |time| format!("{:.1} s", time.as_secs_f64()));
        lines.push(
            format!("{name:width$}  {word:7}  {time:>8}  {note}")
                .trim_end()
                .to_string(),
        );
    }
    lines.push(format!(
        "{:width$}  {:7}  {:>8}",
        "in all",
        "",
        format!("{:.1} s", total.as_secs_f64())
    ));
    lines.join("\n")
}

/// Sums over the closing lines of several test programs.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct TestTotal {
    pub passed: u32,
    pub failed: u32,
    pub ignored: u32,
}

/// Adds up the lines `test result: ok. 12 passed; 0 failed; 1 ignored; ...`.
pub fn test_total(output: &str) -> TestTotal {
    let mut total = TestTotal::default();
    for line in output.lines().filter(|line| line.starts_with("test result: ")) {
        for count in line.split(['.', ';']) {
            if let Some((number, what)) = count.trim().split_once(' ') {
                let number = number.parse().unwrap_or(0);
                match what {
                    "passed" => total.passed += number,
                    "failed" => total.failed += number,
                    "ignored" => total.ignored += number,
                    _ => {}
                }
            }
        }
    }
    total
}

impl fmt::Display for TestTotal {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "test result: {} passed; {} failed; {} ignored in all",
            self.passed, self.failed, self.ignored
        )
    }
}

#[cfg(test)]
mod tests {
    use std::hint::black_box;
    use std::panic::catch_unwind;

    use super::*;

    #[test]
    fn closing_lines_add_up() {
        let output = "running 2 tests\ntest a ... ok\n\n\
            test result: ok. 12 passed; 0 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.01s\n\
            \ntest result: FAILED. 30 passed; 2 failed; 0 ignored; 0 measured; 7 filtered out; finished in 1.50s\n";
        assert_eq!(
            test_total(output),
            TestTotal {
                passed: 42,
                failed: 2,
                ignored: 1
            }
        );
        assert_eq!(test_total("test results: none"), TestTotal::default());
    }

    #[test]
    fn the_table_lines_up() {
        let rows = [
            Row {
                name: "fmt",
                outcome: Outcome::Passed {
                    time: Duration::from_millis(1_250),
                    note: "formatted".into(),
                },
            },
            Row {
                name: "clippy",
                outcome: Outcome::Failed {
                    time: Duration::from_secs(61),
                },
            },
            Row {
                name: "doc",
                outcome: Outcome::Skipped,
            },
        ];
        assert_eq!(
            table(&rows),
            "fmt     ok          1.2 s  formatted\n\
             clippy  FAILED     61.0 s\n\
             doc     not run\n\
             in all             62.2 s"
        );
    }

    /// `ci` runs the tests twice, and the first run is the one that must not let an overflow pass.
    #[test]
    fn an_overflow_is_an_error_in_the_test_profile() {
        let caught = catch_unwind(|| black_box(i32::MAX) + black_box(1)).is_err();
        assert_eq!(caught, cfg!(debug_assertions));
    }
}
