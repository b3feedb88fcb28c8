//! A target pose or position, as the goal of a search.

use elbowroom_spatial::{Pose, Vec3};

use super::goal::Goal;
use super::options::IkTask;
use super::rotation_error::rotation_error;

/// Tolerance (m, rad) below which only rounding remains.
const FLOOR: f64 = 1e-13;

/// Position and orientation error of a tip.
#[derive(Debug, Clone, Copy)]
pub struct PoseError {
    pub linear: Vec3,
    pub angular: Vec3,
}

impl PoseError {
    pub fn between(tip: &Pose, target: &Pose) -> Self {
        Self { linear: target.translation - tip.translation, angular: rotation_error(tip.rotation, target.rotation) }
    }

    /// Distance from the target, m.
    pub fn position_m(&self) -> f64 {
        self.linear.length()
    }

    /// Angle from the target, rad.
    pub fn angle_rad(&self) -> f64 {
        self.angular.length()
    }
}

/// The goal of a whole pose or, with [`IkTask::Position`], of its position.
#[derive(Debug, Clone, Copy)]
pub struct PoseGoal {
    pub target: Pose,
    pub task: IkTask,
    /// Length (m) whose error counts as much as one radian.
    pub scale: f64,
}

impl Goal<6> for PoseGoal {
    type Linearization = ();

    fn linearize(&self, _: &Pose) {}

    fn error(&self, tip_in_root: &Pose) -> [f64; 6] {
        let error = PoseError::between(tip_in_root, &self.target);
        self.jacobian_column(&(), error.linear, error.angular)
    }

    fn jacobian_column(&self, (): &(), linear: Vec3, angular: Vec3) -> [f64; 6] {
        let l = linear / self.scale;
        let a = if self.task == IkTask::Position { Vec3::ZERO } else { angular };
        [l.x, l.y, l.z, a.x, a.y, a.z]
    }

    fn is_met(&self, e: &[f64; 6]) -> bool {
        let length = |i: usize| Vec3::new(e[i], e[i + 1], e[i + 2]).length();
        length(0) * self.scale <= FLOOR && length(3) <= FLOOR
    }
}
