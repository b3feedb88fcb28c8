//! Planner of problem sets with a limit of configurations instead of time.

use elbowroom_kinematics::JointLimits;
use std::time::Duration;

use elbowroom_planner::{
    CoverModel, CoverObstacles, CoverRrtConnect, PlannedPath, RrtConnect, RrtConnectError, RrtConnectSettings,
    TimedMotion,
};
use elbowroom_query::problems::{PlanningEngine, ProblemScene, ProblemSettings, Solution};
use elbowroom_robot::RobotId;

use super::digest::Digest;

/// Largest number of configurations that a search checks, on the covers and again in the exact scene.
const MAX_STATES: u64 = 200_000;
/// Time limit, which is never reached.
const TIME_LIMIT: Duration = Duration::from_hours(24);
/// The only robot.
const ROBOT: RobotId = RobotId(0);

/// [`CoverRrtConnect`] on covers that are built instead of read from files. It hashes each solution.
#[derive(Clone, Default)]
pub struct BoundedEngine {
    model: Option<CoverModel>,
    pub digest: Digest,
}

impl BoundedEngine {
    /// Builds the covers of a problem's robot, unless the present covers are of the same robot.
    pub fn prepare(&mut self, problem: &ProblemScene, clearance_m: f64) -> Result<(), String> {
        let (scene, start) = (problem.scene(), problem.start());
        if !self.model.as_ref().is_some_and(|m| m.serves(scene, start, clearance_m)) {
            let built = CoverModel::new(scene, start, ROBOT, clearance_m);
            self.model = Some(built.map_err(|e| e.to_string())?);
        }
        Ok(())
    }

    fn search(&mut self, problem: &ProblemScene, settings: &ProblemSettings) -> Result<PlannedPath, String> {
        self.prepare(problem, settings.clearance_m)?;
        let model = self.model.as_ref().ok_or("no covers")?;
        let (scene, start) = (problem.scene(), problem.start());
        let obstacles = CoverObstacles::new(model, scene, start, settings.clearance_m);
        let mut planner = CoverRrtConnect::new(exact(problem).map_err(|e| e.to_string())?, model, &obstacles);
        planner.plan_to_any(start, problem.goals(), &bounded(settings)).map_err(|e| e.to_string())
    }
}

impl PlanningEngine for BoundedEngine {
    fn solve(&mut self, problem: &ProblemScene, settings: &ProblemSettings) -> Solution {
        let solution = match self.search(problem, settings) {
            Ok(path) => Solution {
                found: true,
                proven: true,
                planning: path.planning_time,
                simplification: path.simplification_time,
                cost_raw_rad: path.raw_length_rad,
                cost_rad: path.length_rad,
                waypoints: path.waypoints,
                reason: None,
            },
            Err(reason) => Solution { reason: Some(reason), ..Solution::default() },
        };
        self.digest.flag(solution.found);
        self.digest.numbers([solution.cost_raw_rad, solution.cost_rad]);
        self.digest.whole(solution.waypoints.len());
        self.digest.numbers(solution.waypoints.iter().flatten().copied());
        solution
    }

    fn time(
        &mut self,
        problem: &ProblemScene,
        path: &PlannedPath,
        limits: &[JointLimits],
        settings: &ProblemSettings,
    ) -> Result<TimedMotion, RrtConnectError> {
        let mut exact = exact(problem)?;
        let (scene, start) = (problem.scene(), problem.start());
        let Some(model) = &self.model else {
            let trajectory = exact.time_parametrize(start, path, limits, settings.period_s, &bounded(settings))?;
            return TimedMotion::of(&trajectory, settings.period_s);
        };
        let obstacles = CoverObstacles::new(model, scene, start, settings.clearance_m);
        let mut planner = CoverRrtConnect::new(exact, model, &obstacles);
        planner.time_parametrize(start, path, limits, settings.period_s, &bounded(settings))
    }
}

/// Creates the exact planner, which holds joints that the goals do not name.
fn exact(problem: &ProblemScene) -> Result<RrtConnect<'_>, RrtConnectError> {
    Ok(RrtConnect::new(problem.scene(), ROBOT)?.with_limits(problem.limits().iter().copied()))
}

fn bounded(settings: &ProblemSettings) -> RrtConnectSettings {
    let (clearance_m, seed) = (settings.clearance_m, settings.seed);
    RrtConnectSettings { time_limit: TIME_LIMIT, max_states: MAX_STATES, clearance_m, seed, ..Default::default() }
}
