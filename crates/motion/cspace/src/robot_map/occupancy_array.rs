//! Blocked cells as an array of bytes.

use std::io::{self, Write};

use super::box_tree::BoxTree;
use crate::{GridAxis, OccupancyBitmap, npy};

/// One byte per cell, 1 for blocked; the last axis varies fastest, as in NumPy.
///
/// ```
/// use elbowroom_cspace::{GridAxis, OccupancyArray};
/// let axes = [GridAxis::from_degrees("a", 0.0, 6.0, 2.0)?, GridAxis::from_degrees("b", 0.0, 10.0, 2.0)?];
/// let occupancy = OccupancyArray::new(&axes, []).expect("15 cells are few");
/// let mut file = Vec::new();
/// occupancy.write_npy(&mut file)?;
/// assert!(file.len() == 128 + 15 && occupancy.blocked() == 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OccupancyArray {
    shape: Vec<usize>,
    cells: Vec<u8>,
}

impl OccupancyArray {
    /// Largest number of cells: 1 GiB.
    pub const MAX_CELLS: usize = 1 << 30;

    /// Computes the union of the cells that some maps block. `None` if there are more cells than
    /// [`OccupancyArray::MAX_CELLS`], the memory is not available, or a map has other axes.
    pub fn new<'b>(axes: &[GridAxis], maps: impl IntoIterator<Item = &'b BoxTree>) -> Option<Self> {
        let shape: Vec<usize> = axes.iter().map(GridAxis::count).collect();
        let count = shape.iter().try_fold(1usize, |all, n| all.checked_mul(*n)).filter(|n| *n <= Self::MAX_CELLS)?;
        let mut cells = Vec::new();
        cells.try_reserve_exact(count).ok()?;
        cells.resize(count, 0);
        let mut occupancy = Self { shape, cells };
        for map in maps {
            if map.axes() != axes {
                return None;
            }
            occupancy.add_tree(map);
        }
        Some(occupancy)
    }

    /// Blocks the cells of a tree over the same axes.
    pub fn add_tree(&mut self, map: &BoxTree) {
        let last = self.shape.len() - 1;
        map.for_each_box(|b| {
            let mut cell: Vec<usize> = b.first.iter().map(|&c| c.into()).collect();
            loop {
                let start = cell.iter().zip(&self.shape).fold(0, |at, (c, n)| at * n + c);
                let run = usize::from(b.last[last] - b.first[last]) + 1;
                self.cells[start..start + run].fill(1);
                let Some(axis) = (0..last).rev().find(|&i| cell[i] < usize::from(b.last[i])) else { break };
                cell[axis] += 1;
                for i in axis + 1..last {
                    cell[i] = b.first[i].into();
                }
            }
        });
    }

    /// Blocks the cells of a table of the same shape.
    pub fn add_table(&mut self, table: &OccupancyBitmap) {
        for [i, j, k] in table.iter() {
            let cell = [i, j, k].map(usize::from);
            let at = cell.iter().zip(&self.shape).fold(0, |at, (c, n)| at * n + c);
            if let Some(cell) = self.cells.get_mut(at) {
                *cell = 1;
            }
        }
    }

    /// Numbers of cells along the axes.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// The cells, 1 for blocked; the last axis varies fastest.
    pub fn cells(&self) -> &[u8] {
        &self.cells
    }

    /// Number of blocked cells.
    pub fn blocked(&self) -> u64 {
        self.cells.iter().map(|&c| u64::from(c)).sum()
    }

    /// Writes a `.npy` file: `uint8`, C order, 0 is free, 1 blocked (NumPy's format, version 1.0).
    ///
    /// # Errors
    /// The writer failed.
    pub fn write_npy(&self, mut out: impl Write) -> io::Result<()> {
        out.write_all(&npy::header(&self.shape))?;
        out.write_all(&self.cells)?;
        out.flush()
    }
}
