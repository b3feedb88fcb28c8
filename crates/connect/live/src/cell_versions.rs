//! The cell of a process, with its regions as they are now.

use std::sync::{Arc, Mutex, PoisonError};

use elbowroom_cell::{Cell, EditedRegions, RegionEdit, why_not_continued};
use elbowroom_formats::FormatError;

/// So many cells are kept that were built last: nodes of one process ask for the same ones.
const KEPT: usize = 4;

/// Why the changed regions do not make a valid cell.
#[derive(Debug, thiserror::Error)]
pub enum NoVersion {
    /// A region is wrong.
    #[error(transparent)]
    Wrong(#[from] FormatError),
    /// What runs cannot go on with it.
    #[error("{0}")]
    NotContinued(String),
}

/// A cell, and what it becomes with other regions. Built once for all nodes of a process, outside of their ticks.
pub struct CellVersions {
    base: Arc<Cell>,
    edited: Option<EditedRegions>,
    /// What the service changes in every cell that it guards.
    adapt: fn(Cell) -> Cell,
    built: Mutex<Built>,
}

#[derive(Default)]
struct Built {
    /// The file is the one that the cell was read from.
    is_checked: bool,
    cells: Vec<(Vec<RegionEdit>, Arc<Cell>)>,
}

impl CellVersions {
    /// Of a cell, its file, and what was changed in the cell since it was read.
    pub fn new(base: &Arc<Cell>, edited: Option<EditedRegions>, adapt: fn(Cell) -> Cell) -> Self {
        Self { base: base.clone(), edited, adapt, built: Mutex::default() }
    }

    /// The cell file's regions in memory.
    ///
    /// # Errors
    /// [`NoVersion`] if the cell was not read from a file.
    pub fn edited(&self) -> Result<&EditedRegions, NoVersion> {
        let no_file = || NoVersion::NotContinued("the cell was not read from a file".into());
        self.edited.as_ref().ok_or_else(no_file)
    }

    /// As it was read.
    pub fn base(&self) -> &Arc<Cell> {
        &self.base
    }

    /// The cell with these edits.
    ///
    /// # Errors
    /// [`NoVersion`].
    pub fn cell(&self, edits: &[RegionEdit]) -> Result<Arc<Cell>, NoVersion> {
        if edits.is_empty() {
            return Ok(self.base.clone());
        }
        let edited = self.edited()?;
        // Whoever else asks for the same cell waits for it.
        let mut built = self.built.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, cell)) = built.cells.iter().find(|(of, _)| of == edits) {
            return Ok(cell.clone());
        }
        if !built.is_checked {
            if edited.cell(&[])?.checksum != self.base.checksum {
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
