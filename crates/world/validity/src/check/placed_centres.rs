//! Centres of spheres in the world, each computed at most once per block of configurations.

#![allow(clippy::inline_always, reason = "part of a kernel that is compiled for each instruction set as a whole")]

use fearless_simd::Simd;

use crate::lanes::{PointRow, V3};

/// Rows of centres, valid while they belong to the present block.
#[derive(Debug, Clone)]
pub(super) struct PlacedCentres {
    rows: Vec<PointRow>,
    /// Number of the block for which each row was computed.
    blocks: Vec<u32>,
    block: u32,
}

impl PlacedCentres {
    pub fn new(count: usize) -> Self {
        Self { rows: vec![PointRow::ZERO; count], blocks: vec![0; count], block: 0 }
    }

    /// Discards the centres of the last block. True if numbers of blocks are used again.
    #[inline(always)]
    pub fn begin_block(&mut self) -> bool {
        let starts_again = self.block == u32::MAX;
        if starts_again {
            self.blocks.fill(0);
            self.block = 0;
        }
        self.block += 1;
        starts_again
    }

    /// Number of the present block.
    pub fn block(&self) -> u32 {
        self.block
    }

    #[inline(always)]
    pub fn are_placed(&self, row: usize) -> bool {
        self.blocks[row] == self.block
    }

    #[inline(always)]
    pub fn place<S: Simd>(&mut self, row: usize, centres: V3<S>) {
        self.blocks[row] = self.block;
        self.rows[row].store(centres);
    }

    /// A row that is placed.
    #[inline(always)]
    pub fn row(&self, row: usize) -> &PointRow {
        &self.rows[row]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_centre_outlives_its_block_even_when_numbers_are_used_again() {
        let mut centres = PlacedCentres::new(2);
        let level = fearless_simd::Level::baseline();
        let place = |centres: &mut PlacedCentres| {
            fearless_simd::dispatch!(level, simd => centres.place(1, V3::splat(simd, [1.0, 2.0, 3.0])));
        };
        assert!(!centres.begin_block() && !centres.are_placed(1));
        place(&mut centres);
        assert!(centres.are_placed(1) && !centres.are_placed(0));
        assert!(!centres.begin_block() && !centres.are_placed(1));
        centres.block = u32::MAX;
        place(&mut centres);
        assert!(centres.begin_block() && !centres.are_placed(0) && !centres.are_placed(1));
        assert_eq!(centres.block(), 1);
    }
}
