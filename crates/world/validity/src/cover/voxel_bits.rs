//! A set of voxels of a grid, one bit per voxel, in rows along x.

use std::collections::VecDeque;

/// Number of bits of a row in one word.
const WORD: usize = 64;

/// A set of voxels.
#[derive(Clone)]
pub(super) struct VoxelBits {
    pub counts: [usize; 3],
    row_words: usize,
    words: Vec<u64>,
}

impl VoxelBits {
    pub fn none(counts: [usize; 3]) -> Self {
        let row_words = counts[0].div_ceil(WORD);
        Self { counts, row_words, words: vec![0; row_words * counts[1] * counts[2]] }
    }

    pub fn insert(&mut self, [x, y, z]: [usize; 3]) {
        let at = self.row(y, z).start + x / WORD;
        self.words[at] |= 1 << (x % WORD);
    }

    pub fn contains(&self, [x, y, z]: [usize; 3]) -> bool {
        self.words[self.row(y, z).start + x / WORD] >> (x % WORD) & 1 == 1
    }

    pub fn len(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }

    /// The voxels of the grid that are in neither of two sets.
    pub fn neither(&self, other: &Self) -> Self {
        let words = self.words.iter().zip(&other.words).enumerate();
        let words = words.map(|(i, (a, b))| !(a | b) & self.mask(i % self.row_words)).collect();
        Self { words, ..*self }
    }

    /// All voxels of the set, row by row.
    pub fn iter(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        self.words.iter().enumerate().filter(|(_, word)| **word != 0).flat_map(move |(i, &word)| {
            let (row, first) = (i / self.row_words, i % self.row_words * WORD);
            let bits = (0..WORD).filter(move |bit| word >> bit & 1 == 1);
            bits.map(move |bit| [first + bit, row % self.counts[1], row / self.counts[1]])
        })
    }

    /// True if a voxel of a cube is in the set. The cube may reach beyond the grid.
    pub fn any_in_cube(&self, [x, y, z]: [usize; 3], size: usize) -> bool {
        let end = |axis: usize, from: usize| (from + size).min(self.counts[axis]);
        let (first, last) = (x / WORD, (end(0, x).max(1) - 1) / WORD);
        if x >= end(0, x) {
            return false;
        }
        let low = u64::MAX << (x % WORD);
        let high = u64::MAX >> (WORD - 1 - (end(0, x) - 1) % WORD);
        let in_row = |row: &[u64]| {
            (first..=last).any(|i| {
                let from = if i == first { low } else { u64::MAX };
                let to = if i == last { high } else { u64::MAX };
                row[i] & from & to != 0
            })
        };
        (z..end(2, z)).any(|z| (y..end(1, y)).any(|y| in_row(&self.words[self.row(y, z)])))
    }

    /// One bit for a voxel and each of its 26 neighbours: x first, then y, then z.
    ///
    /// The voxel must not be at the border of the grid.
    pub fn neighbourhood(&self, [x, y, z]: [usize; 3]) -> u32 {
        let mut bits = 0;
        for k in 0..9 {
            let row = &self.words[self.row(y + k % 3 - 1, z + k / 3 - 1)];
            let (word, shift) = ((x - 1) / WORD, (x - 1) % WORD);
            let next = if shift + 3 > WORD { row[word + 1] << (WORD - shift) } else { 0 };
            bits |= ((row[word] >> shift | next) & 0b111) << (3 * k);
        }
        bits as u32
    }

    /// The voxels that are connected to the first voxel through faces, without passing through voxels of this set.
    pub fn flood_around(&self) -> Self {
        let mut reached = Self::none(self.counts);
        reached.words[0] = 1;
        let mut open = VecDeque::from([0_usize]);
        while let Some(row) = open.pop_front() {
            self.spread_in_row(&mut reached, row);
            let (y, z) = (row % self.counts[1], row / self.counts[1]);
            let beside = [
                (y > 0).then(|| row - 1),
                (y + 1 < self.counts[1]).then_some(row + 1),
                (z > 0).then(|| row - self.counts[1]),
                (z + 1 < self.counts[2]).then_some(row + self.counts[1]),
            ];
            for other in beside.into_iter().flatten() {
                if self.step_to_row(&mut reached, row, other) {
                    open.push_back(other);
                }
            }
        }
        reached
    }

    /// Spreads the reached voxels along a row.
    fn spread_in_row(&self, reached: &mut Self, row: usize) {
        let first = row * self.row_words;
        let mut from_left = 0;
        for i in 0..self.row_words {
            let free = !self.words[first + i] & self.mask(i);
            reached.words[first + i] = spread(reached.words[first + i] | (from_left & free), free);
            from_left = reached.words[first + i] >> (WORD - 1);
        }
        let mut from_right = 0;
        for i in (0..self.row_words).rev() {
            let free = !self.words[first + i] & self.mask(i);
            reached.words[first + i] = spread(reached.words[first + i] | (from_right & free), free);
            from_right = reached.words[first + i] << (WORD - 1);
        }
    }

    /// Copies the reached voxels of a row to the adjacent row. True if any are new there.
    fn step_to_row(&self, reached: &mut Self, row: usize, other: usize) -> bool {
        let mut is_new = false;
        for i in 0..self.row_words {
            let (from, to) = (row * self.row_words + i, other * self.row_words + i);
            let found = reached.words[from] & !self.words[to] & !reached.words[to];
            reached.words[to] |= found;
            is_new |= found != 0;
        }
        is_new
    }

    fn row(&self, y: usize, z: usize) -> std::ops::Range<usize> {
        let first = (z * self.counts[1] + y) * self.row_words;
        first..first + self.row_words
    }

    /// The bits of a word of a row that are voxels of the grid.
    fn mask(&self, word: usize) -> u64 {
        let left = self.counts[0] - word * WORD;
        if left >= WORD { u64::MAX } else { (1 << left) - 1 }
    }
}

/// Spreads bits to both sides through free bits: twice as far with each step (Kogge and Stone, 1973).
fn spread(from: u64, free: u64) -> u64 {
    let (mut left, mut right) = (from, from);
    let (mut free_left, mut free_right) = (free, free);
    for shift in [1, 2, 4, 8, 16, 32] {
        left |= free_left & (left << shift);
        free_left &= free_left << shift;
        right |= free_right & (right >> shift);
        free_right &= free_right >> shift;
    }
    left | right
}
