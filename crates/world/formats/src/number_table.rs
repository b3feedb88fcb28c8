//! Tables of numbers: CSV with a header of column names.

use std::io::BufRead;
use std::path::{Path, PathBuf};

use crate::Diagnostic;
use crate::csv::{self, CsvLines, missing_column};
use crate::location::Location;

type Result<T> = std::result::Result<T, Diagnostic>;

/// A CSV file of finite numbers with a header of column names.
///
/// ```
/// use elbowroom_formats::NumberTable;
/// let table = NumberTable::parse("belt.csv".as_ref(), "t_s,travel_m\n0,0\n0.5,0.1\n")?;
/// let travel = table.column("travel_m")?;
/// let rows = table.timed(&[travel])?;
/// assert_eq!((rows[1].t_s, &rows[1].values[..], rows[1].line), (0.5, &[0.1][..], 3));
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct NumberTable {
    /// Path of the file, for messages.
    pub file: PathBuf,
    /// Names of the columns, all different.
    pub columns: Vec<String>,
    /// Line number and values of each row.
    pub rows: Vec<(usize, Vec<f64>)>,
}

/// A row of a table with a column of times.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedRow {
    /// Line number in the file.
    pub line: usize,
    /// Time, seconds.
    pub t_s: f64,
    /// Values of the selected columns.
    pub values: Vec<f64>,
}

impl NumberTable {
    /// Reads a file of at most 1 GiB. Blank lines are skipped.
    ///
    /// # Errors
    /// [`Diagnostic`] with the line of a cell that is not a finite number, of a row whose number of cells differs from
    /// the header, or of a header that repeats a name.
    pub fn read(path: &Path) -> Result<Self> {
        Self::from_lines(path, CsvLines::open(path, csv::MAX_BYTES)?)
    }

    /// Parses the text of a CSV file; `path` is named in messages.
    ///
    /// # Errors
    /// The errors of [`Self::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        Self::from_lines(path, CsvLines::new(text.as_bytes(), path))
    }

    fn from_lines(path: &Path, mut lines: CsvLines<'_, impl BufRead>) -> Result<Self> {
        let Some((at, header)) = lines.next()? else {
            return Err(Diagnostic::new(path, 1, "is empty").hint("a header of column names, then rows of numbers"));
        };
        let columns: Vec<String> = csv::cells(header).map(str::to_owned).collect();
        if let Some(name) = csv::duplicate(&columns) {
            return Err(at.diagnostic(format!("two columns are named `{name}`")).hint("each name once"));
        }
        let mut rows = Vec::new();
        while let Some((at, text)) = lines.next()? {
            if text.split(',').count() != columns.len() {
                return Err(csv::wrong_length(text, &columns, at));
            }
            let number = |(cell, name): (&str, &String)| csv::finite(cell, name, at, "a number such as 0.25");
            rows.push((at.line, csv::cells(text).zip(&columns).map(number).collect::<Result<_>>()?));
        }
        Ok(Self { file: path.to_owned(), columns, rows })
    }

    /// Index of a column.
    ///
    /// # Errors
    /// [`Diagnostic`] that lists the columns, if the table has no such column.
    pub fn column(&self, name: &str) -> Result<usize> {
        self.columns.iter().position(|c| c == name).ok_or_else(|| {
            let what = missing_column(name, &self.columns);
            Diagnostic::new(&self.file, 1, what).hint(name)
        })
    }

    /// The rows as times (column `t_s`) and values of some columns.
    ///
    /// # Errors
    /// [`Diagnostic`] if the table has no column `t_s` or no rows, or if the time does not increase.
    pub fn timed(&self, columns: &[usize]) -> Result<Vec<TimedRow>> {
        let time = self.column("t_s")?;
        let mut last_s = f64::NEG_INFINITY;
        let mut rows = Vec::with_capacity(self.rows.len());
        for (line, row) in &self.rows {
            let t_s = row[time];
            if t_s <= last_s {
                return Err(csv::not_rising(t_s, last_s, Location { file: &self.file, line: *line }));
            }
            last_s = t_s;
            rows.push(TimedRow { line: *line, t_s, values: columns.iter().map(|c| row[*c]).collect() });
        }
        if rows.is_empty() {
            return Err(Diagnostic::new(&self.file, 1, "has no rows").hint("rows of numbers below the header"));
        }
        Ok(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        NumberTable::parse("a.csv".as_ref(), text).unwrap_err().to_string()
    }

    #[test]
    fn quotes_byte_order_marks_and_line_ends_of_other_programs_are_read() {
        let table = NumberTable::parse("a.csv".as_ref(), "\u{feff}\"x\", y\r\n\r\n\" 0.5\",1e3\r\n").unwrap();
        assert_eq!(table.columns, ["x", "y"]);
        assert_eq!(table.rows, [(3, vec![0.5, 1000.0])]);
    }

    #[test]
    fn errors_name_their_line() {
        for (text, part) in [
            ("", "a.csv:1: is empty"),
            ("\n \n", "a.csv:1: is empty"),
            ("a,a\n", "a.csv:1: two columns are named `a`"),
            ("a,b\n1\n", "a.csv:2: has 1 values for 2 columns"),
            ("a,b\n1,2,3\n", "a.csv:2: has 3 values for 2 columns"),
            ("a\n\"1\n", "a.csv:2: column `a` holds \"\"1\""),
            ("a\n\nnan\n", "a.csv:3: column `a` holds \"nan\", which is not a finite number"),
            ("a,b\n,1\n", "a.csv:2: column `a` holds \"\""),
        ] {
            let message = message(text);
            assert!(message.starts_with(part), "{part}: {message}");
        }
        let long = format!("a\n{}\n", "9".repeat(2 << 20));
        assert!(message(&long).starts_with("a.csv:2: is longer than"));
        let error = CsvLines::new(&b"a\n\xff\n"[..], "a.csv".as_ref());
        let error = NumberTable::from_lines("a.csv".as_ref(), error).unwrap_err();
        assert!(error.to_string().starts_with("a.csv:2: is not UTF-8 text"), "{error}");
    }

    #[test]
    fn times_must_be_present_and_increase() {
        let timed = |text: &str| NumberTable::parse("a.csv".as_ref(), text).unwrap().timed(&[]);
        let message = |text: &str| timed(text).unwrap_err().to_string();
        assert_eq!(timed("t_s\n-1\n0\n").unwrap().len(), 2);
        assert!(message("t\n1\n").starts_with("a.csv:1: has no column `t_s`; its columns are t"));
        assert!(message("t_s\n1\n1\n").starts_with("a.csv:3: t_s is 1 after 1"));
        assert!(message("t_s\n").starts_with("a.csv:1: has no rows"));
    }

    #[test]
    fn folders_and_missing_files_are_refused() {
        let message = |path: &str| NumberTable::read(path.as_ref()).unwrap_err().to_string();
        assert!(message("no/such.csv").contains("cannot be read"));
        assert!(message(".").contains("is a folder"));
    }

    /// Comparing every name with all other names would take hours.
    #[test]
    fn a_header_of_many_columns_is_read_quickly() {
        let header = (0..100_000).map(|i| i.to_string()).collect::<Vec<_>>().join(",");
        let start = std::time::Instant::now();
        assert_eq!(NumberTable::parse("a.csv".as_ref(), &header).unwrap().columns.len(), 100_000);
        assert!(start.elapsed().as_secs() < 20);
    }
}
