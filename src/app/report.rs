//! What a command found: text for people, JSON for programs.

use std::fmt::{Display, Write as _};
use std::io::Write as _;

use serde_json::Value;

use crate::{Error, Result};

/// The result of a command.
#[derive(Debug, Clone)]
pub struct Report {
    text: String,
    json: Value,
    succeeded: bool,
}

impl Report {
    /// A result in both forms.
    #[must_use]
    pub fn new(text: impl Into<String>, json: Value) -> Self {
        Self {
            text: text.into(),
            json,
            succeeded: true,
        }
    }

    /// The same report of a check that failed (exit code 1).
    #[must_use]
    pub fn failed(self) -> Self {
        Self {
            succeeded: false,
            ..self
        }
    }

    /// Whether the exit code is 0.
    #[must_use]
    pub fn succeeded(&self) -> bool {
        self.succeeded
    }

    /// Writes the report to stdout.
    ///
    /// # Errors
    /// stdout cannot be written (a closed pipe is not an error).
    pub fn print(&self, as_json: bool) -> Result<()> {
        let text = if as_json {
            format!("{:#}\n", self.json)
        } else {
            self.text.clone()
        };
        let mut stdout = std::io::stdout().lock();
        match stdout
            .write_all(text.as_bytes())
            .and_then(|()| stdout.flush())
        {
            Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => {
                Err(Error::file("standard output", e))
            }
            _ => Ok(()),
        }
    }
}

/// A table whose columns are as wide as their widest cell; numbers stand right.
#[derive(Debug, Clone, Default)]
pub struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with a heading.
    #[must_use]
    pub fn new(heading: &[&str]) -> Self {
        Self {
            rows: vec![heading.iter().map(ToString::to_string).collect()],
        }
    }

    /// Appends a row of as many cells as the heading has.
    pub fn row(&mut self, cells: &[&dyn Display]) {
        assert_eq!(cells.len(), self.rows[0].len(), "one cell per column");
        self.rows
            .push(cells.iter().map(ToString::to_string).collect());
    }
}

impl Display for Table {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let columns = self.rows[0].len();
        let width = |c: usize| self.rows.iter().map(|r| r[c].chars().count()).max();
        let widths: Vec<usize> = (0..columns).map(|c| width(c).unwrap_or(0)).collect();
        let numeric: Vec<bool> = (0..columns)
            .map(|c| {
                self.rows[1..]
                    .iter()
                    .all(|r| r[c].parse::<f64>().is_ok() || r[c] == "-")
            })
            .collect();
        for row in &self.rows {
            let mut line = String::new();
            for (c, cell) in row.iter().enumerate() {
                let w = widths[c];
                if numeric[c] {
                    write!(line, "{cell:>w$}  ")?;
                } else {
                    write!(line, "{cell:<w$}  ")?;
                }
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_align_numbers_right_and_words_left() {
        let mut table = Table::new(&["pass", "ms"]);
        table.row(&[&"density", &1.5]);
        table.row(&[&"surface", &12.25]);
        assert_eq!(
            table.to_string(),
            "pass        ms\ndensity    1.5\nsurface  12.25\n",
            "columns line up"
        );
    }
}
