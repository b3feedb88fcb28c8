//! Append-only log of the changes of a running cell, beside its file.

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use elbowroom_formats::Diagnostic;
use elbowroom_monitor::AccessClass;

use crate::change::Change;
use crate::control_entry::ControlEntry;
use crate::control_history::{MAX_LINE, SignedPart, verify};
use crate::log_head::{LogHead, LogSigner};
use crate::result::Result;
use crate::{hex, text_file, time};

/// The log of the changes of a running cell: `cell.control.jsonl` beside `cell.toml`.
pub fn control_log_of(cell: &Path) -> PathBuf {
    cell.with_extension("control.jsonl")
}

/// A change to log.
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
    /// The changes.
    pub changes: Vec<Change>,
    /// The cell's checksum before and after.
    pub checksums: [&'a str; 2],
}

/// The open log of a running cell.
///
/// One process writes it at a time. Each line contains the hash of the line before it. The last line is signed
/// (`cell.control.head`) with a key that is created with the log (`cell.control.key`).
#[derive(Debug)]
pub struct ControlLog {
    path: PathBuf,
    file: File,
    signer: LogSigner,
    /// Length of its entries, bytes.
    length: u64,
    entries: u64,
    head: String,
    /// True if an unsigned line could not be removed yet.
    has_rest: bool,
}

impl ControlLog {
    /// Opens or creates the log, and verifies that its lines follow each other up to the signed one.
    ///
    /// A line after the signed one is removed: it was being written when the power failed, and its change was not made.
    ///
    /// # Errors
    /// [`Diagnostic`] at the line that was changed, if lines are missing, or if another process writes the log.
    pub fn open(path: &Path) -> Result<Self> {
        let file = File::options().append(true).create(true).open(path).map_err(text_file::unwritable(path))?;
        file.try_lock().map_err(|_| {
            Diagnostic::new(path, None, "is written by another process").hint("one service with --control per cell")
        })?;
        let head = LogHead::read(path)?;
        let SignedPart { length, entries, hash, has_rest } = verify(path, head.as_ref(), |_| ())?;
        let signer = LogSigner::open(path, head.as_ref())?;
        if has_rest {
            file.set_len(length).map_err(text_file::unwritable(path))?;
        }
        Ok(Self { path: path.to_owned(), file, signer, length, entries, head: hash, has_rest: false })
    }

