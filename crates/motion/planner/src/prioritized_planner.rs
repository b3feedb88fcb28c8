//! Prioritized planning for several robots: plans them one after the other, then lets them move at the same time as far
//! as that is proven free.
//!
//! Each robot's path is planned while the robots before it rest at their goals and the robots after it at their starts
//! (Erdmann, Lozano-Pérez: *On multiple moving objects*, 1987). Run one after the other, the motions are free. Each
//! motion then starts as early as a sweep of both robots proves it free beside every motion of higher priority: paths
//! do not change, only times (Kant, Zucker: *Toward efficient trajectory planning: the path-velocity decomposition*,
//! 1986). If a robot has no path with one priority order, the planner tries others.

use elbowroom_kinematics::JointLimits;
use std::time::{Duration, Instant};

use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, Scene, SceneState, Selection, SweepMove, SweepOptions};
use elbowroom_validity::{BuiltCovers, CoverSource};

use crate::{
    CoverModels, CoverObstacles, PathConstraint, RobotPlanner, RrtConnect, RrtConnectError, RrtConnectSettings,
    TimedPath,
};

/// Up to this number of robots, all priority orders are tried; with more robots, each robot is tried as the first.
const ALL_ORDERS: usize = 4;
/// Step of the tried delays, s.
const DELAY_STEP_S: f64 = 0.05;

/// Provides the path constraint of each of several robots.
pub trait PathConstraintSource {
    /// Returns the constraint of a robot; `None` if its paths are not constrained.
    fn constraint_of(&self, robot: RobotId) -> Option<Box<dyn PathConstraint + '_>>;
}

/// Why motions for several robots cannot be planned.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PrioritizedPlannerError {
    /// No robot has a goal.
    #[error("no robot has a goal: write at least one")]
    NoGoal,
    /// A robot has no motion with the first priority order.
    #[error("robot {}: {error}", .robot.0)]
    Robot {
        /// The robot.
        robot: RobotId,
        /// Why the robot has no motion.
        error: RrtConnectError,
    },
    /// With every tried order, some robot has no path around the others at their starts or goals. Motions in which the
    /// robots make way for each other may still exist.
    #[error(
        "no path in {orders} orders of the robots, after {seconds:.1} s: whichever goes first, one of them has none around the others \
         at their starts or goals. They may have to make way for each other: plan one of them to a place aside before"
    )]
    NoPriority {
        /// The robot without a path in the first order.
        robot: RobotId,
        /// Number of tried orders.
        orders: usize,
        /// Duration of the search, s.
        seconds: f64,
    },
}

/// Goal of one of several robots.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotGoal {
    /// The robot.
    pub robot: RobotId,
    /// Its goal configuration, rad (m for prismatic joints).
    pub q: Vec<f64>,
    /// Limits of its motion.
    pub limits: Vec<JointLimits>,
}

/// The motion of one of several robots.
#[derive(Debug, Clone, PartialEq)]
pub struct PrioritizedMotion {
    /// The robot.
    pub robot: RobotId,
    /// Its path; times count from its own start.
    pub timed: TimedPath,
    /// When it starts, s.
    pub start_s: f64,
    /// Period of the motion's rows, s.
    period_s: f64,
}

impl PrioritizedMotion {
    /// Time at which the motion ends, s.
    pub fn end_s(&self) -> f64 {
        self.start_s + self.last_row() as f64 * self.period_s
    }

    /// Configuration at a multiple of the period: before the start the first configuration, after the end the last.
    pub fn at_tick(&self, tick: usize) -> &[f64] {
        &self.timed.trajectory.rows()[tick.saturating_sub(self.start_tick()).min(self.last_row())].q
    }

    fn start_tick(&self) -> usize {
        (self.start_s / self.period_s).round() as usize
    }

    fn last_row(&self) -> usize {
        self.timed.trajectory.rows().len() - 1
    }

    fn end_tick(&self) -> usize {
        self.start_tick() + self.last_row()
    }
}

/// Plans motions for several robots of a scene by priority.
///
/// ```
/// use elbowroom_kinematics::JointLimits;
/// use elbowroom_planner::{PrioritizedPlanner, RobotGoal, RrtConnectSettings};
/// use elbowroom_robot::RobotId;
/// use elbowroom_scene::{SceneState, example};
/// let scene = example::two_arms();
/// let limits = vec![JointLimits::new(2.0, 10.0, 100.0); 3];
/// let goal = |robot: usize, waist: f64| RobotGoal { robot: RobotId(robot), q: vec![waist, 0.4, 0.4], limits: limits.clone() };
/// let goals = [goal(0, 0.8), goal(1, -0.8)];
/// let planner = PrioritizedPlanner::new(&scene);
/// let motions = planner.plan(&SceneState::new(&scene), &goals, 0.01, &RrtConnectSettings::default())?;
/// assert!(motions.iter().all(|motion| motion.end_s() > 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy)]
pub struct PrioritizedPlanner<'s> {
    scene: &'s Scene,
    covers: &'s dyn CoverSource,
    constraints: Option<&'s dyn PathConstraintSource>,
}

