//! What is wrong, where, and what to write instead: one type for refusals and for warnings.
//!
//! A function that refuses a file returns a [`Diagnostic`] as its error. A function that accepts a file with remarks
//! returns them as `Vec<Diagnostic>` beside its result.
//!
//! ```
//! use elbowroom_diagnostic::Diagnostic;
//!
//! fn gap(line: usize, text: &str, warnings: &mut Vec<Diagnostic>) -> Result<f64, Diagnostic> {
//!     let wrong = |message: String| Diagnostic::new("cell.toml", line, message).hint("gap = 50");
//!     let gap: f64 = text.parse().map_err(|e| wrong(format!("`gap`: {e}")))?;
//!     if gap > 1000.0 {
//!         warnings.push(wrong(format!("`gap` is {gap}, more than any robot needs")));
//!     }
//!     Ok(gap)
//! }
//!
//! let mut warnings = Vec::new();
//! assert_eq!(gap(7, "2000", &mut warnings)?, 2000.0);
//! assert_eq!(warnings[0].to_string(), "cell.toml:7: `gap` is 2000, more than any robot needs\n  write: gap = 50");
//! let refusal = gap(7, "wide", &mut warnings).unwrap_err();
//! assert_eq!(refusal.to_string(), "cell.toml:7: `gap`: invalid float literal\n  write: gap = 50");
//! # Ok::<(), Diagnostic>(())
//! ```
//!
//! **Invariant.** The displayed text starts with the file and, if it is known, the line. It ends with the hint, if there
//! is one.

use std::fmt;
use std::path::{Path, PathBuf};

/// Why a file was refused, or a fact that the user of a valid file should know.
///
/// Displayed as `FILE:LINE: message` and, on a separate line, `  write: hint`.
///
/// ```
/// use elbowroom_diagnostic::Diagnostic;
/// let e = Diagnostic::new("arm.urdf", 7, "the joint `j1` has no <axis>").hint("<axis xyz=\"0 0 1\"/>");
/// assert_eq!(e.to_string(), "arm.urdf:7: the joint `j1` has no <axis>\n  write: <axis xyz=\"0 0 1\"/>");
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// Path of the file.
    pub file: PathBuf,
    /// Line in the file, counted from 1; `None` for files without lines (binary files, missing files).
    pub line: Option<usize>,
    /// The fault or the fact.
    pub message: String,
    /// What to write instead, if known.
    pub hint: Option<String>,
}

impl Diagnostic {
    /// Creates a diagnostic at a line of a file (`None`: without a line). The message is a text, or the error of which the
    /// file is the cause.
    pub fn new(file: impl AsRef<Path>, line: impl Into<Option<usize>>, message: impl fmt::Display) -> Self {
        Self { file: file.as_ref().to_owned(), line: line.into(), message: message.to_string(), hint: None }
    }

    /// Adds what to write instead.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Creates the diagnostic of a file that the system cannot read; `wanted` says what the file should be.
    pub fn unreadable(file: impl AsRef<Path>, e: &std::io::Error, wanted: &str) -> Self {
        let instead = match e.kind() {
            std::io::ErrorKind::PermissionDenied => "a file that you may read, or `chmod u+r` on this one",
            _ => wanted,
        };
        Self::new(file, None, format!("cannot be read: {e}")).hint(instead)
    }

    /// Creates the diagnostic of a text file with a byte that is not UTF-8.
    pub fn not_utf8(file: impl AsRef<Path>, line: impl Into<Option<usize>>) -> Self {
        Self::new(file, line, "is not UTF-8 text").hint("the file saved as UTF-8")
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, "{line}:")?;
        }
        write!(f, " {}", self.message)?;
        self.hint.as_ref().map_or(Ok(()), |hint| write!(f, "\n  write: {hint}"))
    }
}

impl std::error::Error for Diagnostic {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_has_the_file_the_line_and_the_hint_if_they_are_known() {
        let bare = Diagnostic::new("a/b.stl", None, "is empty");
        assert_eq!(bare.to_string(), "a/b.stl: is empty");
        assert_eq!(bare.hint("a mesh").to_string(), "a/b.stl: is empty\n  write: a mesh");
        let binary = Diagnostic::not_utf8("c.csv", 3);
        assert_eq!(binary.to_string(), "c.csv:3: is not UTF-8 text\n  write: the file saved as UTF-8");
    }

    #[test]
    fn a_file_that_may_not_be_read_has_another_hint_than_a_missing_one() {
        let of = |kind: std::io::ErrorKind| Diagnostic::unreadable("c.toml", &kind.into(), "a cell file").hint.unwrap();
        assert_eq!(of(std::io::ErrorKind::NotFound), "a cell file");
        assert!(of(std::io::ErrorKind::PermissionDenied).contains("chmod u+r"));
    }
}
