//! RRT-Connect in the exact scene as the planner of problem sets.

use elbowroom_kinematics::JointLimits;
use std::time::{Duration, Instant};

use elbowroom_planner::{PlannedPath, RrtConnectError, RrtConnectSettings, TimedMotion};

use super::{PlanningEngine, ProblemScene, ProblemSettings, Solution};

/// [`RrtConnect`](elbowroom_planner::RrtConnect) in the exact scene. Its paths are proven free.
#[derive(Debug, Clone, Copy, Default)]
pub struct RrtConnectEngine;

impl PlanningEngine for RrtConnectEngine {
    /// Tries the goals one after the other, each within its part of the remaining time.
    fn solve(&mut self, problem: &ProblemScene, settings: &ProblemSettings) -> Solution {
        let mut planner = match problem.planner() {
            Ok(planner) => planner,
            Err(e) => return Solution { reason: Some(e.to_string()), ..Solution::default() },
        };
        let begin = Instant::now();
        let mut solution = Solution::default();
        for (i, goal) in problem.goals().iter().enumerate() {
            let left = settings.time_limit.saturating_sub(begin.elapsed());
            let share = left / u32::try_from(problem.goals().len() - i).unwrap_or(u32::MAX);
            let before = begin.elapsed();
            match planner.plan(problem.start(), goal, &rrt_settings(settings, share)) {
                Ok(path) => return found(path, before),
                Err(e) => solution.reason = Some(reason(&e)),
            }
        }
        Solution { planning: begin.elapsed(), ..solution }
    }

    fn time(
        &mut self,
        problem: &ProblemScene,
        path: &PlannedPath,
        limits: &[JointLimits],
        settings: &ProblemSettings,
    ) -> Result<TimedMotion, RrtConnectError> {
        let rrt = rrt_settings(settings, Duration::MAX);
        let trajectory = problem.planner()?.time_parametrize(problem.start(), path, limits, settings.period_s, &rrt)?;
        TimedMotion::of(&trajectory, settings.period_s)
    }
}

/// Settings of the planner.
pub(super) fn rrt_settings(settings: &ProblemSettings, time_limit: Duration) -> RrtConnectSettings {
    let (clearance_m, seed) = (settings.clearance_m, settings.seed);
    RrtConnectSettings { time_limit, clearance_m, seed, ..RrtConnectSettings::default() }
}

/// A path, after a time that was spent on other goals.
pub(super) fn found(path: PlannedPath, before: Duration) -> Solution {
    Solution {
        found: true,
        proven: true,
        planning: before + path.planning_time,
        simplification: path.simplification_time,
        cost_raw_rad: path.raw_length_rad,
        cost_rad: path.length_rad,
        waypoints: path.waypoints,
        reason: None,
    }
}

/// The reason without the prefix of the only robot's links.
pub(super) fn reason(e: &RrtConnectError) -> String {
    e.to_string().replace("`/", "`")
}
