//! Changes of occupancy, cell by cell.

use crate::bits::ones;
use crate::{CellIndex, OccupancyBitmap};

/// One word of a row before and after an update.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ChangedWord {
    row: u32,
    index: u16,
    was: u64,
    now: u64,
}

/// The cells that an update blocked and freed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CellChanges {
    rows_per_plane: u32,
    words: Vec<ChangedWord>,
}

impl CellChanges {
    pub(crate) fn reset(&mut self, shape: [usize; 3]) {
        self.rows_per_plane = shape[1] as u32;
        self.words.clear();
    }

    /// Records a row before and after an update.
    #[inline]
    pub(crate) fn record_row(&mut self, row: usize, was: &[u64], now: &[u64]) {
        for index in 0..was.len().min(now.len()) {
            let (was, now) = (was[index], now[index]);
            if was != now {
                self.words.push(ChangedWord { row: row as u32, index: index as u16, was, now });
            }
        }
    }

    /// Computes the differences between two bitmaps of the same shape; skips shared planes.
    ///
    /// ```
    /// use elbowroom_cspace::{CellChanges, OccupancyBitmap, RowSpan};
    /// let old = OccupancyBitmap::new([3, 3, 10]);
    /// let mut new = old.clone();
    /// new.block(RowSpan { row: 4, first: 2, last: 3 });
    /// let changes = CellChanges::between(&old, &new);
    /// assert_eq!(changes.iter().collect::<Vec<_>>(), [([1, 1, 2], true), ([1, 1, 3], true)]);
    /// ```
    pub fn between(old: &OccupancyBitmap, new: &OccupancyBitmap) -> Self {
        let mut changes = Self::default();
        changes.reset(new.shape());
        let (rows, width) = (new.shape()[1], new.words_per_row().max(1));
        for plane in (0..new.shape()[0]).filter(|&plane| !old.shares(new, plane)) {
            let (was, now) = (old.plane(plane).chunks_exact(width), new.plane(plane).chunks_exact(width));
            for (row, (was, now)) in was.zip(now).enumerate() {
                changes.record_row(plane * rows + row, was, now);
            }
        }
        changes
    }

    /// Whether no cell changed.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// Number of cells that became blocked.
    pub fn blocked(&self) -> usize {
        self.words.iter().map(|w| (w.now & !w.was).count_ones() as usize).sum()
    }

    /// Number of cells that became free.
    pub fn freed(&self) -> usize {
        self.words.iter().map(|w| (w.was & !w.now).count_ones() as usize).sum()
    }

    /// Iterates over the changed cells in order, with whether each is blocked now.
    pub fn iter(&self) -> impl Iterator<Item = (CellIndex, bool)> + '_ {
        self.words.iter().flat_map(move |w| {
            let (plane, row) = (w.row / self.rows_per_plane, w.row % self.rows_per_plane);
            ones(w.was ^ w.now).map(move |bit| {
                let cell = usize::from(w.index) * 64 + bit;
                ([plane as u16, row as u16, cell as u16], w.now >> bit & 1 == 1)
            })
        })
    }
}
