//! RRT-Connect on sphere covers as the planner of problem sets, followed by RRT-Connect in the exact scene.

use elbowroom_kinematics::JointLimits;
use std::time::{Duration, Instant};

use elbowroom_planner::{CoverModel, CoverObstacles, CoverRrtConnect, PlannedPath, RrtConnectError, TimedMotion};

use super::problem_scene::ROBOT;
use super::rrt_connect::{found, reason, rrt_settings};
use super::{PlanningEngine, ProblemScene, ProblemSettings, RrtConnectEngine, Solution};
use crate::cover_cache::CoverCache;

/// [`CoverRrtConnect`], then [`RrtConnect`](elbowroom_planner::RrtConnect). All paths are proven free.
///
/// The covers of the robot are built at the first problem, and again if its pairs change.
#[derive(Debug, Clone, Default)]
pub struct CoverRrtConnectEngine {
    model: Option<CoverModel>,
}

impl PlanningEngine for CoverRrtConnectEngine {
    /// Plans to the goal that is found first.
    fn solve(&mut self, problem: &ProblemScene, settings: &ProblemSettings) -> Solution {
        let (scene, start) = (problem.scene(), problem.start());
        if !self.model.as_ref().is_some_and(|m| m.serves(scene, start, settings.clearance_m)) {
            self.model =
                CoverModel::with_covers(scene, start, ROBOT, settings.clearance_m, &CoverCache::of_user()).ok();
        }
        let Some(model) = &self.model else { return RrtConnectEngine.solve(problem, settings) };
        let obstacles = CoverObstacles::new(model, scene, start, settings.clearance_m);
        let Ok(exact) = problem.planner() else { return RrtConnectEngine.solve(problem, settings) };
        let mut planner = CoverRrtConnect::new(exact, model, &obstacles);
        let begin = Instant::now();
        let (goals, limits) = (problem.goals(), rrt_settings(settings, settings.time_limit));
        let answer = if settings.optimize {
            planner.plan_anytime(start, goals, &limits).map(|anytime| anytime.path)
        } else {
            planner.plan_to_any(start, goals, &limits)
        };
        match answer {
            Ok(path) => found(path, Duration::ZERO),
            Err(e) => Solution { planning: begin.elapsed(), reason: Some(reason(&e)), ..Solution::default() },
        }
    }

    fn time(
        &mut self,
        problem: &ProblemScene,
        path: &PlannedPath,
        limits: &[JointLimits],
        settings: &ProblemSettings,
    ) -> Result<TimedMotion, RrtConnectError> {
        let Some(model) = &self.model else { return RrtConnectEngine.time(problem, path, limits, settings) };
        let (scene, start) = (problem.scene(), problem.start());
        let obstacles = CoverObstacles::new(model, scene, start, settings.clearance_m);
        let mut planner = CoverRrtConnect::new(problem.planner()?, model, &obstacles);
        let rrt = rrt_settings(settings, Duration::MAX);
        planner.time_parametrize(start, path, limits, settings.period_s, &rrt)
    }
}
