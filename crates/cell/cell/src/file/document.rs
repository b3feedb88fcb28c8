//! A parsed cell file, not yet resolved.

use std::path::Path;

use elbowroom_formats::{Diagnostic, toml_tables};

type Result<T> = std::result::Result<T, Diagnostic>;

/// Largest cell file, bytes.
const MAX_BYTES: u64 = 64 << 20;

/// The tables that hold regions: `[region.NAME]`, `[fence.NAME]`.
pub(crate) const REGION_TABLES: [&str; 2] = ["region", "fence"];

/// A parsed cell file, not yet resolved: every key and value with its line.
#[derive(Debug, Clone)]
pub struct CellFile {
    pub(crate) file: std::path::PathBuf,
    pub(crate) entries: Vec<toml_tables::Entry>,
    /// True if it was read from disk; then its seal is verified.
    pub(super) on_disk: bool,
}

impl CellFile {
    /// Reads a file.
    ///
    /// # Errors
    /// [`Diagnostic`] if it cannot be read or is not TOML.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let unreadable =
            |e: std::io::Error| Diagnostic::unreadable(path, &e, "the path of a cell file (see docs/cell-file.md)");
        if std::fs::metadata(path).map_err(unreadable)?.len() > MAX_BYTES {
            return Err(Diagnostic::new(path, None, format!("is larger than {MAX_BYTES} bytes")));
        }
        let bytes = std::fs::read(path).map_err(unreadable)?;
        let text = String::from_utf8(bytes).map_err(|e| {
            let line = String::from_utf8_lossy(&e.as_bytes()[..e.utf8_error().valid_up_to()]).split('\n').count();
            Diagnostic::not_utf8(path, line)
        })?;
        Ok(Self { on_disk: true, ..Self::parse(path, &text)? })
    }

    /// Parses text as the file `path`; files it names are relative to that. The seal covers the file on disk, not this
    /// text, so no seal is verified.
    ///
    /// # Errors
    /// [`Diagnostic`] if it is not TOML.
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self> {
        let file = path.as_ref().to_owned();
        let entries = toml_tables::parse(&file, text)?;
        Ok(Self { file, entries, on_disk: false })
    }

    /// Marks the file as not read from disk, so that no seal is verified: for changes in memory.
    pub(crate) fn unsealed(self) -> Self {
        Self { on_disk: false, ..self }
    }

    /// Names of the regions, fences among them, in file order.
    pub(crate) fn region_names(&self) -> Vec<String> {
        let of_regions = |e: &&toml_tables::Entry| REGION_TABLES.contains(&e.key.as_str());
        let tables = self.entries.iter().filter(of_regions).filter_map(|e| match &e.node.data {
            toml_tables::Data::Table(tables) => Some(tables),
            _ => None,
        });
        tables.flatten().map(|e| e.key.clone()).collect()
    }
}
