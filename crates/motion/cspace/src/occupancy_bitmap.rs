//! Occupancy as one bit per cell, shared plane by plane.

use std::sync::Arc;

use crate::bits::{ones, set_range};
use crate::{CellIndex, Layer, RowSpan};

/// One bit per cell, 1 for blocked. A row is a whole number of 64-bit words; cell `k` is bit `k % 64` of word `k / 64`.
///
/// Planes (all rows of one θ1) are shared until they are written: a copy costs one counter per plane, and a plane
/// without blocked cells needs no memory of its own.
///
/// ```
/// use elbowroom_cspace::{RowSpan, OccupancyBitmap};
/// let mut occupancy = OccupancyBitmap::new([2, 3, 100]);
/// occupancy.block(RowSpan { row: 4, first: 60, last: 70 }); // θ1 cell 1, θ2 cell 1
/// assert!(occupancy.is_blocked([1, 1, 64]) && !occupancy.is_blocked([1, 1, 71]));
/// assert_eq!(occupancy.blocked(), 11);
/// ```
#[derive(Debug, Clone)]
pub struct OccupancyBitmap {
    shape: [usize; 3],
    words_per_row: usize,
    planes: Vec<Arc<[u64]>>,
    free: Arc<[u64]>,
    /// Mask `n` has the first `n` cells of a row set; empty if rows are long.
    below: Arc<[u64]>,
}

/// Largest number of words of rows that are written with precomputed masks.
const MAX_MASKED_WORDS: usize = 8;

impl OccupancyBitmap {
    /// Creates a bitmap with all cells free, given the numbers of cells along θ1, θ2, θ3.
    pub fn new(shape: [usize; 3]) -> Self {
        let words_per_row = shape[2].div_ceil(64);
        let free: Arc<[u64]> = vec![0; words_per_row * shape[1]].into();
        let cells = if words_per_row <= MAX_MASKED_WORDS { shape[2] + 1 } else { 0 };
        let mut below = vec![0; cells * words_per_row];
        for (count, words) in below.chunks_exact_mut(words_per_row.max(1)).enumerate().skip(1) {
            set_range(words, 0, count as u16 - 1);
        }
        Self { shape, words_per_row, planes: vec![Arc::clone(&free); shape[0]], free, below: below.into() }
    }

    /// Number of cells along each axis.
    pub fn shape(&self) -> [usize; 3] {
        self.shape
    }

    /// Number of 64-bit words of one row.
    pub fn words_per_row(&self) -> usize {
        self.words_per_row
    }

    /// All words of one θ1, row by row; empty beyond the axis.
    pub fn plane(&self, plane: usize) -> &[u64] {
        self.planes.get(plane).map_or(&[], |words| words)
    }

    /// The words of one row; empty beyond the grid.
    pub fn row(&self, row: usize) -> &[u64] {
        let start = row % self.shape[1] * self.words_per_row;
        self.plane(row / self.shape[1]).get(start..start + self.words_per_row).unwrap_or(&[])
    }

    /// Whether the cell is blocked. A cell outside the grid counts as blocked, because its state is unknown.
    pub fn is_blocked(&self, cell: CellIndex) -> bool {
        let [i, j, k] = cell.map(usize::from);
        if i >= self.shape[0] || j >= self.shape[1] || k >= self.shape[2] {
            return true;
        }
        self.planes[i][j * self.words_per_row + k / 64] >> (k % 64) & 1 == 1
    }

    /// Number of blocked cells.
    pub fn blocked(&self) -> usize {
        let ones = |plane: &Arc<[u64]>| plane.iter().map(|w| w.count_ones() as usize).sum::<usize>();
        self.planes.iter().filter(|plane| !Arc::ptr_eq(plane, &self.free)).map(ones).sum()
    }

    /// Frees every cell.
    pub fn clear(&mut self) {
        for plane in &mut self.planes {
            if Arc::ptr_eq(plane, &self.free) {
                continue;
            }
            match Arc::get_mut(plane) {
                Some(words) => words.fill(0),
                None => *plane = Arc::clone(&self.free),
            }
        }
    }

    /// Blocks the cells of one span; ignores cells outside the grid.
    pub fn block(&mut self, span: RowSpan) {
        self.mark(std::slice::from_ref(&span));
    }

    /// Blocks the cells of a layer.
    pub fn add(&mut self, layer: &Layer) {
        self.mark(layer.spans());
    }

    /// Blocks the cells that are blocked in another table of the same shape.
    ///
    /// # Panics
    /// The shapes differ.
    pub fn add_table(&mut self, other: &Self) {
        assert_eq!(self.shape, other.shape, "tables of one shape");
        for (plane, added) in self.planes.iter_mut().zip(&other.planes) {
            if Arc::ptr_eq(added, &other.free) || Arc::ptr_eq(plane, added) {
                continue;
            }
            Arc::make_mut(plane).iter_mut().zip(&**added).for_each(|(word, more)| *word |= more);
        }
    }

