//! Line of sight: all cells that a straight segment touches, row by row.

use elbowroom_cspace::OccupancyBitmap;

use crate::grid_space::GridPoint;

/// Enlargement of cells on every side, in cell widths: a segment along a border or through a corner touches all cells
/// that meet there, independent of rounding. Smaller than the inset of path ends from borders.
const CELL_TOLERANCE: f64 = 5e-10;
/// Motion along an axis, in cell widths, below which a segment counts as not moving along it: the inverse would be
/// infinite.
const MIN_MOTION: f64 = 1e-300;

/// Whether all cells that the segment touches are free; cells outside the grid count as blocked.
pub(crate) fn line_of_sight(occupancy: &OccupancyBitmap, a: GridPoint, b: GridPoint) -> bool {
    let line = Line::new(a, b);
    line.cells(0, (0.0, 1.0)).all(|i| {
        let along_i = line.part(0, i, (0.0, 1.0));
        let plane = usize::try_from(i).map_or(&[][..], |i| occupancy.plane(i));
        line.cells(1, along_i).all(|j| {
            let (low, high) = line.range(2, line.part(1, j, along_i));
            cells_are_free(row_of(occupancy, plane, j), occupancy.shape()[2], low, high)
        })
    })
}

/// Whether all cells that a box touches are free.
pub(crate) fn box_is_free(occupancy: &OccupancyBitmap, low: GridPoint, high: GridPoint) -> bool {
    let range = |axis: usize| floor(low[axis] - CELL_TOLERANCE)..=floor(high[axis] + CELL_TOLERANCE);
    let (first, last) = (*range(2).start(), *range(2).end());
    range(0).all(|i| {
        let plane = usize::try_from(i).map_or(&[][..], |i| occupancy.plane(i));
        range(1).all(|j| cells_are_free(row_of(occupancy, plane, j), occupancy.shape()[2], first, last))
    })
}

/// A row of a plane; outside the grid it is empty, which counts as blocked.
fn row_of<'t>(occupancy: &OccupancyBitmap, plane: &'t [u64], row: i64) -> &'t [u64] {
    let width = occupancy.words_per_row();
    usize::try_from(row).ok().and_then(|j| plane.get(j * width..(j + 1) * width)).unwrap_or(&[])
}

/// Rounds down without a library call, unlike `f64::floor` on many processors.
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

    /// First and last cell along an axis that a part of the line touches.
    fn range(&self, axis: usize, (from, to): (f64, f64)) -> (i64, i64) {
        let (start, end) = (self.at(axis, from), self.at(axis, to));
        (floor(start.min(end) - CELL_TOLERANCE), floor(start.max(end) + CELL_TOLERANCE))
    }

    /// The cells along an axis that a part of the line touches, in the direction of the line.
    fn cells(&self, axis: usize, part: (f64, f64)) -> impl Iterator<Item = i64> + use<> {
        let (low, high) = self.range(axis, part);
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
}

/// Whether the cells `low..=high` of a row are free; cells outside the row count as blocked.
fn cells_are_free(row: &[u64], count: usize, low: i64, high: i64) -> bool {
    if row.is_empty() || low < 0 || high >= count.cast_signed() as i64 {
        return false;
    }
    let (low, high) = (low as usize, high as usize);
    let (from, to) = (low / 64, high / 64);
    let (head, tail) = (!0 << (low % 64), !0 >> (63 - high % 64));
    if from == to {
        return row[from] & head & tail == 0;
    }
    row[from] & head == 0 && row[to] & tail == 0 && row[from + 1..to].iter().all(|word| *word == 0)
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

    proptest! {
        /// Compares with a test of all blocked cells one by one: the segment enters and leaves the slab of each axis.
        #[test]
        fn agrees_with_a_test_of_every_blocked_cell(a in point(), b in point(), cells in prop::collection::vec((0u32..72, 0u16..140), 0..400)) {
            let occupancy = bitmap(&cells);
            let touches = |cell: [u16; 3], tolerance: f64| {
                let mut part = (0.0, 1.0);
                for i in 0..3 {
                    let (low, high) = (f64::from(cell[i]) - tolerance, f64::from(cell[i]) + 1.0 + tolerance);
                    let d = b[i] - a[i];
                    if d == 0.0 {
                        if a[i] < low || a[i] > high {
                            return false;
                        }
                        continue;
                    }
                    let (from, to) = ((low - a[i]) / d, (high - a[i]) / d);
                    part = (f64::max(part.0, from.min(to)), f64::min(part.1, from.max(to)));
                }
                part.0 <= part.1
            };
            let is_free = line_of_sight(&occupancy, a, b);
            if occupancy.iter().any(|cell| touches(cell, 0.0)) {
                prop_assert!(!is_free);
            }
            if !occupancy.iter().any(|cell| touches(cell, 1e-6)) {
                prop_assert!(is_free);
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
        assert!(!line_of_sight(&occupancy, [0.5, 0.5, 0.5], [0.5, 0.5, 200.5]));
        assert!(!line_of_sight(&occupancy, [0.5, 0.5, 0.5], [0.5, -0.5, 0.5]));
        assert!(line_of_sight(&occupancy, [0.5, 0.5, 0.5], [8.5, 7.5, 139.5]));
    }
}
