//! Which regions a cell had when its keeper ended, on disk.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use elbowroom_formats::WholeFile;

use crate::regions_table::RegionTableMessage;

/// Longest file, bytes: more than any table has.
const MAX_BYTES: u64 = 4 << 20;

/// The file in which a keeper writes its table, before it tells anybody: so it is never older than what a node has heard.
#[derive(Debug, Clone)]
pub(crate) struct RegionJournal(PathBuf);

/// The journal of a cell: `cell.regions.json` beside `cell.toml`.
pub fn region_journal_of(cell: &Path) -> PathBuf {
    cell.with_extension("regions.json")
}

impl RegionJournal {
    pub(crate) fn new(path: &Path) -> Self {
        Self(path.to_owned())
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    /// The table that was written last.
    ///
    /// # Errors
    /// Why it is of no use, in words.
    pub(crate) fn read(&self) -> Result<RegionTableMessage, String> {
        let name = self.0.display();
        let length = fs::metadata(&self.0).map_err(|e| match e.kind() {
            io::ErrorKind::NotFound => format!("there is no {name} of a former start"),
            _ => format!("{name}: cannot be read: {e}"),
        })?;
        if length.len() > MAX_BYTES {
            return Err(format!("{name}: is larger than {MAX_BYTES} bytes"));
        }
        let bytes = fs::read(&self.0).map_err(|e| format!("{name}: cannot be read: {e}"))?;
        serde_json::from_slice(&bytes).map_err(|e| format!("{name}: is no table of regions: {e}"))
    }

    /// Writes a table, and returns once it is on the disk. One that cannot be written leaves no file: with an older one the regions
    /// would be as they were long ago.
    ///
    /// # Errors
    /// What the system says.
    pub(crate) fn write(&self, table: &RegionTableMessage) -> io::Result<()> {
        let written = WholeFile::begin(&self.0, |out| serde_json::to_writer(out, table).map_err(io::Error::from))
            .and_then(WholeFile::put_durably);
        if written.is_err() {
            // There may be none.
            let _ = fs::remove_file(&self.0);
        }
        written
    }
}
