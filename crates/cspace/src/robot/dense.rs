//! Boxes of cells written out cell by cell.

use std::io::{self, Write};

use super::blocks::Blocks;
use crate::{Axis, npy};

/// One byte per cell, 1 is blocked: as NumPy has it, the last axis runs fastest.
///
/// ```
/// use elbowroom_cspace::{Axis, Dense};
/// let axes = [Axis::from_degrees("a", 0.0, 6.0, 2.0)?, Axis::from_degrees("b", 0.0, 10.0, 2.0)?];
/// let dense = Dense::of(&axes, []).expect("15 cells are few");
/// let mut file = Vec::new();
/// dense.write_npy(&mut file)?;
/// assert!(file.len() == 128 + 15 && dense.blocked() == 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Dense {
    shape: Vec<usize>,
    cells: Vec<u8>,
}

impl Dense {
    /// Most cells: 1 GiB.
    pub const MOST: usize = 1 << 30;

    /// The cells that any of some maps blocks; `None` where there are more than [`Dense::MOST`], no
    /// memory for them, or a map has other axes.
    pub fn of<'b>(axes: &[Axis], maps: impl IntoIterator<Item = &'b Blocks>) -> Option<Self> {
        let shape: Vec<usize> = axes.iter().map(Axis::count).collect();
        let count = shape.iter().try_fold(1usize, |all, n| all.checked_mul(*n)).filter(|n| *n <= Self::MOST)?;
        let mut cells = Vec::new();
        cells.try_reserve_exact(count).ok()?;
        cells.resize(count, 0);
        let mut dense = Self { shape, cells };
        for map in maps {
            if map.axes() != axes {
                return None;
            }
            dense.add(map);
        }
        Some(dense)
    }

    fn add(&mut self, map: &Blocks) {
        let last = self.shape.len() - 1;
        map.each(|block| {
            let mut cell: Vec<usize> = block.first.iter().map(|&c| c.into()).collect();
            loop {
                let start = cell.iter().zip(&self.shape).fold(0, |at, (c, n)| at * n + c);
                let run = usize::from(block.last[last] - block.first[last]) + 1;
                self.cells[start..start + run].fill(1);
                let Some(axis) = (0..last).rev().find(|&i| cell[i] < usize::from(block.last[i])) else { break };
                cell[axis] += 1;
                for i in axis + 1..last {
                    cell[i] = block.first[i].into();
                }
            }
        });
    }

    /// Number of blocked cells.
    pub fn blocked(&self) -> u64 {
        self.cells.iter().map(|&c| u64::from(c)).sum()
    }

    /// Writes a `.npy` file: `uint8`, C order, 0 is free, 1 blocked (NumPy's format, version 1.0).
    ///
    /// # Errors
    /// What the writer says.
    pub fn write_npy(&self, mut out: impl Write) -> io::Result<()> {
        out.write_all(&npy::header(&self.shape))?;
        out.write_all(&self.cells)?;
        out.flush()
    }
}
