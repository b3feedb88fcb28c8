//! The times at which geometry begins to touch during a simulation.

mod carried_objects;
mod held_object;
mod placed_geometry;

use elbowroom_kinematics::motion_bound::motion_bound;
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_proximity::ccd::RigidMotion;
use elbowroom_robot::{Collider, GeometryId, ObjectId, Robot, RobotId, collision_pairs};
use elbowroom_spatial::{Aabb, Pose, Vec3};

use crate::{Object, PairRules};
use held_object::{Carrier, HeldObject};
use placed_geometry::PlacedGeometry;

/// Finds the first contact of each pair while robots and objects move in small steps.
///
/// Between two calls of [`FirstContacts::check`] every joint moves at a constant rate, and an object along its path. A
/// pair found `d` apart is tested again only after its geometry can have moved by `d`. In that case the time between the
/// calls is searched too, so that thin or fast geometry cannot pass through: every contact deeper than 10 µm that lasts
/// longer than a thousandth of that time is found.
///
/// Links of one robot without a collider between them may touch at the first call. Such a contact counts only after the
/// links have separated. [`rest_pose_contacts`](elbowroom_robot::rest_pose_contacts) lists these pairs.
#[derive(Debug)]
pub struct FirstContacts<'a> {
    robots: Vec<(&'a Robot, Pose)>,
    objects: &'a [Object],
    /// Bounding boxes of the colliders in their own frames, per robot, link and collider.
    boxes: Vec<Vec<Vec<Aabb>>>,
    object_boxes: Vec<Aabb>,
    /// Current poses of the objects, with their boxes.
    placed: Vec<(Pose, Aabb)>,
    /// Joint values at the last call; empty before the first.
    last: Vec<Vec<f64>>,
    pairs: Vec<TrackedPair>,
    /// Per object: how a robot carries it.
    held: Vec<Option<HeldObject>>,
    /// Absent links, such as tools in their stands.
    absent: Vec<(RobotId, LinkId)>,
    /// Which pairs may touch.
    rules: PairRules,
}

/// A pair that touches for the first time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstContact {
    /// First geometry of the pair.
    pub a: GeometryId,
    /// Second geometry of the pair.
    pub b: GeometryId,
    /// Time of the contact as a fraction of the time since the last call: 1 is now.
    pub fraction: f64,
}

/// An object and its motion from the last call to this one.
#[derive(Clone, Copy)]
pub struct MovedObject<'m> {
    /// The object.
    pub object: ObjectId,
    /// Path of the object; `t = 1` is now.
    pub path: &'m dyn RigidMotion,
    /// True if the object jumps to the path without motion in between, such as on a conveyor that begins again.
    ///
    /// Only its current pose is tested then.
    pub jumps: bool,
}

#[derive(Debug)]
struct TrackedPair {
    a: GeometryId,
    b: GeometryId,
    /// The joints that move the pair.
    joints: Vec<PairJoint>,
    /// The object and its radius (m), if one geometry of the pair is an object that moves.
    moving_object: Option<(ObjectId, f64)>,
    /// Distance travelled by that object since the last measurement, m.
    travel: f64,
    /// The pair cannot meet before its geometry has moved by this distance, m. Negative: never measured.
    clear: f64,
    touched: bool,
    /// No collider lies between the two links: they may overlap by design.
    joined: bool,
    /// In contact since the first call, or since an object of the pair was attached or detached.
    resting: bool,
    /// Penetration depth from which a contact counts, for a resting pair with a carried object, m.
    allowed_depth: Option<f64>,
}

#[derive(Debug)]
struct PairJoint {
    robot: RobotId,
    /// Index in `q`.
    index: usize,
    /// Largest displacement of any point, metres per rad or per m.
    motion_bound: f64,
    /// Joint value at the last measurement, rad or m.
    measured_at: f64,
}

/// Contacts at most this deep (m) are ignored in the search between two calls.
const MIN_DEPTH: f64 = 1e-5;
/// Contacts that last at most this fraction of the time are ignored in the search, so that it ends at any speed.
const MIN_DURATION: f64 = 1e-3;
/// Penetration depth from which a permitted contact counts while a part is lifted off or set down, m.
const SET_DOWN_DEPTH: f64 = 1e-3;
/// Factor on measured distances, for the rounding of sums of motion bounds.
const ROUNDING: f64 = 0.999;

