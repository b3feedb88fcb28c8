//! What one obstacle blocks, as intervals of rows.

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

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        self.spans.capacity() * size_of::<Span>()
    }
}

/// Takes the spans of one row from the front of a list, and those of earlier rows with them.
pub(crate) fn group<'a>(spans: &mut &'a [Span], row: u32) -> &'a [Span] {
    let skip = spans.iter().take_while(|span| span.row < row).count();
    let rest = &spans[skip..];
    let (here, later) = rest.split_at(rest.iter().take_while(|span| span.row == row).count());
    *spans = later;
    here
}
