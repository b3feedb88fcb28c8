//! Blocked cells as bits during the computation of a layer: a row of bits along the axis in lanes.

use rayon::prelude::*;

use super::axis_roles::AxisRoles;
use crate::bits::{for_each_run, set_range};
use crate::{Layer, RowSpan};

/// One bit per computed cell.
#[derive(Debug, Clone)]
pub(super) struct CellBits {
    roles: AxisRoles,
    words_per_row: usize,
    words: Vec<u64>,
}

/// A run of cells of the axis in lanes, in a box of the two other axes; ends excluded.
#[derive(Debug, Clone, Copy)]
pub(super) struct CellBox {
    pub lanes: [usize; 2],
    pub others: [[usize; 2]; 2],
}

impl CellBits {
    pub fn new(roles: AxisRoles) -> Self {
        let words_per_row = roles.lane_count().div_ceil(64);
        let [first, second] = roles.other_counts();
        Self { roles, words_per_row, words: vec![0; first * second * words_per_row] }
    }

    /// All rows.
    pub fn all(&mut self) -> CellRows<'_> {
        let rows = self.roles.other_counts()[0];
        CellRows { roles: self.roles, words_per_row: self.words_per_row, rows: [0, rows], words: &mut self.words }
    }

    /// The rows in strips of so many values of the first of the two other axes, each for one thread.
    pub fn strips(&mut self, size: usize) -> impl IndexedParallelIterator<Item = CellRows<'_>> {
        let Self { roles, words_per_row, words } = self;
        let (roles, words_per_row, [first, second]) = (*roles, *words_per_row, roles.other_counts());
        let strips = words.par_chunks_mut(size * second * words_per_row).enumerate();
        strips.map(move |(strip, words)| {
            let rows = [strip * size, ((strip + 1) * size).min(first)];
            CellRows { roles, words_per_row, rows, words }
        })
    }

    /// Sets the same cells of the axis in lanes in a box of the two other axes; ends are excluded, cells beyond the
    /// axes are ignored.
    pub fn add_lanes(&mut self, lanes: &[u64], others: [[usize; 2]; 2]) {
        let counts = self.roles.other_counts();
        for i in others[0][0]..others[0][1].min(counts[0]) {
            for j in others[1][0]..others[1][1].min(counts[1]) {
                self.row_mut([i, j]).iter_mut().zip(lanes).for_each(|(word, add)| *word |= add);
            }
        }
    }

    #[inline]
    fn row_mut(&mut self, [i, j]: [usize; 2]) -> &mut [u64] {
        let row = (i * self.roles.other_counts()[1] + j) * self.words_per_row;
        &mut self.words[row..row + self.words_per_row]
    }

    /// Converts the bits to the layer of a grid with at least as many cells: cells beyond the computed ones repeat
    /// them.
    pub fn to_layer(&self, shape: [usize; 3]) -> Layer {
        let rows = self.rows_of_last_axis();
        let counts = self.roles.counts;
        let words_per_row = counts[2].div_ceil(64);
        let mut spans = Vec::new();
        let mut longer = vec![0; shape[2].div_ceil(64)];
        for i in 0..shape[0] {
            for j in 0..shape[1] {
                let source = (i % counts[0]) * counts[1] + j % counts[1];
                let words = &rows[source * words_per_row..(source + 1) * words_per_row];
                if words.iter().all(|&w| w == 0) {
                    continue;
                }
                let row = (i * shape[1] + j) as u32;
                let words = if counts[2] < shape[2] {
                    repeat(&mut longer, words, counts[2], shape[2]);
                    &longer
                } else {
                    words
                };
                for_each_run(words, |first, last| spans.push(RowSpan { row, first, last }));
            }
        }
        Layer { spans }
    }

    /// The bits, in rows along the last axis.
    fn rows_of_last_axis(&self) -> std::borrow::Cow<'_, [u64]> {
        if self.roles.lanes == 2 {
            return (&self.words).into();
        }
        let counts = self.roles.counts;
        let words_per_row = counts[2].div_ceil(64);
        let mut rows = vec![0; counts[0] * counts[1] * words_per_row];
        // The axis in lanes is one of the first two axes; the last axis is the second of the others.
        let [planes, along] = self.roles.other_counts();
        for plane in 0..planes {
            let bits = &self.words[plane * along * self.words_per_row..][..along * self.words_per_row];
            for from in 0..self.words_per_row {
                for to in 0..words_per_row {
                    let mut block = [0; 64];
                    for (k, word) in block.iter_mut().enumerate().take(along - 64 * to) {
                        *word = bits[(64 * to + k) * self.words_per_row + from];
                    }
                    if block.iter().all(|&w| w == 0) {
                        continue;
                    }
                    transpose(&mut block);
                    for (k, word) in block.iter().enumerate().take(self.roles.lane_count() - 64 * from) {
                        let lane = 64 * from + k;
                        let [i, j] = if self.roles.lanes == 0 { [lane, plane] } else { [plane, lane] };
                        rows[(i * counts[1] + j) * words_per_row + to] = *word;
                    }
                }
            }
        }
        rows.into()
    }
}

