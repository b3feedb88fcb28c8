//! Proof, without sampling, that no joint values within the limits bring a pair together.
//!
//! The first test uses reach spheres: at any joint values a link stays in a sphere around its first moving joint. The
//! second test is branch and bound over the joint values, for pairs that few joints move against each other. It measures
//! the shapes at the centre of a cell of joint space. From there to the boundary of the cell, no point moves farther than
//! the motion bounds of the joints times the half widths of the cell. If the shapes are farther apart than that, the
//! whole cell is clear; otherwise it is split.

use elbowroom_kinematics::motion_bound::{max_stroke_m, motion_bound};
use elbowroom_kinematics::{JointId, JointKind};
use elbowroom_proximity::{Shape, Sphere, separation_within};
use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_spatial::{Pose, Vec3};
use rayon::prelude::*;

use super::entry::{PairEntry, PairState};
use super::matrix::AllowedCollisionMatrix;
use super::reason::Reason;
use crate::local_shape::LocalShape;
use crate::narrow_phase::{NarrowPhase, PlacedModel};
use crate::{Level, Scene, SceneState};

/// Clearance (m) beyond the margin that a proof must show, so that the rounding of poses cannot invalidate it.
const CLEARANCE: f64 = 1e-3;
/// Largest number of joints that branch and bound subdivides.
const MAX_JOINTS: usize = 3;
/// Largest number of cells per pair.
const MAX_CELLS: usize = 4000;

/// Least number of parallel jobs, unless there are fewer pairs. Each job makes a workspace, whose size grows with the scene.
const JOBS: usize = 256;

/// Marks the pairs that are proven to be out of reach.
pub(crate) fn prove_out_of_reach(scene: &Scene, mut matrix: AllowedCollisionMatrix) -> AllowedCollisionMatrix {
    let start = SceneState::new(scene);
    let prove = |(narrow, state): &mut (NarrowPhase, SceneState), entry: &mut PairEntry| {
        let required = entry.margin_m + CLEARANCE;
        let search = || {
            let mut search = BranchAndBound { scene, state, narrow };
            let least_m = search.least_distance(entry.a, entry.b, required);
            // Each pair begins at the same state, so that no proof depends on those before.
            search.reset(&start, [entry.a, entry.b]);
            least_m
        };
        if let Some(least_m) = by_reach_spheres(scene, entry.a, entry.b, required).or_else(search) {
            (entry.state, entry.reason) = (PairState::Skipped, Reason::OutOfReach { least_m });
        }
    };
    let entries = matrix.entries_mut();
    let per_job = entries.len().div_ceil(JOBS).max(1);
    let tested = entries.par_iter_mut().with_max_len(per_job).filter(|e| e.state == PairState::Tested);
    tested.for_each_init(|| (NarrowPhase::new(scene), start.clone()), prove);
    matrix
}

/// A volume that contains the geometry at any joint values, in the frame of a common ancestor or in the world.
enum ReachVolume<'s> {
    /// Sphere with centre and radius.
    Sphere(Vec3, f64),
    /// Geometry that no joint moves.
    Fixed(&'s [LocalShape], Pose),
}

fn by_reach_spheres(scene: &Scene, a: GeometryId, b: GeometryId, required: f64) -> Option<f64> {
    let least = match (reach_volume(scene, a, b)?, reach_volume(scene, b, a)?) {
        (ReachVolume::Sphere(p, r), ReachVolume::Sphere(q, s)) => (p.distance(q) - r - s) * (1.0 - 1e-12),
        (ReachVolume::Sphere(p, radius), ReachVolume::Fixed(shapes, in_frame))
        | (ReachVolume::Fixed(shapes, in_frame), ReachVolume::Sphere(p, radius)) => {
            let sphere = Shape::Sphere(Sphere { radius });
            let at = Pose::from_translation(p);
            let gap = |s: &LocalShape| {
                let found = separation_within(&sphere, &at, &s.shape, &(in_frame * s.in_geometry), f64::INFINITY);
                found.map_or(0.0, |s| s.lower_bound)
            };
            shapes.iter().map(gap).fold(f64::INFINITY, f64::min)
        }
        // Neither geometry moves: the pair rules exclude the pair.
        (ReachVolume::Fixed(..), ReachVolume::Fixed(..)) => return None,
    };
    (least > required && least.is_finite()).then_some(least)
}

