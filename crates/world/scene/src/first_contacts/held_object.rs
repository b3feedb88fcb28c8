//! How a robot carries an object, and which link moves a geometry.

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_robot::{GeometryId, Robot, RobotId};
use elbowroom_spatial::Pose;

use crate::Attachment;

/// An object that a robot carries.
#[derive(Debug, Clone)]
pub(super) struct HeldObject {
    pub attachment: Attachment,
    /// Radius of a sphere around the link's origin that contains the object, m.
    pub radius: f64,
    /// True while the object is set down: it may touch objects.
    pub set_down: bool,
}

impl HeldObject {
    pub(super) fn in_world(&self, robots: &[(&Robot, Pose)], states: &[&ChainState]) -> Pose {
        let Attachment { robot, link, in_link, .. } = &self.attachment;
        robots[robot.0].1 * states[robot.0].link_in_root(*link) * *in_link
    }
}

/// The link that moves a geometry, and the radius (m) of a sphere around the link's origin that contains the geometry.
pub(super) struct Carrier {
    pub robot: RobotId,
    pub link: LinkId,
    pub radius: f64,
}

impl Carrier {
    pub(super) fn of(id: GeometryId, robots: &[(&Robot, Pose)], held: &[Option<HeldObject>]) -> Option<Self> {
        match id {
            GeometryId::Link { robot, link } => Some(Self { robot, link, radius: robots[robot.0].0.link_radius(link) }),
            GeometryId::Object(o) => held[o.0].as_ref().map(|h| {
                let Attachment { robot, link, .. } = h.attachment;
                Self { robot, link, radius: h.radius }
            }),
        }
    }
}
