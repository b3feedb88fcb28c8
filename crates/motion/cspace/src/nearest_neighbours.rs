//! Nearest neighbours of configurations by a linear search, sixteen nodes at a time in single precision.
//!
//! Up to about ten thousand nodes this is faster than a tree of nodes, and nothing needs balancing.

#![allow(clippy::inline_always, reason = "a kernel is compiled for each instruction set as a whole")]

use std::sync::OnceLock;

use elbowroom_validity::lanes::simd::{Level as SimdLevel, Simd, dispatch, f32x16, prelude::*};

const LANES: usize = 16;

/// Configurations, the nodes, among which the one nearest to another configuration is searched.
///
/// The distance of two configurations is Euclidean, with 1 m like 1 rad. Nodes are stored in packs of sixteen: the values
/// of the first joint, then of the second, …
///
/// ```
/// use elbowroom_cspace::NearestNeighbours;
/// let mut nodes = NearestNeighbours::new(2);
/// nodes.push(&[0.0, 0.0]);
/// nodes.push(&[1.0, 0.5]);
/// assert_eq!(nodes.nearest(&[0.9, 0.9]), 1);
/// ```
#[derive(Debug, Clone)]
pub struct NearestNeighbours {
    dof: usize,
    len: usize,
    /// Unused nodes are infinitely far away.
    rows: Vec<[f32; LANES]>,
    simd_level: SimdLevel,
}

impl NearestNeighbours {
    /// No nodes yet, of configurations with this number of values.
    pub fn new(dof: usize) -> Self {
        static DETECTED: OnceLock<SimdLevel> = OnceLock::new();
        Self { dof, len: 0, rows: Vec::new(), simd_level: *DETECTED.get_or_init(SimdLevel::new) }
    }

    /// Adds a node, with the next index.
    pub fn push(&mut self, q: &[f64]) {
        let (pack, lane) = (self.len / LANES, self.len % LANES);
        if lane == 0 {
            self.rows.resize((pack + 1) * self.dof, [f32::INFINITY; LANES]);
        }
        for (row, &value) in self.rows[pack * self.dof..].iter_mut().zip(q) {
            row[lane] = value as f32;
        }
        self.len += 1;
    }

    /// Removes a node from the search; the indices of the others stay.
    pub fn remove(&mut self, node: usize) {
        let (pack, lane) = (node / LANES, node % LANES);
        self.rows[pack * self.dof..][..self.dof].iter_mut().for_each(|row| row[lane] = f32::INFINITY);
    }

    /// The nearest node; 0 if there are no nodes. The result is the same on every instruction set.
    pub fn nearest(&self, q: &[f64]) -> usize {
        dispatch!(self.simd_level, simd => self.nearest_in_lanes(simd, q))
    }

    #[inline(always)]
    fn nearest_in_lanes<S: Simd>(&self, simd: S, q: &[f64]) -> usize {
        let mut best = f32x16::splat(simd, f32::INFINITY);
        // Indices of packs: exact in single precision up to 2²⁴.
        let mut best_pack = f32x16::splat(simd, 0.0);
        for (number, pack) in self.rows.chunks_exact(self.dof.max(1)).enumerate() {
            let squares = squared_distances(simd, pack, q);
            let is_nearer = squares.simd_lt(best);
            best = is_nearer.select(squares, best);
            best_pack = is_nearer.select(f32x16::splat(simd, number as f32), best_pack);
        }
        let (mut squares, mut packs) = ([0.0; LANES], [0.0; LANES]);
        best.store_slice(&mut squares);
        best_pack.store_slice(&mut packs);
        let mut lane = 0;
        for other in 1..LANES {
            if squares[other] < squares[lane] {
                lane = other;
            }
        }
        packs[lane] as usize * LANES + lane
    }

    /// The squared distances of all nodes.
    pub fn squared_distances<'p>(&'p self, q: &'p [f64]) -> impl Iterator<Item = f32> + 'p {
        let of_pack = move |pack: &[[f32; LANES]]| {
            let mut squares = [0.0; LANES];
            dispatch!(self.simd_level, simd => squared_distances(simd, pack, q).store_slice(&mut squares));
            squares
        };
        self.rows.chunks_exact(self.dof.max(1)).flat_map(of_pack).take(self.len)
    }
}

/// Squared distances of the nodes of a pack. Not fused: sums are rounded in the same way on every instruction set.
#[inline(always)]
fn squared_distances<S: Simd>(simd: S, pack: &[[f32; LANES]], q: &[f64]) -> f32x16<S> {
    let mut squares = f32x16::splat(simd, 0.0);
    for (row, &value) in pack.iter().zip(q) {
        let change = f32x16::simd_from(simd, *row) - f32x16::splat(simd, value as f32);
        squares += change * change;
    }
    squares
}

#[cfg(test)]
mod tests {
    use elbowroom_testkit::random::SplitMix;

    use super::*;

    #[test]
    fn the_nearest_node_is_that_of_a_plain_search_on_every_instruction_set() {
        let mut random = SplitMix(5);
        for dof in [1, 2, 7] {
            let (mut packs, mut nodes) = (NearestNeighbours::new(dof), Vec::new());
            assert_eq!(packs.nearest(&vec![0.0; dof]), 0);
            for n in 0..200 {
                let q: Vec<f64> = (0..dof).map(|_| random.between(-3.0, 3.0)).collect();
                packs.push(&q);
                nodes.push(q);
                let sample: Vec<f64> = (0..dof).map(|_| random.between(-3.0, 3.0)).collect();
                let square = |node: &Vec<f64>| -> f32 {
                    node.iter().zip(&sample).map(|(a, b)| (*a as f32 - *b as f32).powi(2)).sum()
                };
                let least = nodes.iter().map(square).fold(f32::INFINITY, f32::min);
                for level in [SimdLevel::new(), SimdLevel::baseline()] {
                    packs.simd_level = level;
                    let found = packs.nearest(&sample);
                    assert!(found <= n && (square(&nodes[found]) - least).abs() <= 1e-6 * (1.0 + least));
                }
                let all: Vec<f32> = packs.squared_distances(&sample).collect();
                assert_eq!(all.len(), nodes.len());
                assert!(all.iter().zip(&nodes).all(|(a, node)| (a - square(node)).abs() <= 1e-5 * (1.0 + a)));
            }
        }
    }
}
