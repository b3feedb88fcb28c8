//! Messages about problems: which problem, and each warning once.

use std::collections::HashSet;
use std::path::Path;

use elbowroom_formats::Diagnostic;
use elbowroom_formats::problem_set::PlanningProblem;

pub(super) type Result<T> = std::result::Result<T, Diagnostic>;

/// Largest number of different warnings.
const MAX_WARNINGS: usize = 50;

/// A problem, for messages.
#[derive(Debug, Clone, Copy)]
pub(super) struct ProblemKey<'a> {
    file: &'a Path,
    set: &'a str,
    id: &'a str,
}

impl<'a> ProblemKey<'a> {
    pub(super) fn new(file: &'a Path, problem: &'a PlanningProblem) -> Self {
        Self { file, set: &problem.set, id: &problem.id }
    }

    pub(super) fn error(self, what: impl std::fmt::Display) -> Diagnostic {
        Diagnostic::new(self.file, None, format!("set `{}`, problem `{}`: {what}", self.set, self.id))
    }
}

/// Warnings, each once: the problems of a file resemble each other.
#[derive(Debug, Default)]
pub(super) struct Notes {
    seen: HashSet<String>,
    pub warnings: Vec<Diagnostic>,
}

impl Notes {
    /// Warns at the first problem.
    pub(super) fn once(&mut self, key: ProblemKey<'_>, what: &str) {
        if self.seen.len() < MAX_WARNINGS && self.seen.insert(what.to_owned()) {
            self.warnings.push(key.error(format!("{what} (reported once)")));
        }
    }
}
