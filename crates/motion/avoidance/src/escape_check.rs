//! Proof of an escape: a sweep in time against the predicted motion of all moving obstacles, and against the static
//! scene.

use elbowroom_kinematics::LinkId;
use elbowroom_planner::PathConstraint;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_scene::{
    Attachment, Checker, CheckerOptions, Scene, SceneError, SceneState, Selection, SweepMove, SweepOptions,
};
use elbowroom_spatial::{Pose, Vec3};

use crate::escape_trajectory::EscapeTrajectory;
use crate::escape_work::EscapeWork;
use crate::motion_bounds::MotionBounds;
use crate::prediction::{motion_between, pose_after, q_after};
use crate::{DynamicObstacles, Neighbour, ObservedObject};

/// Longest stretch that is swept as a straight joint motion at constant rates, s.
const STRETCH_S: f64 = 0.2;
/// Fraction of the clearance by which the motion may deviate from a straight one; the proof guarantees the rest.
const CHORD_SHARE: f64 = 0.5;
/// Longest stretch of a robot at rest, s: within it, the curve of a predicted motion is replaced by a chord.
const REST_STRETCH_S: f64 = 0.25;
/// Shortest stretch of a proof, s.
const MIN_STRETCH_S: f64 = 0.04;
/// Shortest stretch of a proof against a constraint, s.
const MIN_CONSTRAINT_STRETCH_S: f64 = 1e-3;
/// Speed below which an obstacle is stationary, m/s and rad/s.
const STATIONARY: f64 = 0.02;

/// A motion that begins at an instant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EscapeMotion<'a> {
    pub(crate) trajectory: &'a EscapeTrajectory,
    /// Time within the trajectory at which the check begins, s.
    pub(crate) elapsed_s: f64,
    /// Time of the beginning of the check, s after the observations.
    pub(crate) begins_s: f64,
    /// Duration of the check, s.
    pub(crate) horizon_s: f64,
}

/// Clearances of a proof, m.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EscapeClearance {
    /// Clearance from moving obstacles.
    pub(crate) moving_m: f64,
    /// Clearance from fixed obstacles and between the robot's own links.
    pub(crate) fixed_m: f64,
}

/// A predicted hit of a moving obstacle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PredictedHit {
    /// Time since the beginning of the check, s.
    pub(crate) time_s: f64,
    /// The link that is hit.
    pub(crate) link: LinkId,
    /// The hit point of the link, in the world, m.
    pub(crate) point: Vec3,
    /// Velocity of the obstacle in the world, m/s.
    pub(crate) velocity: Vec3,
}

/// Result of a check against moving obstacles.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MotionCheck {
    pub(crate) hit: Option<PredictedHit>,
    /// Whether all of the motion was checked, up to the hit.
    pub(crate) is_complete: bool,
    /// Smallest measured distance, m; infinite if no obstacle comes near.
    pub(crate) gap_m: f64,
}

impl MotionCheck {
    /// Whether the motion is proven free.
    pub(crate) fn is_free(&self) -> bool {
        self.hit.is_none() && self.is_complete
    }
}

/// Checks escapes of one robot. It has its own scene state, with predicted poses.
#[derive(Debug)]
pub(crate) struct EscapeCheck<'s> {
    scene: &'s Scene,
    robot: RobotId,
    tip: LinkId,
    checker: Checker<'s>,
    state: SceneState,
    bounds: MotionBounds,
    /// Configurations at the ends of a stretch.
    from: Vec<f64>,
    to: Vec<f64>,
    /// Deviation of each joint from a straight motion.
    deviation: Vec<f64>,
    /// Per robot, the configuration at the end of its stretch.
    robots_to: Vec<Vec<f64>>,
    /// Largest distance of a point of an object from its origin, m.
    object_radii: Vec<f64>,
    /// Number of evaluations of constraints so far.
    margins: u64,
    /// Work after which checks end without a proof.
    deadline: EscapeWork,
}

/// Whether an object moves.
pub(crate) fn moves(object: &ObservedObject) -> bool {
    object.motion.velocity.length() > STATIONARY || object.motion.angular_velocity.length() > STATIONARY
}

/// Whether a robot moves.
pub(crate) fn robot_moves(robot: &Neighbour<'_>) -> bool {
    robot.qd.iter().any(|v| v.abs() > STATIONARY)
}