    fn mark(&mut self, spans: &[RowSpan]) {
        let (rows, width) = (self.shape[1], self.words_per_row);
        let mut rest = spans;
        while let Some(first) = rest.first() {
            let plane = first.row as usize / rows;
            let end = ((plane + 1) * rows) as u32;
            let count = rest.iter().take_while(|span| span.row < end).count();
            let (here, later) = rest.split_at(count.max(1));
            rest = later;
            let Some(words) = self.planes.get_mut(plane).map(Arc::make_mut) else { continue };
            let first = (plane * rows) as u32;
            match width {
                1 => mark_spans::<1>(words, Masks(self.below.as_chunks().0), first, here),
                2 => mark_spans::<2>(words, Masks(self.below.as_chunks().0), first, here),
                3 => mark_spans::<3>(words, Masks(self.below.as_chunks().0), first, here),
                4 => mark_spans::<4>(words, Masks(self.below.as_chunks().0), first, here),
                5 => mark_spans::<5>(words, Masks(self.below.as_chunks().0), first, here),
                6 => mark_spans::<6>(words, Masks(self.below.as_chunks().0), first, here),
                7 => mark_spans::<7>(words, Masks(self.below.as_chunks().0), first, here),
                8 => mark_spans::<8>(words, Masks(self.below.as_chunks().0), first, here),
                _ => {
                    for span in here {
                        let row = span.row as usize - plane * rows;
                        let last = span.last.min(self.shape[2] as u16 - 1);
                        set_range(&mut words[row * width..][..width], span.first, last);
                    }
                }
            }
        }
    }

    /// Masks of rows of `W` words.
    pub(crate) fn masks<const W: usize>(&self) -> Masks<'_, W> {
        Masks(self.below.as_chunks().0)
    }

    /// All words of one θ1, no longer shared, for writing. Empty beyond the axis.
    pub(crate) fn plane_mut(&mut self, plane: usize) -> &mut [u64] {
        self.planes.get_mut(plane).map_or(&mut [], |words| Arc::make_mut(words))
    }

    /// Whether the two bitmaps have the same plane in memory.
    pub(crate) fn shares(&self, other: &Self, plane: usize) -> bool {
        match (self.planes.get(plane), other.planes.get(plane)) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }

    /// Iterates over the blocked cells in order.
    pub fn iter(&self) -> impl Iterator<Item = CellIndex> + '_ {
        (0..self.shape[0] * self.shape[1]).flat_map(move |row| {
            let (i, j) = ((row / self.shape[1]) as u16, (row % self.shape[1]) as u16);
            let words = self.row(row).iter().enumerate();
            words.flat_map(|(w, &word)| ones(word).map(move |bit| (w * 64 + bit) as u16)).map(move |k| [i, j, k])
        })
    }
}

impl PartialEq for OccupancyBitmap {
    fn eq(&self, other: &Self) -> bool {
        self.shape == other.shape && self.planes == other.planes
    }
}

/// Masks of rows of `W` words: mask `n` has the first `n` cells set.
#[derive(Clone, Copy)]
pub(crate) struct Masks<'a, const W: usize>(&'a [[u64; W]]);

impl<const W: usize> Masks<'_, W> {
    /// Sets the cells of a span in a row; ignores cells outside the grid.
    #[inline]
    pub fn mark(self, row: &mut [u64; W], span: RowSpan) {
        let end = self.0.len().saturating_sub(1);
        let (from, to) = (usize::from(span.first).min(end), (usize::from(span.last) + 1).min(end));
        let (from, to) = (&self.0[from], &self.0[to]);
        for w in 0..W {
            row[w] |= to[w] & !from[w];
        }
    }
}

/// Sets the cells of spans in the words of a plane, `W` per row, whose first row is `first`.
#[inline]
fn mark_spans<const W: usize>(words: &mut [u64], masks: Masks<'_, W>, first: u32, spans: &[RowSpan]) {
    let rows = words.as_chunks_mut::<W>().0;
    for &span in spans {
        masks.mark(&mut rows[(span.row - first) as usize], span);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_is_not_changed_by_later_writes() {
        let mut occupancy = OccupancyBitmap::new([4, 4, 70]);
        occupancy.block(RowSpan { row: 5, first: 0, last: 69 });
        let before = occupancy.clone();
        occupancy.block(RowSpan { row: 6, first: 3, last: 3 });
        assert_eq!((before.blocked(), occupancy.blocked()), (70, 71));
        occupancy.clear();
        assert_eq!((before.blocked(), occupancy.blocked()), (70, 0));
    }

    #[test]
    fn cells_outside_the_grid_are_left_out() {
        let mut occupancy = OccupancyBitmap::new([2, 2, 10]);
        occupancy.block(RowSpan { row: 4, first: 0, last: 3 });
        occupancy.block(RowSpan { row: 3, first: 8, last: 200 });
        assert_eq!(occupancy.iter().collect::<Vec<_>>(), [[1, 1, 8], [1, 1, 9]]);
        assert!(occupancy.is_blocked([2, 0, 0]) && occupancy.is_blocked([0, 0, 10]));
    }
}
