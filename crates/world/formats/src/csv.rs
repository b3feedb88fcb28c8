//! Lines and cells of comma-separated text. Cells may have quotation marks, but contain no commas or line ends.

use std::collections::HashSet;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use crate::Diagnostic;
use crate::location::Location;

type Result<T> = std::result::Result<T, Diagnostic>;

/// Largest length of a line, bytes.
const MAX_LINE: usize = 1 << 20;

/// Largest size of a file that is kept whole in memory, bytes.
pub(crate) const MAX_BYTES: u64 = 1 << 30;

/// Non-blank lines of a CSV file, with their numbers, without a byte order mark and without white space at both ends.
pub(crate) struct CsvLines<'a, R> {
    source: R,
    file: &'a Path,
    line: usize,
    buffer: Vec<u8>,
}

impl<'a> CsvLines<'a, BufReader<File>> {
    /// Opens a file of at most `max_bytes`. Pipes, which have no size, can be read too.
    pub(crate) fn open(path: &'a Path, max_bytes: u64) -> Result<Self> {
        let unreadable = |e: std::io::Error| {
            Diagnostic::unreadable(path, &e, "a CSV file: a header of column names, then rows of numbers")
        };
        let file = File::open(path).map_err(unreadable)?;
        let metadata = file.metadata().map_err(unreadable)?;
        if metadata.is_dir() {
            return Err(Diagnostic::new(path, None, "is a folder").hint("a CSV file"));
        }
        if metadata.len() > max_bytes {
            let what = format!("has {} bytes; at most {max_bytes} are read", metadata.len());
            return Err(Diagnostic::new(path, None, what).hint("a file with fewer rows or columns"));
        }
        Ok(Self::new(BufReader::with_capacity(1 << 16, file), path))
    }
}

impl<'a, R: BufRead> CsvLines<'a, R> {
    /// Reads the lines of a source; `file` is named in messages.
    pub(crate) fn new(source: R, file: &'a Path) -> Self {
        Self { source, file, line: 0, buffer: Vec::new() }
    }

    /// The next line and its location; `None` at the end.
    pub(crate) fn next(&mut self) -> Result<Option<(Location<'a>, &str)>> {
        loop {
            self.line += 1;
            self.buffer.clear();
            let wrong = |what: String| {
                Diagnostic::new(self.file, self.line, what).hint("a text file of comma-separated numbers")
            };
            let mut limited = Read::take(&mut self.source, MAX_LINE as u64);
            let length =
                limited.read_until(b'\n', &mut self.buffer).map_err(|e| wrong(format!("cannot be read: {e}")))?;
            match length {
                0 => return Ok(None),
                MAX_LINE => return Err(wrong(format!("is longer than {MAX_LINE} bytes"))),
                _ if self.buffer.iter().all(u8::is_ascii_whitespace) => {}
                _ => break,
            }
        }
        let text = std::str::from_utf8(&self.buffer).map_err(|_| Diagnostic::not_utf8(self.file, self.line))?;
        Ok(Some((Location { file: self.file, line: self.line }, text.trim_start_matches('\u{feff}').trim())))
    }
}

/// The cells of a line, without surrounding white space and quotation marks.
pub(crate) fn cells(line: &str) -> impl Iterator<Item = &str> {
    line.split(',').map(|cell| {
        let cell = cell.trim();
        cell.strip_prefix('"').and_then(|c| c.strip_suffix('"')).map_or(cell, str::trim)
    })
}

/// A column name that occurs twice.
pub(crate) fn duplicate(columns: &[String]) -> Option<&String> {
    let mut seen = HashSet::new();
    columns.iter().find(|name| !seen.insert(name.as_str()))
}

/// The value of a cell as a finite number; `instead` is an example of a valid value for messages.
pub(crate) fn finite(cell: &str, column: &str, at: Location<'_>, instead: &str) -> Result<f64> {
    match cell.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => {
            let what = format!("column `{column}` holds \"{}\", which is not a finite number", shortened(cell));
            Err(at.diagnostic(what).hint(instead))
        }
    }
}

/// The error of a row with more or fewer cells than the header.
pub(crate) fn wrong_length(text: &str, columns: &[String], at: Location<'_>) -> Diagnostic {
    let what = format!("has {} values for {} columns", text.split(',').count(), columns.len());
    at.diagnostic(what).hint(format!("a number for each of {}", columns.join(",")))
}

/// At most 40 characters of a cell.
fn shortened(cell: &str) -> String {
    if cell.chars().count() > 40 { cell.chars().take(39).chain(['…']).collect() } else { cell.to_owned() }
}

/// The error of a row whose time is not after the time of the previous row.
pub(crate) fn not_rising(t_s: f64, last_s: f64, at: Location<'_>) -> Diagnostic {
    at.diagnostic(format!("t_s is {t_s} after {last_s}")).hint("times that rise from row to row")
}

/// The message for a header with these names that lacks the column `of`.
pub(crate) fn missing_column(of: &str, names: &[String]) -> String {
    let first = of.split('`').next().unwrap_or(of);
    let why = match names {
        [only] if only.contains([';', '\t']) => "; commas separate columns".to_owned(),
        _ => match names.iter().find(|name| name.eq_ignore_ascii_case(first)) {
            Some(similar) => format!("; `{similar}` differs in capitals"),
            None => String::new(),
        },
    };
    format!("has no column `{of}`; its columns are {}{why}", names.join(", "))
}
