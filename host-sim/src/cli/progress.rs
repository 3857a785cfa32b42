//! How far a render is: a bar on a terminal, else a line every few seconds, or nothing.

use std::io::{self, IsTerminal};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::complain;
use super::table::{clock, short};
use crate::run::Progress;

const LINE_EVERY: Duration = Duration::from_secs(5);

/// Shows what the render tells.
pub struct Meter {
    label: String,
    began: Instant,
    output: Output,
}

enum Output {
    Bar(ProgressBar),
    /// When the last line was written.
    Lines(Mutex<Instant>),
    Nothing,
}

impl Meter {
    /// `label` says what is being made.
    pub fn new(label: impl Into<String>, quiet: bool) -> Meter {
        let label = label.into();
        let output = match (quiet, io::stderr().is_terminal()) {
            (true, _) => Output::Nothing,
            (false, true) => Output::Bar(bar(&label)),
            (false, false) => Output::Lines(Mutex::new(Instant::now())),
        };
        Meter {
            label,
            began: Instant::now(),
            output,
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Output::Bar(bar) = &self.output {
            bar.finish_and_clear();
        }
    }
}

impl Progress for Meter {
    fn advance(&self, done: usize, total: usize, rays: u64) {
        let state = State {
            elapsed: self.began.elapsed(),
            done,
            total,
            rays,
        };
        match &self.output {
            Output::Bar(bar) => {
                bar.set_length(total as u64);
                bar.set_position(done as u64);
                bar.set_message(state.rate_and_time_left());
            }
            Output::Lines(last) => {
                let Ok(mut last) = last.lock() else { return };
                if last.elapsed() >= LINE_EVERY {
                    *last = Instant::now();
                    complain(&self.label, &state.line());
                }
            }
            Output::Nothing => {}
        }
    }
}

fn bar(label: &str) -> ProgressBar {
    let bar = ProgressBar::new(0).with_prefix(label.to_string());
    if let Ok(style) = ProgressStyle::with_template("{prefix} [{bar:30}] {percent:>3} %  {msg}") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}

struct State {
    elapsed: Duration,
    done: usize,
    total: usize,
    rays: u64,
}

impl State {
    fn line(&self) -> String {
        let percent = 100 * self.done / self.total.max(1);
        format!("{percent} %  {}", self.rate_and_time_left())
    }

    fn rate_and_time_left(&self) -> String {
        let seconds = self.elapsed.as_secs_f64().max(1e-9);
        let left = seconds * (self.total.saturating_sub(self.done)) as f64 / self.done.max(1) as f64;
        // Not every renderer counts its rays before the end.
        let rate = match self.rays {
            0 => String::new(),
            rays => format!("{} rays/s  ", short(rays as f64 / seconds)),
        };
        format!("{rate}{} left", clock(left))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_done_leaves_three_times_as_long() {
        let state = State {
            elapsed: Duration::from_secs(30),
            done: 2,
            total: 8,
            rays: 60_000_000,
        };
        assert_eq!(state.line(), "25 %  2.00 M rays/s  1:30 left");
    }

    #[test]
    fn nothing_done_yet_divides_by_nothing() {
        let state = State {
            elapsed: Duration::ZERO,
            done: 0,
            total: 0,
            rays: 0,
        };
        assert_eq!(state.line(), "0 %  0:00 left");
    }
}
