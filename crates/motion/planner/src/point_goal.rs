//! Goals of a point: any point of a robot is brought to a place, with the joints that move it (Reichenbach and Kovačić:
//! *Derivation of kinematic parameters from a 3D robot model used for collision-free path planning*, 2003).

use elbowroom_kinematics::surface_ik::{OrientedPoint, PointChain, PointError, SurfaceIkOptions};
use elbowroom_kinematics::{ChainState, JointId, LinkId};
use elbowroom_robot::{RSequence, RobotId};
use elbowroom_scene::{Scene, SceneState};
use elbowroom_spatial::Vec3;

use crate::interpolation::length;
use crate::{OrientationConstraint, PathConstraint};

/// Steps of the search from one sampled configuration.
const STEPS: usize = 60;
/// Rounds in which a configuration is turned to a kept axis, and its point brought back to its place.
const ROUNDS: usize = 20;

/// What the configurations of a goal keep, beside the point at its place.
#[derive(Debug, Default)]
pub struct GoalLimits<'l> {
    /// Indices of the joint values that may differ from those at the start; `None`: all.
    pub moving: Option<&'l [usize]>,
    /// An axis that keeps its direction.
    pub kept: Option<&'l mut OrientationConstraint>,
}

/// A point fixed on a link, and the place where it shall end. The orientation of the link is free.
///
/// ```
/// use elbowroom_planner::{GoalLimits, PointGoal, RrtConnect, RrtConnectSettings};
/// use elbowroom_kinematics::{ChainState, JointId, LinkId};
/// use elbowroom_robot::RobotId;
/// use elbowroom_scene::{SceneState, example};
/// use elbowroom_spatial::Vec3;
/// let (scene, robot) = (example::two_arms(), RobotId(0));
/// let mut start = SceneState::new(&scene);
/// start.set_q(&scene, robot, &[-0.9, 1.3, 0.6])?;
/// // A point on the forearm.
/// let link = scene.robots()[0].robot.chain.tip();
/// let mut point = PointGoal { link, point_in_link: Vec3::new(-0.05, 0.0, 0.0), in_world: Vec3::ZERO };
/// let mut place = point.placement(&scene, robot);
/// point.in_world = place(&[0.9, 1.3, 0.6]);
/// let goals = point.configurations(&scene, &start, robot, 16, GoalLimits::default())?;
/// let path = RrtConnect::new(&scene, robot)?.plan_to_any(&start, &goals, &RrtConnectSettings::default())?;
/// let end = path.waypoints.last().unwrap();
/// assert!(place(end).distance(point.in_world) < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointGoal {
    /// The link to which the point belongs.
    pub link: LinkId,
    /// The point in the frame of the link, m.
    pub point_in_link: Vec3,
    /// The place in the world, m.
    pub in_world: Vec3,
}

impl PointGoal {
    /// Finds configurations of a robot (rad, m for prismatic joints) within its limits with the point at its place: the
    /// one found from the robot's configuration in `start`, and those found from `samples` others, the nearest to `start`
    /// first. Every second sample leaves the joints that do not move the point at their values in `start`. The
    /// configurations may be in collision. The same input gives the same answer.
    ///
    /// If no configuration meets the limits on the axis too, those that only have the point at its place are returned: a
    /// planner with this constraint refuses them, and says by how much the axis is off.
    ///
    /// # Errors
    /// [`PointError`]: the place is not reached, with the remaining distance, or a number is not finite.
    ///
    /// # Panics
    /// The scene does not have this robot, or the robot does not have this link.
    pub fn configurations(
        &self,
        scene: &Scene,
        start: &SceneState,
        robot: RobotId,
        samples: u64,
        limits: GoalLimits<'_>,
    ) -> Result<Vec<Vec<f64>>, PointError> {
        let r = &scene.robots()[robot.0];
        let (chain, from) = (&r.robot.chain, start.q(robot));
        let mut point = self.chain(scene, robot)?;
        let may_move = |index: usize| limits.moving.is_none_or(|moving| moving.contains(&index));
        point.hold(from, |index| !may_move(index));
        let point_in_root = r.base_in_world.inverse_transform_point(self.in_world);
        let target = OrientedPoint { point_in_root, normal_in_root: None };
        let mut nearest = from.to_vec();
        point.solve(&target, &mut nearest)?;
        let moves: Vec<bool> = chain.active_joints().iter().map(|joint| point.joints().contains(joint)).collect();
        let (sequence, mut sample) = (RSequence::new(chain.dof()), ChainState::new(chain));
        let mut found = vec![nearest];
        for n in 0..samples {
            sequence.set_state(chain, &mut sample, n, 0);
            let varies = |i: usize| may_move(i) && (moves[i] || n % 2 == 1);
            let mut q: Vec<f64> = (0..from.len()).map(|i| if varies(i) { sample.q[i] } else { from[i] }).collect();
            if point.refine(&target, &mut q, STEPS).is_ok() {
                found.push(q);
            }
        }
        if let Some(kept) = limits.kept {
            let ranges = chain.lower().into_iter().zip(chain.upper()).enumerate();
            let range = |(i, range)| if may_move(i) { range } else { (from[i], from[i]) };
            let ranges: Vec<(f64, f64)> = ranges.map(range).collect();
            let meets = |q: &Vec<f64>| with_kept_axis(kept, &mut point, &target, &ranges, q.clone());
            let meeting: Vec<_> = found.iter().filter_map(meets).collect();
            found = if meeting.is_empty() { found } else { meeting };
        }
        found.sort_by(|a, b| length(from, a).total_cmp(&length(from, b)));
        Ok(found)
    }

    /// Where the point is in the world (m) at a robot's joint values; NaN if a number is not finite.
    ///
    /// # Panics
    /// The scene does not have this robot, or the robot does not have this link.
    pub fn placement(&self, scene: &Scene, robot: RobotId) -> impl FnMut(&[f64]) -> Vec3 + use<> {
        let (base_in_world, mut point) = (scene.robots()[robot.0].base_in_world, self.chain(scene, robot).ok());
        move |q| {
            base_in_world
                .transform_point(point.as_mut().map_or(Vec3::splat(f64::NAN), |point| point.place(q).point_in_root))
        }
    }

    /// The independent joints that move the point, from the base outwards.
    ///
    /// # Panics
    /// The scene does not have this robot, or the robot does not have this link.
    pub fn moved_by(&self, scene: &Scene, robot: RobotId) -> Vec<JointId> {
        self.chain(scene, robot).map_or_else(|_| Vec::new(), |point| point.joints().to_vec())
    }

    fn chain(&self, scene: &Scene, robot: RobotId) -> Result<PointChain, PointError> {
        let chain = &scene.robots()[robot.0].robot.chain;
        PointChain::new(chain, self.link, self.point_in_link, None, SurfaceIkOptions::default())
    }
}

/// The configuration, changed within the joints' ranges until it keeps the axis and has its point at its place; `None`
/// if that does not succeed.
fn with_kept_axis(
    kept: &mut OrientationConstraint,
    point: &mut PointChain,
    target: &OrientedPoint,
    ranges: &[(f64, f64)],
    mut q: Vec<f64>,
) -> Option<Vec<f64>> {
    for _ in 0..ROUNDS {
        if kept.distance_m(&q, 0.0) > 0.0 {
            return Some(q);
        }
        if !kept.project(&mut q) {
            return None;
        }
        for (value, (lower, upper)) in q.iter_mut().zip(ranges) {
            *value = value.max(*lower).min(*upper);
        }
        point.refine(target, &mut q, STEPS).ok()?;
    }
    None
}
