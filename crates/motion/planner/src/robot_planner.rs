//! The choice between sphere covers and the exact scene.

use elbowroom_kinematics::JointLimits;
use elbowroom_robot::RobotId;
use elbowroom_scene::{Scene, SceneState};
use elbowroom_validity::CoverSource;

use crate::cover_rrt_connect::{AnytimePath, CoverModel, CoverObstacles, CoverRrtConnect, LinearMove};
use crate::joint_path::JointPath;
use crate::rrt_connect::{RrtConnect, RrtConnectError, RrtConnectSettings};
use crate::timed_path::TimedPath;

/// Largest number of models that are kept; then the oldest goes.
const MAX_KEPT: usize = 8;

/// Plans for one robot of a scene: on sphere covers, if its links have them, otherwise in the exact scene. Every path is
/// proven free.
///
/// ```
/// use elbowroom_kinematics::JointLimits;
/// use elbowroom_planner::{CoverModels, CoverObstacles, RobotPlanner, RrtConnect, RrtConnectSettings};
/// use elbowroom_robot::RobotId;
/// use elbowroom_scene::{SceneState, example};
/// use elbowroom_validity::BuiltCovers;
/// let (scene, robot, settings) = (example::two_arms(), RobotId(0), RrtConnectSettings::default());
/// let mut start = SceneState::new(&scene);
/// start.set_q(&scene, robot, &[-0.9, 1.3, 0.6])?;
/// let mut models = CoverModels::default();
/// let model = models.serving(&scene, &start, robot, settings.clearance_m, &BuiltCovers);
/// let obstacles = model.map(|model| CoverObstacles::new(model, &scene, &start, settings.clearance_m));
/// let mut planner = RobotPlanner::new(RrtConnect::new(&scene, robot)?, model.zip(obstacles.as_ref()));
/// let path = planner.plan_to_any(&start, &[[0.9, 1.3, 0.6]], &settings)?;
/// let limits = vec![JointLimits::new(2.0, 8.0, 80.0); 3];
/// let timed = planner.time_parametrize(&start, path, &limits, 0.004, &settings)?;
/// assert_eq!(timed.trajectory.last(), Some(&[0.9, 1.3, 0.6][..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "one value per plan, never in a list")]
pub enum RobotPlanner<'m> {
    /// On sphere covers; in the exact scene where the covers find no path.
    Covers(CoverRrtConnect<'m>),
    /// In the exact scene.
    Exact(RrtConnect<'m>),
}

impl<'m> RobotPlanner<'m> {
    /// Creates a planner with the limits and the constraint of an exact planner. The covers must belong to the same
    /// robot.
    pub fn new(exact: RrtConnect<'m>, covers: Option<(&'m CoverModel, &'m CoverObstacles)>) -> Self {
        match covers {
            Some((model, obstacles)) => Self::Covers(CoverRrtConnect::new(exact, model, obstacles)),
            None => Self::Exact(exact),
        }
    }

    /// Plans to the first of several goals that is reached ([`CoverRrtConnect::plan_to_any`],
    /// [`RrtConnect::plan_to_any`]).
    ///
    /// # Errors
    /// The errors of these methods.
    pub fn plan_to_any<G: AsRef<[f64]>>(
        &mut self,
        start: &SceneState,
        goals: &[G],
        settings: &RrtConnectSettings,
    ) -> Result<JointPath, RrtConnectError> {
        match self {
            Self::Covers(planner) => planner.plan_to_any(start, goals, settings),
            Self::Exact(planner) => planner.plan_to_any(start, goals, settings),
        }
    }

    /// Like [`plan_to_any`](Self::plan_to_any), then searches on covers for shorter paths until the time limit. In the
    /// exact scene the first path is the answer.
    ///
    /// # Errors
    /// The errors of [`plan_to_any`](Self::plan_to_any).
    pub fn plan_anytime<G: AsRef<[f64]>>(
        &mut self,
        start: &SceneState,
        goals: &[G],
        settings: &RrtConnectSettings,
    ) -> Result<AnytimePath, RrtConnectError> {
        match self {
            Self::Covers(planner) => planner.plan_anytime(start, goals, settings),
            Self::Exact(planner) => planner.plan_to_any(start, goals, settings).map(AnytimePath::from),
        }
    }

    /// Plans a straight line of the tip ([`CoverRrtConnect::plan_linear`]).
    ///
    /// # Errors
    /// The errors of this method, and [`RrtConnectError::LinearMoveWithoutCovers`] without covers.
    pub fn plan_linear(
        &mut self,
        start: &SceneState,
        line: &LinearMove,
        settings: &RrtConnectSettings,
    ) -> Result<JointPath, RrtConnectError> {
        match self {
            Self::Covers(planner) => planner.plan_linear(start, line, settings),
            Self::Exact(_) => Err(RrtConnectError::LinearMoveWithoutCovers),
        }
    }

    /// Times a path that was planned from `start`, with a row every `period_s`
    /// ([`CoverRrtConnect::time_parametrize`], [`RrtConnect::time_parametrize`]).
    ///
    /// # Errors
    /// The errors of these methods.
    pub fn time_parametrize(
        &mut self,
        start: &SceneState,
        path: JointPath,
        limits: &[JointLimits],
        period_s: f64,
        settings: &RrtConnectSettings,
    ) -> Result<TimedPath, RrtConnectError> {
        match self {
            Self::Covers(planner) => planner.time_parametrize(start, path, limits, period_s, settings),
            Self::Exact(planner) => planner.timed(start, path, limits, period_s, settings),
        }
    }
}

/// Cover models of the robots of a scene, kept for other scenes with the same robots at the same places, whatever their
/// objects.
#[derive(Debug, Clone, Default)]
pub struct CoverModels {
    kept: Vec<CoverModel>,
    /// The last model that serves one state only: the robot holds something.
    carrying: Option<CoverModel>,
}

impl CoverModels {
    /// A model for a robot in a scene; the links' covers come from a source if no kept model serves. `None` if a link
    /// has no bounds, so that spheres cannot enclose it.
    ///
    /// # Panics
    /// The scene does not have this robot.
    pub fn serving(
        &mut self,
        scene: &Scene,
        state: &SceneState,
        robot: RobotId,
        clearance_m: f64,
        source: &dyn CoverSource,
    ) -> Option<&CoverModel> {
        let serves = |model: &CoverModel| model.serves(scene, state, robot, clearance_m);
        if let Some(known) = self.kept.iter().position(serves) {
            return self.kept.get(known);
        }
        let model = CoverModel::with_covers(scene, state, robot, clearance_m, source).ok()?;
        if serves(&model) {
            if self.kept.len() == MAX_KEPT {
                self.kept.remove(0);
            }
            self.kept.push(model);
            return self.kept.last();
        }
        Some(self.carrying.insert(model))
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_scene::example;
    use elbowroom_validity::BuiltCovers;

    use super::*;

    #[test]
    fn each_robot_has_its_own_model_which_serves_again() {
        let scene = example::two_arms();
        let state = SceneState::new(&scene);
        let mut models = CoverModels::default();
        for kept in [1, 2, 2, 2] {
            let robot = RobotId(1 - kept % 2);
            let model = models.serving(&scene, &state, robot, 0.0, &BuiltCovers).unwrap();
            assert!(
                model.serves(&scene, &state, robot, 0.0) && !model.serves(&scene, &state, RobotId(1 - robot.0), 0.0)
            );
            assert_eq!(models.kept.len(), kept);
        }
        for mm in 0..MAX_KEPT + 2 {
            models.serving(&scene, &state, RobotId(0), 1e-3 * mm as f64, &BuiltCovers).unwrap();
        }
        assert_eq!(models.kept.len(), MAX_KEPT);
    }
}
