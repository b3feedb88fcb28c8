//! Files that are written completely or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// New content of a file, written completely or not at all.
///
/// The content is in a file beside the target until [`Self::put`]. A full disk, an error or a power cut leaves the
/// previous content in place. If the value is dropped before `put`, the file beside the target is removed. A pipe or a
/// device is written directly.
///
/// ```
/// use elbowroom_formats::WholeFile;
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("table.csv");
/// WholeFile::write(&path, |out| out.write_all(b"a,b\n"))?;
/// let failed = WholeFile::write(&path, |_| Err(std::io::ErrorKind::StorageFull.into()));
/// assert!(failed.is_err());
/// assert_eq!(std::fs::read(&path)?, b"a,b\n");
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct WholeFile {
    path: PathBuf,
    /// The file beside the target; `None` for a pipe or a device.
    beside: Option<(Beside, File)>,
}

impl WholeFile {
    /// Writes the content with `write`, and replaces the target.
    ///
    /// # Errors
    /// The errors of `write` or of the system.
    pub fn write(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        Self::begin(path, write)?.put()
    }

    /// Writes the content with `write` to a file beside the target, with the permissions of the file to be replaced.
    ///
    /// # Errors
    /// The errors of `write` or of the system; also if the existing file is read-only.
    pub fn begin(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<Self> {
        let (path, is_file) = match fs::metadata(path) {
            // The target of a symbolic link is replaced, not the link.
            Ok(found) => (fs::canonicalize(path)?, found.is_file()),
            Err(_) => (path.to_path_buf(), true),
        };
        let replaced = fs::metadata(&path).ok().map(|found| found.permissions());
        // Renaming onto a file does not need the right to write it: a file that its owner protects would be lost.
        if replaced.as_ref().is_some_and(fs::Permissions::readonly) {
            return Err(io::ErrorKind::PermissionDenied.into());
        }
        if !is_file {
            write_through(File::create(&path)?, write)?;
            return Ok(Self { path, beside: None });
        }
        let beside = Beside::of(&path);
        let file = write_through(File::options().write(true).create_new(true).open(&beside.0)?, write)?;
        replaced.map_or(Ok(()), |permissions| file.set_permissions(permissions))?;
        Ok(Self { path, beside: Some((beside, file)) })
    }

    /// Replaces the target with the new content.
    ///
    /// # Errors
    /// The errors of the system.
    pub fn put(self) -> io::Result<()> {
        self.beside.map_or(Ok(()), |(beside, _)| fs::rename(&beside.0, &self.path))
    }

    /// Like [`Self::put`], but returns only when the content is on the disk.
    ///
    /// # Errors
    /// The errors of the system.
    pub fn put_durably(self) -> io::Result<()> {
        if let Some((_, file)) = &self.beside {
            file.sync_all()?;
        }
        let folder = self.path.parent().filter(|folder| !folder.as_os_str().is_empty()).map(Path::to_path_buf);
        self.put()?;
        // Syncing the folder puts the name on the disk. A system that cannot open folders writes the name by itself.
        if let Ok(folder) = File::open(folder.unwrap_or_else(|| ".".into())) {
            let _ = folder.sync_all();
        }
        Ok(())
    }
}

/// The file of the new content, in the same folder. If it still exists when dropped, it is removed.
#[derive(Debug)]
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
        // After success the file no longer exists.
        let _ = fs::remove_file(&self.0);
    }
}

/// Writes everything or returns the error: an error would be lost if the buffer wrote its rest when dropped.
fn write_through<W: Write>(to: W, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<W> {
    let mut out = BufWriter::new(to);
    write(&mut out)?;
    out.into_inner().map_err(io::IntoInnerError::into_error)
}
