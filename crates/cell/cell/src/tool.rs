//! A named tool of a robot.

use elbowroom_kinematics::LinkId;
use elbowroom_robot::Collider;
use elbowroom_spatial::Pose;

/// A named tool: `[robot.NAME.tools.TOOL]`.
#[derive(Debug, Clone)]
pub struct CellTool {
    /// Its name.
    pub name: String,
    /// The link that carries it.
    pub flange: LinkId,
    /// Its own link, of the same name, fixed to the flange at its frame.
    pub link: LinkId,
    /// Tool centre point frame in its link.
    pub tcp_in_link: Pose,
    /// Its collider in its link.
    pub collider: Option<Collider>,
    /// Whether it is mounted on its flange at present.
    pub mounted: bool,
}
