//! What one obstacle blocks, as intervals of rows.

use crate::table::mark_row;

/// Blocked cells `first..=last` of one row; `row` counts θ1 · (cells of θ2) + θ2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Span {
    /// Number of the row.
    pub row: u32,
    /// First blocked cell.
    pub first: u16,
    /// Last blocked cell.
    pub last: u16,
}

/// What one obstacle blocks: spans in the order of their rows; several in one row may overlap.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Layer {
    pub(crate) spans: Vec<Span>,
}

impl Layer {
    /// A layer that blocks nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// The spans, rows ascending.
    pub fn spans(&self) -> &[Span] {
        &self.spans
    }

    /// Adds all that another layer blocks.
    pub fn merge(&mut self, other: &Self) {
        let whole = self.spans.last().zip(other.spans.first()).is_none_or(|(a, b)| a.row <= b.row);
        self.spans.extend_from_slice(&other.spans);
        if !whole {
            self.spans.sort_unstable();
        }
    }

    /// Keeps what another layer blocks too. `cells` is the number of cells of a row.
    pub fn intersect(&mut self, other: &Self, cells: usize) {
        let mut kept = Vec::with_capacity(self.spans.len().min(other.spans.len()));
        let (mut a, mut b) = (self.spans.as_slice(), other.spans.as_slice());
        let mut words = [vec![0u64; cells.div_ceil(64)], vec![0u64; cells.div_ceil(64)]];
        while let (Some(x), Some(y)) = (a.first(), b.first()) {
            let row = x.row.max(y.row);
            let (here, there) = (group(&mut a, row), group(&mut b, row));
            if here.is_empty() || there.is_empty() {
                continue;
            }
            for (list, spans) in words.iter_mut().zip([here, there]) {
                list.fill(0);
                for span in spans {
                    mark_row(list, span.first, span.last.min(cells as u16 - 1));
                }
            }
            let both: Vec<u64> = words[0].iter().zip(&words[1]).map(|(a, b)| a & b).collect();
            runs(&both, |first, last| kept.push(Span { row, first, last }));
        }
        self.spans = kept;
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        self.spans.capacity() * size_of::<Span>()
    }
}

/// Takes the spans of one row from the front of a list, and those of earlier rows with them.
#[inline]
pub(crate) fn group<'a>(spans: &mut &'a [Span], row: u32) -> &'a [Span] {
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
    let (here, later) = rest.split_at(count);
    *spans = later;
    here
}

/// Runs of bits that are set.
fn runs(words: &[u64], mut found: impl FnMut(u16, u16)) {
    let bit = |k: usize| words.get(k / 64).is_some_and(|w| w >> (k % 64) & 1 == 1);
    let mut k = 0;
    while k < words.len() * 64 {
        if words[k / 64] >> (k % 64) == 0 {
            k = (k / 64 + 1) * 64;
        } else if bit(k) {
            let first = k;
            while bit(k) {
                k += 1;
            }
            found(first as u16, (k - 1) as u16);
        } else {
            k += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_both_block_is_kept() {
        let span = |row, first, last| Span { row, first, last };
        let mut a = Layer { spans: vec![span(1, 0, 5), span(2, 60, 130), span(2, 140, 150), span(4, 0, 9)] };
        let b = Layer { spans: vec![span(0, 0, 150), span(2, 0, 62), span(2, 128, 145), span(4, 9, 9), span(5, 1, 1)] };
        a.intersect(&b, 151);
        assert_eq!(a.spans, [span(2, 60, 62), span(2, 128, 130), span(2, 140, 145), span(4, 9, 9)]);
    }
}
