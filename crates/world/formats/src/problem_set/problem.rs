//! A planning problem, as far as it is read.

use elbowroom_spatial::Pose;

use crate::moveit_msgs::types::{AllowedCollisions, AttachedObject, CollisionObject, FixedFrame, JointValue};

/// A planning problem: obstacles, a start and alternative goals.
#[derive(Debug, Clone)]
pub struct PlanningProblem {
    /// Name of its set.
    pub set: String,
    /// Its key in the set.
    pub id: String,
    /// Frames that objects may refer to, besides the links.
    pub frames: Vec<FixedFrame>,
    /// Obstacles.
    pub objects: Vec<CollisionObject>,
    /// Objects that the robot holds.
    pub attached: Vec<AttachedObject>,
    /// Pairs that may touch.
    pub matrix: AllowedCollisions,
    /// Pose of the robot's root link.
    pub base_in_world: Pose,
    /// Joint values at the start; no joint twice.
    pub start: Vec<JointValue>,
    /// Alternative goals, at least one; none is empty.
    pub goals: Vec<Vec<JointValue>>,
}
