//! Warnings of one file.

use std::path::Path;

use crate::Diagnostic;

/// Collects warnings, up to a limit.
#[derive(Debug, Default)]
pub(crate) struct WarningList {
    list: Vec<Diagnostic>,
    dropped: usize,
}

impl WarningList {
    const MAX_COUNT: usize = 200;

    /// Builds the warning only below the limit, because finding a line number scans the file.
    pub(crate) fn push_with(&mut self, make: impl FnOnce() -> Diagnostic) {
        if self.list.len() < Self::MAX_COUNT {
            self.list.push(make());
        } else {
            self.dropped += 1;
        }
    }

    pub(crate) fn push(&mut self, warning: Diagnostic) {
        self.push_with(|| warning);
    }

    pub(crate) fn extend(&mut self, more: Vec<Diagnostic>) {
        for warning in more {
            self.push(warning);
        }
    }

    pub(crate) fn finish(mut self, file: &Path) -> Vec<Diagnostic> {
        if self.dropped > 0 {
            self.list.push(Diagnostic::new(file, None, format!("{} more warnings are dropped", self.dropped)));
        }
        self.list
    }
}
