//! Proofs that no path exists by one value of a joint: if the robot is in collision at that value whatever its other
//! joints do, no path passes from one side of the value to the other.
//!
//! At a value of joint j, pairs of solids are followed whose relative pose depends on j and on at most one more joint
//! k. They are followed over the whole range of k. If a ball inside one solid overlaps the other by the depth d, at the
//! distance r from the axis of k, it also overlaps at every value of k that differs by less than d / r, because no
//! point of an arc is farther from its first point than the arc is long.

use elbowroom_kinematics::{Chain, JointId, JointKind, LinkId};
use elbowroom_proximity::{Shape, collides, project_point};
use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_scene::{PairState, Scene, SceneState};
use elbowroom_spatial::{Aabb, Pose, Vec3};

use super::inner_balls::{InnerBall, inner_balls};
use crate::deadline::Deadline;
use crate::rrt_connect::JointRange;

/// Spacing of tried values, rad; for prismatic joints a tenth of this number in metres.
const VALUE_STEP: f64 = 0.05;
/// Largest number of values tried per joint.
const MAX_VALUES: f64 = 100.0;
/// Number of values of the other joint that are tested for a collision before a proof begins.
const PROBES: u32 = 7;
/// Advance, rad (and m), below which a proof ends.
const LEAST_ADVANCE: f64 = 0.003;
/// Fraction of a proven interval that is used: the rest allows for rounding.
const USED_SHARE: f64 = 0.98;
/// Depth below which an overlap is not used, m.
const DEPTH_ROUNDING_M: f64 = 1e-7;

/// The solids of a link or object.
struct Solids<'s> {
    id: GeometryId,
    shapes: Vec<(&'s Shape, Pose)>,
    bounds: Vec<Aabb>,
    balls: Vec<InnerBall>,
}

impl<'s> Solids<'s> {
    fn new(scene: &'s Scene, id: GeometryId) -> Self {
        let shapes: Vec<_> = scene.shapes(id).collect();
        let bounds = shapes.iter().map(|(shape, _)| shape.aabb(&Pose::IDENTITY)).collect();
        let balls = shapes.iter().flat_map(|&(shape, pose)| inner_balls(shape, pose)).collect();
        Self { id, shapes, bounds, balls }
    }

    /// Depth by which a ball (in the frame of these solids) overlaps one of them, m; 0 if it does not.
    fn depth(&self, centre: Vec3, radius_m: f64) -> f64 {
        let of_shape = |(&(shape, pose), bounds): (&(&Shape, Pose), &Aabb)| {
            let is_near = bounds.inflated(radius_m).contains(pose.inverse_transform_point(centre));
            if is_near { radius_m - project_point(shape, &pose, centre).signed_distance } else { 0.0 }
        };
        self.shapes.iter().zip(&self.bounds).map(of_shape).fold(0.0, f64::max)
    }
}

/// Two solids, at least one of them on the robot, and the joints on which their relative pose depends.
struct FollowedPair {
    /// Indices in the list of solids.
    solids: [usize; 2],
    joints: Vec<JointId>,
}

/// A search for a value that no path crosses.
pub(super) struct SeparatingValue<'s> {
    scene: &'s Scene,
    state: SceneState,
    robot: RobotId,
    ranges: Vec<JointRange>,
    solids: Vec<Solids<'s>>,
    pairs: Vec<FollowedPair>,
}

impl<'s> SeparatingValue<'s> {
    /// Creates a search for a robot within the ranges of its values; everything else stays as in the state.
    pub fn new(scene: &'s Scene, state: &SceneState, robot: RobotId, ranges: Vec<JointRange>) -> Self {
        let chain = &scene.robots()[robot.0].robot.chain;
        let (mut solids, mut pairs): (Vec<Solids>, _) = (Vec::new(), Vec::new());
        let mut position = |id: GeometryId| {
            solids.iter().position(|s: &Solids| s.id == id).unwrap_or_else(|| {
                solids.push(Solids::new(scene, id));
                solids.len() - 1
            })
        };
        for entry in scene.allowed_collision_matrix().entries() {
            let is_tested = matches!(state.pair(scene, entry.a, entry.b), Some((PairState::Tested, _)));
            let joints = joints_between(chain, state, robot, [entry.a, entry.b]).filter(|_| is_tested);
            if let Some(joints) = joints {
                pairs.push(FollowedPair { solids: [position(entry.a), position(entry.b)], joints });
            }
        }
        Self { scene, state: state.clone(), robot, ranges, solids, pairs }
    }

