//! RRT-Connect in the exact scene as the planner of problem sets.

use elbowroom_kinematics::JointLimits;
use std::time::{Duration, Instant};

use elbowroom_planner::{AnytimePath, JointPath, RobotPlanner, RrtConnectError, RrtConnectSettings, TimedPath};

use super::{PlanningEngine, ProblemScene, ProblemSettings, Unsolved};

/// [`RrtConnect`](elbowroom_planner::RrtConnect) in the exact scene. Its paths are proven free.
#[derive(Debug, Clone, Copy, Default)]
pub struct RrtConnectEngine;

impl PlanningEngine for RrtConnectEngine {
    fn solve(&mut self, problem: &ProblemScene, settings: &ProblemSettings) -> Result<AnytimePath, Unsolved> {
        solve(RobotPlanner::Exact(problem.planner().map_err(RrtConnectError::from)?), problem, settings)
    }

    fn time(
        &mut self,
        problem: &ProblemScene,
        path: JointPath,
        limits: &[JointLimits],
        settings: &ProblemSettings,
    ) -> Result<TimedPath, RrtConnectError> {
        time(RobotPlanner::Exact(problem.planner()?), problem, path, limits, settings)
    }
}

impl From<RrtConnectError> for Unsolved {
    fn from(e: RrtConnectError) -> Self {
        Self { reason: reason(&e), planning: Duration::ZERO }
    }
}

/// The message, without the prefix of the only robot's links.
pub(super) fn reason(e: &RrtConnectError) -> String {
    e.to_string().replace("`/", "`")
}

/// Plans to the goal that is found first.
pub(super) fn solve(
    mut planner: RobotPlanner,
    problem: &ProblemScene,
    settings: &ProblemSettings,
) -> Result<AnytimePath, Unsolved> {
    let begin = Instant::now();
    let (start, goals, limits) = (problem.start(), problem.goals(), rrt_settings(settings, settings.time_limit));
    let answer = if settings.optimize {
        planner.plan_anytime(start, goals, &limits)
    } else {
        planner.plan_to_any(start, goals, &limits).map(AnytimePath::from)
    };
    answer.map_err(|e| Unsolved { reason: reason(&e), planning: begin.elapsed() })
}

/// Times a path.
pub(super) fn time(
    mut planner: RobotPlanner,
    problem: &ProblemScene,
    path: JointPath,
    limits: &[JointLimits],
    settings: &ProblemSettings,
) -> Result<TimedPath, RrtConnectError> {
    let rrt = rrt_settings(settings, Duration::MAX);
    planner.time_parametrize(problem.start(), path, limits, settings.period_s, &rrt)
}

/// Settings of the planner.
pub(super) fn rrt_settings(settings: &ProblemSettings, time_limit: Duration) -> RrtConnectSettings {
    let (clearance_m, seed) = (settings.clearance_m, settings.seed);
    RrtConnectSettings { time_limit, clearance_m, seed, ..RrtConnectSettings::default() }
}