    /// Appends a change, and returns once it is on the disk.
    ///
    /// # Errors
    /// [`Diagnostic`] if it cannot be written; then the change must not be made.
    pub fn append(&mut self, controlled: Controlled<'_>) -> Result<ControlEntry> {
        if self.has_rest {
            self.file.set_len(self.length).map_err(text_file::unwritable(&self.path))?;
            self.has_rest = false;
        }
        let Controlled { class, name, action, note, changes, checksums: [before, after] } = controlled;
        let entry = ControlEntry {
            sequence: self.entries + 1,
            time: time::utc_now(),
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
        let line = entry.line();
        let (bytes, head) = (line.clone() + "\n", hex::hash(line.as_bytes()));
        if bytes.len() as u64 >= MAX_LINE {
            let what = format!("an entry of {} bytes is too long", bytes.len());
            return Err(Diagnostic::new(&self.path, None, what).hint("a shorter note, or fewer changes at once"));
        }
        let written = self.file.write_all(bytes.as_bytes()).and_then(|()| self.file.sync_all());
        let written = written.map_err(text_file::unwritable(&self.path));
        if let Err(e) = written.and_then(|()| self.signer.sign(self.entries + 1, &head)) {
            // After an error, such as a full disk, readers must not find a partial line. If its removal fails, too, the
            // next line or start removes it.
            self.has_rest = self.file.set_len(self.length).is_err();
            return Err(e);
        }
        self.length += bytes.len() as u64;
        self.entries += 1;
        self.head = head;
        Ok(entry)
    }

    /// The hash of the last line, which identifies the whole log so far. A request that names it cannot be repeated.
    pub fn head(&self) -> &str {
        &self.head
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control_history;

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
        // The end of the log is cut off, and then also in a head that somebody else has signed.
        let first_line = text.split_inclusive('\n').next().unwrap();
        let message = |text: &str| {
            std::fs::write(&path, text).unwrap();
            let [open, read] = [ControlLog::open(&path).map(|_| ()), control_history(&path).map(|_| ())];
            assert_eq!(open.is_ok(), read.is_ok());
            read.err().map_or_else(String::new, |e| e.to_string())
        };
        assert!(message(first_line).contains("has 1 of the 2 lines that were signed"));
        std::fs::write(&head, signed.replace("\"entries\":2", "\"entries\":1")).unwrap();
        assert!(message(first_line).contains("is not signed, or was modified"));
        std::fs::remove_file(&head).unwrap();
        assert!(message(&text).contains("is not signed"));
        std::fs::write(&head, &signed).unwrap();
        assert_eq!(message(&text), "");
        // The log is hashed anew, and signed with another key.
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
        // A partial character is a partial line. A service leaves neither two lines nor the line ends of another
        // system.
        std::fs::write(&head, &signed).unwrap();
        let refused = |text: Vec<u8>| {
            std::fs::write(&path, text).unwrap();
            let [open, read] = [ControlLog::open(&path).map(|_| ()), control_history(&path).map(|_| ())];
            assert_eq!(open.is_err(), read.is_err());
            open.is_err()
        };
        assert!(!refused([whole.as_bytes(), b"{\xc3"].concat()));
        assert!(refused([whole.as_bytes(), b"{\n{"].concat()));
        assert!(refused(whole.replace('\n', "\r\n").into_bytes()));
    }

    #[test]
    fn an_entry_that_could_not_be_read_again_is_not_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = control_log_of(&folder.path().join("cell.toml"));
        let mut log = ControlLog::open(&path).unwrap();
        let note = "n".repeat(MAX_LINE as usize);
        let error = log.append(Controlled { note: Some(&note), ..switched(true) }).unwrap_err();
        assert!(error.message.contains("is too long"), "{error}");
        assert_eq!(log.append(switched(true)).unwrap().sequence, 1);
        drop(log);
        let line = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, note + &line).unwrap();
        assert!(ControlLog::open(&path).unwrap_err().message.contains("longer than any line"));
    }

    /// Written as the service writes it, but signed once: 1,130 lines of 60 kB.
    #[test]
    fn a_log_of_more_than_64_mebibytes_is_opened() {
        let folder = tempfile::tempdir().unwrap();
        let path = control_log_of(&folder.path().join("cell.toml"));
        let entry = ControlEntry {
            sequence: 1,
            time: "2026-11-26T12:00:00Z".into(),
            class: "programmer".into(),
            name: "panel".into(),
            program: "elbowroom".into(),
            action: "switch region.cart".into(),
            note: Some("n".repeat(60_000)),
            changes: Vec::new(),
            checksum_before: "abc".into(),
            checksum: "abc".into(),
            previous: "0".repeat(64),
        };
        let (first, mut previous, mut text) = (entry.line(), entry.previous.clone(), String::new());
        for sequence in 1..=1_130 {
            let line = first.replacen(":1,", &format!(":{sequence},"), 1).replacen(&entry.previous, &previous, 1);
            previous = hex::hash(line.as_bytes());
            text = text + &line + "\n";
        }
        assert!(text.len() > 64 << 20);
        std::fs::write(&path, &text).unwrap();
        LogSigner::open(&path, None).unwrap().sign(1_130, &previous).unwrap();
        assert_eq!(ControlLog::open(&path).unwrap().head(), previous);
        std::fs::write(&path, text.replacen("panel", "other", 1)).unwrap();
        let error = ControlLog::open(&path).unwrap_err();
        assert_eq!(
            (error.line, error.message.as_str()),
            (Some(2), "does not follow the entry before it, or was modified")
        );
    }
}
