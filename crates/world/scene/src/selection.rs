//! Selections of the geometry that a query covers.

use elbowroom_kinematics::LinkId;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};

/// One side of a query; see [`Checker::between`](crate::Checker::between).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Selection {
    /// All robots and all objects.
    All,
    /// The links of one robot and the objects attached to it.
    Robot(RobotId),
    /// All robots, with the objects attached to them.
    Robots,
    /// One link, without the objects attached to it.
    Link {
        /// The robot.
        robot: RobotId,
        /// The link.
        link: LinkId,
    },
    /// One object, attached or not.
    Object(ObjectId),
    /// All objects, attached or not.
    Objects,
}

impl From<GeometryId> for Selection {
    fn from(id: GeometryId) -> Self {
        match id {
            GeometryId::Link { robot, link } => Self::Link { robot, link },
            GeometryId::Object(o) => Self::Object(o),
        }
    }
}

impl Selection {
    /// True if the geometry is selected. `carrier` is the robot to which an attached object is attached.
    pub(crate) fn contains(self, id: GeometryId, carrier: Option<RobotId>) -> bool {
        match (self, id) {
            (Self::All, _) | (Self::Robots, GeometryId::Link { .. }) | (Self::Objects, GeometryId::Object(_)) => true,
            (Self::Robots, GeometryId::Object(_)) => carrier.is_some(),
            (Self::Robot(r), GeometryId::Link { robot, .. }) => r == robot,
            (Self::Robot(r), GeometryId::Object(_)) => carrier == Some(r),
            (Self::Link { .. } | Self::Object(_), _) => self == id.into(),
            (Self::Objects, GeometryId::Link { .. }) => false,
        }
    }

    /// True if the selection can contain only objects.
    pub(crate) fn is_objects(self) -> bool {
        matches!(self, Self::Object(_) | Self::Objects)
    }
}
