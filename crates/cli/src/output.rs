//! What leaves the program.

use std::fmt::Display;
use std::io::{self, IsTerminal, Write};
use std::path::Path;

/// How the answer turned out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    Good,
    /// A collision, a forbidden region entered.
    Bad,
}

/// Why there is no answer.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The input or the call is wrong, or a file cannot be written.
    Wrong(String),
    /// Nobody reads on.
    Closed,
}

impl From<elbowroom::formats::FormatError> for Failure {
    fn from(e: elbowroom::formats::FormatError) -> Self {
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
    let text = serde_json::to_string_pretty(document).map_err(|e| Failure::Wrong(e.to_string()))?;
    print(&format!("{text}\n"))
}

/// Tells the user something beside the answer. Where nobody listens that is no failure.
pub(crate) fn note(message: impl Display) {
    let _ = writeln!(io::stderr().lock(), "{message}");
}

/// What to type to call this program again: under `cargo run` it is on no search path.
pub(crate) fn myself() -> &'static str {
    if std::env::var_os("CARGO").is_some() { "cargo run --release --" } else { "elbowroom" }
}

/// Says which file could not be written.
pub(crate) fn cannot_write(path: &Path) -> impl Fn(io::Error) -> Failure + '_ {
    move |e| {
        Failure::Wrong(format!("{}: cannot be written: {e}\n  write: a folder that you may write to", path.display()))
    }
}

/// Columns of the terminal, 80 where there is none.
pub(crate) fn width() -> usize {
    std::env::var("COLUMNS").ok().and_then(|c| c.parse().ok()).filter(|c| *c >= 60).unwrap_or(80)
}

/// True where colours would be seen.
pub(crate) fn color() -> bool {
    io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none()
}
