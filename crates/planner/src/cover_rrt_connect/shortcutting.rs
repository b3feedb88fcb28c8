//! Shortcutting of a path whose edges the covers prove; every new edge is proven, too.

use super::edge_validator::EdgeValidator;
use crate::rrt_connect::{Random, length, path_length, point_at};

/// Rounds of leaving out waypoints, random shortcuts and pulled corners.
const ROUNDS: usize = 4;
/// Random shortcuts per round.
const SHORTCUTS: usize = 10;
/// A round that gains a smaller share than this is the last.
const MIN_GAIN: f64 = 0.01;
/// Shares of the way from a corner to the line between its neighbours.
const PULLS: [f64; 2] = [0.8, 0.35];

/// Shortens a path.
pub(super) struct Shortcutting<'v, V> {
    pub validator: &'v mut V,
    pub random: &'v mut Random,
}

impl<V: EdgeValidator> Shortcutting<'_, V> {
    pub fn run(&mut self, path: &mut Vec<Vec<f64>>) {
        self.skip_waypoints(path);
        for _ in 0..ROUNDS {
            if path.len() < 3 || self.validator.is_exhausted() {
                return;
            }
            let before = path_length(path);
            self.random_shortcuts(path);
            self.pull_corners(path);
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

    /// Edges between two random points of the path.
    fn random_shortcuts(&mut self, path: &mut Vec<Vec<f64>>) {
        for _ in 0..SHORTCUTS {
            if path.len() < 3 {
                return;
            }
            let all = path_length(path);
            let (s, t) = (self.random.unit() * all, self.random.unit() * all);
            let ((i, a), (j, b)) = (point_at(path, s.min(t)), point_at(path, s.max(t)));
            if i != j && (s - t).abs() - length(&a, &b) > 1e-3 * all && self.validator.edge_is_free(&a, &b) {
                path.splice(i + 1..=j, [a, b]);
                path.dedup();
            }
        }
    }

    /// Moves corners towards the line between their neighbours.
    fn pull_corners(&mut self, path: &mut [Vec<f64>]) {
        for n in 1..path.len().saturating_sub(1) {
            for share in PULLS {
                let moved = pulled(&path[n - 1], &path[n], &path[n + 1], share);
                let around = |q: &[f64]| length(&path[n - 1], q) + length(q, &path[n + 1]);
                if around(&moved) < around(&path[n]) * (1.0 - 1e-4)
                    && self.validator.edge_is_free(&path[n - 1], &moved)
                    && self.validator.edge_is_free(&moved, &path[n + 1])
                {
                    path[n] = moved;
                    break;
                }
            }
        }
    }
}

/// A corner moved by a share of the distance to the point between its neighbours that divides their segment as its edges do.
fn pulled(before: &[f64], corner: &[f64], after: &[f64], share: f64) -> Vec<f64> {
    let (a, b) = (length(before, corner), length(corner, after));
    let t = if a + b > 0.0 { a / (a + b) } else { 0.5 };
    let line = before.iter().zip(after).map(|(x, y)| x + (y - x) * t);
    corner.iter().zip(line).map(|(c, l)| c + (l - c) * share).collect()
}
