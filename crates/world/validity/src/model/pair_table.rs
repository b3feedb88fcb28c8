//! Tables of the pairs of links that can touch.
//!
//! They cover links that at most two turning joints move against each other. Per cell of the values of these joints, a
//! table says whether the links are certainly apart.

use fearless_simd::{Simd, f32x16, i32x16, prelude::*};

use crate::lanes::{LANES, Row, splat};

/// Number of cells per turn of a joint.
pub(crate) const CELLS: usize = 448;
/// Number of tables for motions of different length.
pub(crate) const LEVELS: usize = 5;
/// Per level: a cell is marked for all joint values up to this distance beyond it, rad.
///
/// The level is used for motion between two lanes of at most twice this distance.
pub(crate) const BEYOND_RAD: [f32; LEVELS] = [0.0, 0.005, 0.010, 0.018, 0.036];
/// Largest number of pairs of one table, one bit each.
pub(crate) const MAX_PAIRS: usize = 8;

/// Pairs that can touch, over the values of two joints. For a single joint, the two joints are equal.
#[derive(Debug, Clone)]
pub(crate) struct PairTable {
    /// Steps of the joints.
    pub steps: [usize; 2],
    /// Indices of the pairs.
    pub pairs: Vec<usize>,
    /// Offset from one cell of the first joint to the next; 0 if the two joints are equal.
    pub row: usize,
    /// Per level, per cell of the first joint and cell of the second: one bit per pair that may touch.
    pub levels: [Vec<u8>; LEVELS],
}

impl PairTable {
    /// The pairs that may touch in a block, or between its lanes.
    ///
    /// Joint values and their changes between lanes are in rad.
    #[inline(always)]
    #[allow(clippy::inline_always, clippy::cast_possible_wrap, reason = "part of a kernel; a small number")]
    pub fn near<S: Simd>(&self, simd: S, values: &[Row], deltas: [f32; 2]) -> u8 {
        let is_within = |beyond: &f32| deltas[0] <= 2.0 * beyond && deltas[1] <= 2.0 * beyond;
        let Some(level) = BEYOND_RAD.iter().position(is_within) else { return u8::MAX };
        let cells = &self.levels[level];
        let row: i32x16<S> = cell(simd, values[self.steps[0]].load(simd)).to_int();
        let column: i32x16<S> = cell(simd, values[self.steps[1]].load(simd)).to_int();
        let index = row * i32x16::splat(simd, self.row as i32) + column;
        let mut at = [0_i32; LANES];
        index.store_slice(&mut at);
        at.iter().fold(0, |near, &i| near | cells.get(i as usize).copied().unwrap_or(u8::MAX))
    }
}

impl PairTable {
    /// The pairs that may touch at a configuration, by the cells of the two joints.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a kernel")]
    pub fn near_at(&self, cells: [usize; 2]) -> u8 {
        self.levels[0].get(cells[0] * self.row + cells[1]).copied().unwrap_or(u8::MAX)
    }
}

/// The cells of angles.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a kernel")]
pub(crate) fn cells<S: Simd>(simd: S, angles: f32x16<S>, out: &mut [i32; LANES]) {
    let cells: i32x16<S> = cell(simd, angles).to_int();
    cells.store_slice(out);
}

/// The cell of an angle, before rounding down.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a kernel")]
fn cell<S: Simd>(simd: S, angle: f32x16<S>) -> f32x16<S> {
    let turns = angle * splat(simd, std::f32::consts::TAU.recip());
    let share = (turns - turns.floor()) * splat(simd, CELLS as f32);
    share.min(splat(simd, CELLS as f32 - 0.5)).max(splat(simd, 0.0))
}
