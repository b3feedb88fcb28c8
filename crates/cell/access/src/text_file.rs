//! Reading and atomic replacement of text files.

use std::fs;
use std::path::Path;

use elbowroom_formats::{Diagnostic, WholeFile};

use crate::result::Result;

/// Largest file, bytes.
const MAX_BYTES: u64 = 64 << 20;

/// Reads a text file.
///
/// # Errors
/// The file cannot be read, is not UTF-8, or is larger than 64 MiB.
pub fn read(path: &Path) -> Result<String> {
    let unreadable = |e: std::io::Error| Diagnostic::unreadable(path, &e, "the path of a file that is there");
    if fs::metadata(path).map_err(unreadable)?.len() > MAX_BYTES {
        return Err(Diagnostic::new(path, None, format!("is larger than {MAX_BYTES} bytes")));
    }
    fs::read_to_string(path).map_err(unreadable)
}

/// The error for a file that cannot be written.
pub fn unwritable(path: &Path) -> impl Fn(std::io::Error) -> Diagnostic + '_ {
    move |e| {
        let instead = match e.kind() {
            std::io::ErrorKind::AlreadyExists => "the name of a new file",
            std::io::ErrorKind::StorageFull => "a path on a disk with space left",
            _ => "a file and a folder that you may write to",
        };
        Diagnostic::new(path, None, format!("cannot be written: {e}")).hint(instead)
    }
}

/// Replaces the text of a file: writes the new file beside it, calls `before_last_step`, then moves the new file into
/// its place.
///
/// # Errors
/// The file cannot be written; the error of `before_last_step`, after which the file is as before.
pub fn replace(path: &Path, text: &str, before_last_step: impl FnOnce() -> Result<()>) -> Result<()> {
    let new = WholeFile::begin(path, |out| out.write_all(text.as_bytes())).map_err(unwritable(path))?;
    before_last_step()?;
    new.put_durably().map_err(unwritable(path))
}
