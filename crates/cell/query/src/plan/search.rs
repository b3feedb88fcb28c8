//! A path that is searched for with random samples.

use elbowroom_kinematics::JointLimits;
use elbowroom_planner::{LinearMove, RobotPlanner, RrtConnectError, RrtConnectSettings, TimedPath};
use elbowroom_scene::{Scene, SceneState};

/// Input of a planner.
pub(super) struct Search<'q> {
    pub scene: &'q Scene,
    pub state: &'q SceneState,
    pub goals: &'q [Vec<f64>],
    pub settings: &'q RrtConnectSettings,
    pub limits: &'q [JointLimits],
    pub period_s: f64,
    pub optimize: bool,
    /// A straight line of the TCP in place of a way to one of the goals.
    pub line: Option<LinearMove>,
}

impl Search<'_> {
    pub fn plan(&self, mut planner: RobotPlanner) -> Result<TimedPath, RrtConnectError> {
        let path = if let Some(line) = &self.line {
            planner.plan_linear(self.state, line, self.settings)?
        } else if self.optimize {
            planner.plan_anytime(self.state, self.goals, self.settings)?.path
        } else {
            planner.plan_to_any(self.state, self.goals, self.settings)?
        };
        planner.time_parametrize(self.state, path, self.limits, self.period_s, self.settings)
    }
}