impl<'a> FirstContacts<'a> {
    /// Creates the search for robots with their bases in the world, and objects.
    pub fn new(robots: Vec<(&'a Robot, Pose)>, objects: &'a [Object]) -> Self {
        let local = |c: &Collider| c.shape.aabb(&Pose::IDENTITY);
        let boxes =
            robots.iter().map(|(r, _)| r.colliders.iter().map(|l| l.iter().map(local).collect()).collect()).collect();
        let list = collision_pairs(&robots.iter().map(|r| r.0).collect::<Vec<_>>(), objects.len());
        let held = vec![None; objects.len()];
        let pairs = list.into_iter().map(|(a, b)| TrackedPair::new(&robots, &held, a, b)).collect();
        let object_boxes = objects.iter().map(|o| o.shape.aabb(&Pose::IDENTITY)).collect();
        let placed = objects.iter().map(|o| (o.in_world, o.shape.aabb(&o.in_world))).collect();
        Self {
            robots,
            objects,
            boxes,
            object_boxes,
            placed,
            last: Vec::new(),
            pairs,
            held,
            absent: Vec::new(),
            rules: PairRules::default(),
        }
    }

    /// Removes the pairs that the rules skip, including pairs of carried objects.
    #[must_use]
    pub fn skipping(mut self, rules: PairRules) -> Self {
        self.rules = rules;
        self.pairs.retain(|p| self.rules.skipped(p.a, p.b).is_none());
        self
    }

    /// Sets whether a link is present, effective from the last [`check`](Self::check). At first all links are present.
    ///
    /// A pair that touches when its link becomes present counts only after it has separated, or if it is 1 mm deeper.
    pub fn set_present(&mut self, robot: RobotId, link: LinkId, present: bool, states: &[&ChainState]) {
        self.absent.retain(|absent| *absent != (robot, link));
        if !present {
            self.absent.push((robot, link));
            return;
        }
        let id = GeometryId::Link { robot, link };
        let Self { robots, objects, boxes, placed, pairs, .. } = self;
        let now = PlacedGeometry { robots, objects, boxes, placed, states };
        pairs.iter_mut().filter(|p| p.a == id || p.b == id).for_each(|pair| pair.rest_where_in_contact(&now));
    }

    /// Declares which objects move by themselves: they can meet stationary links too.
    #[must_use]
    pub fn moving(mut self, objects: &[ObjectId]) -> Self {
        for &o in objects {
            for (r, (robot, _)) in self.robots.iter().enumerate() {
                for link in robot.links_with_colliders().filter(|l| !robot.chain.is_movable(*l)) {
                    let (link, object) = (GeometryId::Link { robot: RobotId(r), link }, GeometryId::Object(o));
                    if self.rules.skipped(link, object).is_none() {
                        self.pairs.push(TrackedPair::new(&self.robots, &self.held, link, object));
                    }
                }
            }
            let radius = self.object_boxes.get(o.0).map_or(0.0, |b| b.max_distance(Vec3::ZERO));
            let object = GeometryId::Object(o);
            for pair in self.pairs.iter_mut().filter(|p| p.a == object || p.b == object) {
                pair.moving_object = Some((o, radius));
            }
        }
        self
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.pairs.len()
    }

    /// True if the number of pairs is 0.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    fn place_held(&mut self, states: &[&ChainState]) {
        for (o, held) in self.held.iter().enumerate() {
            let Some(held) = held else { continue };
            let pose = held.in_world(&self.robots, states);
            self.placed[o] = (pose, self.object_boxes[o].transformed(&pose));
        }
    }

