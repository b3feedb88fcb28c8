//! Errors and warnings about files: the fault, its position, and what to write instead.

use std::fmt;
use std::path::{Path, PathBuf};

/// Why a file was refused.
///
/// Displayed as `FILE:LINE: what` and, on a separate line, `  write: hint`.
///
/// ```
/// use elbowroom_formats::FormatError;
/// let e = FormatError::new("arm.urdf", 7, "the joint `j1` has no <axis>").hint("<axis xyz=\"0 0 1\"/>");
/// assert_eq!(e.to_string(), "arm.urdf:7: the joint `j1` has no <axis>\n  write: <axis xyz=\"0 0 1\"/>");
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FormatError {
    /// Path of the file.
    pub file: PathBuf,
    /// Line in the file, counted from 1; `None` for files without lines (binary files, missing files).
    pub line: Option<usize>,
    /// The fault.
    pub what: String,
    /// What to write instead, if known.
    pub write_instead: Option<String>,
}

/// A fact that the user of a valid model should know.
///
/// Displayed like [`FormatError`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Warning {
    /// Path of the file.
    pub file: PathBuf,
    /// Line in the file, counted from 1.
    pub line: Option<usize>,
    /// The fact.
    pub what: String,
    /// What to write instead, if known.
    pub write_instead: Option<String>,
}

impl FormatError {
    /// Creates an error at a line of a file (`None`: without a line).
    pub fn new(file: impl AsRef<Path>, line: impl Into<Option<usize>>, what: impl Into<String>) -> Self {
        Self { file: file.as_ref().to_owned(), line: line.into(), what: what.into(), write_instead: None }
    }

    /// Adds what to write instead.
    #[must_use]
    pub fn hint(mut self, write_instead: impl Into<String>) -> Self {
        self.write_instead = Some(write_instead.into());
        self
    }

    /// Creates the error for a file that the system cannot read; `wanted` says what the file should be.
    pub fn unreadable(file: impl AsRef<Path>, e: &std::io::Error, wanted: &str) -> Self {
        let instead = match e.kind() {
            std::io::ErrorKind::PermissionDenied => "a file that you may read, or `chmod u+r` on this one",
            _ => wanted,
        };
        Self::new(file, None, format!("cannot be read: {e}")).hint(instead)
    }
}

impl Warning {
    /// Creates a warning at a line of a file (`None`: without a line).
    pub fn new(file: impl AsRef<Path>, line: impl Into<Option<usize>>, what: impl Into<String>) -> Self {
        Self { file: file.as_ref().to_owned(), line: line.into(), what: what.into(), write_instead: None }
    }

    /// Adds what to write instead.
    #[must_use]
    pub fn hint(mut self, write_instead: impl Into<String>) -> Self {
        self.write_instead = Some(write_instead.into());
        self
    }
}

impl From<FormatError> for Warning {
    fn from(e: FormatError) -> Self {
        Self { file: e.file, line: e.line, what: e.what, write_instead: e.write_instead }
    }
}

fn display(
    f: &mut fmt::Formatter<'_>,
    file: &Path,
    line: Option<usize>,
    what: &str,
    write_instead: Option<&str>,
) -> fmt::Result {
    write!(f, "{}:", file.display())?;
    if let Some(line) = line {
        write!(f, "{line}:")?;
    }
    write!(f, " {what}")?;
    write_instead.map_or(Ok(()), |hint| write!(f, "\n  write: {hint}"))
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        display(f, &self.file, self.line, &self.what, self.write_instead.as_deref())
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        display(f, &self.file, self.line, &self.what, self.write_instead.as_deref())
    }
}

impl std::error::Error for FormatError {}

/// A line of a text file, for messages.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Location<'a> {
    pub(crate) file: &'a Path,
    /// Line number, counted from 1.
    pub(crate) line: usize,
}

impl Location<'_> {
    /// Creates an error at this line.
    pub(crate) fn error(self, what: impl Into<String>) -> FormatError {
        FormatError::new(self.file, self.line, what)
    }

    /// Creates a warning at this line.
    pub(crate) fn warning(self, what: impl Into<String>) -> Warning {
        Warning::new(self.file, self.line, what)
    }
}

/// Collects warnings, up to a limit.
#[derive(Debug, Default)]
pub(crate) struct WarningList {
    list: Vec<Warning>,
    dropped: usize,
}

impl WarningList {
    const MAX_COUNT: usize = 200;

    /// Builds the warning only below the limit, because finding a line number scans the file.
    pub(crate) fn push_with(&mut self, make: impl FnOnce() -> Warning) {
        if self.list.len() < Self::MAX_COUNT {
            self.list.push(make());
        } else {
            self.dropped += 1;
        }
    }

    pub(crate) fn push(&mut self, warning: Warning) {
        self.push_with(|| warning);
    }

    pub(crate) fn extend(&mut self, more: Vec<Warning>) {
        for warning in more {
            self.push(warning);
        }
    }

    pub(crate) fn finish(mut self, file: &Path) -> Vec<Warning> {
        if self.dropped > 0 {
            self.list.push(Warning::new(file, None, format!("{} more warnings are dropped", self.dropped)));
        }
        self.list
    }
}
