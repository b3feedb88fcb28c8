//! Which members a question is about.

use elbowroom_kinematics::LinkId;

use crate::Member;

/// One side of a question; see [`Checker::between`](crate::Checker::between).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Selection {
    /// Everything there is.
    All,
    /// The links of one robot and the objects that it carries.
    Robot(usize),
    /// All robots, with the objects that they carry.
    Robots,
    /// One link, without what it carries.
    Link {
        /// Index of the robot.
        robot: usize,
        /// The link.
        link: LinkId,
    },
    /// One object, carried or not.
    Object(usize),
    /// All objects, carried or not.
    Objects,
}

impl From<Member> for Selection {
    fn from(member: Member) -> Self {
        match member {
            Member::Link { robot, link } => Self::Link { robot, link },
            Member::Object(o) => Self::Object(o),
        }
    }
}

impl Selection {
    /// True where the member is selected; `carrier` is the robot that carries it, where it is an attached object.
    pub(crate) fn holds(self, member: Member, carrier: Option<usize>) -> bool {
        match (self, member) {
            (Self::All, _) | (Self::Robots, Member::Link { .. }) | (Self::Objects, Member::Object(_)) => true,
            (Self::Robots, Member::Object(_)) => carrier.is_some(),
            (Self::Robot(r), Member::Link { robot, .. }) => r == robot,
            (Self::Robot(r), Member::Object(_)) => carrier == Some(r),
            (Self::Link { .. } | Self::Object(_), _) => self == member.into(),
            (Self::Objects, Member::Link { .. }) => false,
        }
    }

    /// True where it can hold objects alone.
    pub(crate) fn is_objects(self) -> bool {
        matches!(self, Self::Object(_) | Self::Objects)
    }
}
