//! Numbers for people, and rows that stand under each other.

use std::fmt::Write;

/// Three digits and a prefix: `1.23 M`.
pub fn short(value: f64) -> String {
    let (scaled, unit) = match value.abs() {
        x if x >= 1e9 => (value / 1e9, " G"),
        x if x >= 1e6 => (value / 1e6, " M"),
        x if x >= 1e3 => (value / 1e3, " k"),
        _ => return format!("{value:.0}"),
    };
    let decimals = if scaled.abs() >= 100.0 {
        0
    } else if scaled.abs() >= 10.0 {
        1
    } else {
        2
    };
    format!("{scaled:.decimals$}{unit}")
}

/// Digits in threes: `12,345,678`.
pub fn grouped(value: u64) -> String {
    let digits = value.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Minutes and seconds, `1:05`, or with hours, `2:01:05`.
pub fn clock(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    let (hours, minutes, seconds) = (whole / 3600, whole / 60 % 60, whole % 60);
    if hours > 0 {
        format!("{hours}:{minutes:02}:{seconds:02}")
    } else {
        format!("{minutes}:{seconds:02}")
    }
}

/// Labels to the left, columns to the right, each as wide as its widest cell.
#[derive(Default)]
pub struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    pub fn row<const N: usize>(&mut self, cells: [impl Into<String>; N]) -> &mut Table {
        self.rows.push(cells.map(Into::into).into());
        self
    }

    /// Lines of text, none with blanks at its end.
    pub fn text(&self) -> String {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let cells = |c: usize| self.rows.iter().filter_map(move |row| row.get(c));
        let widths: Vec<usize> = (0..columns)
            .map(|c| cells(c).map(|t| t.chars().count()).max().unwrap_or(0))
            .collect();
        let mut text = String::new();
        for row in &self.rows {
            let mut line = String::new();
            for (c, cell) in row.iter().enumerate() {
                let width = widths[c];
                let _ = if c == 0 {
                    write!(line, "{cell:width$}")
                } else {
                    write!(line, "  {cell:>width$}")
                };
            }
            text.push_str(line.trim_end());
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_easily() {
        assert_eq!(
            [0.0, 999.0, 1234.0, 56_780.0, 1.5e6, 123.4e6, 2e9].map(short),
            ["0", "999", "1.23 k", "56.8 k", "1.50 M", "123 M", "2.00 G"]
        );
        assert_eq!(
            [0, 12, 1234, 12_345_678].map(grouped),
            ["0", "12", "1,234", "12,345,678"]
        );
        assert_eq!(
            [0.0, 65.2, 3599.6, 7265.0].map(clock),
            ["0:00", "1:05", "1:00:00", "2:01:05"]
        );
    }

    #[test]
    fn columns_stand_under_each_other() {
        let mut table = Table::default();
        table
            .row(["", "fixed", "reference"])
            .row(["rays", "1,234", "9"])
            .row(["nothing"]);
        assert_eq!(
            table.text(),
            "\u{20}        fixed  reference\nrays     1,234          9\nnothing\n"
        );
    }
}
