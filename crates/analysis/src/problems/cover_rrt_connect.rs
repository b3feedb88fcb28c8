//! RRT-Connect on sphere covers as the planner of problem sets; what it does not find, RRT-Connect in the exact scene may.

use std::time::{Duration, Instant};

use elbowroom_planner::{
    CoverModel, CoverObstacles, CoverRrtConnect, KinematicLimits, PlannedPath, RrtConnectError, TimedMotion,
};

use super::problem_scene::ROBOT;
use super::rrt_connect::{found, reason, rrt_settings};
use super::{PlanningEngine, ProblemScene, ProblemSettings, RrtConnectEngine, Solution};

/// [`CoverRrtConnect`], then [`RrtConnect`](elbowroom_planner::RrtConnect). All paths are proven free. The covers of the robot are
/// built at the first problem and again where its pairs change.
#[derive(Debug, Clone, Default)]
pub struct CoverRrtConnectEngine {
    model: Option<CoverModel>,
}

impl PlanningEngine for CoverRrtConnectEngine {
    /// Tries the goals one after the other, each within its share of the remaining time.
    fn solve(&mut self, problem: &ProblemScene, settings: &ProblemSettings) -> Solution {
        let (scene, start) = (problem.scene(), problem.start());
        if !self.model.as_ref().is_some_and(|m| m.serves(scene, start, settings.clearance_m)) {
            self.model = CoverModel::new(scene, start, ROBOT, settings.clearance_m).ok();
        }
        let Some(model) = &self.model else { return RrtConnectEngine.solve(problem, settings) };
        let obstacles = CoverObstacles::new(model, scene, start, settings.clearance_m);
        let Ok(exact) = problem.planner() else { return RrtConnectEngine.solve(problem, settings) };
        let mut planner = CoverRrtConnect::new(exact, model, &obstacles);
        let begin = Instant::now();
        let mut solution = Solution::default();
        for (i, goal) in problem.goals().iter().enumerate() {
            let left = settings.time_limit.saturating_sub(begin.elapsed());
            let share = left / u32::try_from(problem.goals().len() - i).unwrap_or(u32::MAX);
            let before = begin.elapsed();
            match planner.plan(start, goal, &rrt_settings(settings, share)) {
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
        limits: &KinematicLimits,
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
