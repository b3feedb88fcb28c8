//! The RRT-Connect planner.

use std::time::{Duration, Instant};

use elbowroom_robot::RobotId;
use elbowroom_scene::{Scene, SceneError, SceneRobot, SceneState, SweepOptions};

use super::clearance_exit::{ClearanceExit, ExitError};
use super::error::RrtConnectError;
use super::motion_validator::MotionValidator;
use super::path_constraint::{ConstraintChecker, PathConstraint};
use super::random::Random;
use super::region_sampler::RegionSampler;
use super::scene_validator::SceneValidator;
use super::settings::RrtConnectSettings;
use super::shortcutting::Shortcutting;
use super::tree_search::TreeSearch;
use crate::deadline::{Deadline, Interrupt};
use crate::grid_path::PathEnd;
use crate::interpolation::path_length;
use crate::joint_path::JointPath;

/// Longest time limit: one year. Instants cannot be as far apart as durations can be long.
const MAX_TIME_LIMIT: Duration = Duration::from_hours(365 * 24);

/// Time at which a search that begins at `begin` ends.
fn deadline(begin: Instant, settings: &RrtConnectSettings) -> Instant {
    begin + settings.time_limit.min(MAX_TIME_LIMIT)
}

/// Plans for one robot of a scene; everything else stays as in a state.
///
/// Two trees of configurations grow from start and goal until they meet (RRT-Connect). While the trees grow, edges are
/// tested at discrete configurations; the edges of the path are proven by the continuous
/// [`Checker::sweep`](elbowroom_scene::Checker::sweep). For the same scene, ends and settings the path is always the
/// same, unless the time limit is reached.
///
/// ```
/// use elbowroom_planner::{RrtConnect, RrtConnectSettings};
/// use elbowroom_robot::RobotId;
/// use elbowroom_scene::{SceneState, example};
/// let scene = example::two_arms();
/// let mut state = SceneState::new(&scene);
/// state.set_q(&scene, RobotId(0), &[-0.9, 1.3, 0.6])?;
/// let mut planner = RrtConnect::new(&scene, RobotId(0))?;
/// // The part on the table is between start and goal.
/// let path = planner.plan(&state, &[0.9, 1.3, 0.6], &RrtConnectSettings::default())?;
/// assert!(path.waypoints.len() > 2 && path.length_rad < 5.0);
/// assert_eq!(path.waypoints.last().unwrap(), &[0.9, 1.3, 0.6]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct RrtConnect<'s> {
    pub(crate) validator: SceneValidator<'s>,
}

impl<'s> RrtConnect<'s> {
    /// Creates a planner for one robot of a scene.
    ///
    /// # Errors
    /// The scene does not have this robot.
    pub fn new(scene: &'s Scene, robot: RobotId) -> Result<Self, SceneError> {
        Ok(Self { validator: SceneValidator::new(scene, robot)? })
    }

    /// Adds a constraint that paths satisfy.
    ///
    /// If the start violates the constraint, or is nearer to a violation than paths may be, the path leaves it by a
    /// straight segment that comes no nearer. If the goal is nearer to a violation than paths may be, the path reaches
    /// it in the same way. A goal that violates the constraint is rejected.
    #[must_use]
    pub fn with_constraint(mut self, constraint: impl PathConstraint + 's) -> Self {
        self.validator.constraint = Some(ConstraintChecker::new(constraint));
        self
    }

    /// Lets another thread end the searches.
    #[must_use]
    pub fn with_interrupt(mut self, interrupt: Interrupt) -> Self {
        self.validator.deadline = Deadline::new(Instant::now(), interrupt);
        self
    }

    /// Narrows the robot's limits: lowest and highest value per joint, rad or m. Missing or wider limits have no
    /// effect.
    #[must_use]
    pub fn with_limits(mut self, limits: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.validator.bounds.narrow(limits.into_iter());
        self
    }

    /// Plans from the robot's configuration in `start` to `goal` (rad, m for prismatic joints). Checks self-collision,
    /// objects and other robots, which stay as in `start`, according to the scene's allowed collision matrix.
    ///
    /// # Errors
    /// An end is beyond limits, in collision or nearer than the clearance; the goal violates the [`PathConstraint`];
    /// values are NaN or too few; a setting is invalid; or no path was found within the limits, which does not prove
    /// that none exists.
    pub fn plan(
        &mut self,
        start: &SceneState,
        goal: &[f64],
        settings: &RrtConnectSettings,
    ) -> Result<JointPath, RrtConnectError> {
        let begin = Instant::now();
        let ends = self.prepare(start, goal, settings)?;
        let mut random = Random::new(settings.seed);
        if self.validator.constraint.is_none() {
            return self.connect(begin, ends, &mut random, settings);
        }
        let exits = self.clearance_exits(&ends, &mut random, settings)?;
        Ok(self.connect(begin, exits, &mut random, settings)?.with_ends(ends))
    }