impl std::fmt::Debug for PrioritizedPlanner<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PrioritizedPlanner").field("robots", &self.scene.robots().len()).finish_non_exhaustive()
    }
}

impl<'s> PrioritizedPlanner<'s> {
    /// Creates a planner for the robots of a scene.
    pub fn new(scene: &'s Scene) -> Self {
        Self { scene, covers: &BuiltCovers, constraints: None }
    }

    /// Uses the covers of links from a source.
    #[must_use]
    pub fn with_covers(self, covers: &'s dyn CoverSource) -> Self {
        Self { covers, ..self }
    }

    /// Adds constraints on the paths, for example regions to avoid.
    #[must_use]
    pub fn with_constraints(self, constraints: &'s dyn PathConstraintSource) -> Self {
        Self { constraints: Some(constraints), ..self }
    }

    /// Computes motions from the configurations in `start` to the goals, with a row every `period_s`, in the order of
    /// the goals. The first goals have the highest priority if that order leaves a path for every robot. Between rows
    /// all robots move straight in joint space; the motion of all robots together is proven free, and each robot
    /// follows its path.
    ///
    /// # Errors
    /// The errors of [`RobotPlanner::plan_to_any`] and [`RobotPlanner::time_parametrize`], for the first priority order
    /// and the first robot that fails; [`PrioritizedPlannerError::NoGoal`] without goals.
    pub fn plan(
        &self,
        start: &SceneState,
        goals: &[RobotGoal],
        period_s: f64,
        settings: &RrtConnectSettings,
    ) -> Result<Vec<PrioritizedMotion>, PrioritizedPlannerError> {
        let begin = Instant::now();
        let mut first_error = None;
        for (before, order) in orders(goals.len()).into_iter().enumerate() {
            let planned = self.plan_in_order(start, goals, &order, period_s, settings);
            match planned {
                Ok(mut motions) => {
                    motions.sort_by_key(|motion| goals.iter().position(|goal| goal.robot == motion.robot));
                    return Ok(motions);
                }
                Err(error) => {
                    first_error = Some(of_orders(first_error, error, goals.len(), before + 1, begin.elapsed()));
                }
            }
            if begin.elapsed() >= settings.time_limit {
                break;
            }
        }
        Err(first_error.unwrap_or(PrioritizedPlannerError::NoGoal))
    }

    fn plan_in_order(
        &self,
        start: &SceneState,
        goals: &[RobotGoal],
        order: &[usize],
        period_s: f64,
        settings: &RrtConnectSettings,
    ) -> Result<Vec<PrioritizedMotion>, PrioritizedPlannerError> {
        let share = u32::try_from(goals.len()).unwrap_or(u32::MAX);
        let settings = RrtConnectSettings { time_limit: settings.time_limit / share, ..*settings };
        let mut state = start.clone();
        let mut motions: Vec<PrioritizedMotion> = Vec::new();
        for goal in order.iter().map(|&index| &goals[index]) {
            let of_robot = |error| PrioritizedPlannerError::Robot { robot: goal.robot, error };
            let timed = self.plan_one(&state, goal, period_s, &settings).map_err(of_robot)?;
            let next = PrioritizedMotion { robot: goal.robot, timed, start_s: 0.0, period_s };
            motions.push(self.as_early_as_possible(start, &motions, next, settings.clearance_m).map_err(of_robot)?);
            state.set_q(self.scene, goal.robot, &goal.q).map_err(|error| of_robot(error.into()))?;
        }
        Ok(motions)
    }

    fn plan_one(
        &self,
        state: &SceneState,
        goal: &RobotGoal,
        period_s: f64,
        settings: &RrtConnectSettings,
    ) -> Result<TimedPath, RrtConnectError> {
        let mut exact = RrtConnect::new(self.scene, goal.robot)?;
        if let Some(constraint) = self.constraints.and_then(|all| all.constraint_of(goal.robot)) {
            exact = exact.with_constraint(vec![constraint]);
        }
        let clearance_m = settings.clearance_m;
        let mut models = CoverModels::default();
        let model = models.serving(self.scene, state, goal.robot, clearance_m, self.covers);
        let obstacles = model.map(|model| CoverObstacles::new(model, self.scene, state, clearance_m));
        let mut planner = RobotPlanner::new(exact, model.zip(obstacles.as_ref()));
        let path = planner.plan_to_any(state, &[&goal.q], settings)?;
        planner.time_parametrize(state, path, &goal.limits, period_s, settings)
    }

