//! The steady one of several nearest pairs: a second look at all that are as near as the nearest to within a hair.

use elbowroom_spatial::Vec3;
use fearless_simd::Level;

use super::leaf::{Facing as Faced, filled, near};
use super::limit::Limit;
use super::node::{NEAR, open};
use super::placement::Pairing;
use super::scratch::{Entry, Scratch, corners_in_a, filling, settle};
use super::search::Best;
use super::tree::LEAF;
use crate::TriMesh;
use crate::patch::{Facing, GRAIN, Polygon, SMALL, Wide, between, settled};
use crate::shape::hull::farthest;
use crate::triangle::{Near, nearest_on_triangle};

/// Sizes of a pair of meshes, units of A.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sizes {
    pub grain: f64,
    pub small: f64,
}

impl Sizes {
    pub fn of(a: &TriMesh, b: &TriMesh) -> Self {
        let size = (a.tree.radius + b.tree.radius) * a.tree.frame.inverse;
        Self { grain: GRAIN * size, small: SMALL * size }
    }
}

/// True where the nearest points lie on faces or edges that are so nearly parallel that others are as good.
pub(super) fn is_flat(a: &TriMesh, b: &TriMesh, pairing: &Pairing, best: &Best, sizes: Sizes) -> bool {
    let Some(along) = (best.near.on_b - best.near.on_a).try_normalize() else { return false };
    let (ta, tb) = best.triangles;
    let (s, t) = corners_in_a(a, ta as usize, b, tb as usize, pairing);
    let wide = |t: &[Vec3; 3], along| Wide::of(t.iter().copied(), farthest(t, along), along, sizes.grain, sizes.small);
    wide(&s, along).meets(wide(&t, -along), sizes.grain, sizes.small)
}

struct Choice<'a> {
    a: &'a TriMesh,
    b: &'a TriMesh,
    pairing: &'a Pairing,
    facing: Facing,
    /// Pairs farther apart are none.
    radius: f64,
    /// The nearest points found first, and how far others may be from them and be the same.
    first: Vec3,
    small: f64,
    /// There is a choice: points of a pair lie apart, or pairs do.
    open: bool,
    /// Scores that differ by less are equal, and the smaller numbers count: so nothing depends on the order.
    step: f64,
    best: Option<(f64, (u32, u32), Vec3, Vec3)>,
}

/// The nearest points, and their triangles, that lie nearest to the middle among all pairs within the grain of the best;
/// `None` where there is no choice. Which of them were seen before, and in which order, makes no difference.
pub(super) fn steady(
    level: Level,
    a: &TriMesh,
    b: &TriMesh,
    pairing: &Pairing,
    best: &Best,
    scratch: &mut Scratch,
) -> Option<(Near, (u32, u32))> {
    let sizes = Sizes::of(a, b);
    let inverse = a.tree.frame.inverse;
    let (ra, rb) = (a.tree.radius * inverse, b.tree.radius * inverse);
    let middle = between(Vec3::ZERO, ra, pairing.in_a(Vec3::ZERO), rb);
    let facing = facing(a, b, pairing, best, middle, sizes.grain)?;
    let radius = best.distance + sizes.grain;
    let (first, small) = (best.near.on_a, sizes.small);
    let mut choice =
        Choice { a, b, pairing, facing, radius, first, small, open: false, step: 1e-3 * small, best: None };
    choice.run(level, scratch);
    if !choice.open {
        return None;
    }
    let (_, triangles, on_a, on_b) = choice.best?;
    Some((Near { squared: best.distance * best.distance, on_a, on_b }, triangles))
}

