//! RRT-Connect in the exact scene as the planner of problem sets.

use elbowroom_kinematics::JointLimits;
use std::time::{Duration, Instant};

use elbowroom_planner::{PlannedPath, RobotPlanner, RrtConnectError, RrtConnectSettings, TimedMotion};

use super::{PlanningEngine, ProblemScene, ProblemSettings, Solution};

/// [`RrtConnect`](elbowroom_planner::RrtConnect) in the exact scene. Its paths are proven free.
#[derive(Debug, Clone, Copy, Default)]
pub struct RrtConnectEngine;

impl PlanningEngine for RrtConnectEngine {
    fn solve(&mut self, problem: &ProblemScene, settings: &ProblemSettings) -> Solution {
        match problem.planner() {
            Ok(exact) => solve(RobotPlanner::Exact(exact), problem, settings),
            Err(e) => Solution { reason: Some(e.to_string()), ..Solution::default() },
        }
    }

    fn time(
        &mut self,
        problem: &ProblemScene,
        path: &PlannedPath,
        limits: &[JointLimits],
        settings: &ProblemSettings,
    ) -> Result<TimedMotion, RrtConnectError> {
        time(RobotPlanner::Exact(problem.planner()?), problem, path, limits, settings)
    }
}

/// Plans to the goal that is found first.
pub(super) fn solve(mut planner: RobotPlanner, problem: &ProblemScene, settings: &ProblemSettings) -> Solution {
    let begin = Instant::now();
    let (start, goals, limits) = (problem.start(), problem.goals(), rrt_settings(settings, settings.time_limit));
    let answer = if settings.optimize {
        planner.plan_anytime(start, goals, &limits)
    } else {
        planner.plan_to_any(start, goals, &limits)
    };
    match answer {
        Ok(path) => found(path),
        // Without the prefix of the only robot's links.
        Err(e) => {
            let reason = Some(e.to_string().replace("`/", "`"));
            Solution { planning: begin.elapsed(), reason, ..Solution::default() }
        }
    }
}

/// Times a path.
pub(super) fn time(
    mut planner: RobotPlanner,
    problem: &ProblemScene,
    path: &PlannedPath,
    limits: &[JointLimits],
    settings: &ProblemSettings,
) -> Result<TimedMotion, RrtConnectError> {
    let rrt = rrt_settings(settings, Duration::MAX);
    planner.time_parametrize(problem.start(), path, limits, settings.period_s, &rrt)
}

/// Settings of the planner.
fn rrt_settings(settings: &ProblemSettings, time_limit: Duration) -> RrtConnectSettings {
    let (clearance_m, seed) = (settings.clearance_m, settings.seed);
    RrtConnectSettings { time_limit, clearance_m, seed, ..RrtConnectSettings::default() }
}

fn found(path: PlannedPath) -> Solution {
    Solution {
        found: true,
        proven: true,
        planning: path.planning_time,
        simplification: path.simplification_time,
        cost_raw_rad: path.raw_length_rad,
        cost_rad: path.length_rad,
        waypoints: path.waypoints,
        reason: None,
    }
}
