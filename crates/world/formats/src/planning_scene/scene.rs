//! What a planning scene says.

use std::path::PathBuf;

use elbowroom_spatial::Pose;

use crate::Warning;
use crate::moveit_msgs::types::{AllowedCollisions, AttachedObject, CollisionObject, FixedFrame, JointValue};

/// The content of a planning scene.
#[derive(Debug, Clone, Default)]
pub struct PlanningScene {
    /// The file, for messages.
    pub file: PathBuf,
    /// Its name; empty if it has none.
    pub name: String,
    /// Objects of the world; no name twice.
    pub objects: Vec<CollisionObject>,
    /// Frames that objects may refer to, besides the links of a robot.
    pub frames: Vec<FixedFrame>,
    /// Objects that a robot holds.
    pub attached: Vec<AttachedObject>,
    /// Pairs that may touch.
    pub allowed: AllowedCollisions,
    /// Joint values of the robot.
    pub joints: Vec<JointValue>,
    /// Pose of the robot's root link, where the scene has one.
    pub base_in_world: Option<Pose>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}
