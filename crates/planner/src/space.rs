//! Joint values in widths of cells, and lengths of what is measured in them.

use elbowroom_cspace::{Cell, Grid};

/// A point of joint space in widths of cells: `(q − min) / step` per joint, so that cell `k` is `k..k + 1`.
pub(crate) type Point = [f64; 3];

/// Ends lie at least this far inside their cell, in widths of cells: beside a border it is not clear in which they are.
const INSET: f64 = 1e-9;

/// Joint values to points and back.
#[derive(Debug, Clone)]
pub(crate) struct Space {
    grid: Grid,
    /// Upper limit of each joint in widths of cells: the last cell may reach beyond it.
    top: [f64; 3],
}

impl Space {
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

    /// Joint values of a point, radians.
    pub fn q(&self, point: Point) -> [f64; 3] {
        let value = |i: usize| {
            let axis = &self.grid.axes()[i];
            (axis.min() + point[i] * axis.step()).clamp(axis.min(), axis.max())
        };
        [value(0), value(1), value(2)]
    }

    /// Joint values (radians) as a point, wherever it lies.
    pub fn point(&self, q: [f64; 3]) -> Point {
        let along = |i: usize| {
            let axis = &self.grid.axes()[i];
            (q[i] - axis.min()) / axis.step()
        };
        [along(0), along(1), along(2)]
    }

    /// The same, drawn in from the borders of its cell.
    pub fn point_within(&self, q: [f64; 3], cell: Cell) -> Point {
        let point = self.point(q);
        let within = |i: usize| {
            let low = f64::from(cell[i]);
            point[i].clamp(low + INSET, low + 1.0 - INSET)
        };
        [within(0), within(1), within(2)]
    }

    /// The middle of the part of a cell that lies within the joints' limits.
    pub fn middle(&self, cell: Cell) -> Point {
        let middle = |i: usize| {
            let low = f64::from(cell[i]);
            0.5 * (low + (low + 1.0).min(self.top[i]).max(low))
        };
        [middle(0), middle(1), middle(2)]
    }

    /// Radians per width of a cell, times the joints' weights.
    pub fn scale(&self, weights: [f64; 3]) -> Scale {
        let axes = self.grid.axes();
        Scale([0, 1, 2].map(|i| weights[i] * axes[i].step()))
    }
}

/// How long a width of a cell counts along each joint, weighted radians.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scale(pub [f64; 3]);

impl Scale {
    /// Weighted distance, radians.
    pub fn distance(&self, a: Point, b: Point) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|i| (a[i] - b[i]) * self.0[i]);
        (x * x + y * y + z * z).sqrt()
    }

    /// Weighted length of a chain of points, radians.
    pub fn length(&self, points: &[Point]) -> f64 {
        points.windows(2).map(|w| self.distance(w[0], w[1])).sum()
    }
}
