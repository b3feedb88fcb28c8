//! Shortcutting of a path in the exact scene; every segment stays proven. For paths on the grid: `grid_shortcutting.rs`.

use super::interpolation::{length, path_length, point_at};
use super::motion_validator::MotionValidator;
use super::random::Random;
use super::settings::ShortcuttingSettings;

/// Fractions of the distance by which a corner is pulled towards the line between its neighbours.
const PULL_RATIOS: [f64; 4] = [0.9, 0.5, 0.25, 0.1];
/// Smallest gain, as a fraction of a corner's two segments, for which it is pulled: rounding errors do not pull
/// corners.
const MIN_PULL_GAIN: f64 = 1e-9;

/// Shortens a path.
pub(super) struct Shortcutting<'w, 's> {
    pub validator: &'w mut MotionValidator<'s>,
    pub random: &'w mut Random,
    pub settings: &'w ShortcuttingSettings,
}

impl Shortcutting<'_, '_> {
    /// Shortens a path, if possible.
    pub fn run(&mut self, path: &mut Vec<Vec<f64>>) {
        self.skip_waypoints(path);
        self.random_shortcuts(path);
        for _ in 0..self.settings.max_rounds {
            let before = path_length(path);
            self.skip_waypoints(path);
            self.pull_corners(path);
            if self.validator.is_exhausted() || path_length(path) > before * (1.0 - self.settings.min_gain) {
                break;
            }
        }
    }

    /// Removes waypoints, as many at once as possible.
    fn skip_waypoints(&mut self, path: &mut Vec<Vec<f64>>) {
        let mut from = 0;
        while from + 2 < path.len() && !self.validator.is_exhausted() {
            let far = (from + 2..path.len()).rev().find(|&to| self.validator.is_valid_motion(&path[from], &path[to]));
            if let Some(to) = far {
                path.drain(from + 1..to);
            }
            from += 1;
        }
    }

    /// Joins random pairs of points of the path by straight segments.
    fn random_shortcuts(&mut self, path: &mut Vec<Vec<f64>>) {
        let mut failures = 0;
        for _ in 0..self.settings.max_attempts {
            if path.len() < 3 || failures >= self.settings.max_failures || self.validator.is_exhausted() {
                return;
            }
            failures = if self.try_shortcut(path) { 0 } else { failures + 1 };
        }
    }

    fn try_shortcut(&mut self, path: &mut Vec<Vec<f64>>) -> bool {
        let all = path_length(path);
        let (s, t) = (self.random.unit() * all, self.random.unit() * all);
        let ((i, a), (j, b)) = (point_at(path, s.min(t)), point_at(path, s.max(t)));
        // Within one segment the path is straight.
        if i == j || (s - t).abs() - length(&a, &b) < self.settings.min_gain * all {
            return false;
        }
        if !self.validator.is_valid_motion(&a, &b) {
            return false;
        }
        // Parts of a proven segment are proven.
        path.splice(i + 1..=j, [a, b]);
        path.dedup_by(|x, y| x == y);
        true
    }

    /// Moves corners towards the line between their neighbours.
    fn pull_corners(&mut self, path: &mut [Vec<f64>]) {
        for n in 1..path.len().saturating_sub(1) {
            for share in PULL_RATIOS {
                if self.validator.is_exhausted() {
                    return;
                }
                let moved = pulled_corner(&path[n - 1], &path[n], &path[n + 1], share);
                let around = |q: &[f64]| length(&path[n - 1], q) + length(q, &path[n + 1]);
                if around(&moved) < around(&path[n]) * (1.0 - MIN_PULL_GAIN)
                    && self.validator.is_valid_motion(&path[n - 1], &moved)
                    && self.validator.is_valid_motion(&moved, &path[n + 1])
                {
                    path[n] = moved;
                    break;
                }
            }
        }
    }
}

/// A corner moved by a fraction of the distance to the foot of its perpendicular on the line between its neighbours.
fn pulled_corner(before: &[f64], corner: &[f64], after: &[f64], share: f64) -> Vec<f64> {
    let along: Vec<f64> = after.iter().zip(before).map(|(a, b)| a - b).collect();
    let square: f64 = along.iter().map(|x| x * x).sum();
    let dot: f64 = corner.iter().zip(before).zip(&along).map(|((c, b), d)| (c - b) * d).sum();
    let t = if square > 0.0 { (dot / square).clamp(0.0, 1.0) } else { 0.0 };
    let foot = before.iter().zip(&along).map(|(b, d)| b + d * t);
    corner.iter().zip(foot).map(|(c, f)| c + (f - c) * share).collect()
}
