//! Shortcutting of grid paths: skips corners if there is line of sight, and moves corners to shorten the path. For
//! paths in the exact scene see `rrt_connect/shortcutting.rs`.

use elbowroom_cspace::{CellIndex, OccupancyBitmap};

use crate::grid_space::{CellScale, GridPoint, GridSpace};
use crate::line_of_sight::line_of_sight;

/// Largest number of points for which all pairs are checked.
const MAX_ALL_PAIRS: usize = 24;
/// Largest number of rounds of moving corners.
const MAX_ROUNDS: usize = 6;
/// Largest number of moves of a corner by one step size.
const MAX_MOVES: usize = 8;
/// If a round leaves more than this fraction of the length, it is the last one: further rounds gain even less.
const LAST_ROUND_RATIO: f64 = 0.999;
/// Smallest gain, as a fraction of a corner's two segments, for which it is moved: rounding errors do not move corners.
const MIN_MOVE_GAIN: f64 = 1e-9;
/// Steps by which a corner is moved, cells.
const STEPS: [i32; 5] = [16, 8, 4, 2, 1];

/// Workspace of the shortcutting, reused.
#[derive(Debug, Default)]
pub(crate) struct GridShortcutting {
    other: Vec<GridPoint>,
    length: Vec<f64>,
    next: Vec<usize>,
}

/// The map on which a path lies.
#[derive(Clone, Copy)]
pub(crate) struct PathContext<'a> {
    pub occupancy: &'a OccupancyBitmap,
    pub space: &'a GridSpace,
    pub scale: CellScale,
}

impl GridShortcutting {
    /// Shortens a path; its ends do not change.
    pub fn run(&mut self, context: PathContext, points: &mut Vec<GridPoint>) {
        self.skip_ahead(context, points);
        self.shortest_subsequence(context, points);
        for _ in 0..MAX_ROUNDS {
            let before = context.scale.length(points);
            (1..points.len().saturating_sub(1)).for_each(|i| pull_corner(context, points, i, &STEPS));
            self.shortest_subsequence(context, points);
            if context.scale.length(points) > before * LAST_ROUND_RATIO {
                break;
            }
        }
    }

    /// Joins each point with a far point in line of sight, found by doubling and bisection.
    fn skip_ahead(&mut self, context: PathContext, points: &mut Vec<GridPoint>) {
        self.other.clear();
        let mut at = 0;
        while at + 1 < points.len() {
            self.other.push(points[at]);
            let visible = |to: usize| line_of_sight(context.occupancy, points[at], points[to]);
            let (mut near, mut hop) = (at + 1, 2);
            while at + hop < points.len() && visible(at + hop) {
                near = at + hop;
                hop *= 2;
            }
            let mut far = (at + hop).min(points.len());
            while near + 1 < far {
                let middle = usize::midpoint(near, far);
                if visible(middle) { near = middle } else { far = middle }
            }
            at = near;
        }
        self.other.extend(points.last());
        std::mem::swap(&mut self.other, points);
    }

    /// Reduces the path to its shortest subsequence of points.
    fn shortest_subsequence(&mut self, context: PathContext, points: &mut Vec<GridPoint>) {
        let count = points.len();
        if !(3..=MAX_ALL_PAIRS).contains(&count) {
            return;
        }
        self.length.clear();
        self.length.resize(count, 0.0);
        self.next.clear();
        self.next.resize(count, count - 1);
        for i in (0..count - 1).rev() {
            self.length[i] = f64::INFINITY;
            for j in i + 1..count {
                let length = context.scale.distance(points[i], points[j]) + self.length[j];
                // Consecutive points are always connected, possibly through cells.
                if length < self.length[i] && (j == i + 1 || line_of_sight(context.occupancy, points[i], points[j])) {
                    (self.length[i], self.next[i]) = (length, j);
                }
            }
        }
        let (mut write, mut read) = (0, 0);
        while read != count - 1 {
            points[write] = points[read];
            (write, read) = (write + 1, self.next[read]);
        }
        points[write] = points[read];
        points.truncate(write + 1);
    }

    /// Memory on the heap, bytes.
    pub fn bytes(&self) -> usize {
        self.other.capacity() * size_of::<GridPoint>() + (self.length.capacity() + self.next.capacity()) * 8
    }
}

/// Moves a corner to shorten the path.
fn pull_corner(context: PathContext, points: &mut [GridPoint], i: usize, steps: &[i32]) {
    let (before, after) = (points[i - 1], points[i + 1]);
    let over = |p: GridPoint| context.scale.distance(before, p) + context.scale.distance(p, after);
    for &step in steps {
        let mut moves = 0;
        while let Some(better) = best_move(context, points[i], step, over, |p| {
            line_of_sight(context.occupancy, before, p) && line_of_sight(context.occupancy, p, after)
        }) {
            points[i] = better;
            moves += 1;
            if moves == MAX_MOVES {
                break;
            }
        }
    }
}

fn best_move(
    context: PathContext,
    from: GridPoint,
    step: i32,
    over: impl Fn(GridPoint) -> f64,
    clear: impl Fn(GridPoint) -> bool,
) -> Option<GridPoint> {
    let (mut best, mut least) = (None, over(from) * (1.0 - MIN_MOVE_GAIN));
    for shift in neighbour_shifts() {
        let Some(cell) = shifted_cell(context, from, shift.map(|s| s * step)) else { continue };
        let to = context.space.center(cell);
        let length = over(to);
        if length < least && clear(to) {
            (best, least) = (Some(to), length);
        }
    }
    best
}

/// Iterates over the shifts to the 26 neighbours of a cell.
fn neighbour_shifts() -> impl Iterator<Item = [i32; 3]> {
    (0..27).filter(|&n| n != 13).map(|n| [n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1])
}

/// Returns the cell of a point, shifted; `None` if it is outside the grid.
fn shifted_cell(context: PathContext, from: GridPoint, shift: [i32; 3]) -> Option<CellIndex> {
    let shape = context.occupancy.shape();
    let along = |i: usize| {
        let k = from[i].floor() as i64 + i64::from(shift[i]);
        usize::try_from(k).ok().filter(|&k| k < shape[i]).map(|k| k as u16)
    };
    Some([along(0)?, along(1)?, along(2)?])
}
