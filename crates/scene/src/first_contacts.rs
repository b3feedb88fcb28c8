//! The moments at which solids begin to touch during a run.

use elbowroom_kinematics::ChainState;
use elbowroom_proximity::{collides, separation_within};
use elbowroom_spatial::{Aabb, Pose};

use crate::pairs::{joints_between, motion_bound, pairs, radius};
use crate::{Body, Member, Object, Robot};

/// Looks for the first contact of each pair while robots move in small steps.
///
/// A pair that was found `d` apart is not looked at again before its members can have moved by `d`.
#[derive(Debug)]
pub struct FirstContacts<'a> {
    robots: Vec<(&'a Robot, Pose)>,
    objects: &'a [Object],
    /// Axis-aligned boxes of the bodies in their own frames, per robot, link and body.
    boxes: Vec<Vec<Vec<Aabb>>>,
    object_boxes: Vec<Aabb>,
    pairs: Vec<Watched>,
}

#[derive(Debug)]
struct Watched {
    a: Member,
    b: Member,
    /// (robot, index in q, m per unit, value at the last look).
    levers: Vec<(usize, usize, f64, f64)>,
    /// Nothing can happen before the members have moved by this, m. Negative: never looked at.
    clear: f64,
    touched: bool,
}

/// Beyond this (m) a lower bound is good enough.
const NEAR: f64 = 0.05;

impl<'a> FirstContacts<'a> {
    /// For robots with their bases in the world, and objects.
    pub fn new(robots: Vec<(&'a Robot, Pose)>, objects: &'a [Object]) -> Self {
        let local = |b: &Body| b.shape.aabb(&Pose::IDENTITY);
        let boxes =
            robots.iter().map(|(r, _)| r.bodies.iter().map(|l| l.iter().map(local).collect()).collect()).collect();
        let list = pairs(&robots.iter().map(|r| r.0).collect::<Vec<_>>(), objects.len());
        let pairs = list.into_iter().map(|(a, b)| watched(&robots, a, b)).collect();
        let object_boxes = objects.iter().map(|o| o.shape.aabb(&o.in_world)).collect();
        Self { robots, objects, boxes, object_boxes, pairs }
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.pairs.len()
    }

    /// True where nothing can meet.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Calls `found` for each pair that touches now and never did before. `states` holds forward kinematics, one per robot.
    pub fn check(&mut self, states: &[&ChainState], mut found: impl FnMut(Member, Member)) {
        let Self { robots, objects, boxes, object_boxes, pairs } = self;
        let world = World { robots, objects, boxes, object_boxes, states };
        for pair in pairs.iter_mut().filter(|p| !p.touched) {
            let moved: f64 =
                pair.levers.iter().map(|(r, j, lever, then)| lever * (states[*r].q[*j] - then).abs()).sum();
            // NaN (an unlimited stroke that did not move) must look again.
            if moved < pair.clear {
                continue;
            }
            pair.levers.iter_mut().for_each(|(r, j, _, then)| *then = states[*r].q[*j]);
            let gap = world.gap(pair.a, pair.b);
            // A hair less, for what rounding does to sums of levers.
            pair.clear = gap.unwrap_or(0.0) * 0.999;
            if gap.is_none() {
                pair.touched = true;
                found(pair.a, pair.b);
            }
        }
    }
}

fn watched(robots: &[(&Robot, Pose)], a: Member, b: Member) -> Watched {
    let mut levers = Vec::new();
    let side = |m: Member, other: Member| -> Vec<(usize, usize, f64, f64)> {
        let Member::Link { robot, link } = m else { return Vec::new() };
        let chain = &robots[robot].0.chain;
        let joints = match other {
            Member::Link { robot: same, link: other } if same == robot => joints_between(chain, link, other),
            _ => chain.path(link),
        };
        let radius = radius(&robots[robot].0.bodies[link.0]);
        motion_bound(chain, link, radius, &joints).into_iter().map(|(j, lever)| (robot, j, lever, 0.0)).collect()
    };
    levers.extend(side(a, b));
    levers.extend(side(b, a));
    Watched { a, b, levers, clear: -1.0, touched: false }
}

struct World<'w, 'a> {
    robots: &'w [(&'a Robot, Pose)],
    objects: &'a [Object],
    boxes: &'w [Vec<Vec<Aabb>>],
    object_boxes: &'w [Aabb],
    states: &'w [&'w ChainState],
}

impl<'a> World<'_, 'a> {
    fn count(&self, m: Member) -> usize {
        match m {
            Member::Link { robot, link } => self.robots[robot].0.bodies[link.0].len(),
            Member::Object(_) => 1,
        }
    }

    fn solid(&self, m: Member, i: usize) -> (&'a elbowroom_proximity::Shape, Pose, Aabb) {
        match m {
            Member::Object(o) => (&self.objects[o].shape, self.objects[o].in_world, self.object_boxes[o]),
            Member::Link { robot, link } => {
                let (model, base) = &self.robots[robot];
                let body = &model.bodies[link.0][i];
                let pose = *base * self.states[robot].link_in_root(link) * body.in_link;
                (&body.shape, pose, self.boxes[robot][link.0][i].transformed(&pose))
            }
        }
    }

    /// A proven lower bound of the distance; `None` on contact.
    fn gap(&self, a: Member, b: Member) -> Option<f64> {
        let mut least = f64::INFINITY;
        for i in 0..self.count(a) {
            let (shape_a, pose_a, box_a) = self.solid(a, i);
            for k in 0..self.count(b) {
                let (shape_b, pose_b, box_b) = self.solid(b, k);
                let apart = box_a.distance(&box_b);
                if apart > NEAR {
                    least = least.min(apart);
                    continue;
                }
                let bound = match separation_within(shape_a, &pose_a, shape_b, &pose_b, NEAR) {
                    None => NEAR,
                    Some(s) => s.lower_bound,
                };
                if bound <= 0.0 && collides(shape_a, &pose_a, shape_b, &pose_b) {
                    return None;
                }
                least = least.min(bound);
            }
        }
        Some(least)
    }
}
