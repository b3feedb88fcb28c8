//! Every cell that a straight stretch touches, row by row.

use elbowroom_cspace::Table;

use crate::space::Point;

/// Cells are this much wider on every side, in widths of cells, than they are: a stretch along a border or through a
/// corner touches all that meet there, whatever rounding says. Less than what ends are drawn in from borders.
const WIDER: f64 = 5e-10;

/// True where no cell that the stretch touches is blocked.
pub(crate) fn is_clear(table: &Table, a: Point, b: Point) -> bool {
    let mut clear = true;
    walk(table, a, b, |_| {
        clear = false;
        true
    });
    clear
}

/// The fraction of the stretch after which it first touches a blocked cell or leaves the table.
pub(crate) fn first_blocked(table: &Table, a: Point, b: Point) -> Option<f64> {
    // A stretch along a border is in several rows at once: the first row need not have the first cell.
    let mut first: Option<f64> = None;
    walk(table, a, b, |t| {
        first = Some(first.map_or(t, |f| f.min(t)));
        false
    });
    first
}

/// Tells, row by row, where the stretch first touches something blocked, until told to stop.
fn walk(table: &Table, a: Point, b: Point, mut blocked: impl FnMut(f64) -> bool) {
    let line = Line::new(a, b);
    for i in line.cells(0, (0.0, 1.0)) {
        let along_i = line.part(0, i, (0.0, 1.0));
        let plane = usize::try_from(i).map_or(&[][..], |i| table.plane(i));
        for j in line.cells(1, along_i) {
            let along_j = line.part(1, j, along_i);
            let hit = line.blocked_in_row(row_of(table, plane, j), table.shape()[2], along_j);
            if hit.is_some_and(&mut blocked) {
                return;
            }
        }
    }
}

/// True where all cells that the box between two corners touches are free.
pub(crate) fn box_is_free(table: &Table, low: Point, high: Point) -> bool {
    let range = |axis: usize| floor(low[axis] - WIDER)..=floor(high[axis] + WIDER);
    let (first, last) = (*range(2).start(), *range(2).end());
    range(0).all(|i| {
        let plane = usize::try_from(i).map_or(&[][..], |i| table.plane(i));
        range(1).all(|j| first_in_row(row_of(table, plane, j), table.shape()[2], first, last, false).is_none())
    })
}

/// A row of a plane; empty, which is blocked, outside.
fn row_of<'t>(table: &Table, plane: &'t [u64], row: i64) -> &'t [u64] {
    let width = table.words_per_row();
    usize::try_from(row).ok().and_then(|j| plane.get(j * width..(j + 1) * width)).unwrap_or(&[])
}

/// Without a call into a library, which `f64::floor` is on many processors.
#[inline]
fn floor(value: f64) -> i64 {
    let whole = value as i64;
    whole - i64::from(value < whole as f64)
}

struct Line {
    a: Point,
    d: Point,
    /// 1 / d; 0 along an axis on which nothing moves.
    inverse: Point,
}

impl Line {
    fn new(a: Point, b: Point) -> Self {
        let d = [b[0] - a[0], b[1] - a[1], b[2] - a[2]].map(|d: f64| if d.abs() < 1e-300 { 0.0 } else { d });
        Self { a, d, inverse: d.map(|d| if d == 0.0 { 0.0 } else { 1.0 / d }) }
    }

    fn at(&self, axis: usize, t: f64) -> f64 {
        self.a[axis] + self.d[axis] * t
    }

    /// Cells along an axis that a part of the line touches, in the order in which it comes to them.
    fn cells(&self, axis: usize, (from, to): (f64, f64)) -> impl Iterator<Item = i64> + use<> {
        let (start, end) = (self.at(axis, from), self.at(axis, to));
        let (low, high) = (floor(start.min(end) - WIDER), floor(start.max(end) + WIDER));
        let backward = self.d[axis] < 0.0;
        (0..=high - low).map(move |n| if backward { high - n } else { low + n })
    }

    /// The part of a part that lies in a cell's slab.
    fn part(&self, axis: usize, cell: i64, (from, to): (f64, f64)) -> (f64, f64) {
        if self.d[axis] == 0.0 {
            return (from, to);
        }
        let low = (cell as f64 - WIDER - self.a[axis]) * self.inverse[axis];
        let high = ((cell + 1) as f64 + WIDER - self.a[axis]) * self.inverse[axis];
        (low.min(high).clamp(from, to), low.max(high).clamp(from, to))
    }

