//! RRT-Connect on sphere covers as the planner of problem sets; what it does not find, RRT-Connect in the exact scene may.

use std::time::{Duration, Instant};

use elbowroom_planner::{CoverModel, CoverObstacles, CoverRrtConnect, RrtConnectError};

use super::problem_scene::ROBOT;
use super::rrt_connect::{found, reason, rrt_settings};
use super::{PlanningEngine, ProblemScene, ProblemSettings, RrtConnectEngine, Solution};

/// Share of the time limit after which the exact scene is searched.
const COVER_SHARE: f64 = 0.5;

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
        if !self.model.as_ref().is_some_and(|m| m.serves(scene, start)) {
            self.model = CoverModel::new(scene, start, ROBOT, settings.clearance_m).ok();
        }
        let Some(model) = &self.model else { return RrtConnectEngine.solve(problem, settings) };
        let obstacles = CoverObstacles::new(model, scene, start, settings.clearance_m);
        let mut planner =
            CoverRrtConnect::new(scene, ROBOT, model, &obstacles).with_limits(problem.limits().iter().copied());
        let mut spent = Duration::ZERO;
        for (i, goal) in problem.goals().iter().enumerate() {
            let left = settings.time_limit.mul_f64(COVER_SHARE).saturating_sub(spent);
            let share = left / u32::try_from(problem.goals().len() - i).unwrap_or(u32::MAX);
            let begin = Instant::now();
            match planner.plan(start, goal, &rrt_settings(settings, share)) {
                Ok(path) => return found(path, spent),
                Err(RrtConnectError::NotFound { .. }) => {}
                Err(e) => return Solution { reason: Some(reason(&e)), planning: spent, ..Solution::default() },
            }
            spent += begin.elapsed();
        }
        let rest = ProblemSettings { time_limit: settings.time_limit.saturating_sub(spent), ..settings.clone() };
        let solution = RrtConnectEngine.solve(problem, &rest);
        Solution { planning: spent + solution.planning, ..solution }
    }
}
