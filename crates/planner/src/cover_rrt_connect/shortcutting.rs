//! Shortcutting of a path whose edges the covers prove; every new edge is proven, too.

use super::edge_validator::EdgeValidator;
use crate::rrt_connect::{length, lerp, path_length};

/// Rounds of leaving out waypoints and cutting corners.
const ROUNDS: usize = 8;
/// A round that gains a smaller share than this is the last.
const MIN_GAIN: f64 = 0.01;
/// How far from a corner it is cut, as shares of the shorter of its edges. What is left of both edges is proven already.
const CUTS: [f64; 2] = [0.75, 0.35];
/// A cut that gains a smaller share of both edges than this is not worth an edge.
const MIN_CUT_GAIN: f64 = 0.004;

/// Shortens a path.
pub(super) struct Shortcutting<'v, V> {
    pub validator: &'v mut V,
}

impl<V: EdgeValidator> Shortcutting<'_, V> {
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
        while from + 2 < path.len() {
            let (mut reached, mut step) = (from + 1, path.len() - 1 - from);
            while step > 0 && reached + 1 < path.len() {
                let to = (reached + step).min(path.len() - 1);
                if to > reached && self.validator.edge_is_free(&path[from], &path[to]) {
                    reached = to;
                } else {
                    step /= 2;
                }
            }
            path.drain(from + 1..reached);
            from += 1;
        }
    }

    /// Replaces corners by an edge between points before and after them.
    fn cut_corners(&mut self, path: &mut Vec<Vec<f64>>) {
        let mut corner = 1;
        while corner + 1 < path.len() {
            corner += match self.cut(&path[corner - 1], &path[corner], &path[corner + 1]) {
                Some(ends) => {
                    path.splice(corner..=corner, ends);
                    2
                }
                None => 1,
            };
        }
    }

    /// The ends of a proven edge across a corner, the farthest first.
    fn cut(&mut self, before: &[f64], corner: &[f64], after: &[f64]) -> Option<[Vec<f64>; 2]> {
        let edges = [length(before, corner), length(corner, after)];
        let shorter = edges[0].min(edges[1]);
        for distance in CUTS.map(|share| share * shorter) {
            let mut ends = [corner.to_vec(), corner.to_vec()];
            lerp(corner, before, distance / edges[0], &mut ends[0]);
            lerp(corner, after, distance / edges[1], &mut ends[1]);
            let gain = 2.0 * distance - length(&ends[0], &ends[1]);
            // False for edges without length, too.
            if !(gain > MIN_CUT_GAIN * (edges[0] + edges[1])) {
                return None;
            }
            if self.validator.edge_is_free(&ends[0], &ends[1]) {
                return Some(ends);
            }
        }
        None
    }
}
