//! Output: standard output, standard error, exit status.

use std::fmt::Display;
use std::io::{self, IsTerminal, Write};
use std::path::Path;

use elbowroom::Diagnostic;
use elbowroom::report::TextSummary;
use elbowroom::sim::Recording;

/// The exit status of a command that gave an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ExitStatus {
    /// 0.
    Success,
    /// 1: a collision, a forbidden region entered, no path found.
    NegativeResult,
}

/// Why a command gave no answer.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The input or the call is wrong, or a file cannot be written.
    Wrong(String),
    /// The reader of standard output closed the pipe.
    Closed,
}

impl From<Diagnostic> for Failure {
    fn from(e: Diagnostic) -> Self {
        Self::Wrong(e.to_string())
    }
}

/// Prints to standard output.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(|e| match e.kind() {
        io::ErrorKind::BrokenPipe => Failure::Closed,
        _ => Failure::Wrong(format!("standard output: {e}")),
    })
}

/// Prints one JSON document.
pub(crate) fn print_json(document: &impl serde::Serialize) -> Result<(), Failure> {
    let document = serde_json::to_value(document).map_err(|e| Failure::Wrong(e.to_string()))?;
    print(&format!("{document:#}\n"))
}

/// Prints a message to standard error. A failed write is ignored.
pub(crate) fn note(message: impl Display) {
    let _ = writeln!(io::stderr().lock(), "{message}");
}

/// The command line that starts this program; under `cargo run` the program is not on the search path.
pub(crate) fn myself() -> &'static str {
    if std::env::var_os("CARGO").is_some() { "cargo run --release --" } else { "elbowroom" }
}

/// Makes the error for a file that could not be written.
pub(crate) fn cannot_write(path: &Path) -> impl Fn(io::Error) -> Failure + '_ {
    move |e| {
        let instead = match e.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "a path on a disk with space left",
            io::ErrorKind::NotFound => "a folder that is there",
            io::ErrorKind::NotADirectory | io::ErrorKind::AlreadyExists => "another name: a file of this one is there",
            io::ErrorKind::IsADirectory => "the name of a file: this is a folder",
            _ => "a file and a folder that you may write to",
        };
        Diagnostic::new(path, None, format!("cannot be written: {e}")).hint(instead).into()
    }
}

/// Makes the error for a file that could not be read.
pub(crate) fn cannot_read(path: &Path) -> impl Fn(io::Error) -> Failure + '_ {
    move |e| Diagnostic::new(path, None, format!("cannot be read: {e}")).into()
}

/// Width of the terminal in columns; 80 if unknown.
pub(crate) fn width() -> usize {
    std::env::var("COLUMNS").ok().and_then(|c| c.parse().ok()).filter(|c| *c >= 60).unwrap_or(80)
}

/// Formats the summary of a run, as wide as the terminal; unshortened if the output is not a terminal.
pub(crate) fn summary(recording: &Recording) -> String {
    let text = TextSummary::new(recording).width(width()).color(color());
    text.whole(!io::stdout().is_terminal()).to_string()
}

/// Whether standard output is a terminal that accepts colours.
pub(crate) fn color() -> bool {
    io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none()
}

/// Refuses to overwrite a file.
pub(crate) fn refuse_existing(path: &Path) -> Result<(), Failure> {
    if path.exists() {
        let what = format!("{}: is there already\n  write: the name of a new file", path.display());
        return Err(Failure::Wrong(what));
    }
    Ok(())
}
