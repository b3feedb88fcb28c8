//! Typed indices of robots, objects and their collision geometry.

use elbowroom_kinematics::LinkId;

/// Index of a robot among the robots of a scene or a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RobotId(pub usize);

/// Index of an object among the objects of a scene or a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(pub usize);

/// One side of a collision pair: a link of a robot with all of its colliders, or an object.
///
/// The order is by robot, then by link; objects come after all links.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum GeometryId {
    /// A link of a robot.
    Link {
        /// The robot.
        robot: RobotId,
        /// The link of its chain.
        link: LinkId,
    },
    /// An object.
    Object(ObjectId),
}
