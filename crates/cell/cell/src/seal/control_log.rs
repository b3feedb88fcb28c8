//! What was changed in a running cell: an append-only log beside its file.

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use elbowroom_formats::FormatError;
use elbowroom_monitor::AccessClass;
use serde::{Deserialize, Serialize};

use super::change::Change;
use super::log_head::{LogHead, LogSigner, RESTORE};
use super::result::Result;
use super::{hex, text, time};

/// The log of the changes of a running cell: `cell.control.jsonl` beside `cell.toml`.
pub fn control_log_of(cell: &Path) -> PathBuf {
    cell.with_extension("control.jsonl")
}

/// A change of a running cell, and who asked for it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControlEntry {
    /// Counted from 1.
    pub sequence: u64,
    /// Time in UTC, by the clock of the service's computer.
    pub time: String,
    /// The access class of the token.
    pub class: String,
    /// The name of the token.
    pub name: String,
    /// The program that wrote the entry, with its version.
    pub program: String,
    /// The action: `switch region.cart`, `clear robot.left`.
    pub action: String,
    /// The note of the request.
    pub note: Option<String>,
    /// What differs.
    pub changes: Vec<Change>,
    /// The cell's checksum before.
    pub checksum_before: String,
    /// The cell's checksum after: the same where no region was edited.
    pub checksum: String,
    /// SHA-256 (hex) of the previous line; 64 zeros in the first entry.
    pub previous: String,
}

/// A change that is to be logged.
#[derive(Debug, Clone)]
pub struct Controlled<'a> {
    /// The access class of the token.
    pub class: AccessClass,
    /// The name of the token.
    pub name: &'a str,
    /// The action.
    pub action: String,
    /// The note of the request.
    pub note: Option<&'a str>,
    /// What differs.
    pub changes: Vec<Change>,
    /// The cell's checksum before and after.
    pub checksums: [&'a str; 2],
}

/// The open log of a running cell: one process writes it at a time, each line has the hash of the one before it, and the last one
/// is signed (`cell.control.head`) with a key that is made with the log (`cell.control.key`).
#[derive(Debug)]
pub struct ControlLog {
    path: PathBuf,
    file: File,
    signer: LogSigner,
    /// Bytes of its entries.
    length: u64,
    entries: u64,
    head: String,
    /// A line that was not signed could not be removed yet.
    has_rest: bool,
}

impl ControlLog {
    /// Opens the log, or begins it, and verifies that its lines follow each other up to the one that is signed. A line behind it
    /// is removed: it was being written when the power went, and its change was not made.
    ///
    /// # Errors
    /// [`FormatError`] at the line that was changed, where lines are missing, or where another process writes the log.
    pub fn open(path: &Path) -> Result<Self> {
        let file = File::options().append(true).create(true).open(path).map_err(text::unwritable(path))?;
        file.try_lock().map_err(|_| {
            FormatError::new(path, None, "is written by another process").hint("one service with --control per cell")
        })?;
        let written = text::read(path)?;
        let signed = LogHead::read(path)?;
        let (entries, text) = signed_entries(path, &written, signed.as_ref())?;
        let signer = LogSigner::open(path, signed.as_ref())?;
        if text.len() < written.len() {
            file.set_len(text.len() as u64).map_err(text::unwritable(path))?;
        }
        let head = signed.map_or_else(|| "0".repeat(64), |head| head.hash);
        let (length, entries) = (text.len() as u64, entries.len() as u64);
        Ok(Self { path: path.to_owned(), file, signer, length, entries, head, has_rest: false })
    }