    /// Plans to the first of several goals that is reached: one after the other, each in an equal part of the remaining
    /// time and with the whole limit of configurations. The last waypoint is that goal.
    ///
    /// # Errors
    /// [`RrtConnectError::NoGoal`] without goals. Otherwise the error of the first goal, or of a later valid goal to which
    /// no path was found, which says more than that another goal is invalid.
    pub fn plan_to_any<G: AsRef<[f64]>>(
        &mut self,
        start: &SceneState,
        goals: &[G],
        settings: &RrtConnectSettings,
    ) -> Result<JointPath, RrtConnectError> {
        let begin = Instant::now();
        let mut answer = RrtConnectError::NoGoal;
        for (i, goal) in goals.iter().enumerate() {
            let spent = begin.elapsed();
            let left = settings.time_limit.saturating_sub(spent) / u32::try_from(goals.len() - i).unwrap_or(u32::MAX);
            let found = self.plan(start, goal.as_ref(), &RrtConnectSettings { time_limit: left, ..*settings });
            let error = match found {
                Ok(path) => return Ok(JointPath { planning_time: path.planning_time + spent, ..path }),
                Err(error) => error,
            };
            if i == 0 || matches!(error, RrtConnectError::NotFound { .. }) {
                answer = error.after(&answer);
            }
        }
        Err(answer)
    }

    /// Like [`plan`](Self::plan), but the ends need only be free: the path leaves (or reaches) an end with less than
    /// the clearance by a straight segment that keeps half of the distance at the end, and keeps the clearance
    /// otherwise.
    ///
    /// # Errors
    /// The errors of [`plan`](Self::plan); if no such segment is found, no path is found.
    pub fn plan_from_tight_ends(
        &mut self,
        start: &SceneState,
        goal: &[f64],
        settings: &RrtConnectSettings,
    ) -> Result<JointPath, RrtConnectError> {
        let begin = Instant::now();
        let clearance_m = settings.clearance_m;
        let ends = self.prepare(start, goal, &RrtConnectSettings { clearance_m: 0.0, ..*settings })?;
        let mut random = Random::new(settings.seed);
        let exits = self.clearance_exits(&ends, &mut random, settings)?;
        self.validator.sweep = SweepOptions { clearance_m, ..self.validator.sweep };
        Ok(self.connect(begin, exits, &mut random, settings)?.with_ends(ends))
    }

    /// Returns the first of these straight segments, by the index of the waypoint at its end, that a sweep of the exact
    /// scene does not prove free or that the constraint does not allow; `None` if all of them are proven. The first
    /// waypoint must be the robot's configuration in `start`. Checks paths that were planned by other means, for
    /// example on a map.
    ///
    /// ```
    /// use elbowroom_planner::{RrtConnect, RrtConnectSettings};
    /// use elbowroom_robot::RobotId;
    /// use elbowroom_scene::{SceneState, example};
    /// let scene = example::two_arms();
    /// let mut state = SceneState::new(&scene);
    /// state.set_q(&scene, RobotId(0), &[-0.9, 1.3, 0.6])?;
    /// let (mut planner, settings) = (RrtConnect::new(&scene, RobotId(0))?, RrtConnectSettings::default());
    /// let [left, up, over, right] = [[-0.9, 1.3, 0.6], [-0.9, 0.2, 0.6], [0.9, 0.2, 0.6], [0.9, 1.3, 0.6]].map(Vec::from);
    /// let through = [left.clone(), right.clone()];
    /// assert_eq!(planner.first_unproven_segment(&state, &through, &settings)?, Some(1));
    /// assert_eq!(planner.first_unproven_segment(&state, &[left, up, over, right], &settings)?, None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`plan`](Self::plan) for the ends and the settings.
    pub fn first_unproven_segment(
        &mut self,
        start: &SceneState,
        waypoints: &[Vec<f64>],
        settings: &RrtConnectSettings,
    ) -> Result<Option<usize>, RrtConnectError> {
        self.prepare(start, waypoints.last().map_or(&[], |q| q), settings)?;
        let unproven = waypoints.windows(2).position(|pair| !self.validator.proves_motion(&pair[0], &pair[1]));
        Ok(unproven.map(|before| before + 1))
    }

    fn connect(
        &mut self,
        begin: Instant,
        [from, to]: [Vec<f64>; 2],
        random: &mut Random,
        settings: &RrtConnectSettings,
    ) -> Result<JointPath, RrtConnectError> {
        let mut waypoints = if self.validator.is_valid_motion(&from, &to) {
            vec![from, to]
        } else {
            let mut sampler = RegionSampler::new(self.validator.bounds.sampling_region(&from, &to), random);
            let mut search = TreeSearch::new(&mut self.validator, &from, [&to[..]]);
            let found = search.run(&mut sampler);
            let nodes = search.nodes();
            found.ok_or_else(|| self.not_found(&[from, to], nodes, settings))?
        };
        let planning_time = begin.elapsed();
        let raw_length_rad = path_length(&waypoints);
        if waypoints.len() > 2 {
            // The straight segment was tested first.
            Shortcutting::of_rejected_ends(&mut self.validator, &waypoints).run(&mut waypoints);
        }
        let simplification_time = begin.elapsed().saturating_sub(planning_time);
        Ok(JointPath {
            length_rad: path_length(&waypoints),
            raw_length_rad,
            waypoints,
            planning_time,
            simplification_time,
            states_checked: self.validator.states_checked,
        })
    }

