//! Seals: who may change what in a cell file, and a log of all edits.
//!
//! A sealed cell has a log beside it, `cell.seal.jsonl` for `cell.toml`: one JSON line per edit, signed (Ed25519) by
//! its author and chained to the previous line by its hash. The last line is the seal. It covers all inputs of the
//! monitors: robots, regions, the sources that regions follow (objects included), laws, units, tick, and the files that
//! these name. [`Cell::load`](crate::Cell::load) refuses a cell that differs from its seal, and names the differences.
//!
//! [`TrustedKeys`] lists the accepted keys. [`edit()`] and [`seal()`] change a sealed cell on behalf of a class;
//! [`history`] reads the log. `docs/roles.md` states what this protects against, and what it does not.

mod authorize;
mod edit;
mod last_seal;
mod log;
mod result;
mod source;
mod state;
pub(crate) mod value;

use std::path::Path;

use elbowroom_access::{Change, LogEntry, TrustedKeys, text_file, trust};
use elbowroom_formats::Diagnostic;
use elbowroom_monitor::AccessClass;

pub use edit::{CellEdit, Signer, edit, seal};
pub use last_seal::Seal;
pub use log::log_of;
pub(crate) use source::source_checksum;

use crate::{Cell, CellFile};
use log::Log;
use result::Result;
use state::SealedState;

/// A verified log, and the differences between the cell and its seal.
#[derive(Debug, Clone)]
pub struct History {
    /// From the first seal to the last edit.
    pub entries: Vec<LogEntry>,
    /// Unsealed changes; empty if the seal is valid.
    pub unsealed: Vec<Change>,
    /// The accepted keys.
    pub trusted: TrustedKeys,
}

/// Verifies the seal of a cell. `None` if it has none and needs none.
pub(crate) fn verify(file: &CellFile, cell: &Cell) -> Result<Option<Seal>> {
    let path = log_of(&file.file);
    let trusted = TrustedKeys::find(&file.file)?;
    match (trusted, path.exists()) {
        (None, false) => Ok(None),
        (None, true) => Err(trust::missing(&file.file, &path)),
        (Some(trusted), false) => Err(unsealed(&file.file, &trusted)),
        (Some(trusted), true) => {
            let log = Log::read(&path, &trusted)?;
            let now = SealedState::of(file, cell)?;
            let changes = log.state.changes_to(&now);
            if changes.is_empty() { Ok(Some(log.seal(&trusted))) } else { Err(differs(file, &log, &now, &changes)) }
        }
    }
}

/// Whether changes of this cell file need a key: it has a log, or comes under a file of trusted keys.
///
/// # Errors
/// [`Diagnostic`] if the file of trusted keys cannot be read.
pub(crate) fn is_guarded(cell: &Path) -> Result<bool> {
    Ok(log_of(cell).exists() || TrustedKeys::find(cell)?.is_some())
}

/// Reads and verifies the log of a cell file, whether or not the cell matches its seal.
///
/// # Errors
/// [`Diagnostic`] if the cell cannot be read or is not sealed, or at the line of the log that is not valid.
pub fn history(cell: &Path) -> Result<History> {
    let path = log_of(cell);
    let Some(trusted) = TrustedKeys::find(cell)? else { return Err(trust::missing(cell, &path)) };
    if !path.exists() {
        return Err(unsealed(cell, &trusted));
    }
    let log = Log::read(&path, &trusted)?;
    let text = text_file::read(cell)?;
    let mut file = CellFile::parse(cell, &text)?;
    // The history is shown even if the `checksum` key is wrong.
    file.entries.retain(|e| e.key != "checksum");
    let now = SealedState::of(&file, &file.resolve()?)?;
    let unsealed = log.state.changes_to(&now);
    Ok(History { entries: log.entries, unsealed, trusted })
}

/// The changes made by people, without derived changes of checksums.
pub fn shown(changes: &[Change]) -> Vec<&Change> {
    state::without_consequences(changes)
}

fn unsealed(cell: &Path, trusted: &TrustedKeys) -> Diagnostic {
    let what = format!(
        "is not sealed, and cells that come under {} must be: {} is missing",
        trusted.file.display(),
        log_of(cell).display()
    );
    Diagnostic::new(cell, None, what).hint(seal_command(cell, AccessClass::Integrator))
}

fn seal_command(cell: &Path, class: AccessClass) -> String {
    let class = class.name();
    format!(
        "elbowroom region seal {} --as {class} --key FILE   (by a holder of the key of the {class} class)",
        cell.display()
    )
}

/// Largest number of differences in a message.
const NAMED: usize = 5;

fn differs(file: &CellFile, log: &Log, now: &SealedState, changes: &[Change]) -> Diagnostic {
    let shown = state::without_consequences(changes);
    let mut what = String::from("is not as it was sealed: ");
    let named: Vec<String> = shown.iter().take(NAMED).map(std::string::ToString::to_string).collect();
    what += &named.join("; ");
    if shown.len() > NAMED {
        what = format!("{what}; and {} more", shown.len() - NAMED);
    }
    let line = shown.first().and_then(|c| now.line(c));
    let least = state::least_class(&log.state, now, changes);
    Diagnostic::new(&file.file, line, what).hint(format!("the sealed version; or {}", seal_command(&file.file, least)))
}