impl<'s> EscapeCheck<'s> {
    pub(crate) fn new(scene: &'s Scene, robot: RobotId) -> Self {
        let dof = scene.robots()[robot.0].robot.chain.dof();
        let state = SceneState::new(scene);
        Self {
            scene,
            robot,
            tip: scene.robots()[robot.0].robot.chain.tip(),
            checker: Checker::new(scene, CheckerOptions::default()),
            bounds: MotionBounds::of_state(scene, &state, robot),
            state,
            from: vec![0.0; dof],
            to: vec![0.0; dof],
            deviation: vec![0.0; dof],
            robots_to: scene.robots().iter().map(|r| vec![0.0; r.robot.chain.dof()]).collect(),
            object_radii: scene
                .objects()
                .iter()
                .map(|o| o.shape.aabb(&Pose::IDENTITY).max_distance(Vec3::ZERO))
                .collect(),
            margins: 0,
            deadline: EscapeWork::UNLIMITED,
        }
    }

    /// Work done so far.
    pub(crate) fn work(&self) -> EscapeWork {
        EscapeWork::of(&self.checker.stats(), self.margins)
    }

    /// Sets the amount of [`Self::work`] at which checks end without a proof.
    pub(crate) fn set_deadline(&mut self, deadline: EscapeWork) {
        self.deadline = deadline;
    }

    /// Whether the work is used up.
    pub(crate) fn is_overdue(&self) -> bool {
        self.work() >= self.deadline
    }

    /// Options of a sweep that ends, at the latest, when the work is used up.
    fn sweep_options(&self, clearance_m: f64) -> SweepOptions {
        (self.deadline - self.work()).sweep_options(clearance_m)
    }

    /// Attaches an object to a link of any robot.
    pub(crate) fn attach(&mut self, object: ObjectId, attachment: Attachment) -> Result<(), SceneError> {
        self.state.attach_at(self.scene, object, attachment)?;
        self.bounds = MotionBounds::of_state(self.scene, &self.state, self.robot);
        Ok(())
    }

    /// Detaches an object, which is at `in_world` now.
    pub(crate) fn detach(&mut self, object: ObjectId, in_world: Pose) -> Result<(), SceneError> {
        self.state.detach(self.scene, object)?;
        self.state.place(self.scene, object, in_world)?;
        self.bounds = MotionBounds::of_state(self.scene, &self.state, self.robot);
        Ok(())
    }

    /// Checks where a motion first comes nearer than `clearance_m` to a moving obstacle. `counts` selects objects and
    /// other robots by whether they are known. A motion that cannot be checked counts as a hit.
    pub(crate) fn meets_moving(
        &mut self,
        motion: &EscapeMotion<'_>,
        obstacles: &DynamicObstacles<'_>,
        clearance_m: f64,
        counts: impl Fn(bool) -> bool,
    ) -> Result<MotionCheck, SceneError> {
        let mut first = MotionCheck { hit: None, is_complete: true, gap_m: f64::INFINITY };
        let mut until_s = motion.horizon_s;
        for object in obstacles.objects.iter().filter(|o| moves(o) && counts(o.known)) {
            self.meets_object(motion, object, clearance_m, &mut until_s, &mut first)?;
            if !first.is_complete {
                return Ok(first);
            }
        }
        let own = self.robot;
        for other in obstacles.robots.iter().filter(|n| n.robot != own && robot_moves(n) && counts(n.known)) {
            let met = self.meets_robot(motion, other, clearance_m, until_s)?;
            first.is_complete &= !self.is_overdue();
            if let Some(hit) = met {
                until_s = hit.time_s;
                first.hit = Some(hit);
            }
        }
        Ok(first)
    }

