//! The moments at which solids begin to touch during a run.

use elbowroom_kinematics::ChainState;
use elbowroom_proximity::impact::Path;
use elbowroom_proximity::{collides, separation_within};
use elbowroom_spatial::{Aabb, Pose};

use crate::pairs::{is_moved, joined_without_solids, joints_between, motion_bound, pairs, radius};
use crate::{Body, Member, Object, Robot};

/// Looks for the first contact of each pair while robots and objects move in small steps.
///
/// From one look to the next every joint goes at a constant rate, and an object along its path. A pair that was found
/// `d` apart is not looked at again before its members can have moved by `d`; where they have, the time between the
/// looks is searched too, so that nothing thin or fast slips through: what goes deeper than 10 µm and lasts longer than a
/// thousandth of that time, is found.
///
/// Links of one robot with no solid between them that touch at the first look do not begin to touch: such a contact counts
/// once they have been apart. [`resting_contacts`](crate::pairs::resting_contacts) tells which they are.
#[derive(Debug)]
pub struct FirstContacts<'a> {
    robots: Vec<(&'a Robot, Pose)>,
    objects: &'a [Object],
    /// Axis-aligned boxes of the bodies in their own frames, per robot, link and body.
    boxes: Vec<Vec<Vec<Aabb>>>,
    object_boxes: Vec<Aabb>,
    /// Where objects are now, with their boxes.
    placed: Vec<(Pose, Aabb)>,
    /// Joint values at the last look; empty before the first.
    last: Vec<Vec<f64>>,
    pairs: Vec<Watched>,
}

/// A pair that touches for the first time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstContact {
    /// The first of the pair.
    pub a: Member,
    /// The other.
    pub b: Member,
    /// When, as a fraction of the time since the last look: 1 is now.
    pub fraction: f64,
}

/// How an object goes from the last look to this one.
#[derive(Clone, Copy)]
pub struct ObjectStep<'m> {
    /// Index of the object.
    pub object: usize,
    /// Its path; `t = 1` is now.
    pub path: &'m dyn Path,
    /// True where it was elsewhere before, not on the way (a belt that begins again): it is looked at now only.
    pub jumps: bool,
}

#[derive(Debug)]
struct Watched {
    a: Member,
    b: Member,
    /// What moves it.
    levers: Vec<Lever>,
    /// Distance (m) of the object's farthest point from its origin, where one of the pair is an object that moves.
    free: Option<(usize, f64)>,
    /// What that object went since the last measurement, m.
    travel: f64,
    /// Nothing can happen before the members have moved by this, m. Negative: never measured.
    clear: f64,
    touched: bool,
    /// No solid stands between the two: they may be built to overlap.
    joined: bool,
    /// In contact since the first look.
    resting: bool,
}

#[derive(Debug)]
struct Lever {
    robot: usize,
    /// Index in q.
    joint: usize,
    /// m per unit.
    reach: f64,
    /// Value at the last measurement.
    then: f64,
}

/// Beyond this (m) a lower bound is good enough.
const NEAR: f64 = 0.05;
/// The search between two looks leaves out contacts that go no deeper than this, m,
const FINEST: f64 = 1e-5;
/// and those that last no longer than this share of the time, so that it ends whatever the speeds.
const SHORTEST: f64 = 1e-3;

