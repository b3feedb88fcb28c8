//! RRT-Connect on sphere covers as the planner of problem sets, followed by RRT-Connect in the exact scene.

use elbowroom_kinematics::{JointLimits, LinkId};
use elbowroom_planner::{
    AnytimePath, CoverModels, CoverObstacles, JointPath, RobotPlanner, RrtConnectError, TimedPath,
};

use super::problem_scene::ROBOT;
use super::{PlanningEngine, ProblemScene, ProblemSettings, Unsolved, linear_move, rrt_connect};
use crate::cover_cache::CoverCache;

/// [`CoverRrtConnect`](elbowroom_planner::CoverRrtConnect), then [`RrtConnect`](elbowroom_planner::RrtConnect). All paths
/// are proven free.
///
/// The covers of the robot are built at the first problem, and again for other pairs; if the robot holds something, for
/// each question.
#[derive(Debug, Clone, Default)]
pub struct CoverRrtConnectEngine {
    models: CoverModels,
}

impl CoverRrtConnectEngine {
    fn with_planner<T>(
        &mut self,
        problem: &ProblemScene,
        settings: &ProblemSettings,
        ask: impl FnOnce(RobotPlanner) -> T,
    ) -> Result<T, RrtConnectError> {
        let (scene, start, clearance_m) = (problem.scene(), problem.start(), settings.clearance_m);
        let model = self.models.serving(scene, start, ROBOT, clearance_m, &CoverCache::of_user());
        let obstacles = model.map(|model| CoverObstacles::new(model, scene, start, clearance_m));
        Ok(ask(RobotPlanner::new(problem.planner()?, model.zip(obstacles.as_ref()))))
    }
}

impl PlanningEngine for CoverRrtConnectEngine {
    /// Plans to the goal that is found first.
    fn solve(&mut self, problem: &ProblemScene, settings: &ProblemSettings) -> Result<AnytimePath, Unsolved> {
        self.with_planner(problem, settings, |planner| rrt_connect::solve(planner, problem, settings))?
    }

    fn solve_linear(
        &mut self,
        problem: &ProblemScene,
        link: LinkId,
        settings: &ProblemSettings,
    ) -> Result<JointPath, Unsolved> {
        self.with_planner(problem, settings, |planner| linear_move::plan(planner, problem, link, settings))?
    }

    fn time(
        &mut self,
        problem: &ProblemScene,
        path: JointPath,
        limits: &[JointLimits],
        settings: &ProblemSettings,
    ) -> Result<TimedPath, RrtConnectError> {
        self.with_planner(problem, settings, |planner| rrt_connect::time(planner, problem, path, limits, settings))?
    }
}
