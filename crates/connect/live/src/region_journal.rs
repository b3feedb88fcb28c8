//! Which regions a cell had when its keeper ended, on disk.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use elbowroom_formats::WholeFile;

use crate::regions_table::RegionTableMessage;

/// Longest file, bytes: more than any table has.
const MAX_BYTES: u64 = 4 << 20;

/// The file in which a keeper writes its table, before it tells anybody: so it is never older than what a node has heard. One process
/// keeps it at a time; the lock is a file of its own, as each table replaces the file before.
#[derive(Debug)]
pub(crate) struct RegionJournal {
    path: PathBuf,
    _lock: File,
}

/// The journal of a cell: `cell.regions.json` beside `cell.toml`.
pub fn region_journal_of(cell: &Path) -> PathBuf {
    cell.with_extension("regions.json")
}

impl RegionJournal {
    /// Locks it until it is dropped.
    ///
    /// # Errors
    /// Why it is not kept, in words.
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

    /// The table that was written last.
    ///
    /// # Errors
    /// Why it is of no use, in words.
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

    /// Writes a table, and returns once it is on the disk. One that cannot be written leaves no file: with an older one the regions
    /// would be as they were long ago.
    ///
    /// # Errors
    /// What the system says.
    pub(crate) fn write(&self, table: &RegionTableMessage) -> io::Result<()> {
        let written = WholeFile::begin(&self.path, |out| serde_json::to_writer(out, table).map_err(io::Error::from))
            .and_then(WholeFile::put_durably);
        if written.is_err() {
            // There may be none.
            let _ = fs::remove_file(&self.path);
        }
        written
    }
}