    /// Appends a change, and returns once it is on the disk.
    ///
    /// # Errors
    /// [`FormatError`] where it cannot be written; then the change must not be made.
    pub fn append(&mut self, controlled: Controlled<'_>) -> Result<ControlEntry> {
        if self.has_rest {
            self.file.set_len(self.length).map_err(text::unwritable(&self.path))?;
            self.has_rest = false;
        }
        let Controlled { class, name, action, note, changes, checksums: [before, after] } = controlled;
        let entry = ControlEntry {
            sequence: self.entries + 1,
            time: time::now(),
            class: class.name().into(),
            name: name.into(),
            program: concat!("elbowroom ", env!("CARGO_PKG_VERSION")).into(),
            action,
            note: note.map(Into::into),
            changes,
            checksum_before: before.into(),
            checksum: after.into(),
            previous: self.head.clone(),
        };
        let line = line(&entry);
        let (bytes, head) = (line.clone() + "\n", hex::hash(line.as_bytes()));
        let written = self.file.write_all(bytes.as_bytes()).and_then(|()| self.file.sync_all());
        let written = written.map_err(text::unwritable(&self.path));
        if let Err(e) = written.and_then(|()| self.signer.sign(self.entries + 1, &head)) {
            // Of a full disk: half a line is not left for whoever reads on. Where that fails, too, the next line or start removes it.
            self.has_rest = self.file.set_len(self.length).is_err();
            return Err(e);
        }
        self.length += bytes.len() as u64;
        self.entries += 1;
        self.head = head;
        Ok(entry)
    }

    /// Names all that was logged so far: the hash of the last line. A request that names it cannot be repeated.
    pub fn head(&self) -> &str {
        &self.head
    }
}

/// A control log that was verified.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ControlHistory {
    /// In the order in which the changes were made.
    pub entries: Vec<ControlEntry>,
    /// The short id of the key that has signed them; empty for a log without entries.
    pub signed_by: String,
}

/// Reads a log and verifies it.
///
/// # Errors
/// [`FormatError`] at the first line that does not follow the one before it, or where lines are missing or not signed.
pub fn control_history(path: &Path) -> Result<ControlHistory> {
    let read = || {
        let head = LogHead::read(path)?;
        let entries = signed_entries(path, &text::read(path)?, head.as_ref())?.0;
        Ok(ControlHistory { entries, signed_by: head.and_then(|head| head.key_id()).unwrap_or_default() })
    };
    // The service may write between the two files.
    read().or_else(|_: FormatError| read())
}

/// The entries that are signed, and their lines. At most one line more may be there, or a half one, which was being written.
fn signed_entries<'t>(path: &Path, text: &'t str, head: Option<&LogHead>) -> Result<(Vec<ControlEntry>, &'t str)> {
    let wrong = |line: Option<usize>, what: &str| FormatError::new(path, line, what).hint(RESTORE);
    let (count, hash) = head.map_or((0, "0".repeat(64)), |head| (head.entries as usize, head.hash.clone()));
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let whole = lines.iter().filter(|line| line.ends_with('\n')).count();
    if whole < count {
        return Err(wrong(None, &format!("has {whole} lines, of the {count} that were signed: its end was cut off")));
    }
    let signed = &text[..lines[..count].iter().map(|line| line.len()).sum()];
    let (entries, last) = verified(path, signed)?;
    if last != hash {
        return Err(wrong(None, "is not the log that was signed"));
    }
    // The service makes its key before the first line, and signs each line after it was written.
    let unsigned = usize::from(head.is_some() || LogSigner::file_of(path).exists());
    if lines.len() > count + unsigned {
        return Err(wrong(Some(count + 1), "is not signed"));
    }
    Ok((entries, signed))
}

fn line(entry: &ControlEntry) -> String {
    // Serialization of texts and numbers cannot fail; an empty line would not be accepted again.
    serde_json::to_string(entry).unwrap_or_default()
}

