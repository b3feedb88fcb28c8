//! File with the regions that a cell had when its keeper ended.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use elbowroom_formats::WholeFile;

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

/// Path of the journal of a cell: `cell.regions.json` beside `cell.toml`.
pub fn region_journal_of(cell: &Path) -> PathBuf {
    cell.with_extension("regions.json")
}

impl RegionJournal {
    /// Locks the journal until it is dropped.
    ///
    /// # Errors
    /// The reason, as text, if the journal cannot be locked.
    pub(crate) fn open(path: &Path) -> Result<Self, String> {
        let locked = path.with_extension("lock");
        let lock = File::options().write(true).create(true).truncate(false).open(&locked);
        let lock = lock.map_err(|e| format!("{}: cannot be written: {e}", locked.display()))?;
        lock.try_lock().map_err(|_| format!("{} is kept by another process", path.display()))?;
        Ok(Self { path: path.to_owned(), _lock: lock })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Reads the last written table.
    ///
    /// # Errors
    /// The reason, as text, if the table cannot be used.
    pub(crate) fn read(&self) -> Result<RegionTableMessage, String> {
        let name = self.path.display();
        let length = fs::metadata(&self.path).map_err(|e| match e.kind() {
            io::ErrorKind::NotFound => format!("there is no {name} of a former start"),
            _ => format!("{name}: cannot be read: {e}"),
        })?;
        if length.len() > MAX_BYTES {
            return Err(format!("{name}: is larger than {MAX_BYTES} bytes"));
        }
        let bytes = fs::read(&self.path).map_err(|e| format!("{name}: cannot be read: {e}"))?;
        serde_json::from_slice(&bytes).map_err(|e| format!("{name}: is no table of regions: {e}"))
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
