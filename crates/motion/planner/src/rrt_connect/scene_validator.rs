//! Motion validator in the exact scene: tests by sampling, and proves continuously, whether motions of one robot are
//! free.

use std::time::Instant;

use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_scene::{
    Checker, CheckerOptions, PairContact, PairDistance, Scene, SceneError, SceneRobot, SceneState, Selection,
    SweepMove, SweepOptions,
};

use super::joint_bounds::JointBounds;
use super::joint_weights::joint_weights;
use super::motion_validator::MotionValidator;
use super::path_constraint::ConstraintChecker;
use super::settings::RrtConnectSettings;
use crate::deadline::{Deadline, Interrupt};
use crate::interpolation::lerp;

/// Number of questions whether the search must end that count as a checked configuration.
const QUESTIONS_PER_STATE: u64 = 16;

/// Validates motions of one robot; everything else stays as in a state.
#[derive(Debug)]
pub(crate) struct SceneValidator<'s> {
    scene: &'s Scene,
    robot: RobotId,
    checker: Checker<'s>,
    state: SceneState,
    pub bounds: JointBounds,
    pub sweep: SweepOptions,
    pub constraint: Option<ConstraintChecker<'s>>,
    /// Motion of the solids per value, m per rad or m; see [`super::joint_weights`].
    weights: Vec<f64>,
    max_weight: f64,
    /// Longest edge of a tree, rad (and m).
    edge_length: f64,
    /// Largest step of a discrete check; see [`Self::distance`].
    check_resolution: f64,
    /// Number of checked configurations.
    pub states_checked: u64,
    /// Number of questions whether the search must end.
    questions: u64,
    pub deadline: Deadline,
    pub max_states: u64,
}

impl<'s> SceneValidator<'s> {
    /// Creates a validator for one robot of a scene.
    ///
    /// # Errors
    /// The scene does not have this robot.
    pub fn new(scene: &'s Scene, robot: RobotId) -> Result<Self, SceneError> {
        let count = scene.robots().len();
        let placed = scene.robots().get(robot.0).ok_or(SceneError::NoSuchRobot { index: robot.0, count })?;
        let bounds = JointBounds::new(&placed.robot.chain);
        let weights = joint_weights(&placed.robot, &bounds);
        Ok(Self {
            scene,
            robot,
            checker: Checker::new(scene, CheckerOptions::default()),
            state: SceneState::new(scene),
            bounds,
            sweep: SweepOptions::default(),
            constraint: None,
            max_weight: weights.iter().copied().fold(0.0, f64::max),
            weights,
            edge_length: f64::INFINITY,
            check_resolution: f64::INFINITY,
            states_checked: 0,
            questions: 0,
            deadline: Deadline::new(Instant::now(), Interrupt::default()),
            max_states: u64::MAX,
        })
    }

    /// Begins a query: sets the state of the scene and the limits of the search.
    ///
    /// # Errors
    /// The scene rejects the goal.
    pub fn begin(
        &mut self,
        state: &SceneState,
        goal: &[f64],
        settings: &RrtConnectSettings,
        deadline: Instant,
    ) -> Result<(), SceneError> {
        state.check_q(self.scene, self.robot, goal)?;
        self.state.clone_from(state);
        (self.states_checked, self.questions) = (0, 0);
        self.deadline = self.deadline.until(deadline);
        self.max_states = settings.max_states;
        self.edge_length = settings.edge_length;
        self.check_resolution = settings.check_resolution;
        self.sweep = SweepOptions { clearance_m: settings.clearance_m, ..Default::default() };
        Ok(())
    }

    /// Index of the robot.
    pub fn robot(&self) -> RobotId {
        self.robot
    }

