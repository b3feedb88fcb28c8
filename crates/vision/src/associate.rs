//! Which of the things known is which of those seen.

use crate::{Point2, polygon};

/// Something seen, on the floor: metres, world x and y.
#[derive(Debug, Clone, Default)]
pub(crate) struct Detection {
    /// Convex outline.
    pub(crate) outline_m: Vec<Point2>,
    pub(crate) centre_m: Point2,
    pub(crate) area: f64,
    /// Mean grey level, or any other feature on that scale.
    pub(crate) brightness: f64,
    /// It goes on behind the arm.
    pub(crate) is_cut_by_arm: bool,
    /// It goes on beside the picture.
    pub(crate) is_cut_by_border: bool,
    pub(crate) z_from_m: f64,
    pub(crate) z_to_m: f64,
}

/// Something known, where it should be by now.
#[derive(Debug, Clone, Default)]
pub(crate) struct Expected {
    pub(crate) outline_m: Vec<Point2>,
    pub(crate) centre_m: Point2,
    pub(crate) area: f64,
    pub(crate) brightness: f64,
    /// How far from `centre_m` it may be, metres.
    pub(crate) reach_m: f64,
    /// Behind the arm: then only what touches its last place can be it.
    pub(crate) is_hidden: bool,
}

/// The answer, and scratch.
#[derive(Debug, Clone, Default)]
pub(crate) struct Association {
    /// For each thing known, the one seen; several may share one.
    pub(crate) seen_of: Vec<Option<usize>>,
    /// For each thing seen that is nobody's own, the thing known of which it is a piece.
    pub(crate) piece_of: Vec<Option<usize>>,
    /// For each thing known: the only one of its detection.
    pub(crate) is_alone: Vec<bool>,
    pairs: Vec<Pair>,
    taken: Vec<bool>,
    common: Vec<Point2>,
    spare: Vec<Point2>,
}

#[derive(Debug, Clone, Copy)]
struct Pair {
    known: usize,
    seen: usize,
    cost: f64,
    /// Common area as a share of the thing known, and of the thing seen.
    share_of_known: f64,
    share_of_seen: f64,
}

/// A thing known whose place is covered to this share by a thing seen is in it, though another one is too.
const IN_IT: f64 = 0.3;
/// A thing seen that lies to this share where a thing known is expected is a piece of it.
const A_PIECE: f64 = 0.5;

impl Association {
    /// Pairs each with its own where that is possible; then those left over with what covers them.
    pub(crate) fn find(&mut self, known: &[Expected], seen: &[Detection]) {
        self.list_pairs(known, seen);
        self.pair_off(known.len(), seen.len());
        self.swap_where_better();
        self.share(seen.len());
    }

    fn list_pairs(&mut self, known: &[Expected], seen: &[Detection]) {
        self.pairs.clear();
        for (k, expected) in known.iter().enumerate() {
            for (s, detection) in seen.iter().enumerate() {
                let distance = (expected.centre_m - detection.centre_m).length();
                polygon::intersection(&expected.outline_m, &detection.outline_m, &mut self.common, &mut self.spare);
                let common = polygon::area(&self.common);
                let is_near = distance <= expected.reach_m && !expected.is_hidden;
                if common > 0.0 || is_near {
                    self.pairs.push(Pair {
                        known: k,
                        seen: s,
                        cost: cost(expected, detection, distance),
                        share_of_known: common / expected.area.max(1e-12),
                        share_of_seen: common / detection.area.max(1e-12),
                    });
                }
            }
        }
        self.pairs.sort_by(|a, b| a.cost.total_cmp(&b.cost).then(a.known.cmp(&b.known)).then(a.seen.cmp(&b.seen)));
    }

    /// Each takes the cheapest that is still free.
    fn pair_off(&mut self, known: usize, seen: usize) {
        reset(&mut self.seen_of, known, None);
        reset(&mut self.taken, seen, false);
        for pair in &self.pairs {
            if self.seen_of[pair.known].is_none() && !self.taken[pair.seen] {
                self.seen_of[pair.known] = Some(pair.seen);
                self.taken[pair.seen] = true;
            }
        }
    }

    /// The cheapest first is not the cheapest in all: swaps two where that costs less together.
    fn swap_where_better(&mut self) {
        let n = self.seen_of.len();
        for _round in 0..n {
            let mut swapped = false;
            for a in 0..n {
                for b in a + 1..n {
                    swapped |= self.swap_if_better(a, b);
                }
            }
            if !swapped {
                return;
            }
        }
    }

    fn swap_if_better(&mut self, a: usize, b: usize) -> bool {
        let (Some(i), Some(j)) = (self.seen_of[a], self.seen_of[b]) else { return false };
        let cost = |known, seen| self.pairs.iter().find(|p| p.known == known && p.seen == seen).map(|p| p.cost);
        let (Some(ai), Some(bj), Some(aj), Some(bi)) = (cost(a, i), cost(b, j), cost(a, j), cost(b, i)) else {
            return false;
        };
        if aj + bi + 1e-12 < ai + bj {
            self.seen_of.swap(a, b);
            return true;
        }
        false
    }

    /// Leftovers: things known that are within another's detection, and detections that are pieces of a thing known.
    fn share(&mut self, seen: usize) {
        reset(&mut self.piece_of, seen, None);
        for k in 0..self.seen_of.len() {
            if self.seen_of[k].is_none() {
                let within = self.pairs.iter().filter(|p| p.known == k && p.share_of_known > IN_IT);
                let best = within.max_by(|a, b| a.share_of_known.total_cmp(&b.share_of_known));
                self.seen_of[k] = best.map(|p| p.seen);
            }
        }
        for s in 0..seen {
            if !self.seen_of.contains(&Some(s)) {
                let pieces = self.pairs.iter().filter(|p| p.seen == s && p.share_of_seen > A_PIECE);
                let best = pieces.max_by(|a, b| a.share_of_seen.total_cmp(&b.share_of_seen));
                self.piece_of[s] = best.map(|p| p.known);
            }
        }
        self.is_alone.clear();
        let count = |seen: &Option<usize>| self.seen_of.iter().filter(|s| *s == seen).count();
        self.is_alone.extend(self.seen_of.iter().map(|seen| seen.is_some() && count(seen) == 1));
    }
}

/// How unlikely it is that the thing seen is the one expected: place, size and brightness, each about 1 where doubtful.
fn cost(expected: &Expected, detection: &Detection, distance: f64) -> f64 {
    let size = (expected.area.max(1e-9) / detection.area.max(1e-9)).ln().abs();
    let brightness = (expected.brightness - detection.brightness).abs();
    let radius = (expected.area / std::f64::consts::PI).sqrt();
    distance / (radius + 1e-6) + 0.5 * size.min(2.0) + (brightness / 40.0).min(2.0)
}

fn reset<T: Clone>(list: &mut Vec<T>, n: usize, value: T) {
    list.clear();
    list.resize(n, value);
}
