//! Files that commands write: whole, or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use crate::output::{Failure, cannot_write};

/// Writes a file by `write`. The new content stands beside it until it is complete, so that a full disk or an error leaves what
/// was there before. A pipe or a device is written to directly.
///
/// # Errors
/// What keeps the file from being written, and what to do.
pub(crate) fn write_file(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    try_write(path, write).map_err(cannot_write(path))
}

/// Writes a file of these bytes: [`write_file`].
pub(crate) fn write_bytes(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
    write_file(path, |out| out.write_all(bytes.as_ref()))
}

/// As [`write_file`].
///
/// # Errors
/// What `write` says, or the system.
pub(crate) fn try_write(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let (path, is_file) = match fs::metadata(path) {
        // What a symbolic link names is replaced, not the link.
        Ok(found) => (fs::canonicalize(path)?, found.is_file()),
        Err(_) => (path.to_path_buf(), true),
    };
    let replaced = fs::metadata(&path).ok().map(|found| found.permissions());
    // To rename onto a file needs no right to write it: one that its owner protects would be lost.
    if replaced.as_ref().is_some_and(fs::Permissions::readonly) {
        return Err(io::ErrorKind::PermissionDenied.into());
    }
    if !is_file {
        return write_through(File::create(&path)?, write).map(drop);
    }
    let beside = Beside::of(&path);
    let file = write_through(File::options().write(true).create_new(true).open(&beside.0)?, write)?;
    replaced.map_or(Ok(()), |permissions| file.set_permissions(permissions))?;
    fs::rename(&beside.0, &path)
}

/// The file of the new content, in the same folder; what is left of it is removed.
struct Beside(PathBuf);

impl Beside {
    fn of(path: &Path) -> Self {
        static WRITTEN: AtomicU32 = AtomicU32::new(0);
        let number = WRITTEN.fetch_add(1, Ordering::Relaxed);
        Self(path.with_file_name(format!(".elbowroom-{}-{number}.part", std::process::id())))
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        // It is not there any more where all went well.
        let _ = fs::remove_file(&self.0);
    }
}

/// Writes all, or says why not: what a buffer still holds when it is dropped would be lost without a word.
fn write_through<W: Write>(to: W, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<W> {
    let mut out = BufWriter::new(to);
    write(&mut out)?;
    out.into_inner().map_err(io::IntoInnerError::into_error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_whole_or_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        write_bytes(&path, "old").unwrap();
        let full = |out: &mut dyn Write| {
            out.write_all(b"half")?;
            Err(io::ErrorKind::StorageFull.into())
        };
        let Err(Failure::Wrong(message)) = write_file(&path, full) else { panic!("it was written") };
        assert!(message.contains("a.csv: cannot be written: no storage space"), "{message}");
        assert!(message.contains("write: a path on a disk with space left"), "{message}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside it");
        write_bytes(&path, "new").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    }

    #[test]
    #[cfg(unix)]
    fn links_permissions_and_devices_stay_what_they_are() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("a.csv"), folder.path().join("link.csv"));
        write_bytes(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        symlink(&path, &link).unwrap();
        write_bytes(&link, "new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
        fs::set_permissions(&path, fs::Permissions::from_mode(0o440)).unwrap();
        let Err(Failure::Wrong(message)) = write_bytes(&link, "newer") else { panic!("it was written") };
        assert!(message.contains("write: a file and a folder that you may write to"), "{message}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "new", "a protected file stays");
        write_bytes(Path::new("/dev/null"), "gone").unwrap();
        let Err(Failure::Wrong(message)) = write_bytes(Path::new("/dev/full"), "x") else { panic!("it was written") };
        assert!(message.contains("a disk with space left"), "{message}");
        let nowhere = folder.path().join("nowhere/a.csv");
        let Err(Failure::Wrong(message)) = write_bytes(&nowhere, "x") else { panic!("it was written") };
        assert!(message.contains("write: a folder that is there"), "{message}");
    }
}
