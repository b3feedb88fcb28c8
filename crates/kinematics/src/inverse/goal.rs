//! What a descent brings to zero: the difference of a tip from its target, as rows of a least-squares problem.

use elbowroom_spatial::{Pose, Vec3};

use super::Task;
use super::arm::turn_between;

/// Below this (m, rad) nothing but rounding is left to gain.
const FLOOR: f64 = 1e-13;

/// `R` equations on the pose of a tip in the root.
pub trait Goal<const R: usize> {
    /// What [`Goal::column`] needs to know of the place where it is asked.
    type Place: Copy;

    /// Looked at once per linearization.
    fn place(&self, tip_in_root: &Pose) -> Self::Place;

    /// What is missing, metres made comparable with radians. Its square is what descends.
    fn error(&self, tip_in_root: &Pose) -> [f64; R];

    /// How much of the error the tip's motion takes away per unit: `linear` (m) and `angular` (rad), in the root.
    fn column(&self, place: &Self::Place, linear: Vec3, angular: Vec3) -> [f64; R];

    /// True where nothing more is asked for.
    fn met(&self, error: &[f64; R]) -> bool;
}

/// What remains between the tip and its target.
#[derive(Debug, Clone, Copy)]
pub struct Remainder {
    pub linear: Vec3,
    pub angular: Vec3,
}

impl Remainder {
    pub fn between(tip: &Pose, target: &Pose) -> Self {
        Self { linear: target.translation - tip.translation, angular: turn_between(tip.rotation, target.rotation) }
    }

    /// Distance from the target.
    pub fn position_m(&self) -> f64 {
        self.linear.length()
    }

    pub fn angle_rad(&self) -> f64 {
        self.angular.length()
    }
}

/// A whole pose, or with [`Task::Position`] its position.
#[derive(Debug, Clone, Copy)]
pub struct PoseGoal {
    pub target: Pose,
    pub task: Task,
    /// Metres that weigh as much as a radian.
    pub scale: f64,
}

impl Goal<6> for PoseGoal {
    type Place = ();

    fn place(&self, _: &Pose) {}

    fn error(&self, tip_in_root: &Pose) -> [f64; 6] {
        let missing = Remainder::between(tip_in_root, &self.target);
        self.column(&(), missing.linear, missing.angular)
    }

    fn column(&self, (): &(), linear: Vec3, angular: Vec3) -> [f64; 6] {
        let l = linear / self.scale;
        let a = if self.task == Task::Position { Vec3::ZERO } else { angular };
        [l.x, l.y, l.z, a.x, a.y, a.z]
    }

    fn met(&self, e: &[f64; 6]) -> bool {
        let length = |i: usize| Vec3::new(e[i], e[i + 1], e[i + 2]).length();
        length(0) * self.scale <= FLOOR && length(3) <= FLOOR
    }
}