/// The reach volume of a geometry in the frame of the last link that it shares with `other`.
fn reach_volume(scene: &Scene, id: GeometryId, other: GeometryId) -> Option<ReachVolume<'_>> {
    let model = &scene.models[scene.model_of(id)?];
    let robot = match id {
        GeometryId::Object(o) => return Some(ReachVolume::Fixed(&model.exact, scene.objects[o.0].in_world)),
        GeometryId::Link { robot, .. } => robot,
    };
    let r = &scene.robots[robot.0];
    let chain = &r.robot.chain;
    let mut in_frame = match other {
        GeometryId::Link { robot: same, .. } if same == robot => Pose::IDENTITY,
        _ => r.base_in_world,
    };
    let own = own_joints(scene, id, other);
    let Some(first) = own.iter().position(|j| chain.joints()[j.0].kind.moves()) else {
        for j in &own {
            in_frame = in_frame * chain.joints()[j.0].origin;
        }
        return Some(ReachVolume::Fixed(&model.exact, in_frame));
    };
    for j in &own[..=first] {
        in_frame = in_frame * chain.joints()[j.0].origin;
    }
    let mut radius = model.radius();
    for (i, j) in own.iter().enumerate().skip(first) {
        let joint = &chain.joints()[j.0];
        radius += if i > first { joint.origin.translation.length() } else { 0.0 };
        if joint.kind == JointKind::Prismatic {
            radius += max_stroke_m(chain, *j);
        }
    }
    // Slightly enlarged for the rounding of the sum. An infinite or NaN radius bounds nothing.
    radius.is_finite().then_some(ReachVolume::Sphere(in_frame.translation, radius * (1.0 + 1e-12)))
}

/// The joints from the last link shared with the other geometry to this link, in this order.
fn own_joints(scene: &Scene, id: GeometryId, other: GeometryId) -> Vec<JointId> {
    let GeometryId::Link { robot, link } = id else { return Vec::new() };
    let chain = &scene.robots[robot.0].robot.chain;
    let path = chain.path(link);
    match other {
        GeometryId::Link { robot: same, link: other } if same == robot => {
            let between = chain.joints_between(link, other);
            path.into_iter().filter(|j| between.contains(j)).collect()
        }
        _ => path,
    }
}

/// A joint value that moves the pair.
#[derive(Clone, Copy)]
struct PairJoint {
    robot: RobotId,
    index: usize,
    /// Largest displacement of any point of one geometry against the other, metres per rad or per m.
    motion_bound: f64,
}

/// A box of joint space.
#[derive(Clone, Copy)]
struct JointCell {
    centre: [f64; MAX_JOINTS],
    half_width: [f64; MAX_JOINTS],
}

struct BranchAndBound<'s, 'n> {
    scene: &'s Scene,
    state: &'n mut SceneState,
    narrow: &'n mut NarrowPhase,
}

impl BranchAndBound<'_, '_> {
    /// Returns `required` (m) if the pair is proven to be that far apart in every cell.
    fn least_distance(&mut self, a: GeometryId, b: GeometryId, required: f64) -> Option<f64> {
        let models = [self.scene.model_of(a)?, self.scene.model_of(b)?];
        let joints = self.joints(a, b)?;
        let mut stack = vec![self.whole_range(&joints)?];
        let mut visited = 0;
        while let Some(cell) = stack.pop() {
            visited += 1;
            if visited > MAX_CELLS {
                return None;
            }
            self.set_centre(&joints, &cell);
            let moves: Vec<f64> = joints.iter().zip(cell.half_width).map(|(x, half)| x.motion_bound * half).collect();
            let [x, y] = models.map(|model| PlacedModel::new(self.scene, self.state, model));
            let clear = |narrow: &mut NarrowPhase, limit: f64| {
                narrow.separated_coarsely(&x, &y, limit).is_some() || !narrow.within(&x, &y, Level::L3, limit)
            };
            let at_boundary = required + moves.iter().sum::<f64>() * (1.0 + 1e-9);
            if clear(self.narrow, at_boundary) {
                continue;
            }
            // A cell that contains this point cannot be proven clear.
            if !clear(self.narrow, required) {
                return None;
            }
            let widest = (0..joints.len()).max_by(|i, j| moves[*i].total_cmp(&moves[*j]))?;
            for sign in [-0.5, 0.5] {
                let mut half = cell;
                half.half_width[widest] *= 0.5;
                half.centre[widest] += sign * cell.half_width[widest];
                stack.push(half);
            }
        }
        Some(required)
    }

