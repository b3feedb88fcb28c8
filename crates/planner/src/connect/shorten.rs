//! A path pulled taut: every leg stays proven.

use super::random::Random;
use super::way::{Way, length, lerp};

/// Short cuts that are tried.
const TRIES: usize = 400;
/// So many in vain one after the other are enough.
const VAIN: usize = 60;
/// Rounds of pulling corners; one that gains less than this share is the last.
const ROUNDS: usize = 12;
const GAIN: f64 = 1e-3;
/// How far a corner is pulled towards the line between its neighbours.
const PULLS: [f64; 4] = [0.9, 0.5, 0.25, 0.1];

pub(super) struct Shorten<'w, 's> {
    pub way: &'w mut Way<'s>,
    pub random: &'w mut Random,
}

impl Shorten<'_, '_> {
    /// Shorter, or as it was.
    pub fn run(&mut self, path: &mut Vec<Vec<f64>>) {
        self.skip(path);
        self.cut(path);
        for _ in 0..ROUNDS {
            let before = total(path);
            self.skip(path);
            self.pull(path);
            if self.way.late() || total(path) > before * (1.0 - GAIN) {
                break;
            }
        }
    }

    /// Leaves out waypoints, as many at once as possible.
    fn skip(&mut self, path: &mut Vec<Vec<f64>>) {
        let mut from = 0;
        while from + 2 < path.len() && !self.way.late() {
            let far = (from + 2..path.len()).rev().find(|&to| self.way.free(&path[from], &path[to]));
            if let Some(to) = far {
                path.drain(from + 1..to);
            }
            from += 1;
        }
    }

    /// Straight between two random points of the path.
    fn cut(&mut self, path: &mut Vec<Vec<f64>>) {
        let mut vain = 0;
        for _ in 0..TRIES {
            if path.len() < 3 || vain >= VAIN || self.way.late() {
                return;
            }
            vain = if self.cut_once(path) { 0 } else { vain + 1 };
        }
    }

    fn cut_once(&mut self, path: &mut Vec<Vec<f64>>) -> bool {
        let all = total(path);
        let (s, t) = (self.random.unit() * all, self.random.unit() * all);
        let ((i, a), (j, b)) = (at(path, s.min(t)), at(path, s.max(t)));
        // On one leg it is straight already.
        if i == j || (s - t).abs() - length(&a, &b) < GAIN * all || !self.way.free(&a, &b) {
            return false;
        }
        // What is left of a leg is as proven as the leg.
        path.splice(i + 1..=j, [a, b]);
        path.dedup_by(|x, y| x == y);
        true
    }

    /// Each corner towards the line between its neighbours.
    fn pull(&mut self, path: &mut [Vec<f64>]) {
        for n in 1..path.len().saturating_sub(1) {
            for share in PULLS {
                if self.way.late() {
                    return;
                }
                let moved = pulled(&path[n - 1], &path[n], &path[n + 1], share);
                let around = |q: &[f64]| length(&path[n - 1], q) + length(q, &path[n + 1]);
                if around(&moved) < around(&path[n]) * (1.0 - 1e-9)
                    && self.way.free(&path[n - 1], &moved)
                    && self.way.free(&moved, &path[n + 1])
                {
                    path[n] = moved;
                    break;
                }
            }
        }
    }
}

pub(super) fn total(path: &[Vec<f64>]) -> f64 {
    path.windows(2).map(|w| length(&w[0], &w[1])).sum()
}

/// The leg and the state after a length.
fn at(path: &[Vec<f64>], far: f64) -> (usize, Vec<f64>) {
    let mut left = far;
    for (leg, w) in path.windows(2).enumerate() {
        let length = length(&w[0], &w[1]);
        if left <= length && length > 0.0 {
            let mut q = w[0].clone();
            lerp(&w[0], &w[1], left / length, &mut q);
            return (leg, q);
        }
        left -= length;
    }
    (path.len() - 2, path[path.len() - 1].clone())
}

/// A share of the way from a corner to the foot of its perpendicular.
fn pulled(before: &[f64], corner: &[f64], after: &[f64], share: f64) -> Vec<f64> {
    let along: Vec<f64> = after.iter().zip(before).map(|(a, b)| a - b).collect();
    let square: f64 = along.iter().map(|x| x * x).sum();
    let dot: f64 = corner.iter().zip(before).zip(&along).map(|((c, b), d)| (c - b) * d).sum();
    let t = if square > 0.0 { (dot / square).clamp(0.0, 1.0) } else { 0.0 };
    let foot = before.iter().zip(&along).map(|(b, d)| b + d * t);
    corner.iter().zip(foot).map(|(c, f)| c + (f - c) * share).collect()
}
