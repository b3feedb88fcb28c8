//! Cell of a process, with its present regions.

use std::sync::{Arc, Mutex};

use elbowroom_cell::{Cell, EditedRegions, RegionEdit, why_not_continued};
use elbowroom_formats::Diagnostic;

use crate::locked::locked;

/// Number of built cells that are cached: the nodes of one process ask for the same cells.
const KEPT: usize = 4;

/// Why the changed regions do not make a valid cell.
#[derive(Debug, thiserror::Error)]
pub enum NoVersion {
    /// A region is wrong.
    #[error(transparent)]
    Wrong(#[from] Diagnostic),
    /// The running cell cannot continue with the changed regions.
    #[error("{0}")]
    NotContinued(String),
}

/// A cell and its versions with changed regions.
///
/// Each version is built once for all nodes of a process, outside their ticks.
pub struct CellVersions {
    base: Arc<Cell>,
    edited: Option<EditedRegions>,
    /// Changes that the service makes to every cell it guards.
    adapt: fn(Cell) -> Cell,
    built: Mutex<Built>,
}

#[derive(Default)]
struct Built {
    /// Whether the file was compared with the cell that was read from it.
    is_checked: bool,
    cells: Vec<(Vec<RegionEdit>, Arc<Cell>)>,
}

impl CellVersions {
    /// Creates the versions of a cell.
    ///
    /// `edited` are the regions of its file; `adapt` repeats the changes made to `base` since it was read.
    pub fn new(base: &Arc<Cell>, edited: Option<EditedRegions>, adapt: fn(Cell) -> Cell) -> Self {
        Self { base: base.clone(), edited, adapt, built: Mutex::default() }
    }

    /// Returns the cell file's regions in memory.
    ///
    /// # Errors
    /// [`NoVersion`] if the cell was not read from a file.
    pub fn edited(&self) -> Result<&EditedRegions, NoVersion> {
        let no_file = || NoVersion::NotContinued("the cell was not read from a file".into());
        self.edited.as_ref().ok_or_else(no_file)
    }

    /// The cell without edits.
    pub fn base(&self) -> &Arc<Cell> {
        &self.base
    }

    /// Returns the cell with these edits.
    ///
    /// # Errors
    /// [`NoVersion`].
    pub fn cell(&self, edits: &[RegionEdit]) -> Result<Arc<Cell>, NoVersion> {
        if edits.is_empty() {
            return Ok(self.base.clone());
        }
        let edited = self.edited()?;
        // Other callers that ask for the same cell wait here.
        let mut built = locked(&self.built);
        if let Some((_, cell)) = built.cells.iter().find(|(of, _)| of == edits) {
            return Ok(cell.clone());
        }
        if !built.is_checked {
            if edited.cell(&[])?.approval.checksum != self.base.approval.checksum {
                return Err(NoVersion::NotContinued("the cell file has changed since the start".into()));
            }
            built.is_checked = true;
        }
        let cell = (self.adapt)(edited.cell(edits)?);
        if let Some(why) = why_not_continued(&self.base, &cell)? {
            return Err(NoVersion::NotContinued(why));
        }
        let cell = Arc::new(cell);
        if built.cells.len() == KEPT {
            built.cells.remove(0);
        }
        built.cells.push((edits.to_vec(), cell.clone()));
        Ok(cell)
    }
}
