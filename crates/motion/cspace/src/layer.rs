//! The cells that one obstacle blocks, as spans of rows.

use crate::bits::{for_each_run, set_range};

/// Blocked cells `first..=last` of one row; `row` counts θ1 · (cells of θ2) + θ2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct RowSpan {
    /// Index of the row.
    pub row: u32,
    /// First blocked cell.
    pub first: u16,
    /// Last blocked cell.
    pub last: u16,
}

/// The cells that one obstacle blocks: spans sorted by row; spans of one row may overlap.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Layer {
    pub(crate) spans: Vec<RowSpan>,
}

impl Layer {
    /// Creates a layer without blocked cells.
    pub fn new() -> Self {
        Self::default()
    }

    /// The spans, sorted by row.
    pub fn spans(&self) -> &[RowSpan] {
        &self.spans
    }

    /// Keeps only the cells that another layer also blocks. `cells` is the number of cells of a row.
    pub fn intersect(&mut self, other: &Self, cells: usize) {
        let mut kept = Vec::with_capacity(self.spans.len().min(other.spans.len()));
        let (mut a, mut b) = (self.spans.as_slice(), other.spans.as_slice());
        let mut words = [vec![0u64; cells.div_ceil(64)], vec![0u64; cells.div_ceil(64)]];
        while let (Some(x), Some(y)) = (a.first(), b.first()) {
            let row = x.row.max(y.row);
            let (in_a, in_b) = (take_row(&mut a, row), take_row(&mut b, row));
            if in_a.is_empty() || in_b.is_empty() {
                continue;
            }
            for (list, spans) in words.iter_mut().zip([in_a, in_b]) {
                list.fill(0);
                for span in spans {
                    set_range(list, span.first, span.last.min(cells as u16 - 1));
                }
            }
            let both: Vec<u64> = words[0].iter().zip(&words[1]).map(|(a, b)| a & b).collect();
            for_each_run(&both, |first, last| kept.push(RowSpan { row, first, last }));
        }
        self.spans = kept;
    }

    /// Memory on the heap, bytes.
    pub fn bytes(&self) -> usize {
        self.spans.capacity() * size_of::<RowSpan>()
    }
}

/// Removes the spans of one row and of earlier rows from the front of a list; returns the spans of the row.
#[inline]
pub(crate) fn take_row<'a>(spans: &mut &'a [RowSpan], row: u32) -> &'a [RowSpan] {
    let mut rest = *spans;
    while let [first, later @ ..] = rest
        && first.row < row
    {
        rest = later;
    }
    let mut count = 0;
    while rest.get(count).is_some_and(|span| span.row == row) {
        count += 1;
    }
    let (taken, later) = rest.split_at(count);
    *spans = later;
    taken
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_intersection_is_kept() {
        let span = |row, first, last| RowSpan { row, first, last };
        let mut a = Layer { spans: vec![span(1, 0, 5), span(2, 60, 130), span(2, 140, 150), span(4, 0, 9)] };
        let b = Layer { spans: vec![span(0, 0, 150), span(2, 0, 62), span(2, 128, 145), span(4, 9, 9), span(5, 1, 1)] };
        a.intersect(&b, 151);
        assert_eq!(a.spans, [span(2, 60, 62), span(2, 128, 130), span(2, 140, 145), span(4, 9, 9)]);
    }
}
