//! Robots that act as one.

use elbowroom_cooperation::{CooperationSettings, Grasp};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_vision::Visibility;

use crate::OperatorStream;

/// Robots that act as one: `[virtual_robot.NAME]`.
#[derive(Debug, Clone)]
pub struct CellVirtualRobot {
    /// Its name.
    pub name: String,
    /// Line of its table.
    pub line: usize,
    /// What the robots carry.
    pub work_piece: ObjectId,
    /// The robots.
    pub members: Vec<VirtualRobotMember>,
    /// Index of the member that holds the work-piece at the start.
    pub holder: usize,
    /// The desired poses of the work-piece.
    pub stream: OperatorStream,
    /// Distances, speeds and times.
    pub settings: CooperationSettings,
    /// The camera that looks at the work-piece, if one is named.
    pub view: Option<WorkPieceView>,
}

/// A camera that looks at a work-piece.
#[derive(Debug, Clone)]
pub struct WorkPieceView {
    /// Name of the camera.
    pub camera: String,
    /// What it sees of the work-piece.
    pub visibility: Visibility,
}

/// A robot that is a member of a virtual robot.
#[derive(Debug, Clone)]
pub struct VirtualRobotMember {
    /// The robot.
    pub robot: RobotId,
    /// How it can grasp the work-piece.
    pub grasps: Vec<Grasp>,
}
