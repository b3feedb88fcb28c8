//! Line of sight: all cells that a straight segment touches, row by row.

use elbowroom_cspace::OccupancyBitmap;

use crate::grid_space::GridPoint;

/// Cells are enlarged by this on every side, in cell widths: a segment along a border or through a corner touches all cells
/// that meet there, independent of rounding. Smaller than the inset of path ends from borders.
const CELL_TOLERANCE: f64 = 5e-10;
/// A segment that moves less along an axis, in cell widths, does not move along it: the inverse would be infinite.
const MIN_MOTION: f64 = 1e-300;

/// True where all cells that the segment touches are free.
pub(crate) fn line_of_sight(occupancy: &OccupancyBitmap, a: GridPoint, b: GridPoint) -> bool {
    let mut clear = true;
    for_each_row_hit(occupancy, a, b, |_| {
        clear = false;
        true
    });
    clear
}

/// The fraction of the segment at which it first touches a blocked cell or leaves the grid.
pub(crate) fn first_blocked(occupancy: &OccupancyBitmap, a: GridPoint, b: GridPoint) -> Option<f64> {
    // A segment along a border is in several rows at once: the first cell need not be in the first row.
    let mut first: Option<f64> = None;
    for_each_row_hit(occupancy, a, b, |t| {
        first = Some(first.map_or(t, |f| f.min(t)));
        false
    });
    first
}

/// Calls `blocked`, row by row, with the fraction at which the segment first touches a blocked cell, until it returns true.
fn for_each_row_hit(occupancy: &OccupancyBitmap, a: GridPoint, b: GridPoint, mut blocked: impl FnMut(f64) -> bool) {
    let line = Line::new(a, b);
    for i in line.cells(0, (0.0, 1.0)) {
        let along_i = line.part(0, i, (0.0, 1.0));
        let plane = usize::try_from(i).map_or(&[][..], |i| occupancy.plane(i));
        for j in line.cells(1, along_i) {
            let along_j = line.part(1, j, along_i);
            let hit = line.blocked_in_row(row_of(occupancy, plane, j), occupancy.shape()[2], along_j);
            if hit.is_some_and(&mut blocked) {
                return;
            }
        }
    }
}

/// True where all cells that a box touches are free.
pub(crate) fn box_is_free(occupancy: &OccupancyBitmap, low: GridPoint, high: GridPoint) -> bool {
    let range = |axis: usize| floor(low[axis] - CELL_TOLERANCE)..=floor(high[axis] + CELL_TOLERANCE);
    let (first, last) = (*range(2).start(), *range(2).end());
    range(0).all(|i| {
        let plane = usize::try_from(i).map_or(&[][..], |i| occupancy.plane(i));
        range(1).all(|j| first_in_row(row_of(occupancy, plane, j), occupancy.shape()[2], first, last, false).is_none())
    })
}

/// A row of a plane; outside the grid it is empty, which counts as blocked.
fn row_of<'t>(occupancy: &OccupancyBitmap, plane: &'t [u64], row: i64) -> &'t [u64] {
    let width = occupancy.words_per_row();
    usize::try_from(row).ok().and_then(|j| plane.get(j * width..(j + 1) * width)).unwrap_or(&[])
}

/// Without a library call, unlike `f64::floor` on many processors.
#[inline]
fn floor(value: f64) -> i64 {
    let whole = value as i64;
    whole - i64::from(value < whole as f64)
}

struct Line {
    a: GridPoint,
    d: GridPoint,
    /// 1 / d; 0 along an axis without motion.
    inverse: GridPoint,
}

impl Line {
    fn new(a: GridPoint, b: GridPoint) -> Self {
        let d = [b[0] - a[0], b[1] - a[1], b[2] - a[2]].map(|d: f64| if d.abs() < MIN_MOTION { 0.0 } else { d });
        Self { a, d, inverse: d.map(|d| if d == 0.0 { 0.0 } else { 1.0 / d }) }
    }

    fn at(&self, axis: usize, t: f64) -> f64 {
        self.a[axis] + self.d[axis] * t
    }

    /// Cells along an axis that a part of the line touches, in the direction of the line.
    fn cells(&self, axis: usize, (from, to): (f64, f64)) -> impl Iterator<Item = i64> + use<> {
        let (start, end) = (self.at(axis, from), self.at(axis, to));
        let (low, high) = (floor(start.min(end) - CELL_TOLERANCE), floor(start.max(end) + CELL_TOLERANCE));
        let backward = self.d[axis] < 0.0;
        (0..=high - low).map(move |n| if backward { high - n } else { low + n })
    }

    /// The part of an interval of the line that lies in a cell's slab.
    fn part(&self, axis: usize, cell: i64, (from, to): (f64, f64)) -> (f64, f64) {
        if self.d[axis] == 0.0 {
            return (from, to);
        }
        let low = (cell as f64 - CELL_TOLERANCE - self.a[axis]) * self.inverse[axis];
        let high = ((cell + 1) as f64 + CELL_TOLERANCE - self.a[axis]) * self.inverse[axis];
        (low.min(high).clamp(from, to), low.max(high).clamp(from, to))
    }

    fn blocked_in_row(&self, row: &[u64], count: usize, (from, to): (f64, f64)) -> Option<f64> {
        let (start, end) = (self.at(2, from), self.at(2, to));
        let (low, high) = (floor(start.min(end) - CELL_TOLERANCE), floor(start.max(end) + CELL_TOLERANCE));
        let d = self.d[2];
        let cell = first_in_row(row, count, low, high, d < 0.0)?;
        let border = if d < 0.0 { (cell + 1) as f64 + CELL_TOLERANCE } else { cell as f64 - CELL_TOLERANCE };
        Some(if d == 0.0 { from } else { ((border - self.a[2]) / d).clamp(from, to) })
    }
}