    fn not_found(&self, [from, to]: &[Vec<f64>; 2], nodes: usize, settings: &RrtConnectSettings) -> RrtConnectError {
        let left = self.validator.deadline.left();
        let seconds = settings.time_limit.min(MAX_TIME_LIMIT).saturating_sub(left).as_secs_f64();
        let states_checked = self.validator.states_checked;
        RrtConnectError::NotFound {
            seconds,
            states_checked,
            nodes,
            nearer: self.validator.bounds.equivalent_goals(from, to),
        }
    }

    /// Returns, for each end, the end itself or a nearby configuration that has the clearance and satisfies the
    /// constraint.
    fn clearance_exits(
        &mut self,
        ends: &[Vec<f64>; 2],
        random: &mut Random,
        settings: &RrtConnectSettings,
    ) -> Result<[Vec<f64>; 2], RrtConnectError> {
        let mut exits = ends.clone();
        for (end, exit) in [PathEnd::Start, PathEnd::Goal].into_iter().zip(&mut exits) {
            let sampler = ClearanceExit { validator: &mut self.validator, random: &mut *random };
            let found = sampler.find(end, exit, settings.clearance_m);
            *exit = found.map_err(|e| match e {
                ExitError::Violation { what, distance_m } => {
                    RrtConnectError::ConstraintViolated { end, what, metres: distance_m }
                }
                ExitError::NotFound => self.not_found(ends, 0, settings),
            })?;
        }
        Ok(exits)
    }

    /// Prepares the validator for a query. Returns start and goal, within limits and free. Reduces the tolerance of the
    /// sweep to half of the distances at the ends at most.
    pub(super) fn prepare(
        &mut self,
        start: &SceneState,
        goal: &[f64],
        settings: &RrtConnectSettings,
    ) -> Result<[Vec<f64>; 2], RrtConnectError> {
        if let Some((setting, value)) = settings.invalid() {
            return Err(RrtConnectError::InvalidSetting { setting, value });
        }
        self.begin(start, goal, settings)?;
        let ends = [(PathEnd::Start, start.q(self.robot())), (PathEnd::Goal, goal)];
        let mut checked = Vec::new();
        for (end, q) in ends {
            let q = self.validator.bounds.clamped_end(end, q)?;
            let margin = self.free_margin_m(end, &q)?;
            self.validator.sweep.tolerance_m = self.validator.sweep.tolerance_m.min(0.5 * margin);
            checked.push(q);
        }
        let to = checked.pop().unwrap_or_default();
        Ok([checked.pop().unwrap_or_default(), to])
    }

    /// Prepares the validator for a query without checking the ends.
    pub(crate) fn begin(
        &mut self,
        start: &SceneState,
        goal: &[f64],
        settings: &RrtConnectSettings,
    ) -> Result<(), RrtConnectError> {
        Ok(self.validator.begin(start, goal, settings, deadline(Instant::now(), settings))?)
    }

    /// Distance of the nearest pair at an end minus its margin and the clearance, metres.
    pub(crate) fn free_margin_m(&mut self, end: PathEnd, q: &[f64]) -> Result<f64, RrtConnectError> {
        let clearance_m = self.validator.sweep.clearance_m;
        if let Some(contact) = self.validator.first_contact(q) {
            let metres = self.validator.pair_distance(q, &contact);
            let [a, b] = [contact.a, contact.b].map(|m| self.validator.name(m));
            return Err(RrtConnectError::InCollision { end, a, b, metres, clearance_m });
        }
        Ok(self.validator.nearest_pair(q).map_or(f64::INFINITY, |d| d.metres) - clearance_m)
    }

    /// Returns the ends if there is no constraint. Otherwise returns, for each end, the end itself or a nearby
    /// configuration that has the clearance and satisfies the constraint.
    pub(crate) fn constraint_exits(
        &mut self,
        ends: &[Vec<f64>; 2],
        start: &SceneState,
        random: &mut Random,
        settings: &RrtConnectSettings,
    ) -> Result<[Vec<f64>; 2], RrtConnectError> {
        if self.validator.constraint.is_none() {
            return Ok(ends.clone());
        }
        self.prepare(start, &ends[1], settings)?;
        self.clearance_exits(ends, random, settings)
    }

    /// Whether the scene has other robots.
    pub(crate) fn has_other_robots(&self) -> bool {
        self.validator.has_other_robots()
    }

    /// The robot in the scene.
    pub(crate) fn placed_robot(&self) -> &'s SceneRobot {
        self.validator.placed_robot()
    }

    /// Index of the robot.
    pub(crate) fn robot(&self) -> RobotId {
        self.validator.robot()
    }
}
