//! The edit log, verified from its first line to its last.

use std::path::{Path, PathBuf};

use elbowroom_access::{LogEntry, TrustedKey, TrustedKeys, hex, text_file, trust};
use elbowroom_formats::Diagnostic;
use elbowroom_monitor::AccessClass;

use super::last_seal::Seal;
use super::result::Result;
use super::state::{SealedState, least_class};

/// The log of a cell file: `cell.seal.jsonl` beside `cell.toml`.
pub fn log_of(cell: &Path) -> PathBuf {
    cell.with_extension("seal.jsonl")
}

/// A verified log, and the state that its edits lead to.
#[derive(Debug)]
pub(super) struct Log {
    pub file: PathBuf,
    pub entries: Vec<LogEntry>,
    pub state: SealedState,
    /// Hash of the last line.
    pub head: String,
}

impl Log {
    /// An empty log.
    pub fn new(file: &Path) -> Self {
        Self { file: file.to_owned(), entries: Vec::new(), state: SealedState::default(), head: "0".repeat(64) }
    }

    /// Reads a log and verifies every entry: hash chain, signature, class, and resulting state.
    pub fn read(file: &Path, trusted: &TrustedKeys) -> Result<Self> {
        let log = Self::read_to_continue(file, trusted)?;
        log.check_retired(trusted)?;
        Ok(log)
    }

    /// Like [`read`](Self::read), but permits entries of retired keys, for an entry that approves them.
    pub fn read_to_continue(file: &Path, trusted: &TrustedKeys) -> Result<Self> {
        let text = text_file::read(file)?;
        let mut log = Self::new(file);
        for line in text.lines() {
            log.take(line, trusted)?;
        }
        if log.entries.is_empty() {
            return Err(Diagnostic::new(file, None, "is empty: the seal was removed").hint(RESTORE));
        }
        Ok(log)
    }

    fn take(&mut self, line: &str, trusted: &TrustedKeys) -> Result<()> {
        let number = self.entries.len() + 1;
        let wrong = |what: String| Diagnostic::new(&self.file, number, what).hint(RESTORE);
        let entry =
            LogEntry::parse(line).ok_or_else(|| wrong("is not an entry of an edit log, or was modified".into()))?;
        if entry.sequence != number as u64 || entry.previous != self.head {
            return Err(wrong(format!("entry {} does not follow the one before it", entry.sequence)));
        }
        let key = self.signer(&entry, trusted)?;
        if !entry.is_signed_by(&key.public) {
            return Err(wrong(format!("is not what \"{}\" (key {}) signed", key.name, entry.key)));
        }
        let class = AccessClass::parse(&entry.class).unwrap_or(AccessClass::Operator);
        if trusted.beside && number > 1 && !self.state.sealed_key(&entry.key).is_some_and(|k| trust::may_sign(k, class))
        {
            let what = format!(
                "was signed with the key {} of \"{}\", which was not sealed with the cell",
                entry.key, key.name
            );
            return Err(wrong(what + ": it was added later"));
        }
        let state = self
            .state
            .with(&entry.changes)
            .filter(|state| state.digest() == entry.state)
            .ok_or_else(|| wrong("does not lead to the state that it names".into()))?;
        let least =
            if number == 1 { AccessClass::Integrator } else { least_class(&self.state, &state, &entry.changes) };
        if class < least || class > key.class {
            let what = format!("\"{}\" ({}) was not allowed to {}", key.name, key.class.name(), entry.action);
            return Err(wrong(what));
        }
        self.state = state;
        self.head = hex::hash(line.as_bytes());
        self.entries.push(entry);
        Ok(())
    }

    fn signer<'a>(&self, entry: &LogEntry, trusted: &'a TrustedKeys) -> Result<&'a TrustedKey> {
        trusted.get(&entry.key).ok_or_else(|| {
            let what = format!("was signed with the key {}, which {} does not name", entry.key, trusted.file.display());
            Diagnostic::new(&self.file, self.entries.len() + 1, what).hint(
                "a key that is no longer used stays there with `retired = true`; an unknown key means a forged log",
            )
        })
    }

    /// Entries of a retired key are valid only with a later entry of an integrator.
    fn check_retired(&self, trusted: &TrustedKeys) -> Result<()> {
        let active = |e: &LogEntry| trusted.get(&e.key).is_some_and(|k| !k.retired);
        let approved = self.entries.iter().rposition(|e| active(e) && e.class == AccessClass::Integrator.name());
        let rest = approved.map_or(0, |at| at + 1);
        let Some(at) = self.entries[rest..].iter().position(|e| !active(e)) else { return Ok(()) };
        let key = &self.entries[rest + at].key;
        let what =
            format!("was signed with the key {key}, which is retired, and no integrator has sealed the cell since");
        Err(Diagnostic::new(&self.file, rest + at + 1, what)
            .hint("elbowroom region seal CELL --as integrator --key FILE"))
    }

    /// Returns class, key, key name and time of the last entry, and the number of entries.
    pub fn seal(&self, trusted: &TrustedKeys) -> Seal {
        let last = self.entries.last();
        let text = |field: fn(&LogEntry) -> &String| last.map(field).cloned().unwrap_or_default();
        let key = text(|e| &e.key);
        let name = trusted.get(&key).map(|k| k.name.clone()).unwrap_or_default();
        Seal { class: text(|e| &e.class), name, key, time: text(|e| &e.time), entries: self.entries.len() as u64 }
    }
}

const RESTORE: &str = "the original log, from a backup; where there is none, the integrator keeps this one as evidence \
                       under another name, checks every region, and seals the cell again";
