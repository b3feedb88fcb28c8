//! Shortcutting of a proven path; every new edge is proven, too. For paths on the grid: `grid_shortcutting.rs`.

use super::motion_validator::MotionValidator;
use crate::interpolation::{length, lerp, path_length};

/// Largest number of rounds of removing waypoints and cutting corners.
const ROUNDS: usize = 8;
/// Gain, as a fraction of the length, below which a round is the last.
const MIN_GAIN: f64 = 0.01;
/// Distances from a corner at which it is cut, as fractions of the shorter of its edges. The remaining parts of both
/// edges are proven already.
const CUTS: [f64; 2] = [0.75, 0.35];
/// Gain, as a fraction of both edges, below which a cut is not worth an edge.
const MIN_CUT_GAIN: f64 = 0.008;

/// Shortens a path.
pub(crate) struct Shortcutting<'v, V> {
    validator: &'v mut V,
    /// Keys of edges that could not be proven.
    rejected: Vec<u64>,
}

impl<'v, V: MotionValidator> Shortcutting<'v, V> {
    pub fn new(validator: &'v mut V) -> Self {
        Self { validator, rejected: Vec::new() }
    }

    /// Creates a shortcutting for a path whose ends cannot be joined by a proven edge.
    pub fn of_rejected_ends(validator: &'v mut V, path: &[Vec<f64>]) -> Self {
        let ends = path.first().zip(path.last());
        Self { validator, rejected: ends.map(|(from, to)| edge_key(from, to)).into_iter().collect() }
    }

    pub fn run(&mut self, path: &mut Vec<Vec<f64>>) {
        self.skip_waypoints(path);
        for _ in 0..ROUNDS {
            if path.len() < 3 || self.validator.is_exhausted() {
                return;
            }
            let before = path_length(path);
            self.cut_corners(path);
            self.skip_waypoints(path);
            if path_length(path) > before * (1.0 - MIN_GAIN) {
                return;
            }
        }
    }

    /// Joins each waypoint with the farthest one that a proven edge reaches, found by bisection.
    fn skip_waypoints(&mut self, path: &mut Vec<Vec<f64>>) {
        let mut from = 0;
        while from + 2 < path.len() && !self.validator.is_exhausted() {
            let (mut reached, mut step) = (from + 1, path.len() - 1 - from);
            while step > 0 && reached + 1 < path.len() {
                let to = (reached + step).min(path.len() - 1);
                if to > reached && self.is_joined(&path[from], &path[to]) {
                    reached = to;
                } else {
                    step /= 2;
                }
            }
            path.drain(from + 1..reached);
            from += 1;
        }
    }

    /// Whether an edge is proven free. A rejected edge is not tested again, because rounds repeat most of their tests.
    fn is_joined(&mut self, from: &[f64], to: &[f64]) -> bool {
        let key = edge_key(from, to);
        if self.rejected.contains(&key) {
            return false;
        }
        let is_free = self.validator.is_valid_motion(from, to);
        if !is_free {
            self.rejected.push(key);
        }
        is_free
    }

    /// Replaces each corner by an edge between points before and after it.
    fn cut_corners(&mut self, path: &mut Vec<Vec<f64>>) {
        let mut corner = 1;
        while corner + 1 < path.len() && !self.validator.is_exhausted() {
            corner += match self.cut(&path[corner - 1], &path[corner], &path[corner + 1]) {
                Some(ends) => {
                    path.splice(corner..=corner, ends);
                    2
                }
                None => 1,
            };
        }
    }

    /// The ends of a proven edge across a corner, farthest first.
    fn cut(&mut self, before: &[f64], corner: &[f64], after: &[f64]) -> Option<[Vec<f64>; 2]> {
        let edges = [length(before, corner), length(corner, after)];
        let shorter = edges[0].min(edges[1]);
        for distance in CUTS.map(|share| share * shorter) {
            let mut ends = [corner.to_vec(), corner.to_vec()];
            lerp(corner, before, distance / edges[0], &mut ends[0]);
            lerp(corner, after, distance / edges[1], &mut ends[1]);
            let gain = 2.0 * distance - length(&ends[0], &ends[1]);
            // Also false for edges of length 0.
            if !(gain > MIN_CUT_GAIN * (edges[0] + edges[1])) {
                return None;
            }
            if self.is_joined(&ends[0], &ends[1]) {
                return Some(ends);
            }
        }
        None
    }
}

/// A hash of an edge. Two edges rarely have the same hash; if they do, one counts as rejected, never as free.
fn edge_key(from: &[f64], to: &[f64]) -> u64 {
    let mix = |key: u64, value: &f64| (key ^ value.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
    from.iter().chain(to).fold(0, mix)
}