    /// Checks the motion until `until_s` for one moving object; an earlier hit becomes the first one, and its time the
    /// end.
    fn meets_object(
        &mut self,
        motion: &EscapeMotion<'_>,
        object: &ObservedObject,
        clearance_m: f64,
        until_s: &mut f64,
        first: &mut MotionCheck,
    ) -> Result<(), SceneError> {
        let own = Selection::Robot(self.robot);
        let speed = object.motion.velocity.length()
            + object.motion.angular_velocity.length() * self.object_radii[object.object.0];
        let mut t = 0.0;
        while t < *until_s {
            let resting = self.set_time(motion, t)?;
            let place = pose_after(object, motion.begins_s + t);
            self.state.place(self.scene, object.object, place)?;
            let distance = self.checker.between(own, Selection::Object(object.object)).distance(&self.state);
            let Some(distance) = distance else { break };
            first.gap_m = first.gap_m.min(distance.metres);
            if self.is_overdue() {
                // A motion that is not proven free counts as a hit.
                let sides = [(distance.a, distance.on_a), (distance.b, distance.on_b)];
                let hit = self.object_hit(object, place.translation, sides, t);
                first.hit = first.hit.take().or(Some(hit));
                first.is_complete = false;
                return Ok(());
            }
            let by_robot = if resting { 0.0 } else { self.bounds.max_travel(&motion.trajectory.max_speeds, 1.0) };
            let free_s = (distance.lower_bound - clearance_m) / (speed + by_robot);
            let stretch_s = if resting { REST_STRETCH_S } else { self.stretch_s(motion, t, clearance_m) };
            if free_s > stretch_s {
                t += free_s;
                continue;
            }
            let end = (t + stretch_s).min(*until_s);
            motion.trajectory.q_at(motion.elapsed_s + end, &mut self.to);
            let path = motion_between(object, motion.begins_s + t, motion.begins_s + end);
            let moved = [
                SweepMove::Robot { robot: self.robot, to: &self.to },
                SweepMove::Object { object: object.object, path: &path },
            ];
            let options = self.sweep_options(clearance_m);
            let mut pair = self.checker.between(own, Selection::Object(object.object));
            if let Some(hit) = pair.sweep(&self.state, &moved, &options)? {
                *until_s = t + hit.time * (end - t);
                let sides = [(hit.a, hit.on_a), (hit.b, hit.on_b)];
                first.hit = Some(self.object_hit(object, place.translation, sides, *until_s));
                first.gap_m = first.gap_m.min(hit.metres);
                break;
            }
            t = end;
        }
        Ok(())
    }

    /// A hit between an object, whose origin is then at `place`, and another geometry; each side has its point.
    fn object_hit(
        &self,
        object: &ObservedObject,
        place: Vec3,
        [a, b]: [(GeometryId, Vec3); 2],
        time_s: f64,
    ) -> PredictedHit {
        let (id, point) = if a.0 == GeometryId::Object(object.object) { b } else { a };
        // A carried object is moved by the last link.
        let link = if let GeometryId::Link { link, .. } = id { link } else { self.tip };
        PredictedHit { time_s, link, point, velocity: object.motion.velocity_at(point - place) }
    }

    /// A hit with another robot; each side has its point. The direction of the obstacle is from its point to the
    /// robot's point.
    fn robot_hit(&self, [a, b]: [(GeometryId, Vec3); 2], time_s: f64) -> PredictedHit {
        let is_own = |id: GeometryId| matches!(id, GeometryId::Link { robot, .. } if robot == self.robot);
        let ((id, point), (_, from)) = if is_own(a.0) { (a, b) } else { (b, a) };
        let link = if let GeometryId::Link { link, .. } = id { link } else { self.tip };
        PredictedHit { time_s, link, point, velocity: point - from }
    }

    /// Checks where a motion first comes nearer than `clearance_m` to another robot; a motion that is not proven free
    /// counts as a hit.
    fn meets_robot(
        &mut self,
        motion: &EscapeMotion<'_>,
        other: &Neighbour<'_>,
        clearance_m: f64,
        until_s: f64,
    ) -> Result<Option<PredictedHit>, SceneError> {
        let (own, mut t) = (self.robot, 0.0);
        while t < until_s {
            let resting = self.set_time(motion, t)?;
            let stretch_s = if resting { REST_STRETCH_S } else { self.stretch_s(motion, t, clearance_m) };
            let end = (t + stretch_s).min(until_s);
            motion.trajectory.q_at(motion.elapsed_s + end, &mut self.to);
            let options = self.sweep_options(clearance_m);
            let to = &mut self.robots_to[other.robot.0];
            q_after(other, motion.begins_s + t, to);
            self.state.set_q(self.scene, other.robot, to)?;
            q_after(other, motion.begins_s + end, to);
            let mut pair = self.checker.between(Selection::Robot(own), Selection::Robot(other.robot));
            if options.max_steps == 0 {
                let Some(d) = pair.distance(&self.state) else { return Ok(None) };
                return Ok(Some(self.robot_hit([(d.a, d.on_a), (d.b, d.on_b)], t)));
            }
            let moved = [SweepMove::Robot { robot: own, to: &self.to }, SweepMove::Robot { robot: other.robot, to }];
            if let Some(hit) = pair.sweep(&self.state, &moved, &options)? {
                let sides = [(hit.a, hit.on_a), (hit.b, hit.on_b)];
                return Ok(Some(self.robot_hit(sides, t + hit.time * (end - t))));
            }
            t = end;
        }
        Ok(None)
    }

