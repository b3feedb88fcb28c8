//! The grid of three axes, with the numbering of cells and rows.

use crate::GridAxis;

/// A cell by its index on each of the three axes.
pub type CellIndex = [u16; 3];

/// A grid of three axes. A *plane* is all cells of one θ1, a *row* all cells of one θ1 and θ2; rows run along θ3.
///
/// ```
/// use elbowroom_cspace::{Grid, GridAxis};
/// let axis = |name, range: f64| GridAxis::from_degrees(name, -range, range, 2.0);
/// let grid = Grid::new([axis("a", 170.0)?, axis("b", 90.0)?, axis("c", 135.0)?]).unwrap();
/// assert_eq!(grid.cells(), 170 * 90 * 135);
/// assert_eq!(grid.cell([0.0, 0.0, 0.0]), Some([85, 45, 67]));
/// # Ok::<(), elbowroom_cspace::GridAxisError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    axes: [GridAxis; 3],
}

/// The grid has more cells than a dense table can hold.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{0} x {1} x {2} cells are too many for a dense table (at most {MAX}): make the steps larger", MAX = Grid::MAX_CELLS)]
pub struct TooManyCells(pub usize, pub usize, pub usize);

impl Grid {
    /// Largest number of cells: 2³³ bits are 1 GiB.
    pub const MAX_CELLS: usize = 1 << 33;

    /// Joins three axes: base, shoulder, elbow.
    ///
    /// # Errors
    /// The grid has more than [`Grid::MAX_CELLS`] cells.
    pub fn new(axes: [GridAxis; 3]) -> Result<Self, TooManyCells> {
        let [a, b, c] = [axes[0].count(), axes[1].count(), axes[2].count()];
        if a * b * c > Self::MAX_CELLS {
            return Err(TooManyCells(a, b, c));
        }
        Ok(Self { axes })
    }

    /// The axes.
    pub fn axes(&self) -> &[GridAxis; 3] {
        &self.axes
    }

    /// Number of cells along each axis.
    pub fn shape(&self) -> [usize; 3] {
        [self.axes[0].count(), self.axes[1].count(), self.axes[2].count()]
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.shape().iter().product()
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.axes[0].count() * self.axes[1].count()
    }

    /// The cell of a configuration (radians), `None` if a joint is outside its limits or NaN.
    pub fn cell(&self, q: [f64; 3]) -> Option<CellIndex> {
        let cell = |i: usize| self.axes[i].cell(q[i]).map(|c| c as u16);
        Some([cell(0)?, cell(1)?, cell(2)?])
    }

    /// Centre of a cell, radians.
    pub fn center(&self, cell: CellIndex) -> [f64; 3] {
        let center = |i: usize| self.axes[i].center(usize::from(cell[i]));
        [center(0), center(1), center(2)]
    }

    /// Half widths of every cell, radians.
    pub fn half_widths(&self) -> [f64; 3] {
        [self.axes[0].step() * 0.5, self.axes[1].step() * 0.5, self.axes[2].step() * 0.5]
    }
}
