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
    /// Links of other robots that may touch it, such as the fingers that take it over.
    pub visiting_links: Vec<(RobotId, LinkId)>,
}

impl Attachment {
    /// Whether a link may touch the object.
    pub fn may_touch(&self, robot: RobotId, link: LinkId) -> bool {
        robot == self.robot && self.touch_links.contains(&link) || self.visiting_links.contains(&(robot, link))
    }
}
