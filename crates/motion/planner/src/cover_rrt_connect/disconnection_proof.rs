//! Proofs that no path exists (Basch, Guibas, Hsu, Nguyen: *Disconnection proofs for motion planning*, 2001).
//!
//! A few joints span a grid of closed cells. A cell is blocked if the covers prove that the robot collides everywhere
//! in the cell, whatever the values of the other joints. A path never enters a blocked cell, so it stays in cells that
//! are connected through faces. (A cell shares each of its edges and corners with the neighbours that complete the turn
//! around them; a blocked cell also blocks the edge or corner.) If blocked cells enclose the cells around the start,
//! and the goal is not among the enclosed cells, no path exists.

use elbowroom_validity::ValidityChecker;

use crate::deadline::Deadline;
use crate::rrt_connect::JointRange;

/// Largest number of cells of a grid.
const MAX_CELLS: usize = 8_000_000;
/// Number of cells whose collision is tested together: a multiple of sixteen.
const BATCH: usize = 64;

/// The joints that span a grid, and the width of its cells.
#[derive(Debug, Clone)]
pub(super) struct Projection {
    /// Indices of the joints.
    pub joints: Vec<usize>,
    /// Width of a cell, rad; for prismatic joints a tenth of this number in metres.
    pub step: f64,
}

/// A joint of the grid.
#[derive(Debug, Clone)]
struct Axis {
    joint: usize,
    min: f64,
    step: f64,
    count: usize,
    /// Whether the last cell is next to the first.
    wraps: bool,
}

impl Axis {
    fn new(joint: usize, range: &JointRange, step: f64) -> Option<Self> {
        let step = if range.is_prismatic { 0.1 * step } else { step };
        let (min, width, wraps) = match range {
            r if r.lower.is_finite() && r.upper.is_finite() => (r.lower, r.upper - r.lower, false),
            r if r.is_prismatic || !r.repeats => return None,
            _ => (0.0, std::f64::consts::TAU, true),
        };
        let count = (width / step).ceil().max(1.0);
        (count <= MAX_CELLS as f64).then(|| Self { joint, min, step: width / count, count: count as usize, wraps })
    }

    fn cell(&self, value: f64) -> usize {
        let at = ((value - self.min) / self.step).floor();
        let at = if self.wraps { at.rem_euclid(self.count as f64) } else { at };
        (at.max(0.0) as usize).min(self.count - 1)
    }

    fn centre(&self, cell: usize) -> f64 {
        self.min + (cell as f64 + 0.5) * self.step
    }

    /// The cell next to another, if it exists.
    fn beside(&self, cell: usize, is_up: bool) -> Option<usize> {
        let (first, last) = (0, self.count - 1);
        match (is_up, self.wraps) {
            (true, true) if cell == last => Some(first),
            (false, true) if cell == first => Some(last),
            (true, _) => (cell < last).then_some(cell + 1),
            (false, _) => cell.checked_sub(1),
        }
    }
}

/// The known state of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cell {
    Unknown,
    Blocked,
    /// Reached from the start (0) or from the goal (1).
    Reached(u8),
}

/// A flood fill from both ends.
struct Flood<'c, 'm> {
    checker: &'c mut ValidityChecker<'m>,
    axes: Vec<Axis>,
    cells: Vec<Cell>,
    /// Values of the joints that do not span the grid.
    others: Vec<f64>,
    half_widths: Vec<f64>,
}

/// Whether it is proven that no path within the ranges joins two configurations. False proves nothing.
pub(super) fn are_disconnected(
    checker: &mut ValidityChecker,
    ranges: &[JointRange],
    [from, to]: [&[f64]; 2],
    projection: &Projection,
    deadline: &Deadline,
) -> bool {
    let axes: Option<Vec<Axis>> =
        projection.joints.iter().map(|&j| Axis::new(j, ranges.get(j)?, projection.step)).collect();
    let Some(axes) = axes.filter(|axes| !axes.is_empty()) else { return false };
    let count = axes.iter().try_fold(1_usize, |product, axis| product.checked_mul(axis.count));
    let Some(count) = count.filter(|&count| count <= MAX_CELLS) else { return false };
    let mut half_widths = vec![f64::INFINITY; ranges.len()];
    for axis in &axes {
        half_widths[axis.joint] = 0.5 * axis.step;
    }
    let mut flood = Flood { checker, axes, cells: vec![Cell::Unknown; count], others: from.to_vec(), half_widths };
    flood.encloses_an_end(from, to, deadline)
}

impl Flood<'_, '_> {
    /// Extends both ends alternately until one cannot be extended (true) or they meet (false).
    fn encloses_an_end(&mut self, from: &[f64], to: &[f64], deadline: &Deadline) -> bool {
        let ends = [self.cell_of(from), self.cell_of(to)];
        if ends[0] == ends[1] {
            return false;
        }
        let mut fronts = [vec![ends[0]], vec![ends[1]]];
        for side in [0, 1] {
            self.cells[ends[side]] = Cell::Reached(side as u8);
        }
        let mut candidates = Vec::new();
        for side in [0, 1].into_iter().cycle() {
            if fronts[side].is_empty() {
                return true;
            }
            if deadline.is_over() || !self.extend(side as u8, &mut fronts[side], &mut candidates) {
                return false;
            }
        }
        false
    }

    /// Reaches the cells next to some cells of a front. False if the other end is reached.
    fn extend(&mut self, side: u8, front: &mut Vec<usize>, candidates: &mut Vec<usize>) -> bool {
        candidates.clear();
        while let Some(cell) = front.pop() {
            for beside in self.neighbours(cell).into_iter().flatten() {
                match self.cells[beside] {
                    Cell::Unknown => {
                        // Marked until it is tested, so that it is listed only once.
                        self.cells[beside] = Cell::Blocked;
                        candidates.push(beside);
                    }
                    Cell::Reached(other) if other != side => return false,
                    _ => {}
                }
            }
            if candidates.len() >= BATCH {
                break;
            }
        }
        let blocked = self.are_blocked(candidates);
        for (&cell, _) in candidates.iter().zip(&blocked).filter(|(_, blocked)| !**blocked) {
            self.cells[cell] = Cell::Reached(side);
            front.push(cell);
        }
        true
    }

    /// For each cell, whether it is proven in collision as a whole.
    fn are_blocked(&mut self, cells: &[usize]) -> Vec<bool> {
        let mut centres = Vec::with_capacity(cells.len() * self.others.len());
        for &cell in cells {
            let first = centres.len();
            centres.extend_from_slice(&self.others);
            let mut rest = cell;
            for axis in &self.axes {
                centres[first + axis.joint] = axis.centre(rest % axis.count);
                rest /= axis.count;
            }
        }
        let mut blocked = Vec::new();
        match self.checker.boxes_are_in_collision(&centres, &self.half_widths, &mut blocked) {
            Ok(()) => blocked,
            Err(_) => vec![false; cells.len()],
        }
    }

    fn cell_of(&self, q: &[f64]) -> usize {
        self.axes.iter().rev().fold(0, |index, axis| index * axis.count + axis.cell(q[axis.joint]))
    }

    /// The cells that share a face with a cell, two per axis.
    fn neighbours(&self, cell: usize) -> Vec<Option<usize>> {
        let (mut found, mut rest, mut stride) = (Vec::with_capacity(2 * self.axes.len()), cell, 1);
        for axis in &self.axes {
            let at = rest % axis.count;
            for is_up in [true, false] {
                found.push(axis.beside(at, is_up).map(|beside| cell - at * stride + beside * stride));
            }
            rest /= axis.count;
            stride *= axis.count;
        }
        found
    }
}
