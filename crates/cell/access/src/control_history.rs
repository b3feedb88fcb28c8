//! Verification of a control log, line by line. Memory use is bounded by the longest line, at any length of the log.

use std::fs::File;
use std::io::{BufRead as _, BufReader, Read as _, Take};
use std::path::Path;

use elbowroom_formats::Diagnostic;

use crate::control_entry::ControlEntry;
use crate::hex;
use crate::log_head::{LogHead, LogSigner, RESTORE};
use crate::result::Result;

/// Longest line with its end, bytes; a request has at most 64 KiB.
pub(crate) const MAX_LINE: u64 = 16 << 20;

/// A control log that was verified.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ControlHistory {
    /// Entries in the order in which the changes were made.
    pub entries: Vec<ControlEntry>,
    /// The short id of the key that has signed them; empty for a log without entries.
    pub signed_by: String,
}

/// Reads a log and verifies it.
///
/// # Errors
/// [`Diagnostic`] at the first line that does not follow the one before it, or if lines are missing or not signed.
pub fn control_history(path: &Path) -> Result<ControlHistory> {
    let read = || {
        let (head, mut entries) = (LogHead::read(path)?, Vec::new());
        verify(path, head.as_ref(), |entry| entries.push(entry))?;
        Ok(ControlHistory { entries, signed_by: head.and_then(|head| head.key_id()).unwrap_or_default() })
    };
    // The service may write between the reads of the two files.
    read().or_else(|_: Diagnostic| read())
}

/// The part of a log that is signed.
pub(crate) struct SignedPart {
    /// Length of its lines, bytes.
    pub(crate) length: u64,
    pub(crate) entries: u64,
    /// SHA-256 (hex) of the last line; 64 zeros if it has no line.
    pub(crate) hash: String,
    /// Whether an unsigned rest follows, which was being written.
    pub(crate) has_rest: bool,
}

/// Verifies the signed part of a log, and passes each entry to `take` before the rest of the log is verified.
///
/// At most one more line may follow, complete or partial, which was being written.
pub(crate) fn verify(path: &Path, head: Option<&LogHead>, mut take: impl FnMut(ControlEntry)) -> Result<SignedPart> {
    let wrong = |line: Option<u64>, what: &str| Diagnostic::new(path, line.map(|n| n as usize), what).hint(RESTORE);
    let count = head.map_or(0, |head| head.entries);
    let mut lines = Lines::open(path)?;
    let mut part = SignedPart { length: 0, entries: 0, hash: "0".repeat(64), has_rest: false };
    while part.entries < count {
        let Some(line) = lines.next()?.strip_suffix(b"\n") else {
            if lines.line.len() as u64 == MAX_LINE {
                return Err(wrong(Some(part.entries + 1), "is longer than any line that is written here"));
            }
            let what = format!("has {} of the {count} lines that were signed: its end was cut off", part.entries);
            return Err(wrong(None, &what));
        };
        let number = part.entries + 1;
        let entry: ControlEntry = serde_json::from_slice(line)
            .map_err(|_| wrong(Some(number), "is not an entry of a control log, or was modified"))?;
        // Only the canonical form is accepted: otherwise spaces or repeated keys would go unnoticed.
        if entry.sequence != number || entry.previous != part.hash || entry.line().as_bytes() != line {
            return Err(wrong(Some(number), "does not follow the entry before it, or was modified"));
        }
        let length = part.length + line.len() as u64 + 1;
        part = SignedPart { length, entries: number, hash: hex::hash(line), ..part };
        take(entry);
    }
    if head.is_some_and(|head| head.hash != part.hash) {
        return Err(wrong(None, "is not the log that was signed"));
    }
    // The service makes its key before the first line, and signs each line after it was written.
    let may_have_more = head.is_some() || LogSigner::file_of(path).exists();
    part.has_rest = !lines.next()?.is_empty();
    if part.has_rest && !(may_have_more && lines.next()?.is_empty()) {
        return Err(wrong(Some(count + 1), "is not signed"));
    }
    Ok(part)
}

/// The lines of a file up to its length when it was opened: the service may continue to write.
struct Lines<'p> {
    path: &'p Path,
    reader: BufReader<Take<File>>,
    line: Vec<u8>,
}

impl<'p> Lines<'p> {
    fn open(path: &'p Path) -> Result<Self> {
        let file = File::open(path).map_err(unreadable(path))?;
        let length = file.metadata().map_err(unreadable(path))?.len();
        Ok(Self { path, reader: BufReader::new(file.take(length)), line: Vec::new() })
    }

    /// The next line with its `\n`, which is missing if the line is unfinished or too long; empty at the end of the
    /// file.
    fn next(&mut self) -> Result<&[u8]> {
        self.line.clear();
        let mut bounded = self.reader.by_ref().take(MAX_LINE);
        bounded.read_until(b'\n', &mut self.line).map_err(unreadable(self.path))?;
        Ok(&self.line)
    }
}

fn unreadable(path: &Path) -> impl Fn(std::io::Error) -> Diagnostic + '_ {
    move |e| Diagnostic::unreadable(path, &e, "the path of a file that is there")
}
