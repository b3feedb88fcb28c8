//! The solids of a robot, grouped by the joints of the map that move them.

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_proximity::Shape;
use elbowroom_robot::Robot;
use elbowroom_spatial::Pose;

use super::driven_chain::{DrivenChain, DrivingJoint, LinkJoints};
use super::enclosure::swept_enclosure;
use super::error::RobotMapError;

/// The solids that the same joints of the map move.
#[derive(Debug)]
pub(super) struct RigidGroup {
    /// The joints from the root outwards; at least one.
    pub joints: Vec<DrivingJoint>,
    /// The solids in the frame of the last joint's child.
    pub solids: Vec<(Shape, Pose)>,
}

/// All solids of a robot that count in the map.
#[derive(Debug, Default)]
pub(super) struct RigidGroups {
    pub groups: Vec<RigidGroup>,
    /// Swept volumes of links that no axis of the map moves, in the world.
    pub static_solids: Vec<(Shape, Pose)>,
}

impl RigidGroups {
    pub fn new(robot: &Robot, chain: &DrivenChain) -> Result<Self, RobotMapError> {
        let mut all = Self::default();
        let state = chain.state();
        for (link, link_joints) in chain.links.iter().enumerate() {
            if link_joints.driving.is_empty() && link_joints.swept.is_empty() {
                continue;
            }
            let solids = solids(robot, chain, link)?;
            let Some(last) = link_joints.driving.last() else {
                let carrier_in_world = chain.link_in_world(&state, link_joints.carrier);
                all.static_solids.extend(solids.into_iter().map(|(shape, at)| (shape, carrier_in_world * at)));
                continue;
            };
            let carrier = if link_joints.swept.is_empty() { LinkId(link) } else { link_joints.carrier };
            let carrier_in_last = relative_pose(&state, last.child, carrier);
            let group = all.group(&link_joints.driving);
            group.solids.extend(solids.into_iter().map(|(shape, at)| (shape, carrier_in_last * at)));
        }
        Ok(all)
    }

    /// The group of some joints; created if it does not exist yet.
    fn group(&mut self, joints: &[DrivingJoint]) -> &mut RigidGroup {
        let last = joints.last().map(|joint| joint.child);
        let is_same = |group: &RigidGroup| group.joints.last().map(|joint| joint.child) == last;
        let at = self.groups.iter().position(is_same).unwrap_or(self.groups.len());
        if at == self.groups.len() {
            self.groups.push(RigidGroup { joints: joints.to_vec(), solids: Vec::new() });
        }
        &mut self.groups[at]
    }
}

/// The solids of a link, or their swept volumes, with their poses in the link or in the link that carries the swept
/// volume.
fn solids(robot: &Robot, chain: &DrivenChain, link: usize) -> Result<Vec<(Shape, Pose)>, RobotMapError> {
    let LinkJoints { swept, .. } = &chain.links[link];
    let invalid = || RobotMapError::InvalidPlacement(format!("link `{}`", chain.chain.links()[link]));
    let place = |shape: &Shape, in_link: Pose| match swept.as_slice() {
        _ if !in_link.is_finite() || shape.validate().is_err() => None,
        [] => Some((shape.clone(), in_link)),
        swept => swept_enclosure(shape, in_link, swept),
    };
    let solids = robot.colliders[link].iter().map(|c| place(&c.shape, c.in_link).ok_or_else(invalid));
    solids.collect()
}

/// Pose of a link in the frame of another link.
pub(super) fn relative_pose(state: &ChainState, frame: LinkId, link: LinkId) -> Pose {
    state.link_in_root(frame).inverse_mul(&state.link_in_root(link))
}