    /// All joints that move the pair; `None` if there are too many, or if a motion bound is infinite.
    fn joints(&self, a: GeometryId, b: GeometryId) -> Option<Vec<PairJoint>> {
        let mut joints: Vec<PairJoint> = Vec::new();
        for (id, other) in [(a, b), (b, a)] {
            let GeometryId::Link { robot, link } = id else { continue };
            let chain = &self.scene.robots[robot.0].robot.chain;
            let radius = self.scene.models[self.scene.model_of(id)?].radius();
            for (index, bound) in motion_bound(chain, link, radius, &own_joints(self.scene, id, other)) {
                match joints.iter_mut().find(|x| (x.robot, x.index) == (robot, index)) {
                    Some(known) => known.motion_bound += bound,
                    None => joints.push(PairJoint { robot, index, motion_bound: bound }),
                }
            }
        }
        let bounded = joints.iter().all(|x| x.motion_bound.is_finite());
        (!joints.is_empty() && joints.len() <= MAX_JOINTS && bounded).then_some(joints)
    }

    /// All values within the limits; a full turn for rotations without limits.
    fn whole_range(&self, joints: &[PairJoint]) -> Option<JointCell> {
        let mut cell = JointCell { centre: [0.0; MAX_JOINTS], half_width: [0.0; MAX_JOINTS] };
        for (i, x) in joints.iter().enumerate() {
            let chain = &self.scene.robots[x.robot.0].robot.chain;
            let id = chain.active_joints()[x.index];
            let joint = &chain.joints()[id.0];
            let (lower, upper) = (joint.limits.lower, joint.limits.upper);
            if lower <= upper && lower.is_finite() && upper.is_finite() {
                (cell.centre[i], cell.half_width[i]) = (0.5 * (lower + upper), 0.5 * (upper - lower) * (1.0 + 1e-12));
                continue;
            }
            // One turn covers all turns, unless a mimic joint follows at another rate.
            let followed =
                (0..chain.joints().len()).any(|j| chain.mimic_source(JointId(j)).is_some_and(|m| m.joint == id));
            if !joint.kind.turns() || followed {
                return None;
            }
            (cell.centre[i], cell.half_width[i]) = (0.0, std::f64::consts::PI * (1.0 + 1e-12));
        }
        Some(cell)
    }

    /// Moves the robots of a pair back to their joint values in another state.
    fn reset(&mut self, start: &SceneState, [a, b]: [GeometryId; 2]) {
        let robot_of = |id| if let GeometryId::Link { robot, .. } = id { Some(robot) } else { None };
        let (first, second) = (robot_of(a), robot_of(b));
        for robot in [first, second.filter(|_| second != first)].into_iter().flatten() {
            self.state.chains[robot.0].q.copy_from_slice(&start.chains[robot.0].q);
            self.scene.robots[robot.0].robot.chain.forward(&mut self.state.chains[robot.0]);
            self.state.robot_moved(self.scene, robot);
        }
    }

    /// Moves the robots to the centre of a cell.
    fn set_centre(&mut self, joints: &[PairJoint], cell: &JointCell) {
        for (i, x) in joints.iter().enumerate() {
            self.state.chains[x.robot.0].q[x.index] = cell.centre[i];
        }
        for (i, x) in joints.iter().enumerate() {
            if joints[..i].iter().all(|y| y.robot != x.robot) {
                self.scene.robots[x.robot.0].robot.chain.forward(&mut self.state.chains[x.robot.0]);
                self.state.robot_moved(self.scene, x.robot);
            }
        }
    }
}