/// The direction in which the two nearest triangles are farthest apart: that of the nearest points, unless they are so
/// close that it has lost its digits and a face's normal tells more.
fn facing(a: &TriMesh, b: &TriMesh, pairing: &Pairing, best: &Best, middle: Vec3, grain: f64) -> Option<Facing> {
    let (s, t) = corners_in_a(a, best.triangles.0 as usize, b, best.triangles.1 as usize, pairing);
    let sight = (best.near.on_b - best.near.on_a).try_normalize()?;
    let ends = |d: Vec3| {
        let high = s.iter().fold(f64::NEG_INFINITY, |m, p| m.max(d.dot(*p)));
        [high, t.iter().fold(f64::INFINITY, |m, p| m.min(d.dot(*p)))]
    };
    let toward = |t: &[Vec3; 3]| {
        let n = (t[1] - t[0]).cross(t[2] - t[0]).try_normalize()?;
        Some(if n.dot(sight) < 0.0 { -n } else { n })
    };
    let all = [Some(sight), toward(&s), toward(&t)];
    let apart = |d: &Vec3| ends(*d)[1] - ends(*d)[0];
    let along = all.into_iter().flatten().max_by(|d, e| apart(d).total_cmp(&apart(e)))?;
    Some(Facing { along, ends: ends(along), grain, middle })
}

impl Choice<'_> {
    fn run(&mut self, level: Level, scratch: &mut Scratch) {
        let limit = Limit::new(self.radius, self.pairing);
        let Scratch { stack, queue, visits, .. } = scratch;
        let trees = (&self.a.tree, &self.b.tree);
        queue.clear();
        stack.clear();
        stack.push(Entry::root(trees.0, trees.1));
        while let Some(pair) = stack.pop() {
            if pair.key > limit.squared {
                continue;
            }
            if !pair.is_leaves() {
                visits.nodes += 1;
                visits.boxes += open::<NEAR>(level, trees, &pair, self.pairing, &limit, stack);
                continue;
            }
            visits.leaves += 1;
            let (leaf_a, leaf_b) = (pair.a as usize, pair.b as usize);
            let all = filled(filling(trees.0, leaf_a), filling(trees.1, leaf_b));
            let (of_a, of_b) = (&trees.0.leaves[leaf_a], &trees.1.leaves[leaf_b]);
            let mut faced = Faced::NOTHING;
            let mut left = near(level, of_a, of_b, self.pairing, &limit, &mut faced, all);
            while left != 0 {
                let bit = left.trailing_zeros();
                left &= left - 1;
                visits.triangles += 1;
                self.look(pair.a * LEAF as u32 + bit / 8, pair.b * LEAF as u32 + bit % 8);
            }
        }
    }

    /// Measures a pair of slots that could be better.
    fn look(&mut self, slot_a: u32, slot_b: u32) {
        let (ta, tb) = (self.a.tree.triangle(slot_a), self.b.tree.triangle(slot_b));
        let (s, t) = corners_in_a(self.a, ta, self.b, tb, self.pairing);
        let reach = self.best.map_or(f64::INFINITY, |b| (b.0 + 1.0) * self.step);
        let nearest = |t: &[Vec3; 3]| (nearest_on_triangle(self.facing.middle, *t) - self.facing.middle).length();
        if self.open && nearest(&s) > reach {
            return;
        }
        let found = settle(self.a, ta, self.b, tb, self.pairing);
        if !(found.squared <= self.radius * self.radius) {
            return;
        }
        self.open |= found.on_a.distance(self.first) > self.small;
        self.offer(found.on_a, found.on_b, (ta as u32, tb as u32));
        if let Some((on_a, _, size)) = self.facing.pair(&Polygon::new(s), &Polygon::new(t)) {
            let (on_a, on_b) = settled(on_a, &|q| nearest_on_triangle(q, s), &|p| nearest_on_triangle(p, t));
            // Where the faces look elsewhere, ends along the common direction say nothing.
            let most = self.radius + 2.0 * self.facing.grain;
            if (on_a - on_b).length_squared() <= most * most {
                self.open |= size > self.small;
                self.offer(on_a, on_b, (ta as u32, tb as u32));
            }
        }
    }

    fn offer(&mut self, on_a: Vec3, on_b: Vec3, triangles: (u32, u32)) {
        let score = ((on_a - self.facing.middle).length() / self.step).round();
        if self.best.is_none_or(|b| (score, triangles) < (b.0, b.1)) {
            self.best = Some((score, triangles, on_a, on_b));
        }
    }
}
