//! The cells that an object blocks, as a table or as a tree of boxes.

use elbowroom_cspace::{BoxTree, Grid, GridAxis, OccupancyArray, OccupancyBitmap, RowSpan};

/// The cells that an object blocks.
#[derive(Debug, Clone)]
pub enum BlockedCells {
    /// One bit per cell of three axes.
    Table {
        /// The axes.
        grid: Box<Grid>,
        /// The cells.
        table: OccupancyBitmap,
    },
    /// A tree of boxes, for any number of axes.
    Tree(BoxTree),
}

impl BlockedCells {
    /// True if a configuration (rad or m, one value per axis) lies in a blocked cell, lies outside the limits, or has a
    /// wrong number of values.
    pub fn is_blocked(&self, q: &[f64]) -> bool {
        match self {
            Self::Table { grid, table } => {
                let cell = <[f64; 3]>::try_from(q).ok().and_then(|q| grid.cell(q));
                cell.is_none_or(|cell| table.is_blocked(cell))
            }
            Self::Tree(tree) => tree.is_blocked(q),
        }
    }

    /// True if a cell is blocked, or has a wrong number of indices. `cell` has one index per axis.
    pub fn is_blocked_cell(&self, cell: &[u16]) -> bool {
        match self {
            Self::Table { table, .. } => <[u16; 3]>::try_from(cell).map_or(true, |cell| table.is_blocked(cell)),
            Self::Tree(tree) => tree.is_blocked_cell(cell),
        }
    }

    /// Number of blocked cells.
    pub fn blocked(&self) -> u64 {
        match self {
            Self::Table { table, .. } => table.blocked() as u64,
            Self::Tree(tree) => tree.blocked(),
        }
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Table { grid, table } => grid.rows() * table.words_per_row() * size_of::<u64>(),
            Self::Tree(tree) => tree.bytes(),
        }
    }
}

/// Union of the cells that some objects block, on three axes.
pub(crate) fn table<'b>(axes: &[GridAxis; 3], all: impl IntoIterator<Item = &'b BlockedCells>) -> OccupancyBitmap {
    let shape = axes.each_ref().map(GridAxis::count);
    let mut union = OccupancyBitmap::new(shape);
    for cells in all {
        match cells {
            BlockedCells::Table { table, .. } => union.add_table(table),
            BlockedCells::Tree(tree) => {
                let [planes, rows, cells] = shape.map(|n| n as u16);
                let each = (0..planes).flat_map(|i| (0..rows).flat_map(move |j| (0..cells).map(move |k| [i, j, k])));
                for [i, j, k] in each.filter(|cell| tree.is_blocked_cell(cell)) {
                    let row = usize::from(i) * shape[1] + usize::from(j);
                    union.block(RowSpan { row: row as u32, first: k, last: k });
                }
            }
        }
    }
    union
}

/// Union of the cells that some objects block; `None` if there are too many cells.
pub(super) fn union<'b>(axes: &[GridAxis], all: impl IntoIterator<Item = &'b BlockedCells>) -> Option<OccupancyArray> {
    let mut union = OccupancyArray::new(axes, [])?;
    for cells in all {
        match cells {
            BlockedCells::Table { table, .. } => union.add_table(table),
            BlockedCells::Tree(tree) => union.add_tree(tree),
        }
    }
    Some(union)
}