/// The first blocked cell of `low..=high`, the last one if `backward`. Cells outside the row are blocked.
fn first_in_row(row: &[u64], count: usize, low: i64, high: i64, backward: bool) -> Option<i64> {
    let last = count.cast_signed() as i64 - 1;
    if row.is_empty() || high < 0 || low > last {
        return Some(if backward { high } else { low });
    }
    if backward && high > last {
        return Some(high);
    }
    if !backward && low < 0 {
        return Some(low);
    }
    let inside = first_one(row, low.max(0) as usize, high.min(last) as usize, backward);
    let outside = if backward { (low < 0).then_some(-1) } else { (high > last).then_some(last + 1) };
    inside.map(|k| k.cast_signed() as i64).or(outside)
}

fn first_one(row: &[u64], low: usize, high: usize, backward: bool) -> Option<usize> {
    let (from, to) = (low / 64, high / 64);
    let bits = |w: usize| {
        let head = if w == from { !0 << (low % 64) } else { !0 };
        let tail = if w == to { !0 >> (63 - high % 64) } else { !0 };
        row[w] & head & tail
    };
    if from == to {
        let word = bits(from);
        let bit = if backward { 63 - word.leading_zeros().min(63) } else { word.trailing_zeros() };
        return (word != 0).then(|| from * 64 + bit as usize);
    }
    if backward {
        let w = (from..=to).rev().find(|&w| bits(w) != 0)?;
        return Some(w * 64 + 63 - bits(w).leading_zeros() as usize);
    }
    let w = (from..=to).find(|&w| bits(w) != 0)?;
    Some(w * 64 + bits(w).trailing_zeros() as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_cspace::RowSpan;
    use proptest::prelude::*;

    const SHAPE: [usize; 3] = [9, 8, 140];

    /// Coordinates, often on borders and at centres of cells.
    fn coordinate(count: usize) -> impl Strategy<Value = f64> {
        let top = count as f64 - 1e-6;
        prop_oneof![1e-6..top, (0..count).prop_map(|k| k as f64 + 0.5), (1..count).prop_map(|k| k as f64)]
    }

    fn point() -> impl Strategy<Value = GridPoint> {
        (coordinate(SHAPE[0]), coordinate(SHAPE[1]), coordinate(SHAPE[2])).prop_map(|(x, y, z)| [x, y, z])
    }

    fn bitmap(cells: &[(u32, u16)]) -> OccupancyBitmap {
        let mut occupancy = OccupancyBitmap::new(SHAPE);
        for &(row, k) in cells {
            occupancy.block(RowSpan { row, first: k, last: k });
        }
        occupancy
    }

    fn is_blocked_at(occupancy: &OccupancyBitmap, p: GridPoint) -> bool {
        occupancy.is_blocked(p.map(|x| x.floor() as u16))
    }

    proptest! {
        /// Dense sampling finds no blocked cell before the reported fraction, and a blocked cell is there.
        #[test]
        fn agrees_with_dense_sampling(a in point(), b in point(), cells in prop::collection::vec((0u32..72, 0u16..140), 0..400)) {
            let occupancy = bitmap(&cells);
            let found = first_blocked(&occupancy, a, b);
            let at = |t: f64| [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * t);
            let sampled = (0..=5000).map(|n| f64::from(n) / 5000.0).find(|&t| is_blocked_at(&occupancy, at(t)));
            if let Some(t) = sampled {
                prop_assert!(found.is_some_and(|f| f <= t + 1e-7), "sampled {t}, found {found:?}");
            }
            if let Some(t) = found {
                // Some cell near the reported point is blocked.
                let p = at(t);
                let near = (0..27).any(|n: i32| {
                    let shift = [n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1];
                    let p = [0, 1, 2].map(|i| p[i] + f64::from(shift[i]) * 1e-6);
                    is_blocked_at(&occupancy, p)
                });
                prop_assert!(near, "nothing blocked at {t}");
            }
        }

        #[test]
        fn a_box_is_free_where_all_its_cells_are(a in point(), b in point(), cells in prop::collection::vec((0u32..72, 0u16..140), 0..8)) {
            let occupancy = bitmap(&cells);
            let (low, high) = ([0, 1, 2].map(|i| a[i].min(b[i])), [0, 1, 2].map(|i| a[i].max(b[i])));
            let touches = |c: [u16; 3]| (0..3).all(|i| {
                let k = f64::from(c[i]);
                k <= high[i] + CELL_TOLERANCE && k + 1.0 >= low[i] - CELL_TOLERANCE
            });
            prop_assert_eq!(box_is_free(&occupancy, low, high), !occupancy.iter().any(touches));
        }
    }

    #[test]
    fn no_line_of_sight_between_blocked_cells_that_share_an_edge() {
        let occupancy = bitmap(&[(0, 1), (8, 0)]); // [0, 0, 1] and [1, 0, 0]
        assert!(!line_of_sight(&occupancy, [0.5, 0.5, 0.5], [1.5, 0.5, 1.5]));
    }

    #[test]
    fn outside_is_blocked() {
        let occupancy = bitmap(&[]);
        assert_eq!(
            first_blocked(&occupancy, [0.5, 0.5, 0.5], [0.5, 0.5, 200.5]).map(|t| t > 0.69 && t < 0.7),
            Some(true)
        );
        assert!(!line_of_sight(&occupancy, [0.5, 0.5, 0.5], [0.5, -0.5, 0.5]));
        assert!(line_of_sight(&occupancy, [0.5, 0.5, 0.5], [8.5, 7.5, 139.5]));
    }
}
