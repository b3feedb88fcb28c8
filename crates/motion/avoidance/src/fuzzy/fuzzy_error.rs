//! Errors of variables and rules.

/// Why variables and rules are not a valid controller.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}{message}\n  write: {hint}", line.map(|l| format!("line {l}: ")).unwrap_or_default())]
pub struct FuzzyError {
    /// Line of the text, from 1, if known.
    pub line: Option<usize>,
    /// The problem.
    pub message: String,
    /// What to write instead.
    pub hint: String,
}

impl FuzzyError {
    pub(crate) fn new(message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { line: None, message: message.into(), hint: hint.into() }
    }

    pub(crate) fn at(self, line: impl Into<Option<usize>>) -> Self {
        Self { line: line.into(), ..self }
    }
}
