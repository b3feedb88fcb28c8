//! Promises of `check` for a cell.

use std::cell::OnceCell;

use elbowroom_cell::Cell;
use elbowroom_sim::check::check;

/// Pairs of region and robot for which `check` says that entry is excluded.
pub struct Promises<'a> {
    cell: &'a Cell,
    /// Computed only if a robot was inside: `check` takes longer than a run.
    excluded: OnceCell<Vec<(usize, usize)>>,
}

impl<'a> Promises<'a> {
    pub fn new(cell: &'a Cell) -> Self {
        Self { cell, excluded: OnceCell::new() }
    }

    pub fn exclude(&self, region: usize, robot: usize) -> bool {
        let ask = || {
            // A cell that cannot be planned is not run.
            let checks = check(self.cell).unwrap_or_default();
            checks.iter().filter(|c| c.excluded).map(|c| (c.region.0, c.robot.0)).collect()
        };
        self.excluded.get_or_init(ask).contains(&(region, robot))
    }

    #[cfg(test)]
    pub fn none(cell: &'a Cell) -> Self {
        Self::promised(cell, Vec::new())
    }

    /// Creates promises for these pairs, whatever `check` says.
    #[cfg(test)]
    pub fn promised(cell: &'a Cell, pairs: Vec<(usize, usize)>) -> Self {
        Self { cell, excluded: OnceCell::from(pairs) }
    }
}
