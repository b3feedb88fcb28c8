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
    /// True if the path was planned with it: it is kept clear of and not evaded.
    pub known: bool,
}

/// Another robot of the scene, as it reports itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour<'a> {
    /// Index of the robot in the scene.
    pub robot: RobotId,
    /// Its joint values, rad or m.
    pub q: &'a [f64],
    /// Its joint velocities, rad/s or m/s.
    pub qd: &'a [f64],
    /// True if the path was planned with it: it is kept clear of and not evaded.
    pub known: bool,
}

/// All observed objects and robots besides the controlled one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DynamicObstacles<'a> {
    /// Objects. Those that were never observed are fixed at the poses of the scene; those that are no longer observed are
    /// assumed stationary at the last observed pose, and may move.
    pub objects: &'a [ObservedObject],
    /// Robots. Those without updates are assumed stationary at their last configuration, or at that of the scene.
    pub robots: &'a [Neighbour<'a>],
}
