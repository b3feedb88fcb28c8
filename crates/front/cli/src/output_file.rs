//! Files that commands write: whole, or not at all.

use std::io::{self, Write};
use std::path::Path;

use elbowroom::formats::WholeFile;

use crate::output::{Failure, cannot_write};

/// Writes a file with the function `write`: [`WholeFile::write`].
///
/// # Errors
/// The reason that the file cannot be written, and what to do.
pub(crate) fn write_file(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    WholeFile::write(path, write).map_err(cannot_write(path))
}

/// Writes these bytes to a file: [`write_file`].
pub(crate) fn write_bytes(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
    write_file(path, |out| out.write_all(bytes.as_ref()))
}

#[cfg(test)]
mod tests {
    use std::fs;

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
