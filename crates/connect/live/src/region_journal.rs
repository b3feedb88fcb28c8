//! File with the regions that a cell had when its keeper ended.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use elbowroom_formats::WholeFile;
use thiserror::Error;

use crate::cell_versions::NoVersion;
use crate::regions_table::RegionTableMessage;

/// Longest file, bytes; every table is shorter.
const MAX_BYTES: u64 = 4 << 20;

/// The file of a keeper's table.
///
/// A keeper writes the table before it publishes it, so the file is never older than what a node has received. One
/// process at a time owns the file; the lock is a separate file, because each table replaces the file before.
#[derive(Debug)]
pub(crate) struct RegionJournal {
    path: PathBuf,
    _lock: File,
}

/// Why the regions of an earlier start are not continued.
#[derive(Debug, Error)]
pub(crate) enum JournalError {
    /// The service has no journal.
    #[error("no journal is kept")]
    NotKept,
    /// The file of the lock cannot be written.
    #[error("{}: cannot be written: {source}", file.display())]
    Lock { file: PathBuf, source: io::Error },
    /// Another process has the lock.
    #[error("{} is kept by another process", .0.display())]
    KeptElsewhere(PathBuf),
    /// No table was written.
    #[error("there is no {} of a former start", .0.display())]
    Missing(PathBuf),
    /// The system does not read the file.
    #[error("{}: cannot be read: {source}", file.display())]
    Unreadable { file: PathBuf, source: io::Error },
    /// The file is larger than any table.
    #[error("{}: is larger than {MAX_BYTES} bytes", .0.display())]
    TooLarge(PathBuf),
    /// The content is not a table.
    #[error("{}: is no table of regions: {source}", file.display())]
    NoTable { file: PathBuf, source: serde_json::Error },
    /// The table is of another configuration.
    #[error("{} is of another cell file", .0.display())]
    OtherCell(PathBuf),
    /// The cell cannot have the regions of the table.
    #[error("{}: {source}", file.display())]
    Regions { file: PathBuf, source: NoVersion },
}

/// Path of the journal of a cell: `cell.regions.json` beside `cell.toml`.
pub fn region_journal_of(cell: &Path) -> PathBuf {
    cell.with_extension("regions.json")
}

impl RegionJournal {
    /// Locks the journal until it is dropped.
    ///
    /// # Errors
    /// [`JournalError`] if the journal cannot be locked.
    pub(crate) fn open(path: &Path) -> Result<Self, JournalError> {
        let file = path.with_extension("lock");
        let lock = File::options().write(true).create(true).truncate(false).open(&file);
        let lock = lock.map_err(|source| JournalError::Lock { file, source })?;
        lock.try_lock().map_err(|_| JournalError::KeptElsewhere(path.to_owned()))?;
        Ok(Self { path: path.to_owned(), _lock: lock })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Reads the last written table.
    ///
    /// # Errors
    /// [`JournalError`] if the table cannot be used.
    pub(crate) fn read(&self) -> Result<RegionTableMessage, JournalError> {
        let file = || self.path.clone();
        let length = fs::metadata(&self.path).map_err(|source| match source.kind() {
            io::ErrorKind::NotFound => JournalError::Missing(file()),
            _ => JournalError::Unreadable { file: file(), source },
        })?;
        if length.len() > MAX_BYTES {
            return Err(JournalError::TooLarge(file()));
        }
        let bytes = fs::read(&self.path).map_err(|source| JournalError::Unreadable { file: file(), source })?;
        serde_json::from_slice(&bytes).map_err(|source| JournalError::NoTable { file: file(), source })
    }

    /// Writes a table, and returns once it is on the disk.
    ///
    /// If the write fails, the file is removed: an older table would restore outdated regions.
    ///
    /// # Errors
    /// The error of the operating system.
    pub(crate) fn write(&self, table: &RegionTableMessage) -> io::Result<()> {
        let written = WholeFile::begin(&self.path, |out| serde_json::to_writer(out, table).map_err(io::Error::from))
            .and_then(WholeFile::put_durably);
        if written.is_err() {
            // The file may not exist.
            let _ = fs::remove_file(&self.path);
        }
        written
    }
}
