//! Two members against each other.

use elbowroom_proximity::contact::{ContactPoint, Detail, contact_at};
use elbowroom_proximity::mesh::{Hint, Scratch, bound_at, bound_of};
use elbowroom_proximity::{Separation, Shape, separation_within};
use elbowroom_spatial::{Obb, Pose, Vec3};

use crate::model::{Model, Solid};
use crate::world_box::{WorldBox, round_up};
use crate::{Counts, Level, Scene, SceneState, obb};

/// What comparing two members takes: memory, and counts of what was done.
#[derive(Debug)]
pub(crate) struct Narrow {
    scratch: Scratch,
    /// World boxes of one member's solids.
    bounds: Vec<WorldBox>,
    pub counts: Counts,
}

/// A model and where it is.
#[derive(Clone, Copy)]
pub(crate) struct Placed<'s> {
    pub model: &'s Model,
    pub in_world: Pose,
}

impl<'s> Placed<'s> {
    pub fn new(scene: &'s Scene, state: &SceneState, model: usize) -> Self {
        Self { model: &scene.models[model], in_world: state.in_world[model] }
    }

    pub fn obb(&self) -> Option<Obb> {
        self.model.obb.map(|o| Obb { pose: self.in_world * o.pose, ..o })
    }
}

impl Narrow {
    pub fn new(scene: &Scene) -> Self {
        let most = scene.models.iter().map(|m| m.exact.len()).max().unwrap_or(0);
        Self { scratch: Scratch::new(), bounds: Vec::with_capacity(most), counts: Counts::default() }
    }

    /// The coarse level at which two members are certainly farther apart than `limit` metres.
    pub fn cleared_coarsely(&mut self, a: &Placed, b: &Placed, limit: f64) -> Option<Level> {
        if !(a.model.complex || b.model.complex) {
            return None;
        }
        if let (Some(x), Some(y)) = (a.obb(), b.obb()) {
            self.counts.pairs_tested.l2 += 1;
            if obb::gap(&x, &y) > limit {
                return Some(Level::L2);
            }
        }
        if a.model.slim || b.model.slim {
            self.counts.pairs_tested.capsule += 1;
            let ([x], [y]) = (enclosure(a.model), enclosure(b.model)) else { return None };
            let (in_a, in_b) = (a.in_world * x.in_member, b.in_world * y.in_member);
            if separation_within(&x.shape, &in_a, &y.shape, &in_b, limit).is_none() {
                return Some(Level::Capsule);
            }
        }
        None
    }

    /// Metres that the boxes around two members certainly have between them; -∞ where boxes are no cheaper than solids.
    pub fn gap(&mut self, a: &Placed, b: &Placed) -> f64 {
        match (a.obb(), b.obb()) {
            (Some(x), Some(y)) if a.model.complex || b.model.complex => {
                self.counts.pairs_tested.l2 += 1;
                obb::gap(&x, &y)
            }
            _ => f64::NEG_INFINITY,
        }
    }

    /// True where the models of a level are not certainly farther apart than `limit` metres.
    pub fn touch(&mut self, a: &Placed, b: &Placed, level: Level, limit: f64) -> bool {
        self.counts.pairs_tested.add(level, 1);
        let (of_a, of_b) = (a.model.at(level), b.model.at(level));
        if let ([x], [y]) = (of_a, of_b) {
            return self.solids_touch(x, &a.in_world, y, &b.in_world, limit);
        }
        let margin = round_up(limit);
        self.fill_bounds(of_b, &b.in_world);
        for x in of_a {
            let bounds = WorldBox::of_aabb(&x.bounds.transformed(&a.in_world));
            for (j, y) in of_b.iter().enumerate() {
                if !bounds.clear(&self.bounds[j], margin) && self.solids_touch(x, &a.in_world, y, &b.in_world, limit) {
                    return true;
                }
            }
        }
        false
    }

    fn solids_touch(&mut self, x: &Solid, a_in_world: &Pose, y: &Solid, b_in_world: &Pose, limit: f64) -> bool {
        let (in_a, in_b) = (*a_in_world * x.in_member, *b_in_world * y.in_member);
        let touch = if limit > 0.0 {
            self.scratch.within(&x.shape, &in_a, &y.shape, &in_b, limit)
        } else {
            self.scratch.collides(&x.shape, &in_a, &y.shape, &in_b)
        };
        self.count_meshes(x, y);
        touch
    }

    /// Counts the work of the last question, which was about these.
    fn count_meshes(&mut self, x: &Solid, y: &Solid) {
        if let (Shape::Mesh(_), Shape::Mesh(_)) = (&x.shape, &y.shape) {
            self.counts.meshes(self.scratch.visits());
        }
    }

