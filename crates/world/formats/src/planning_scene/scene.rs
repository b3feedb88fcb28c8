//! Content of a planning scene.

use std::path::PathBuf;

use elbowroom_spatial::Pose;

use crate::Diagnostic;
use crate::moveit_msgs::types::{AllowedCollisions, AttachedObject, CollisionObject, FixedFrame, JointValue};

/// The content of a planning scene.
#[derive(Debug, Clone, Default)]
pub struct PlanningScene {
    /// Path of the file, for messages.
    pub file: PathBuf,
    /// Name of the scene; may be empty.
    pub name: String,
    /// Objects of the world, with unique names.
    pub objects: Vec<CollisionObject>,
    /// Frames to which objects may refer, in addition to the links of a robot.
    pub frames: Vec<FixedFrame>,
    /// Objects that a robot holds.
    pub attached: Vec<AttachedObject>,
    /// Pairs that may touch.
    pub allowed: AllowedCollisions,
    /// Joint values of the robot.
    pub joints: Vec<JointValue>,
    /// Pose of the robot's root link, if the scene has it.
    pub base_in_world: Option<Pose>,
    /// Warnings for the user.
    pub warnings: Vec<Diagnostic>,
}
