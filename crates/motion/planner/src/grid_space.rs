//! Joint values in units of cell widths, and weighted lengths of points in these units.

use elbowroom_cspace::{CellIndex, Grid};

/// A point of joint space in cell widths: `(q − min) / step` per joint, so that cell `k` is `k..k + 1`.
pub(crate) type GridPoint = [f64; 3];

/// Path ends lie at least this far inside their cell, in cell widths: on a border the cell would be ambiguous.
const BORDER_INSET: f64 = 1e-9;

/// Converts between joint values and grid points.
#[derive(Debug, Clone)]
pub(crate) struct GridSpace {
    grid: Grid,
    /// Upper limit of each joint in cell widths: the last cell may extend beyond it.
    top: [f64; 3],
}

impl GridSpace {
    pub fn new(grid: &Grid) -> Self {
        let top = |i: usize| {
            let axis = &grid.axes()[i];
            (axis.max() - axis.min()) / axis.step()
        };
        Self { top: [top(0), top(1), top(2)], grid: grid.clone() }
    }

    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Returns the joint values of a point, radians.
    pub fn q(&self, point: GridPoint) -> [f64; 3] {
        let value = |i: usize| {
            let axis = &self.grid.axes()[i];
            (axis.min() + point[i] * axis.step()).clamp(axis.min(), axis.max())
        };
        [value(0), value(1), value(2)]
    }

    /// Returns joint values (radians) as a point, inside or outside the grid.
    pub fn point(&self, q: [f64; 3]) -> GridPoint {
        let along = |i: usize| {
            let axis = &self.grid.axes()[i];
            (q[i] - axis.min()) / axis.step()
        };
        [along(0), along(1), along(2)]
    }

    /// Returns joint values (radians) as a point, moved inward from the borders of its cell.
    pub fn point_within(&self, q: [f64; 3], cell: CellIndex) -> GridPoint {
        let point = self.point(q);
        let within = |i: usize| {
            let low = f64::from(cell[i]);
            point[i].clamp(low + BORDER_INSET, low + 1.0 - BORDER_INSET)
        };
        [within(0), within(1), within(2)]
    }

    /// Returns the centre of the part of a cell that lies within the joint limits.
    pub fn center(&self, cell: CellIndex) -> GridPoint {
        let center = |i: usize| {
            let low = f64::from(cell[i]);
            0.5 * (low + (low + 1.0).min(self.top[i]).max(low))
        };
        [center(0), center(1), center(2)]
    }

    /// Returns the radians per cell width, times the joints' weights.
    pub fn scale(&self, weights: [f64; 3]) -> CellScale {
        let axes = self.grid.axes();
        CellScale([0, 1, 2].map(|i| weights[i] * axes[i].step()))
    }
}

/// Length of a cell along each joint, weighted radians.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellScale(pub [f64; 3]);

impl CellScale {
    /// Weighted distance, radians.
    pub fn distance(&self, a: GridPoint, b: GridPoint) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|i| (a[i] - b[i]) * self.0[i]);
        (x * x + y * y + z * z).sqrt()
    }

    /// Weighted length of a polyline, radians.
    pub fn length(&self, points: &[GridPoint]) -> f64 {
        points.windows(2).map(|w| self.distance(w[0], w[1])).sum()
    }
}

/// A free cell and a point in it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellPoint {
    pub cell: CellIndex,
    pub point: GridPoint,
}
