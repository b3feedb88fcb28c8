//! A line of a text file.

use std::path::Path;

use crate::Diagnostic;

/// A line of a text file, for messages.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Location<'a> {
    pub(crate) file: &'a Path,
    /// Line number, counted from 1.
    pub(crate) line: usize,
}

impl Location<'_> {
    /// Creates a diagnostic at this line.
    pub(crate) fn diagnostic(self, message: impl std::fmt::Display) -> Diagnostic {
        Diagnostic::new(self.file, self.line, message)
    }
}
