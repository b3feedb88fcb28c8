//! Seals: who may change what in a cell file, and who did (S1.12).
//!
//! A sealed cell has a log beside it, `cell.seal.jsonl` for `cell.toml`: a line of JSON per edit, each signed (Ed25519) by
//! whoever made it, each with the hash of the line before. The last line is the seal. It covers all that the monitors go by:
//! robots, regions, what regions follow (objects too), laws, units, tick, and the files that these name. [`Cell::load`](crate::Cell::load)
//! refuses a cell that is not as it was sealed, and names what differs.
//!
//! Whose signature counts is said by [`TrustedKeys`]. [`edit()`] and [`seal()`] change a sealed cell on behalf of a class;
//! [`history`] reads the log. `docs/roles.md` says what this protects against, and what it does not.

mod authorize;
mod change;
mod edit;
mod entry;
mod hex;
mod keys;
mod log;
mod source;
mod state;
mod text;
mod time;
mod trust;

use std::path::{Path, PathBuf};

use elbowroom_formats::FormatError;
use elbowroom_monitor::AccessClass;

pub use change::Change;
pub use edit::{Edit, Signer, edit, seal};
pub use entry::Entry;
pub use keys::{PrivateKey, PublicKey};
pub use trust::{TrustedKey, TrustedKeys};

use crate::{Cell, CellFile};
use log::Log;
use state::State;

type Result<T> = std::result::Result<T, FormatError>;

/// Who sealed a cell last.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Seal {
    /// The class on whose behalf.
    pub class: String,
    /// The owner of the key.
    pub name: String,
    /// The key's short name: the first 16 hex digits of its hash.
    pub key: String,
    /// When, in UTC, by the clock of whoever sealed.
    pub time: String,
    /// How many entries the log has.
    pub entries: u64,
}

/// A log that has been verified, and how the cell differs from what was sealed.
#[derive(Debug, Clone)]
pub struct History {
    /// From the first seal to the last edit.
    pub entries: Vec<Entry>,
    /// What was changed since without a key: nothing where the seal is good.
    pub unsealed: Vec<Change>,
    /// Whose keys count.
    pub trusted: TrustedKeys,
}

/// The log of a cell file: `cell.seal.jsonl` beside `cell.toml`.
pub fn log_of(cell: &Path) -> PathBuf {
    cell.with_extension("seal.jsonl")
}

/// Checks the seal of a cell. `None` where it has none and needs none.
pub(crate) fn verify(file: &CellFile, cell: &Cell) -> Result<Option<Seal>> {
    let path = log_of(&file.file);
    let trusted = TrustedKeys::find(&file.file)?;
    match (trusted, path.exists()) {
        (None, false) => Ok(None),
        (None, true) => Err(trust::missing(&file.file, &path)),
        (Some(trusted), false) => Err(unsealed(&file.file, &trusted)),
        (Some(trusted), true) => {
            let log = Log::read(&path, &trusted)?;
            let now = State::of(file, cell)?;
            let changes = log.state.changes_to(&now);
            if changes.is_empty() { Ok(Some(log.seal(&trusted))) } else { Err(differs(file, &log, &now, &changes)) }
        }
    }
}

/// Reads and verifies the log of a cell file, whether or not the cell is still as it was sealed.
///
/// # Errors
/// [`FormatError`] where the cell cannot be read or is not sealed, or at the line of the log that is not as it was signed.
pub fn history(cell: &Path) -> Result<History> {
    let path = log_of(cell);
    let Some(trusted) = TrustedKeys::find(cell)? else { return Err(trust::missing(cell, &path)) };
    if !path.exists() {
        return Err(unsealed(cell, &trusted));
    }
    let log = Log::read(&path, &trusted)?;
    let text = text::read(cell)?;
    let mut file = CellFile::parse(cell, &text)?;
    // One that does not fit is not what is asked about.
    file.entries.retain(|e| e.key != "checksum");
    let now = State::of(&file, &file.resolve()?)?;
    let unsealed = log.state.changes_to(&now);
    Ok(History { entries: log.entries, unsealed, trusted })
}

/// The changes that people make, of all that they lead to: not that a checksum changed where a key that it covers did.
pub fn shown(changes: &[Change]) -> Vec<&Change> {
    state::without_consequences(changes)
}

fn unsealed(cell: &Path, trusted: &TrustedKeys) -> FormatError {
    let what = format!(
        "is not sealed, and cells that come under {} must be: {} is missing",
        trusted.file.display(),
        log_of(cell).display()
    );
    FormatError::new(cell, None, what).hint(seal_command(cell, AccessClass::Integrator))
}

fn seal_command(cell: &Path, class: AccessClass) -> String {
    let class = class.name();
    format!(
        "elbowroom region seal {} --as {class} --key FILE   (whoever has the key of the {class} class)",
        cell.display()
    )
}

/// At most this many differences are named.
const NAMED: usize = 5;

fn differs(file: &CellFile, log: &Log, now: &State, changes: &[Change]) -> FormatError {
    let shown = state::without_consequences(changes);
    let mut what = String::from("is not as it was sealed: ");
    let named: Vec<String> = shown.iter().take(NAMED).map(std::string::ToString::to_string).collect();
    what += &named.join("; ");
    if shown.len() > NAMED {
        what = format!("{what}; and {} more", shown.len() - NAMED);
    }
    let line = shown.first().and_then(|c| now.line(c));
    let least = state::least_class(&log.state, now, changes);
    FormatError::new(&file.file, line, what).hint(format!("what was sealed; or {}", seal_command(&file.file, least)))
}