    fn chain(&self) -> &'s Chain {
        &self.scene.robots()[self.robot.0].robot.chain
    }

    /// Finds a joint with a proven value between two configurations. `None` proves nothing.
    pub fn joint_between(&mut self, from: &[f64], to: &[f64], deadline: &Deadline) -> Option<usize> {
        (0..self.ranges.len()).find(|&joint| {
            let range = self.ranges[joint];
            let (a, b) = (from[joint], to[joint]);
            let is_bounded = range.lower.is_finite() && range.upper.is_finite();
            let step = if range.is_prismatic { 0.1 * VALUE_STEP } else { VALUE_STEP };
            let count = ((b - a).abs() / step).ceil().min(MAX_VALUES) as usize;
            is_bounded
                && (1..count).any(|i| {
                    let value = a + (b - a) * i as f64 / count as f64;
                    !deadline.is_over() && self.separates(from, joint, value, deadline)
                })
        })
    }

    /// Whether it is proven that every configuration with this value of a joint is in collision.
    fn separates(&mut self, others: &[f64], joint: usize, value: f64, deadline: &Deadline) -> bool {
        let mut q = others.to_vec();
        q[joint] = value;
        (0..self.ranges.len()).filter(|&other| other != joint).any(|other| {
            let pairs = self.pairs_of(joint, other);
            !pairs.is_empty() && self.collide_everywhere(&pairs, &mut q.clone(), other, deadline)
        })
    }

    /// The pairs that depend on `joint` and, besides, on at most one joint, whose value is `other`.
    fn pairs_of(&self, joint: usize, other: usize) -> Vec<usize> {
        let chain = self.chain();
        let follows = |pair: &FollowedPair| {
            let indices: Vec<_> = pair.joints.iter().filter_map(|&j| chain.coupling(j)).map(|c| c.index).collect();
            indices.contains(&joint)
                && indices.iter().all(|&i| i == joint || i == other)
                && indices.iter().filter(|&&i| i == other).count() <= 1
        };
        (0..self.pairs.len()).filter(|&p| follows(&self.pairs[p])).collect()
    }

    fn collide_everywhere(&mut self, pairs: &[usize], q: &mut [f64], other: usize, deadline: &Deadline) -> bool {
        let Some((lower, upper)) = whole_range(&self.ranges[other]) else { return false };
        for probe in 0..PROBES {
            q[other] = lower + (upper - lower) * f64::from(probe) / f64::from(PROBES - 1);
            if !self.set(q) || !pairs.iter().any(|&pair| self.pair_collides(pair)) {
                return false;
            }
        }
        let mut proven = lower;
        while proven <= upper {
            q[other] = proven;
            if deadline.is_over() || !self.set(q) {
                return false;
            }
            let advance = pairs.iter().map(|&pair| self.reach(pair, other)).fold(0.0, f64::max);
            if advance < LEAST_ADVANCE {
                return false;
            }
            proven += advance;
        }
        true
    }

    fn set(&mut self, q: &[f64]) -> bool {
        self.state.set_q(self.scene, self.robot, q).is_ok()
    }

    fn pose(&self, solids: usize) -> Pose {
        self.state.pose(self.scene, self.solids[solids].id).unwrap_or(Pose::IDENTITY)
    }

    fn pair_collides(&self, pair: usize) -> bool {
        let [a, b] = self.pairs[pair].solids;
        let poses = [self.pose(a), self.pose(b)];
        let placed =
            |i: usize, pose: Pose| self.solids[i].shapes.iter().map(move |&(shape, local)| (shape, pose * local));
        placed(a, poses[0]).any(|(x, at)| placed(b, poses[1]).any(|(y, there)| collides(x, &at, y, &there)))
    }

    /// Change of a joint from the present configuration, in either direction, during which a pair is certain to stay in
    /// collision.
    fn reach(&self, pair: usize, other: usize) -> f64 {
        let FollowedPair { solids: [a, b], joints } = &self.pairs[pair];
        let chain = self.chain();
        let moves =
            joints.iter().find_map(|&j| chain.coupling(j).filter(|c| c.index == other).map(|c| (j, c.multiplier)));
        let axis = moves.map(|(joint, multiplier)| self.axis(joint, multiplier));
        let of_side = |inner: usize, outer: usize| {
            let (inner_pose, outer_pose) = (self.pose(inner), self.pose(outer));
            let ball_reach = |ball: &InnerBall| {
                let centre = inner_pose.transform_point(ball.centre);
                let depth = self.solids[outer].depth(outer_pose.inverse_transform_point(centre), ball.radius_m);
                let speed = axis.as_ref().map_or(0.0, |axis| axis.speed(centre));
                if depth > DEPTH_ROUNDING_M { USED_SHARE * (depth - DEPTH_ROUNDING_M) / speed } else { 0.0 }
            };
            self.solids[inner].balls.iter().map(ball_reach).fold(0.0, f64::max)
        };
        of_side(*a, *b).max(of_side(*b, *a))
    }

    /// The axis of a joint in the world, at the present configuration.
    fn axis(&self, joint: JointId, multiplier: f64) -> Axis {
        let of_chain = &self.chain().joints()[joint.0];
        let child = GeometryId::Link { robot: self.robot, link: of_chain.child };
        let pose = self.state.pose(self.scene, child).unwrap_or(Pose::IDENTITY);
        Axis {
            origin: pose.translation,
            direction: pose.transform_vector(of_chain.axis),
            slides: of_chain.kind == JointKind::Prismatic,
            rate: multiplier.abs(),
        }
    }
}

