//! Planner of problem sets with a limit of configurations instead of time.

use elbowroom_kinematics::JointLimits;
use std::time::Duration;

use elbowroom_planner::{
    AnytimePath, CoverModels, CoverObstacles, JointPath, RobotPlanner, RrtConnect, RrtConnectError, RrtConnectSettings,
    TimedPath,
};
use elbowroom_query::problems::{PlanningEngine, ProblemScene, ProblemSettings, Unsolved};
use elbowroom_robot::RobotId;
use elbowroom_validity::BuiltCovers;

use super::digest::Digest;

/// Largest number of configurations that a search checks, on the covers and again in the exact scene.
const MAX_STATES: u64 = 200_000;
/// Time limit, which is never reached.
const TIME_LIMIT: Duration = Duration::from_hours(24);
/// The only robot.
const ROBOT: RobotId = RobotId(0);

/// [`RobotPlanner`] on covers that are built instead of read from files. It hashes each solution.
#[derive(Clone, Default)]
pub struct BoundedEngine {
    models: CoverModels,
    pub digest: Digest,
}

impl BoundedEngine {
    /// Builds the covers of a problem's robot, unless the present covers are of the same robot.
    pub fn prepare(&mut self, problem: &ProblemScene, clearance_m: f64) -> Result<(), String> {
        let model = self.models.serving(problem.scene(), problem.start(), ROBOT, clearance_m, &BuiltCovers);
        model.map(|_| ()).ok_or_else(|| "no covers".to_owned())
    }

    fn with_planner<T>(
        &mut self,
        problem: &ProblemScene,
        clearance_m: f64,
        ask: impl FnOnce(RobotPlanner) -> Result<T, RrtConnectError>,
    ) -> Result<T, RrtConnectError> {
        let (scene, start) = (problem.scene(), problem.start());
        let model = self.models.serving(scene, start, ROBOT, clearance_m, &BuiltCovers);
        let obstacles = model.map(|model| CoverObstacles::new(model, scene, start, clearance_m));
        // Joints that the goals do not name are held.
        let exact = RrtConnect::new(scene, ROBOT)?.with_limits(problem.limits().iter().copied());
        ask(RobotPlanner::new(exact, model.zip(obstacles.as_ref())))
    }
}

impl PlanningEngine for BoundedEngine {
    fn solve(&mut self, problem: &ProblemScene, settings: &ProblemSettings) -> Result<AnytimePath, Unsolved> {
        let found = self.with_planner(problem, settings.clearance_m, |mut planner| {
            planner.plan_to_any(problem.start(), problem.goals(), &bounded(settings))
        });
        let none = Vec::new();
        let path = found.as_ref().ok();
        let waypoints = path.map_or(&none, |path| &path.waypoints);
        self.digest.flag(path.is_some());
        self.digest.numbers(path.map_or([0.0; 2], |path| [path.raw_length_rad, path.length_rad]));
        self.digest.whole(waypoints.len());
        self.digest.numbers(waypoints.iter().flatten().copied());
        Ok(found?.into())
    }

    fn time(
        &mut self,
        problem: &ProblemScene,
        path: JointPath,
        limits: &[JointLimits],
        settings: &ProblemSettings,
    ) -> Result<TimedPath, RrtConnectError> {
        self.with_planner(problem, settings.clearance_m, |mut planner| {
            planner.time_parametrize(problem.start(), path, limits, settings.period_s, &bounded(settings))
        })
    }
}

fn bounded(settings: &ProblemSettings) -> RrtConnectSettings {
    let (clearance_m, seed) = (settings.clearance_m, settings.seed);
    RrtConnectSettings { time_limit: TIME_LIMIT, max_states: MAX_STATES, clearance_m, seed, ..Default::default() }
}