    /// Sets the earliest start at which a motion is proven free beside all motions of higher priority: at the latest,
    /// when they have ended.
    fn as_early_as_possible(
        &self,
        start: &SceneState,
        before: &[PrioritizedMotion],
        mut next: PrioritizedMotion,
        clearance_m: f64,
    ) -> Result<PrioritizedMotion, RrtConnectError> {
        let last = before.iter().map(PrioritizedMotion::end_tick).max().unwrap_or(0);
        let step = ((DELAY_STEP_S / next.period_s).round() as usize).max(1);
        let mut checker = Checker::new(self.scene, CheckerOptions::default());
        let sweep = SweepOptions { clearance_m, ..SweepOptions::default() };
        for tick in (0..last).step_by(step) {
            next.start_s = tick as f64 * next.period_s;
            let mut are_free = true;
            for other in before {
                are_free = are_free && self.are_free_together(&mut checker, start, other, &next, &sweep)?;
            }
            if are_free {
                return Ok(next);
            }
        }
        next.start_s = last as f64 * next.period_s;
        Ok(next)
    }

    /// Whether two motions are proven free while the second one moves and the first one has not ended. At other times
    /// they are free already: the second path is free beside the end of the first, and the first path beside the start
    /// of the second.
    fn are_free_together(
        &self,
        checker: &mut Checker<'s>,
        start: &SceneState,
        first: &PrioritizedMotion,
        second: &PrioritizedMotion,
        sweep: &SweepOptions,
    ) -> Result<bool, RrtConnectError> {
        let mut state = start.clone();
        for tick in second.start_tick()..second.end_tick().min(first.end_tick()) {
            for motion in [first, second] {
                state.set_q(self.scene, motion.robot, motion.at_tick(tick))?;
            }
            let moves =
                [first, second].map(|motion| SweepMove::Robot { robot: motion.robot, to: motion.at_tick(tick + 1) });
            let mut pair = checker.between(Selection::Robot(first.robot), Selection::Robot(second.robot));
            if pair.sweep(&state, &moves, sweep)?.is_some() {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// The error after a number of tried orders. A proof for one robot while the others rest somewhere is not a proof for
/// all together.
fn of_orders(
    first: Option<PrioritizedPlannerError>,
    error: PrioritizedPlannerError,
    robots: usize,
    orders: usize,
    after: Duration,
) -> PrioritizedPlannerError {
    let seconds = after.as_secs_f64();
    match first.unwrap_or(error) {
        PrioritizedPlannerError::NoPriority { robot, .. }
        | PrioritizedPlannerError::Robot { robot, error: RrtConnectError::Disconnected { .. } }
            if robots > 1 =>
        {
            PrioritizedPlannerError::NoPriority { robot, orders, seconds }
        }
        other => other,
    }
}

/// Orders of a number of robots: all orders of a few robots, each of many robots as the first; the given order first.
fn orders(count: usize) -> Vec<Vec<usize>> {
    let given: Vec<usize> = (0..count).collect();
    if count > ALL_ORDERS {
        return (0..count).map(|by| given.iter().map(|i| (i + by) % count).collect()).collect();
    }
    let mut orders: Vec<Vec<usize>> = given.iter().map(|&first| vec![first]).collect();
    for _ in 1..count {
        let mut longer = Vec::new();
        for order in &orders {
            let others = given.iter().filter(|i| !order.contains(i));
            longer.extend(others.map(|&next| [&order[..], &[next]].concat()));
        }
        orders = longer;
    }
    orders
}

#[cfg(test)]
mod tests {
    use super::orders;

    #[test]
    fn the_given_order_is_first_and_none_is_repeated() {
        assert_eq!(orders(0), Vec::<Vec<usize>>::new());
        let three = orders(3);
        assert_eq!((three.len(), &three[0][..]), (6, &[0, 1, 2][..]));
        assert!((1..6).all(|i| !three[..i].contains(&three[i])));
        let six = orders(6);
        assert!(six.len() == 6 && six[0] == [0, 1, 2, 3, 4, 5] && six[5] == [5, 0, 1, 2, 3, 4]);
    }
}