    /// Whether the motion keeps `clearance_m` to all fixed obstacles and between the robot's own links. Moving
    /// obstacles count at their predicted poses at the beginning of each stretch. False if the work is used up.
    pub(crate) fn keeps_clear_of_fixed(
        &mut self,
        motion: &EscapeMotion<'_>,
        obstacles: &DynamicObstacles<'_>,
        clearance_m: f64,
    ) -> Result<bool, SceneError> {
        let mut t = 0.0;
        let end_s = (motion.trajectory.duration_s - motion.elapsed_s).min(motion.horizon_s);
        while t < end_s {
            if self.is_overdue() {
                return Ok(false);
            }
            self.set_time(motion, t)?;
            self.set_moving(obstacles, motion.begins_s + t)?;
            let end = (t + self.stretch_s(motion, t, clearance_m)).min(end_s);
            motion.trajectory.q_at(motion.elapsed_s + end, &mut self.to);
            let moved = [SweepMove::Robot { robot: self.robot, to: &self.to }];
            let options = self.sweep_options(clearance_m);
            let mut pairs = self.checker.between(Selection::Robot(self.robot), Selection::All);
            if pairs.sweep(&self.state, &moved, &options)?.is_some() {
                return Ok(false);
            }
            t = end;
        }
        Ok(true)
    }

    /// Whether the motion keeps a constraint, such as regions that are closed to the robot.
    pub(crate) fn keeps_constraint(&mut self, motion: &EscapeMotion<'_>, constraint: &mut dyn PathConstraint) -> bool {
        let end_s = (motion.trajectory.duration_s - motion.elapsed_s).min(motion.horizon_s);
        let (mut t, mut step_s) = (0.0, STRETCH_S);
        motion.trajectory.q_at(motion.elapsed_s, &mut self.from);
        // A robot within the margin may leave but not approach.
        let need_m = constraint.margin_m(&self.from, f64::INFINITY).min(0.0);
        while t < end_s {
            if self.is_overdue() {
                return false;
            }
            self.margins += 1;
            let end = (t + step_s).min(end_s);
            motion.trajectory.q_at(motion.elapsed_s + t, &mut self.from);
            motion.trajectory.q_at(motion.elapsed_s + end, &mut self.to);
            let bound_m = constraint.motion_bound_m(&self.from, &self.to);
            let left_m = constraint.margin_m(&self.from, bound_m) - need_m;
            // Comparisons with NaN are false.
            if left_m >= bound_m {
                (t, step_s) = (end, (2.0 * step_s).min(STRETCH_S));
            } else if left_m >= 0.0 && step_s > MIN_CONSTRAINT_STRETCH_S {
                step_s *= 0.5;
            } else {
                return false;
            }
        }
        true
    }

    /// Duration of the stretch from `t_s` during which the motion is straight, up to a fraction of the clearance.
    fn stretch_s(&mut self, motion: &EscapeMotion<'_>, t_s: f64, clearance_m: f64) -> f64 {
        let (from, mut stretch_s) = (motion.elapsed_s + t_s, STRETCH_S);
        while stretch_s > MIN_STRETCH_S {
            motion.trajectory.chord_deviation(from, from + stretch_s, &mut self.deviation);
            if self.bounds.max_travel(&self.deviation, 1.0) <= CHORD_SHARE * clearance_m {
                break;
            }
            stretch_s *= 0.5;
        }
        stretch_s.max(MIN_STRETCH_S)
    }

    /// Moves the robot to its configuration after `t_s` seconds; returns whether it rests from then on.
    fn set_time(&mut self, motion: &EscapeMotion<'_>, t_s: f64) -> Result<bool, SceneError> {
        let at = motion.elapsed_s + t_s;
        motion.trajectory.q_at(at, &mut self.from);
        self.state.set_q(self.scene, self.robot, &self.from)?;
        Ok(at >= motion.trajectory.duration_s)
    }

    /// Places all observed obstacles where they are predicted to be in `t_s` seconds.
    fn set_moving(&mut self, obstacles: &DynamicObstacles<'_>, t_s: f64) -> Result<(), SceneError> {
        for object in obstacles.objects {
            self.state.place(self.scene, object.object, pose_after(object, t_s))?;
        }
        let own = self.robot;
        for other in obstacles.robots.iter().filter(|n| n.robot != own) {
            let q = &mut self.robots_to[other.robot.0];
            q_after(other, t_s, q);
            self.state.set_q(self.scene, other.robot, q)?;
        }
        Ok(())
    }

    /// Places all observed obstacles where they are now: an obstacle that is no longer observed later stays there.
    pub(crate) fn reset(&mut self, obstacles: &DynamicObstacles<'_>) -> Result<(), SceneError> {
        self.set_moving(obstacles, 0.0)
    }
}
