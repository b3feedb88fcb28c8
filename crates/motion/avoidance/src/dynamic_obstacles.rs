//! Dynamic obstacles as observed at one instant.

use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_spatial::{FrameMotion, Pose};

/// An observed object that moves, or that the path was not planned for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObservedObject {
    /// Index of the object in the scene.
    pub object: ObjectId,
    /// Pose of the object.
    pub in_world: Pose,
    /// Motion of the object; [`FrameMotion::REST`] if it is stationary.
    pub motion: FrameMotion,
    /// Whether the path was planned with the object: then the robot keeps its distance but does not evade it.
    pub known: bool,
}

/// Another robot of the scene, with the state that it reports.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour<'a> {
    /// Index of the robot in the scene.
    pub robot: RobotId,
    /// Joint values of the robot, rad or m.
    pub q: &'a [f64],
    /// Joint velocities of the robot, rad/s or m/s.
    pub qd: &'a [f64],
    /// Whether the path was planned with the robot: then the controlled robot keeps its distance but does not evade it.
    pub known: bool,
}

/// All observed objects and robots except the controlled robot.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DynamicObstacles<'a> {
    /// Objects. Objects that were never observed are fixed at their poses in the scene. Objects that are no longer
    /// observed are assumed stationary at the last observed pose, and may move.
    pub objects: &'a [ObservedObject],
    /// Robots. Robots without updates are assumed stationary at their last configuration, or at their configuration in
    /// the scene.
    pub robots: &'a [Neighbour<'a>],
}