    /// Distance between the models of a level, or `None` where it is certainly above `limit` metres.
    pub fn measure(
        &mut self,
        a: &Placed,
        b: &Placed,
        level: Level,
        limit: f64,
        hint: &mut (u32, u32, Hint),
    ) -> Option<Separation> {
        self.counts.pairs_tested.add(level, 1);
        let (of_a, of_b) = (a.model.at(level), b.model.at(level));
        if let ([x], [y]) = (of_a, of_b) {
            let (in_a, in_b) = (a.in_world * x.in_member, b.in_world * y.in_member);
            let found = self.scratch.separation(&x.shape, &in_a, &y.shape, &in_b, limit, &mut hint.2);
            self.count_meshes(x, y);
            return found;
        }
        // The two that were nearest last time give a limit to the others.
        let (first, mut best, mut limit) = ((hint.0 as usize, hint.1 as usize), None, limit);
        if let (Some(x), Some(y)) = (of_a.get(first.0), of_b.get(first.1)) {
            let (in_a, in_b) = (a.in_world * x.in_member, b.in_world * y.in_member);
            best = self.scratch.separation(&x.shape, &in_a, &y.shape, &in_b, limit, &mut hint.2);
            self.count_meshes(x, y);
            limit = best.map_or(limit, |s: Separation| s.distance);
        }
        self.fill_bounds(of_b, &b.in_world);
        for (i, x) in of_a.iter().enumerate() {
            let bounds = WorldBox::of_aabb(&x.bounds.transformed(&a.in_world));
            for (j, y) in of_b.iter().enumerate() {
                if (i, j) == first || f64::from(bounds.gap(&self.bounds[j])) > limit {
                    continue;
                }
                let (in_a, in_b) = (a.in_world * x.in_member, b.in_world * y.in_member);
                let mut fresh = Hint::default();
                let found = self.scratch.separation(&x.shape, &in_a, &y.shape, &in_b, limit, &mut fresh);
                self.count_meshes(x, y);
                let Some(s) = found else { continue };
                best = Some(nearer(best, s));
                if best == Some(s) {
                    *hint = (i as u32, j as u32, fresh);
                }
                limit = limit.min(s.distance);
            }
        }
        best
    }

    /// Metres that two members certainly have between them by the boxes of their meshes down to a depth, and points of the
    /// boxes that are nearest; a little more than `limit` where it is certainly above it. `None` where there are no such boxes.
    pub fn bound_at(&mut self, a: &Placed, b: &Placed, depth: u8, limit: f64) -> Option<(f64, [Vec3; 2])> {
        let ([x], [y]) = (&a.model.exact[..], &b.model.exact[..]) else { return None };
        let (in_a, in_b) = (a.in_world * x.in_member, b.in_world * y.in_member);
        let beyond = (limit + 1e-9 * (1.0 + limit), [in_a.translation, in_b.translation]);
        let coarse = match (&x.shape, &y.shape) {
            (Shape::Mesh(m), Shape::Mesh(n)) => bound_at(m, &in_a, n, &in_b, depth, limit, &mut self.scratch),
            (Shape::Mesh(m), other) => Some(bound_of(m, &in_a, other, &in_b, depth)?),
            (other, Shape::Mesh(m)) => {
                let coarse = bound_of(m, &in_b, other, &in_a, depth)?;
                return Some((coarse.lower_bound, [coarse.on_b, coarse.on_a]));
            }
            _ => return None,
        };
        self.count_meshes(x, y);
        Some(coarse.map_or(beyond, |c| (c.lower_bound, [c.on_a, c.on_b])))
    }

    /// Where the exact models meet, or are no farther apart than `limit` metres, and which of their solids: the first pair
    /// that touches, else the first that is near.
    pub fn meet(
        &mut self,
        a: &Placed,
        b: &Placed,
        detail: Detail,
        limit: f64,
    ) -> Option<((usize, usize), ContactPoint)> {
        self.counts.pairs_tested.add(Level::L3, 1);
        let (of_a, of_b) = (&a.model.exact, &b.model.exact);
        let margin = round_up(limit);
        let mut near = None;
        self.fill_bounds(of_b, &b.in_world);
        for (i, x) in of_a.iter().enumerate() {
            let bounds = WorldBox::of_aabb(&x.bounds.transformed(&a.in_world));
            for (j, y) in of_b.iter().enumerate() {
                if bounds.clear(&self.bounds[j], margin) {
                    continue;
                }
                let (in_a, in_b) = (a.in_world * x.in_member, b.in_world * y.in_member);
                let found = contact_at(&x.shape, &in_a, &y.shape, &in_b, detail, limit, &mut self.scratch);
                self.count_meshes(x, y);
                match found {
                    Some(c) if c.touching => return Some(((i, j), c)),
                    Some(c) => near = near.or(Some(((i, j), c))),
                    None => {}
                }
            }
        }
        near
    }

    /// An upper bound of the distance of the exact models, metres; `None` where it would not come cheap.
    pub fn guess(&mut self, a: &Placed, b: &Placed, hint: &mut (u32, u32, Hint)) -> Option<f64> {
        let ([x], [y]) = (&a.model.exact[..], &b.model.exact[..]) else { return None };
        let (in_a, in_b) = (a.in_world * x.in_member, b.in_world * y.in_member);
        self.scratch.guess(&x.shape, &in_a, &y.shape, &in_b, &mut hint.2)
    }

    fn fill_bounds(&mut self, solids: &[Solid], in_world: &Pose) {
        self.bounds.clear();
        self.bounds.extend(solids.iter().map(|s| WorldBox::of_aabb(&s.bounds.transformed(in_world))));
    }
}

/// The smaller of capsule and box, where there is one.
fn enclosure(model: &Model) -> &[Solid] {
    let solids = if model.slim { &model.capsule } else { &model.cuboid };
    if matches!(solids[..], [Solid { shape: Shape::Capsule(_) | Shape::Cuboid(_), .. }]) { solids } else { &[] }
}

/// The nearer of two, with the lower bound of both.
fn nearer(best: Option<Separation>, s: Separation) -> Separation {
    match best {
        None => s,
        Some(b) if b.distance <= s.distance => Separation { lower_bound: b.lower_bound.min(s.lower_bound), ..b },
        Some(b) => Separation { lower_bound: b.lower_bound.min(s.lower_bound), ..s },
    }
}
