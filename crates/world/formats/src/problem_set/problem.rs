//! The parts of a planning problem that are read.

use elbowroom_spatial::Pose;

use super::motion::RequestedMotion;
use super::path_constraint::AxisConstraint;
use crate::moveit_msgs::types::{AllowedCollisions, AttachedObject, CollisionObject, FixedFrame, JointValue};

/// A planning problem: obstacles, a start and alternative goals.
#[derive(Debug, Clone)]
pub struct PlanningProblem {
    /// Name of the set.
    pub set: String,
    /// Key in the set.
    pub id: String,
    /// Frames to which objects may refer, in addition to the links.
    pub frames: Vec<FixedFrame>,
    /// Obstacles.
    pub objects: Vec<CollisionObject>,
    /// Objects that the robot holds.
    pub attached: Vec<AttachedObject>,
    /// Pairs that may touch.
    pub matrix: AllowedCollisions,
    /// Pose of the robot's root link.
    pub base_in_world: Pose,
    /// Joint values at the start, each joint once.
    pub start: Vec<JointValue>,
    /// Alternative goals: at least one, all non-empty.
    pub goals: Vec<Vec<JointValue>>,
    /// Axes of links that keep their directions along the path.
    pub kept: Vec<AxisConstraint>,
    /// How the robot moves.
    pub motion: RequestedMotion,
    /// Name of the group of joints that the request is for; may be empty.
    pub group: String,
}