/// The entries, and the hash of the last line.
fn verified(path: &Path, text: &str) -> Result<(Vec<ControlEntry>, String)> {
    let (mut entries, mut head) = (Vec::new(), "0".repeat(64));
    for (number, written) in (1..).zip(text.lines()) {
        let wrong = |what: &str| FormatError::new(path, number, what).hint(RESTORE);
        let entry: ControlEntry =
            serde_json::from_str(written).map_err(|_| wrong("is not an entry of a control log, or was modified"))?;
        // Only the form that is written here: otherwise spaces or repeated keys would go unnoticed.
        if entry.sequence != number as u64 || entry.previous != head || line(&entry) != written {
            return Err(wrong("does not follow the entry before it, or was modified"));
        }
        head = hex::hash(written.as_bytes());
        entries.push(entry);
    }
    Ok((entries, head))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn switched(on: bool) -> Controlled<'static> {
        let (before, after) = (Some((!on).to_string()), Some(on.to_string()));
        let change = Change { item: "region.cart".into(), field: "active".into(), before, after };
        Controlled {
            class: AccessClass::Programmer,
            name: "panel",
            action: "switch region.cart".into(),
            note: None,
            changes: vec![change],
            checksums: ["abc", "abc"],
        }
    }

    #[test]
    fn entries_follow_each_other_over_restarts_and_a_change_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let path = control_log_of(&folder.path().join("cell.toml"));
        let mut log = ControlLog::open(&path).unwrap();
        let first = log.append(switched(true)).unwrap();
        assert_eq!((first.sequence, first.previous.as_str()), (1, "0".repeat(64).as_str()));
        assert!(ControlLog::open(&path).unwrap_err().to_string().contains("another process"));
        drop(log);
        let mut log = ControlLog::open(&path).unwrap();
        let second = log.append(switched(false)).unwrap();
        assert_eq!(second.sequence, 2);
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(second.previous, hex::hash(text.lines().next().unwrap().as_bytes()));
        drop(log);
        let history = control_history(&path).unwrap();
        assert_eq!(history.entries, [first, second]);
        let head = path.with_extension("head");
        let signed = std::fs::read_to_string(&head).unwrap();
        let lines = |lines: &[&str]| lines.join("\n") + "\n";
        for wrong in [
            text.replacen("true", "false", 1),
            text.replacen("panel", "other", 1),
            lines(&text.lines().skip(1).collect::<Vec<_>>()),
            lines(&text.lines().rev().collect::<Vec<_>>()),
            text.replacen(":1,", ": 1,", 1),
        ] {
            std::fs::write(&path, wrong).unwrap();
            assert!(ControlLog::open(&path).is_err() && control_history(&path).is_err());
        }
        // Its end is cut off; so it is in a head that somebody else has signed.
        let first_line = text.split_inclusive('\n').next().unwrap();
        let message = |text: &str| {
            std::fs::write(&path, text).unwrap();
            let [open, read] = [ControlLog::open(&path).map(|_| ()), control_history(&path).map(|_| ())];
            assert_eq!(open.is_ok(), read.is_ok());
            read.err().map_or_else(String::new, |e| e.to_string())
        };
        assert!(message(first_line).contains("has 1 lines, of the 2 that were signed"));
        std::fs::write(&head, signed.replace("\"entries\":2", "\"entries\":1")).unwrap();
        assert!(message(first_line).contains("is not signed, or was modified"));
        std::fs::remove_file(&head).unwrap();
        assert!(message(&text).contains("is not signed"));
        std::fs::write(&head, &signed).unwrap();
        assert_eq!(message(&text), "");
        // Hashed anew, and signed with another key.
        let other = control_log_of(&folder.path().join("other.toml"));
        let mut forged = ControlLog::open(&other).unwrap();
        forged.append(switched(false)).unwrap();
        std::fs::copy(&other, &path).unwrap();
        std::fs::copy(other.with_extension("head"), &head).unwrap();
        assert!(ControlLog::open(&path).unwrap_err().to_string().contains("is not the key that has signed the log"));
        assert_ne!(control_history(&path).unwrap().signed_by, history.signed_by, "who has noted the id sees it");
    }

    #[test]
    fn half_a_line_is_removed_and_the_log_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let path = control_log_of(&folder.path().join("cell.toml"));
        ControlLog::open(&path).unwrap().append(switched(true)).unwrap();
        let (whole, head) = (std::fs::read_to_string(&path).unwrap(), path.with_extension("head"));
        let signed = std::fs::read_to_string(&head).unwrap();
        for half in ["{", &whole[..whole.len() / 2], whole.trim_end()] {
            std::fs::write(&path, format!("{whole}{half}")).unwrap();
            std::fs::write(&head, &signed).unwrap();
            assert_eq!(control_history(&path).unwrap().entries.len(), 1);
            let mut log = ControlLog::open(&path).unwrap();
            assert_eq!(log.append(switched(false)).unwrap().sequence, 2);
            assert_eq!(control_history(&path).unwrap().entries.len(), 2);
        }
    }
}
