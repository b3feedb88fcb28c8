//! The arms of a virtual robot, and how they can grasp the work-piece.

use elbowroom_kinematics::{JointLimits, LinkId};
use elbowroom_robot::RobotId;
use elbowroom_spatial::{Pose, Vec3};

/// A way to grasp the work-piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grasp {
    /// Pose of the tool centre point in the frame of the work-piece.
    pub tool_in_part: Pose,
    /// Motion from the pre-grasp to the grasp, in the frame of the work-piece, m.
    pub approach: Vec3,
}

impl Grasp {
    /// Pose of the tool centre point in the frame of the work-piece, at a distance (m) before the grasp.
    pub(crate) fn at(&self, before_m: f64) -> Pose {
        let back = self.approach.try_normalize().map_or(Vec3::ZERO, |direction| direction * before_m);
        Pose::new(self.tool_in_part.rotation, self.tool_in_part.translation - back)
    }

    /// Length of the approach, m.
    pub(crate) fn length_m(&self) -> f64 {
        self.approach.length()
    }
}

/// An arm of a virtual robot.
#[derive(Debug, Clone)]
pub struct Member {
    /// The robot in the scene.
    pub robot: RobotId,
    /// The link that carries the hand.
    pub tip: LinkId,
    /// The tool centre point in the frame of that link.
    pub tool_in_tip: Pose,
    /// Limits of the joints.
    pub limits: Vec<JointLimits>,
    /// Links that may touch the work-piece while the arm grasps, holds or leaves it.
    pub hand: Vec<LinkId>,
    /// Its grasps.
    pub grasps: Vec<Grasp>,
}