impl<'a> FirstContacts<'a> {
    /// For robots with their bases in the world, and objects.
    pub fn new(robots: Vec<(&'a Robot, Pose)>, objects: &'a [Object]) -> Self {
        let local = |b: &Body| b.shape.aabb(&Pose::IDENTITY);
        let boxes =
            robots.iter().map(|(r, _)| r.bodies.iter().map(|l| l.iter().map(local).collect()).collect()).collect();
        let list = pairs(&robots.iter().map(|r| r.0).collect::<Vec<_>>(), objects.len());
        let pairs = list.into_iter().map(|(a, b)| watched(&robots, a, b)).collect();
        let object_boxes = objects.iter().map(|o| o.shape.aabb(&Pose::IDENTITY)).collect();
        let placed = objects.iter().map(|o| (o.in_world, o.shape.aabb(&o.in_world))).collect();
        Self { robots, objects, boxes, object_boxes, placed, last: Vec::new(), pairs }
    }

    /// Tells which objects move by themselves: links that stand still can meet those too.
    #[must_use]
    pub fn moving(mut self, objects: &[usize]) -> Self {
        for &o in objects {
            for (r, (robot, _)) in self.robots.iter().enumerate() {
                let solid = |l: &usize| !robot.bodies[*l].is_empty();
                for link in (0..robot.bodies.len()).filter(solid).map(elbowroom_kinematics::LinkId) {
                    if !is_moved(&robot.chain, link) {
                        self.pairs.push(watched(&self.robots, Member::Link { robot: r, link }, Member::Object(o)));
                    }
                }
            }
            let radius = self.object_boxes.get(o).map_or(0.0, |b| b.min.abs().max(b.max.abs()).length());
            for pair in self.pairs.iter_mut().filter(|p| p.a == Member::Object(o) || p.b == Member::Object(o)) {
                pair.free = Some((o, radius));
            }
        }
        self
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.pairs.len()
    }

    /// True where nothing can meet.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Calls `found` for each pair that touched since the last look (or, at the first, touches) and never did before.
    /// `states` holds forward kinematics, one per robot; `steps` the objects that were named as [`Self::moving`].
    pub fn check(&mut self, states: &[&ChainState], steps: &[ObjectStep<'_>], mut found: impl FnMut(FirstContact)) {
        for step in steps {
            let pose = step.path.pose(1.0);
            self.placed[step.object] = (pose, self.object_boxes[step.object].transformed(&pose));
        }
        let Self { robots, objects, boxes, object_boxes, placed, last, pairs } = self;
        let world = World { robots, objects, boxes, placed, states };
        let between = Between { world: &world, object_boxes, last, steps };
        for pair in pairs.iter_mut().filter(|p| !p.touched) {
            let step = pair.free.and_then(|(o, radius)| Some((steps.iter().find(|s| s.object == o)?, radius)));
            let travel = step.map_or(0.0, |(s, radius)| s.path.speed(radius, 0.0, 1.0));
            let jumped = step.is_some_and(|(s, _)| s.jumps);
            pair.travel += travel;
            let moved = pair.moved(|l| states[l.robot].q[l.joint]);
            // NaN (an unlimited stroke that did not move) must look again.
            if !jumped && (moved + pair.travel < pair.clear || (pair.resting && moved == 0.0)) {
                continue;
            }
            let gap = world.gap(pair.a, pair.b);
            if pair.resting || (last.is_empty() && pair.joined) {
                pair.resting = gap.is_none();
                pair.measured(states, gap);
                continue;
            }
            let first =
                if jumped || last.is_empty() { gap.is_none().then_some(1.0) } else { between.first(pair, travel, gap) };
            pair.measured(states, gap);
            if let Some(fraction) = first {
                pair.touched = true;
                found(FirstContact { a: pair.a, b: pair.b, fraction });
            }
        }
        last.resize(states.len(), Vec::new());
        for (last, state) in last.iter_mut().zip(states) {
            last.clone_from(&state.q);
        }
    }
}

impl Watched {
    /// How far joints can have moved its members since the last measurement, m.
    fn moved(&self, now: impl Fn(&Lever) -> f64) -> f64 {
        self.levers.iter().map(|l| l.reach * (now(l) - l.then).abs()).sum()
    }

    fn measured(&mut self, states: &[&ChainState], gap: Option<f64>) {
        self.levers.iter_mut().for_each(|l| l.then = states[l.robot].q[l.joint]);
        self.travel = 0.0;
        // A hair less, for what rounding does to sums of levers.
        self.clear = gap.unwrap_or(0.0) * 0.999;
    }
}

/// The time from the last look to this.
struct Between<'w, 'a> {
    world: &'w World<'w, 'a>,
    object_boxes: &'w [Aabb],
    last: &'w [Vec<f64>],
    steps: &'w [ObjectStep<'w>],
}

impl Between<'_, '_> {
    /// The first contact of a pair that is `gap` apart now, as a fraction. Its object went `travel` m.
    fn first(&self, pair: &Watched, travel: f64, gap: Option<f64>) -> Option<f64> {
        let now = |l: &Lever| self.world.states[l.robot].q[l.joint];
        let before = |l: &Lever| self.last[l.robot][l.joint];
        let way: f64 = travel + pair.levers.iter().map(|l| l.reach * (now(l) - before(l)).abs()).sum::<f64>();
        // Without a bound only instants are looked at.
        if !way.is_finite() {
            return gap.is_none().then_some(1.0);
        }
        let room = pair.clear - pair.moved(before) - (pair.travel - travel);
        self.search(pair, way, (0.0, room), (1.0, gap))
    }