    /// Calls `found` for each pair that touched for the first time since the last call.
    ///
    /// At the first call, these are the pairs that touch now. `states` holds forward kinematics, one per robot;
    /// `moved_objects` the objects declared by [`Self::moving`].
    pub fn check(
        &mut self,
        states: &[&ChainState],
        moved_objects: &[MovedObject<'_>],
        mut found: impl FnMut(FirstContact),
    ) {
        for s in moved_objects {
            let pose = s.path.pose(1.0);
            self.placed[s.object.0] = (pose, self.object_boxes[s.object.0].transformed(&pose));
        }
        self.place_held(states);
        let Self { robots, objects, boxes, object_boxes, placed, last, pairs, held, absent, .. } = self;
        let now = PlacedGeometry { robots, objects, boxes, placed, states };
        let interval = Interval { now: &now, object_boxes, last, moved_objects, held };
        let is_absent =
            |id: GeometryId| absent.iter().any(|(robot, link)| id == GeometryId::Link { robot: *robot, link: *link });
        for pair in pairs.iter_mut().filter(|p| !p.touched && !is_absent(p.a) && !is_absent(p.b)) {
            let object = pair
                .moving_object
                .and_then(|(o, radius)| Some((moved_objects.iter().find(|s| s.object == o)?, radius)));
            let travel = object.map_or(0.0, |(s, radius)| s.path.speed(radius, 0.0, 1.0));
            let jumped = object.is_some_and(|(s, _)| s.jumps);
            pair.travel += travel;
            let moved = pair.moved(|j| states[j.robot.0].q[j.index]);
            // NaN (an unlimited slide that did not move) requires a new test.
            if !jumped && (moved + pair.travel < pair.clear || (pair.resting && moved == 0.0)) {
                continue;
            }
            let gap = now.gap(pair.a, pair.b);
            if gap.is_none() && pair.resting && pair.is_too_deep(&now) {
                pair.touched = true;
                found(FirstContact { a: pair.a, b: pair.b, fraction: 1.0 });
                continue;
            }
            if pair.resting || (last.is_empty() && pair.joined) {
                pair.resting = gap.is_none();
                pair.measured(states, gap);
                continue;
            }
            let first = if jumped || last.is_empty() {
                gap.is_none().then_some(1.0)
            } else {
                interval.first_contact(pair, travel, gap)
            };
            pair.measured(states, gap);
            if first.is_some() && gap.is_none() && pair.is_set_down(held, &now) {
                continue;
            }
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

impl TrackedPair {
    fn new(robots: &[(&Robot, Pose)], held: &[Option<HeldObject>], a: GeometryId, b: GeometryId) -> Self {
        let side = |id: GeometryId, other: GeometryId| -> Vec<PairJoint> {
            let Some(Carrier { robot, link, radius }) = Carrier::of(id, robots, held) else { return Vec::new() };
            let model = robots[robot.0].0;
            let joints = match Carrier::of(other, robots, held) {
                Some(other) if other.robot == robot => model.chain.joints_between(link, other.link),
                _ => model.chain.path(link),
            };
            let bounds = motion_bound(&model.chain, link, radius, &joints);
            let joint = |(index, motion_bound)| PairJoint { robot, index, motion_bound, measured_at: 0.0 };
            bounds.into_iter().map(joint).collect()
        };
        let mut joints = side(a, b);
        joints.extend(side(b, a));
        let joined = match (a, b) {
            (GeometryId::Link { robot, link }, GeometryId::Link { robot: same, link: other }) if robot == same => {
                robots[robot.0].0.joined_without_colliders(link, other)
            }
            _ => false,
        };
        let (travel, clear) = (0.0, -1.0);
        let moving_object = None;
        let (touched, resting, allowed_depth) = (false, false, None);
        Self { a, b, joints, moving_object, travel, clear, touched, joined, resting, allowed_depth }
    }

    /// Marks a pair that is in contact now as resting: its contact counts only after it has separated or gone deeper.
    fn rest_where_in_contact(&mut self, now: &PlacedGeometry<'_, '_>) {
        let gap = now.gap(self.a, self.b);
        self.resting = gap.is_none();
        self.allowed_depth = self.resting.then(|| now.depth(self.a, self.b) + SET_DOWN_DEPTH);
        self.measured(now.states, gap);
    }

    /// True if a resting pair penetrates deeper than permitted.
    fn is_too_deep(&self, now: &PlacedGeometry<'_, '_>) -> bool {
        self.allowed_depth.is_some_and(|allowed| !(now.depth(self.a, self.b) <= allowed))
    }

    /// True if a part touches the object on which it is set down; the pair rests from then on.
    fn is_set_down(&mut self, held: &[Option<HeldObject>], now: &PlacedGeometry<'_, '_>) -> bool {
        let (GeometryId::Object(a), GeometryId::Object(b)) = (self.a, self.b) else { return false };
        let is_set_down = [a, b].iter().any(|o| held[o.0].as_ref().is_some_and(|h| h.set_down));
        if is_set_down && now.depth(self.a, self.b) <= SET_DOWN_DEPTH {
            (self.resting, self.allowed_depth) = (true, Some(SET_DOWN_DEPTH));
        }
        self.resting
    }

    /// Upper bound (m) on the displacement by joints since the last measurement.
    fn moved(&self, value: impl Fn(&PairJoint) -> f64) -> f64 {
        self.joints.iter().map(|j| j.motion_bound * (value(j) - j.measured_at).abs()).sum()
    }

    fn measured(&mut self, states: &[&ChainState], gap: Option<f64>) {
        self.joints.iter_mut().for_each(|j| j.measured_at = states[j.robot.0].q[j.index]);
        self.travel = 0.0;
        self.clear = gap.unwrap_or(0.0) * ROUNDING;
    }
}

/// The time from the last call to this one.
struct Interval<'w, 'a> {
    now: &'w PlacedGeometry<'w, 'a>,
    object_boxes: &'w [Aabb],
    last: &'w [Vec<f64>],
    moved_objects: &'w [MovedObject<'w>],
    held: &'w [Option<HeldObject>],
}

/// An instant of an interval at which a pair is apart.
#[derive(Clone, Copy)]
struct ClearInstant {
    /// Time as a fraction of the interval.
    at: f64,
    /// Lower bound on the distance, metres.
    gap_m: f64,
}

/// An instant of an interval, with the measured gap of a pair.
#[derive(Clone, Copy)]
struct MeasuredInstant {
    /// Time as a fraction of the interval.
    at: f64,
    /// Distance of the pair, metres; `None` in contact.
    gap_m: Option<f64>,
}

impl Interval<'_, '_> {
    /// Finds the first contact of a pair, as a fraction of the interval.
    ///
    /// The pair is `gap` apart now, and its object travelled `travel` (m).
    fn first_contact(&self, pair: &TrackedPair, travel: f64, gap: Option<f64>) -> Option<f64> {
        let now = |j: &PairJoint| self.now.states[j.robot.0].q[j.index];
        let before = |j: &PairJoint| self.last[j.robot.0][j.index];
        let by_joints: f64 = pair.joints.iter().map(|j| j.motion_bound * (now(j) - before(j)).abs()).sum::<f64>();
        let travel_bound = travel + by_joints;
        // Without a bound, only the current instant is tested.
        if !travel_bound.is_finite() {
            return gap.is_none().then_some(1.0);
        }
        let clear_before = pair.clear - pair.moved(before) - (pair.travel - travel);
        let from = ClearInstant { at: 0.0, gap_m: clear_before };
        self.bisect(pair, travel_bound, from, MeasuredInstant { at: 1.0, gap_m: gap })
    }

    /// Finds the first contact between two instants.
    ///
    /// Over the whole interval the gap changes by at most `travel_bound` (m).
    fn bisect(&self, pair: &TrackedPair, travel_bound: f64, from: ClearInstant, to: MeasuredInstant) -> Option<f64> {
        // The gap at each end excludes contact for a while, so contact is possible only in between.
        let first = from.at + from.gap_m.max(0.0) / travel_bound;
        let last = to.at - to.gap_m.unwrap_or(0.0) * ROUNDING / travel_bound;
        // Also true for NaN, if nothing moved.
        if !(last - first > (2.0 * MIN_DEPTH / travel_bound).max(MIN_DURATION)) {
            return to.gap_m.is_none().then_some(to.at);
        }
        let middle = 0.5 * (first + last);
        match self.gap(pair, middle) {
            None => self.bisect(pair, travel_bound, from, MeasuredInstant { at: middle, gap_m: None }),
            Some(gap) => self
                .bisect(pair, travel_bound, from, MeasuredInstant { at: middle, gap_m: Some(gap) })
                .or_else(|| self.bisect(pair, travel_bound, ClearInstant { at: middle, gap_m: gap * ROUNDING }, to)),
        }
    }

    /// The gap of a pair at a fraction of the interval.
    fn gap(&self, pair: &TrackedPair, at: f64) -> Option<f64> {
        let mut states: Vec<ChainState> = self.now.states.iter().map(|s| (*s).clone()).collect();
        let moves = |r: usize| pair.joints.iter().any(|j| j.robot.0 == r);
        for (r, state) in states.iter_mut().enumerate().filter(|(r, _)| moves(*r)) {
            state.q.iter_mut().zip(&self.last[r]).for_each(|(q, last)| *q = last + at * (*q - last));
            self.now.robots[r].0.chain.forward(state);
        }
        let mut placed = self.now.placed.to_vec();
        for s in self.moved_objects {
            let pose = s.path.pose(at);
            placed[s.object.0] = (pose, self.object_boxes[s.object.0].transformed(&pose));
        }
        let states: Vec<&ChainState> = states.iter().collect();
        for (o, held) in self.held.iter().enumerate() {
            let Some(held) = held else { continue };
            let pose = held.in_world(self.now.robots, &states);
            placed[o] = (pose, self.object_boxes[o].transformed(&pose));
        }
        PlacedGeometry { states: &states, placed: &placed, ..*self.now }.gap(pair.a, pair.b)
    }
}