    fn blocked_in_row(&self, row: &[u64], count: usize, (from, to): (f64, f64)) -> Option<f64> {
        let (start, end) = (self.at(2, from), self.at(2, to));
        let (low, high) = (floor(start.min(end) - WIDER), floor(start.max(end) + WIDER));
        let d = self.d[2];
        let cell = first_in_row(row, count, low, high, d < 0.0)?;
        let border = if d < 0.0 { (cell + 1) as f64 + WIDER } else { cell as f64 - WIDER };
        Some(if d == 0.0 { from } else { ((border - self.a[2]) / d).clamp(from, to) })
    }
}

/// The first blocked cell of `low..=high`, from the high end where asked. What is outside the row is blocked.
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
    use elbowroom_cspace::Span;
    use proptest::prelude::*;

    const SHAPE: [usize; 3] = [9, 8, 140];

    /// Points that prefer borders and middles of cells.
    fn coordinate(count: usize) -> impl Strategy<Value = f64> {
        let top = count as f64 - 1e-6;
        prop_oneof![1e-6..top, (0..count).prop_map(|k| k as f64 + 0.5), (1..count).prop_map(|k| k as f64)]
    }

    fn point() -> impl Strategy<Value = Point> {
        (coordinate(SHAPE[0]), coordinate(SHAPE[1]), coordinate(SHAPE[2])).prop_map(|(x, y, z)| [x, y, z])
    }

    fn table(cells: &[(u32, u16)]) -> Table {
        let mut table = Table::new(SHAPE);
        for &(row, k) in cells {
            table.block(Span { row, first: k, last: k });
        }
        table
    }

    fn is_blocked_at(table: &Table, p: Point) -> bool {
        table.is_blocked(p.map(|x| x.floor() as u16))
    }

    proptest! {
        /// Dense sampling never meets a blocked cell before the walk says so, and what the walk names is blocked.
        #[test]
        fn agrees_with_dense_sampling(a in point(), b in point(), cells in prop::collection::vec((0u32..72, 0u16..140), 0..400)) {
            let table = table(&cells);
            let found = first_blocked(&table, a, b);
            let at = |t: f64| [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * t);
            let sampled = (0..=5000).map(|n| f64::from(n) / 5000.0).find(|&t| is_blocked_at(&table, at(t)));
            if let Some(t) = sampled {
                prop_assert!(found.is_some_and(|f| f <= t + 1e-7), "sampled {t}, found {found:?}");
            }
            if let Some(t) = found {
                // Within a hair of the named point some blocked cell is touched.
                let p = at(t);
                let near = (0..27).any(|n: i32| {
                    let shift = [n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1];
                    let p = [0, 1, 2].map(|i| p[i] + f64::from(shift[i]) * 1e-6);
                    is_blocked_at(&table, p)
                });
                prop_assert!(near, "nothing blocked at {t}");
            }
        }

        #[test]
        fn a_box_is_free_where_each_cell_is(a in point(), b in point(), cells in prop::collection::vec((0u32..72, 0u16..140), 0..8)) {
            let table = table(&cells);
            let (low, high) = ([0, 1, 2].map(|i| a[i].min(b[i])), [0, 1, 2].map(|i| a[i].max(b[i])));
            let touches = |c: [u16; 3]| (0..3).all(|i| {
                let k = f64::from(c[i]);
                k <= high[i] + WIDER && k + 1.0 >= low[i] - WIDER
            });
            prop_assert_eq!(box_is_free(&table, low, high), !table.iter().any(touches));
        }
    }

    #[test]
    fn between_two_blocked_cells_that_meet_at_an_edge_there_is_no_way() {
        let table = table(&[(0, 1), (8, 0)]); // [0, 0, 1] and [1, 0, 0]
        assert!(!is_clear(&table, [0.5, 0.5, 0.5], [1.5, 0.5, 1.5]));
    }

    #[test]
    fn outside_is_blocked() {
        let table = table(&[]);
        assert_eq!(first_blocked(&table, [0.5, 0.5, 0.5], [0.5, 0.5, 200.5]).map(|t| t > 0.69 && t < 0.7), Some(true));
        assert!(!is_clear(&table, [0.5, 0.5, 0.5], [0.5, -0.5, 0.5]));
        assert!(is_clear(&table, [0.5, 0.5, 0.5], [8.5, 7.5, 139.5]));
    }
}