/// An axis in the world about which solids turn, or along which they slide.
struct Axis {
    origin: Vec3,
    direction: Vec3,
    slides: bool,
    /// Rate of the joint per rate of its value.
    rate: f64,
}

impl Axis {
    /// Speed of a point at the rate 1, m per rad (or m).
    fn speed(&self, p: Vec3) -> f64 {
        self.rate * if self.slides { 1.0 } else { (p - self.origin).cross(self.direction).length() }
    }
}

/// The joints between a link of the robot and another of its links, or a geometry that no joint of the robot moves.
/// `None` if neither is a link of the robot, or if one is an attached object.
fn joints_between(chain: &Chain, state: &SceneState, robot: RobotId, pair: [GeometryId; 2]) -> Option<Vec<JointId>> {
    let link = |id: GeometryId| match id {
        GeometryId::Link { robot: of, link } if of == robot => Some(link),
        _ => None,
    };
    let is_attached = |id: GeometryId| matches!(id, GeometryId::Object(object) if state.attachment(object).is_some());
    if pair.into_iter().any(is_attached) {
        return None;
    }
    let of_link = |link: LinkId| chain.path(link);
    let joints = match pair.map(link) {
        [Some(a), Some(b)] => chain.joints_between(a, b),
        [Some(link), None] | [None, Some(link)] => of_link(link),
        [None, None] => return None,
    };
    Some(joints.into_iter().filter(|&j| chain.coupling(j).is_some()).collect())
}

/// All postures of a joint: its limits or one turn.
fn whole_range(range: &JointRange) -> Option<(f64, f64)> {
    if range.lower.is_finite() && range.upper.is_finite() {
        return Some((range.lower, range.upper));
    }
    (range.repeats && !range.is_prismatic).then_some((0.0, std::f64::consts::TAU))
}
