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
    /// By thing known, then by thing seen.
    pairs: Vec<Pair>,
    by_cost: Vec<usize>,
    taken: Vec<bool>,
    owner_of: Vec<Option<usize>>,
    /// How many things known each thing seen is.
    pub(crate) sharers: Vec<u32>,
    piece_share: Vec<f64>,
    radii: Vec<f64>,
    near: Vec<(f64, usize)>,
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

/// Of the things seen that a thing known could have jumped to, so many of the nearest are looked at.
const MOST_NEAR: usize = 6;
const MOST_ROUNDS: usize = 8;
/// A thing known whose place is covered to this share by a thing seen is in it, though another one is too.
const IN_IT: f64 = 0.3;
/// A thing seen that lies to this share where a thing known is expected is a piece of it.
const A_PIECE: f64 = 0.5;

impl Association {
    /// Pairs each with its own where that is possible; then those left over with what covers them.
    pub(crate) fn find(&mut self, known: &[Expected], seen: &[Detection]) {
        self.list_pairs(known, seen);
        self.pair_off(known.len(), seen.len());
        self.swap_where_better(seen.len());
        self.share(seen.len());
    }

    fn list_pairs(&mut self, known: &[Expected], seen: &[Detection]) {
        self.pairs.clear();
        self.radii.clear();
        self.radii.extend(seen.iter().map(|detection| radius(&detection.outline_m, detection.centre_m)));
        for (k, expected) in known.iter().enumerate() {
            let own = radius(&expected.outline_m, expected.centre_m);
            let first = self.pairs.len();
            self.near.clear();
            for (s, detection) in seen.iter().enumerate() {
                let distance = (expected.centre_m - detection.centre_m).length();
                if distance <= own + self.radii[s] && self.push_common(k, s, expected, detection, distance) {
                    continue;
                }
                if distance <= expected.reach_m && !expected.is_hidden {
                    self.near.push((distance, s));
                }
            }
            self.near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            for &(distance, s) in self.near.iter().take(MOST_NEAR) {
                let cost = cost(expected, &seen[s], distance);
                self.pairs.push(Pair { known: k, seen: s, cost, share_of_known: 0.0, share_of_seen: 0.0 });
            }
            self.pairs[first..].sort_unstable_by_key(|pair| pair.seen);
        }
        self.by_cost.clear();
        self.by_cost.extend(0..self.pairs.len());
        let pairs = &self.pairs;
        self.by_cost.sort_unstable_by(|&a, &b| pairs[a].cost.total_cmp(&pairs[b].cost).then(a.cmp(&b)));
    }

    /// Lists a pair where the two have an area in common.
    fn push_common(&mut self, k: usize, s: usize, expected: &Expected, detection: &Detection, distance: f64) -> bool {
        polygon::intersection(&expected.outline_m, &detection.outline_m, &mut self.common, &mut self.spare);
        let common = polygon::area(&self.common);
        if common > 0.0 {
            self.pairs.push(Pair {
                known: k,
                seen: s,
                cost: cost(expected, detection, distance),
                share_of_known: common / expected.area.max(1e-12),
                share_of_seen: common / detection.area.max(1e-12),
            });
        }
        common > 0.0
    }

    /// Each takes the cheapest that is still free.
    fn pair_off(&mut self, known: usize, seen: usize) {
        reset(&mut self.seen_of, known, None);
        reset(&mut self.taken, seen, false);
        for pair in self.by_cost.iter().map(|&i| self.pairs[i]) {
            if self.seen_of[pair.known].is_none() && !self.taken[pair.seen] {
                self.seen_of[pair.known] = Some(pair.seen);
                self.taken[pair.seen] = true;
            }
        }
    }

    /// The cheapest first is not the cheapest in all: swaps two where that costs less together.
    fn swap_where_better(&mut self, seen: usize) {
        reset(&mut self.owner_of, seen, None);
        for (known, &seen) in self.seen_of.iter().enumerate() {
            if let Some(seen) = seen {
                self.owner_of[seen] = Some(known);
            }
        }
        for _round in 0..MOST_ROUNDS {
            let mut swapped = false;
            for i in 0..self.pairs.len() {
                swapped |= self.swap_if_better(self.pairs[i]);
            }
            if !swapped {
                return;
            }
        }
    }

    /// Gives the thing known of a pair the thing seen of it, and that one's owner the other.
    fn swap_if_better(&mut self, pair: Pair) -> bool {
        let (a, j) = (pair.known, pair.seen);
        let (Some(i), Some(b)) = (self.seen_of[a], self.owner_of[j]) else { return false };
        let (Some(ai), Some(bj), Some(bi)) = (self.cost_of(a, i), self.cost_of(b, j), self.cost_of(b, i)) else {
            return false;
        };
        if a == b || pair.cost + bi + 1e-12 >= ai + bj {
            return false;
        }
        (self.seen_of[a], self.seen_of[b]) = (Some(j), Some(i));
        (self.owner_of[j], self.owner_of[i]) = (Some(a), Some(b));
        true
    }

    /// Pairs are listed by thing known, then by thing seen.
    fn cost_of(&self, known: usize, seen: usize) -> Option<f64> {
        let place = self.pairs.binary_search_by(|p| p.known.cmp(&known).then(p.seen.cmp(&seen)));
        place.ok().map(|i| self.pairs[i].cost)
    }

    fn of_known(&self, known: usize) -> &[Pair] {
        let from = self.pairs.partition_point(|p| p.known < known);
        let to = self.pairs.partition_point(|p| p.known <= known);
        &self.pairs[from..to]
    }

    /// Leftovers: things known that are within another's detection, and detections that are pieces of a thing known.
    fn share(&mut self, seen: usize) {
        reset(&mut self.piece_of, seen, None);
        for k in 0..self.seen_of.len() {
            if self.seen_of[k].is_none() {
                let within = self.of_known(k).iter().filter(|p| p.share_of_known > IN_IT);
                let best = within.max_by(|a, b| a.share_of_known.total_cmp(&b.share_of_known));
                self.seen_of[k] = best.map(|p| p.seen);
            }
        }
        reset(&mut self.sharers, seen, 0);
        self.seen_of.iter().flatten().for_each(|&s| self.sharers[s] += 1);
        reset(&mut self.piece_share, seen, 0.0);
        for pair in &self.pairs {
            let s = pair.seen;
            if self.sharers[s] == 0 && pair.share_of_seen > A_PIECE && pair.share_of_seen > self.piece_share[s] {
                self.piece_share[s] = pair.share_of_seen;
                self.piece_of[s] = Some(pair.known);
            }
        }
        self.is_alone.clear();
        self.is_alone.extend(self.seen_of.iter().map(|seen| seen.is_some_and(|s| self.sharers[s] == 1)));
    }
}

/// How unlikely it is that the thing seen is the one expected: place, size and brightness, each about 1 where doubtful.
fn cost(expected: &Expected, detection: &Detection, distance: f64) -> f64 {
    let size = (expected.area.max(1e-9) / detection.area.max(1e-9)).ln().abs();
    let brightness = (expected.brightness - detection.brightness).abs();
    let radius = (expected.area / std::f64::consts::PI).sqrt();
    distance / (radius + 1e-6) + 0.5 * size.min(2.0) + (brightness / 40.0).min(2.0)
}

fn radius(outline_m: &[Point2], centre_m: Point2) -> f64 {
    outline_m.iter().map(|&p| (p - centre_m).length()).fold(0.0, f64::max)
}

fn reset<T: Clone>(list: &mut Vec<T>, n: usize, value: T) {
    list.clear();
    list.resize(n, value);
}
