//! Cells that are not proven free at once: does anything in them really touch?

use super::joints::MOST_JOINTS;
use super::pace::Pace;
use super::search::{Pair, Search, Span};

/// So often a cell of three axes is looked at before it counts as blocked; with more axes, less: its border has more parts.
const LOOKS_PER_CELL: u32 = 4096;
/// A corner is tried where it seems to lead nearer by this share of the gap.
const WORTH: f64 = 0.8;

impl Search<'_> {
    /// True where a piece moved by `depth` axes may touch in a cell, of the pairs from `begin` on.
    pub fn touch_in(&mut self, span: &Span, begin: usize, depth: usize) -> bool {
        if self.is_inside(depth, None) {
            return true;
        }
        self.left = LOOKS_PER_CELL >> (4 * depth.saturating_sub(3));
        let parts = &self.task.parts.pieces;
        let mut here: Vec<Pair> =
            self.pairs[begin..].iter().filter(|pair| parts[pair.part as usize].depth == depth).copied().collect();
        // The nearest most likely touches, and one is enough.
        here.sort_by(|a, b| a.gap.total_cmp(&b.gap));
        let touches = here.into_iter().any(|pair| self.touches(pair, span, None, self.task.looks[depth]));
        self.go_to(&span.middle);
        touches
    }

    /// True where a pair may touch in a box. Looks at the middle, then at the corner that leads nearer, then at both halves.
    fn touches(&mut self, mut pair: Pair, span: &Span, tried: Option<&[f64; MOST_JOINTS]>, looks: u32) -> bool {
        let task = self.task;
        let part = &task.parts.pieces[pair.part as usize];
        let target = &task.targets[pair.target as usize];
        self.go_to(&span.middle);
        let pace = Pace::of(part, task.drive, &self.state);
        let far = pace.farthest(part, &span.half);
        let in_world = self.in_world(pair.part as usize);
        // Inside something, contact is the sooner answer.
        if tried.is_none() {
            self.counts.tried += 1;
            if self.scratch.collides(&part.shape, &in_world, &target.shape, &target.in_world) {
                return true;
            }
        }
        self.counts.looks += 1;
        let scratch = &mut self.scratch;
        let found = scratch.separation(&part.shape, &in_world, &target.shape, &target.in_world, far, &mut pair.hint);
        let Some(gap) = found.filter(|s| s.lower_bound <= far) else { return false };
        if gap.distance <= 0.0 {
            return true;
        }
        let line = (gap.on_b - gap.on_a) * gap.distance.recip();
        let mut corner = span.middle;
        let mut shares = [0.0; MOST_JOINTS];
        let mut nearer = 0.0;
        for axis in 0..part.depth {
            let speed = pace.velocity(axis, gap.on_a).dot(line);
            nearer += span.half[axis] * speed.abs();
            corner[axis] += span.half[axis] * if speed < 0.0 { -1.0 } else { 1.0 };
            shares[axis] = pace.share(part, axis, &span.half);
        }
        // Where the corner leads little nearer, no contact is to be expected.
        if nearer > WORTH * gap.distance && tried.is_none_or(|tried| !same(tried, &corner)) {
            self.go_to(&corner);
            let there = self.in_world(pair.part as usize);
            self.counts.tried += 1;
            if self.scratch.collides(&part.shape, &there, &target.shape, &target.in_world) {
                return true;
            }
        }
        self.left = self.left.saturating_sub(1);
        if looks == 0 || self.left == 0 {
            self.counts.unsure += 1;
            return true;
        }
        let Some(axis) = (0..part.depth).max_by(|&a, &b| shares[a].total_cmp(&shares[b])) else { return true };
        let toward = if corner[axis] < span.middle[axis] { -1.0 } else { 1.0 };
        [toward, -toward].into_iter().any(|side| {
            let mut half = *span;
            half.half[axis] *= 0.5;
            half.middle[axis] += side * half.half[axis];
            self.touches(pair, &half, Some(&corner), looks - 1)
        })
    }

    fn go_to(&mut self, q: &[f64; MOST_JOINTS]) {
        self.task.drive.place(&mut self.state, &q[..self.task.axes.len()]);
    }
}

/// True where two corners are one but for rounding.
fn same(a: &[f64; MOST_JOINTS], b: &[f64; MOST_JOINTS]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-9)
}
