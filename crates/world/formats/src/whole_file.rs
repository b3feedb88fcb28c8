//! Files that are written whole, or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// The new content of a file. It stands beside the file until [`Self::put`], so that a full disk, an error or a power cut leaves what
/// was there before. Dropped before that, it leaves nothing. A pipe or a device is written to directly.
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
    /// Beside the file; `None` for a pipe or a device.
    beside: Option<(Beside, File)>,
}

impl WholeFile {
    /// Writes the content by `write`, and puts it in its place.
    ///
    /// # Errors
    /// What `write` says, or the system.
    pub fn write(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        Self::begin(path, write)?.put()
    }

    /// Writes the content by `write` beside the file. It has the permissions of the file that it replaces.
    ///
    /// # Errors
    /// What `write` says, or the system; also where the file that is there may not be written.
    pub fn begin(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<Self> {
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
            write_through(File::create(&path)?, write)?;
            return Ok(Self { path, beside: None });
        }
        let beside = Beside::of(&path);
        let file = write_through(File::options().write(true).create_new(true).open(&beside.0)?, write)?;
        replaced.map_or(Ok(()), |permissions| file.set_permissions(permissions))?;
        Ok(Self { path, beside: Some((beside, file)) })
    }

    /// Puts the content in the place of the file.
    ///
    /// # Errors
    /// What the system says.
    pub fn put(self) -> io::Result<()> {
        self.beside.map_or(Ok(()), |(beside, _)| fs::rename(&beside.0, &self.path))
    }

    /// As [`Self::put`], and returns once it is on the disk.
    ///
    /// # Errors
    /// What the system says.
    pub fn put_durably(self) -> io::Result<()> {
        if let Some((_, file)) = &self.beside {
            file.sync_all()?;
        }
        let folder = self.path.parent().filter(|folder| !folder.as_os_str().is_empty()).map(Path::to_path_buf);
        self.put()?;
        // The name is on the disk with its folder; a system that cannot open folders writes it by itself.
        if let Ok(folder) = File::open(folder.unwrap_or_else(|| ".".into())) {
            let _ = folder.sync_all();
        }
        Ok(())
    }
}

/// The file of the new content, in the same folder; what is left of it is removed.
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
