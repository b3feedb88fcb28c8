//! An object that is attached to a link.

use elbowroom_kinematics::LinkId;
use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;

/// How an object is attached to a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Attachment {
    /// The robot.
    pub robot: RobotId,
    /// The link that holds the object.
    pub link: LinkId,
    /// Pose of the object's frame in the link's frame.
    pub in_link: Pose,
    /// Links of the robot that may touch the object, such as fingers.
    pub touch_links: Vec<LinkId>,
}