    /// The first contact between two fractions of the time with the gaps there; in all of it the gap changes by `way` m
    /// at most.
    fn search(&self, pair: &Watched, way: f64, from: (f64, f64), to: (f64, Option<f64>)) -> Option<f64> {
        // From either end the gap lasts for a while: contact can only be in between.
        let first = from.0 + from.1.max(0.0) / way;
        let last = to.0 - to.1.unwrap_or(0.0) * 0.999 / way;
        // True for NaN, too: where nothing moved.
        if !(last - first > (2.0 * FINEST / way).max(SHORTEST)) {
            return to.1.is_none().then_some(to.0);
        }
        let middle = 0.5 * (first + last);
        match self.gap(pair, middle) {
            None => self.search(pair, way, from, (middle, None)),
            Some(gap) => self
                .search(pair, way, from, (middle, Some(gap)))
                .or_else(|| self.search(pair, way, (middle, gap * 0.999), to)),
        }
    }

    /// The gap of a pair at a fraction of the time.
    fn gap(&self, pair: &Watched, at: f64) -> Option<f64> {
        let mut states: Vec<ChainState> = self.world.states.iter().map(|s| (*s).clone()).collect();
        for (r, state) in states.iter_mut().enumerate().filter(|(r, _)| pair.levers.iter().any(|l| l.robot == *r)) {
            state.q.iter_mut().zip(&self.last[r]).for_each(|(q, last)| *q = last + at * (*q - last));
            self.world.robots[r].0.chain.forward(state);
        }
        let mut placed = self.world.placed.to_vec();
        for s in self.steps {
            let pose = s.path.pose(at);
            placed[s.object] = (pose, self.object_boxes[s.object].transformed(&pose));
        }
        let states: Vec<&ChainState> = states.iter().collect();
        World { states: &states, placed: &placed, ..*self.world }.gap(pair.a, pair.b)
    }
}

fn watched(robots: &[(&Robot, Pose)], a: Member, b: Member) -> Watched {
    let mut levers = Vec::new();
    let side = |m: Member, other: Member| -> Vec<Lever> {
        let Member::Link { robot, link } = m else { return Vec::new() };
        let chain = &robots[robot].0.chain;
        let joints = match other {
            Member::Link { robot: same, link: other } if same == robot => joints_between(chain, link, other),
            _ => chain.path(link),
        };
        let radius = radius(&robots[robot].0.bodies[link.0]);
        let bounds = motion_bound(chain, link, radius, &joints);
        bounds.into_iter().map(|(joint, reach)| Lever { robot, joint, reach, then: 0.0 }).collect()
    };
    levers.extend(side(a, b));
    levers.extend(side(b, a));
    let joined = match (a, b) {
        (Member::Link { robot, link }, Member::Link { robot: same, link: other }) if robot == same => {
            joined_without_solids(robots[robot].0, link, other)
        }
        _ => false,
    };
    Watched { a, b, levers, free: None, travel: 0.0, clear: -1.0, touched: false, joined, resting: false }
}

/// Everything at one instant.
#[derive(Clone, Copy)]
struct World<'w, 'a> {
    robots: &'w [(&'a Robot, Pose)],
    objects: &'a [Object],
    boxes: &'w [Vec<Vec<Aabb>>],
    placed: &'w [(Pose, Aabb)],
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
            Member::Object(o) => (&self.objects[o].shape, self.placed[o].0, self.placed[o].1),
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
