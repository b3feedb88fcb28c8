//! A path that is searched for with random samples.

use elbowroom_kinematics::JointLimits;
use elbowroom_planner::{CoverRrtConnect, PlannedPath, RrtConnect, RrtConnectError, RrtConnectSettings, TimedMotion};
use elbowroom_scene::{Scene, SceneState};

/// Input of a planner.
pub(super) struct Query<'q> {
    pub scene: &'q Scene,
    pub state: &'q SceneState,
    pub goals: &'q [Vec<f64>],
    pub settings: &'q RrtConnectSettings,
    pub limits: &'q [JointLimits],
    pub period_s: f64,
    pub optimize: bool,
}

impl Query<'_> {
    pub fn on_covers(&self, mut planner: CoverRrtConnect) -> Result<(PlannedPath, TimedMotion), RrtConnectError> {
        let path = if self.optimize {
            planner.plan_anytime(self.state, self.goals, self.settings)?.path
        } else {
            planner.plan_to_any(self.state, self.goals, self.settings)?
        };
        let motion = planner.time_parametrize(self.state, &path, self.limits, self.period_s, self.settings)?;
        Ok((path, motion))
    }

    pub fn exactly(&self, mut planner: RrtConnect) -> Result<(PlannedPath, TimedMotion), RrtConnectError> {
        // Each goal has an equal part of the time. The error is the one of the first goal.
        let share = u32::try_from(self.goals.len()).unwrap_or(u32::MAX).max(1);
        let settings = RrtConnectSettings { time_limit: self.settings.time_limit / share, ..*self.settings };
        let mut path = Err(RrtConnectError::NoGoal);
        for (i, goal) in self.goals.iter().enumerate() {
            let found = planner.plan(self.state, goal, &settings);
            if i == 0 || found.is_ok() {
                path = found;
            }
            if path.is_ok() {
                break;
            }
        }
        let path = path?;
        let motion = planner.time_parametrize(self.state, &path, self.limits, self.period_s, self.settings)?;
        Ok((path, TimedMotion::of(&motion, self.period_s)?))
    }
}