/// Rows of bits for some values of the first of the two other axes.
#[derive(Debug)]
pub(super) struct CellRows<'b> {
    roles: AxisRoles,
    words_per_row: usize,
    /// First value and the one after the last.
    rows: [usize; 2],
    words: &'b mut [u64],
}

impl CellRows<'_> {
    /// Sets cells; ignores cells beyond the axes, and other rows.
    pub fn set(&mut self, cells: &CellBox) {
        let last = cells.lanes[1].min(self.roles.lane_count());
        if cells.lanes[0] >= last {
            return;
        }
        for i in cells.others[0][0].max(self.rows[0])..cells.others[0][1].min(self.rows[1]) {
            for j in cells.others[1][0]..cells.others[1][1].min(self.roles.other_counts()[1]) {
                let row = self.row([i, j]);
                set_range(&mut self.words[row..row + self.words_per_row], cells.lanes[0] as u16, last as u16 - 1);
            }
        }
    }

    /// Sets some of sixteen cells of a row, all within the axis.
    #[inline]
    pub fn set_sixteen(&mut self, others: [usize; 2], group: usize, lanes: u32) {
        let row = self.row(others);
        self.words[row + group / 4] |= u64::from(lanes) << (16 * (group % 4));
    }

    /// Returns, for sixteen cells of a row, whether they are set.
    #[inline]
    pub fn sixteen(&self, others: [usize; 2], group: usize) -> u32 {
        (self.words[self.row(others) + group / 4] >> (16 * (group % 4))) as u32 & 0xffff
    }

    /// Where a row begins.
    #[inline]
    fn row(&self, [i, j]: [usize; 2]) -> usize {
        ((i - self.rows[0]) * self.roles.other_counts()[1] + j) * self.words_per_row
    }
}

/// Transposes 64 × 64 bits: exchanges bit `j` of word `i` with bit `i` of word `j` (Warren, *Hacker's Delight*, 7-3).
fn transpose(block: &mut [u64; 64]) {
    let (mut width, mut mask) = (32, 0x0000_0000_ffff_ffff_u64);
    while width != 0 {
        let mut k = 0;
        while k < 64 {
            let swapped = (block[k] >> width ^ block[k + width]) & mask;
            block[k] ^= swapped << width;
            block[k + width] ^= swapped;
            k = (k + width + 1) & !width;
        }
        width >>= 1;
        mask ^= mask << width;
    }
}

/// Repeats the first `period` bits of a row.
fn repeat(row: &mut [u64], words: &[u64], period: usize, count: usize) {
    row.fill(0);
    for_each_run(words, |first, last| {
        let (mut first, mut last) = (usize::from(first), usize::from(last));
        while first < count {
            set_range(row, first as u16, last.min(count - 1) as u16);
            (first, last) = (first + period, last + period);
        }
    });
}

#[cfg(test)]
mod tests {
    use elbowroom_testkit::random::linear_congruential;

    use super::*;

    #[test]
    fn bits_change_places() {
        let mut state = 3;
        let block: [u64; 64] = [0; 64].map(|_: u64| linear_congruential(&mut state));
        let mut turned = block;
        transpose(&mut turned);
        for (i, word) in block.iter().enumerate() {
            for (j, other) in turned.iter().enumerate() {
                assert_eq!(word >> j & 1, other >> i & 1);
            }
        }
    }

    #[test]
    fn layers_have_the_cells_that_are_set_for_any_axis_in_lanes() {
        for (lanes, others) in [(0, [1, 2]), (1, [0, 2]), (2, [0, 1])] {
            let roles = AxisRoles { lanes, others, counts: [70, 66, 130] };
            let mut bits = CellBits::new(roles);
            let cells = [[0, 0, 0], [69, 65, 129], [3, 64, 65], [3, 64, 66], [68, 1, 63], [20, 30, 40]];
            for cell in cells {
                let others = roles.others.map(|axis| cell[axis]);
                bits.all().set_sixteen(others, cell[lanes] / 16, 1 << (cell[lanes] % 16));
            }
            let mut found = Vec::new();
            for span in bits.to_layer([70, 66, 130]).spans() {
                let row = span.row as usize;
                found.extend((span.first..=span.last).map(|k| [row / 66, row % 66, usize::from(k)]));
            }
            let mut expected = cells.to_vec();
            expected.sort_unstable();
            assert_eq!(found, expected);
        }
    }
}