    /// The robot in the scene.
    pub fn placed_robot(&self) -> &'s SceneRobot {
        &self.scene.robots()[self.robot.0]
    }

    /// The scene and its state, in which everything but the robot is as it was set.
    pub fn scene_state(&self) -> (&'s Scene, &SceneState) {
        (self.scene, &self.state)
    }

    pub fn name(&self, geometry: GeometryId) -> String {
        self.scene.name(geometry)
    }

    /// Sets the robot's values. False if the scene rejects them: they count as not free.
    fn set_robot(&mut self, q: &[f64]) -> bool {
        self.state.set_q(self.scene, self.robot, q).is_ok()
    }

    /// Returns a pair nearer than the clearance.
    pub fn first_contact(&mut self, q: &[f64]) -> Option<PairContact> {
        self.set_robot(q);
        self.pair_within(self.sweep.clearance_m)
    }

    fn pair_within(&mut self, metres: f64) -> Option<PairContact> {
        self.checker.between(Selection::Robot(self.robot), Selection::All).within(&self.state, metres)
    }

    /// Returns the nearest pair of the robot.
    pub fn nearest_pair(&mut self, q: &[f64]) -> Option<PairDistance> {
        self.set_robot(q);
        self.checker.between(Selection::Robot(self.robot), Selection::All).distance(&self.state)
    }

    /// Distance of a pair minus its security margin, metres.
    pub fn pair_distance(&mut self, q: &[f64], contact: &PairContact) -> f64 {
        self.set_robot(q);
        let found = self.checker.between(contact.a.into(), contact.b.into()).distance(&self.state);
        found.map_or(0.0, |d| d.metres)
    }

    /// Whether the constraint, if any, is satisfied with a margin for a proof.
    pub fn satisfies_constraint(&mut self, q: &[f64]) -> bool {
        self.constraint.as_mut().is_none_or(|constraint| constraint.is_free(q))
    }

    /// Whether a configuration is free with a margin for a proof.
    pub fn is_free(&mut self, q: &[f64]) -> bool {
        self.states_checked += 1;
        let margin = self.sweep.clearance_m + self.sweep.tolerance_m;
        // The constraint first: it is the cheaper test.
        self.satisfies_constraint(q) && self.set_robot(q) && self.pair_within(margin).is_none()
    }

    /// Weighted distance: approximate motion of the solids, as rad (or m) of the joint that moves them most.
    pub fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let each = a.iter().zip(b).zip(&self.weights).map(|((x, y), w)| ((x - y) * w).powi(2));
        if self.max_weight > 0.0 { each.sum::<f64>().sqrt() / self.max_weight } else { 0.0 }
    }

    /// Steps of the joints that each, alone, have this weighted distance.
    pub fn equivalent_steps(&self, distance: f64) -> impl Iterator<Item = f64> + '_ {
        self.weights.iter().map(move |w| if *w > 0.0 { distance * self.max_weight / w } else { 0.0 })
    }

    /// Checks `b`, then configurations in between at the resolution, coarsely first. This is not a proof.
    fn discrete_check(&mut self, a: &[f64], b: &[f64]) -> bool {
        if !self.is_free(b) {
            return false;
        }
        let steps = (self.distance(a, b) / self.check_resolution).ceil() as usize;
        let mut stride = steps.max(1).next_power_of_two();
        let mut q = vec![0.0; a.len()];
        while stride > 1 {
            let half = stride / 2;
            for i in (half..steps).step_by(stride) {
                lerp(a, b, i as f64 / steps as f64, &mut q);
                if !self.is_free(&q) {
                    return false;
                }
            }
            stride = half;
        }
        true
    }

    /// Like [`proves_motion`](MotionValidator::proves_motion), but `a` may be nearer to a violation of the constraint than paths
    /// may, if the segment comes no nearer.
    pub fn proves_departure(&mut self, a: &[f64], b: &[f64]) -> bool {
        let constrained = self.constraint.as_mut().is_none_or(|constraint| constraint.proves_departure(a, b));
        constrained && self.sweep_is_free(a, b)
    }

    /// Whether the constraint, if any, is proven to be satisfied on the straight segment from `a` to `b`.
    pub fn constraint_allows(&mut self, a: &[f64], b: &[f64]) -> bool {
        self.constraint.as_mut().is_none_or(|constraint| constraint.proves_motion(a, b))
    }

    /// Whether one pair is proven to stay apart while the robot moves straight from a configuration.
    pub fn pair_sweep_is_free(
        &mut self,
        a: GeometryId,
        b: GeometryId,
        from: &[f64],
        to: SweepMove,
        options: &SweepOptions,
    ) -> bool {
        let mut pair = self.checker.between(a.into(), b.into());
        self.state.set_q(self.scene, self.robot, from).is_ok()
            && matches!(pair.sweep(&self.state, &[to], options), Ok(None))
    }

    /// Longest edge of a tree to projected configurations, rad (and m), if the constraint projects.
    pub fn projected_edge_length(&self) -> Option<f64> {
        self.constraint.as_ref().and_then(ConstraintChecker::projected_edge_length)
    }

    /// Whether the scene has other robots.
    pub fn has_other_robots(&self) -> bool {
        self.scene.robots().len() > 1
    }

    /// Proves a segment in the scene.
    fn sweep_is_free(&mut self, a: &[f64], b: &[f64]) -> bool {
        if !self.set_robot(a) {
            return false;
        }
        let moves = [SweepMove::Robot { robot: self.robot, to: b }];
        let mut pairs = self.checker.between(Selection::Robot(self.robot), Selection::All);
        matches!(pairs.sweep(&self.state, &moves, &self.sweep), Ok(None))
    }
}

impl MotionValidator for SceneValidator<'_> {
    /// Tests configurations at the resolution: cheaper than the proof.
    fn motion_is_free(&mut self, from: &[f64], to: &[f64]) -> bool {
        self.discrete_check(from, to)
    }

    fn proves_motion(&mut self, from: &[f64], to: &[f64]) -> bool {
        self.constraint_allows(from, to) && self.sweep_is_free(from, to)
    }

    fn is_exhausted(&mut self) -> bool {
        // A search that is stuck may draw samples without checking any configuration.
        self.questions += 1;
        let rounds = self.questions / QUESTIONS_PER_STATE;
        self.states_checked.max(rounds) >= self.max_states || self.deadline.is_over()
    }

    fn longest_edge(&self) -> f64 {
        self.projected_edge_length().unwrap_or(self.edge_length)
    }

    fn project(&mut self, q: &mut [f64]) -> bool {
        self.constraint.as_mut().is_none_or(|constraint| constraint.project(q)) && self.bounds.contains(q)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use elbowroom_scene::example;

    use super::*;

    #[test]
    fn a_search_that_checks_nothing_ends_too() {
        let scene = example::two_arms();
        let mut validator = SceneValidator::new(&scene, RobotId(0)).unwrap();
        let settings = RrtConnectSettings { max_states: 3, ..RrtConnectSettings::default() };
        let state = SceneState::new(&scene);
        let deadline = Instant::now() + Duration::from_hours(1);
        for _ in 0..2 {
            validator.begin(&state, &[0.0; 3], &settings, deadline).unwrap();
            let questions = (1..1000).find(|_| validator.is_exhausted()).unwrap();
            assert_eq!((questions, validator.states_checked), (3 * QUESTIONS_PER_STATE, 0));
        }
    }
}
