//! The robot in pieces, each with the joints that move it.

use std::sync::Arc;

use elbowroom_kinematics::{ChainState, JointId, JointKind, LinkId};
use elbowroom_proximity::{Shape, TriMesh};
use elbowroom_robot::Robot;
use elbowroom_spatial::{Pose, Vec3};

use super::driven_chain::{DrivenChain, DrivingJoint, LinkJoints};
use super::enclosure::swept_enclosure;
use super::error::RobotMapError;
use super::solid_pieces::{SolidPiece, as_mesh, split_capsule};
use super::triangle_soup::TriangleSoup;
use crate::ConvexObstacle;

/// Size of a piece as a share of its distance from the farthest axis: rotation adds as small a share to its motion.
const PIECE_SIZE_RATIO: f64 = 0.15;

/// Sample points of a piece, for its penetration depth in an obstacle.
const SAMPLE_POINTS: usize = 6;

/// A piece of the robot.
#[derive(Debug, Clone)]
pub(super) struct RobotPiece {
    pub shape: Shape,
    /// The link that it moves with.
    pub link: LinkId,
    pub in_link: Pose,
    /// A ball around it, in the link's frame.
    pub center: Vec3,
    pub radius: f64,
    /// Number of axes, counted from the first, that can move it.
    pub depth: usize,
    /// The joints that move it.
    pub joints: Vec<DrivingJoint>,
    /// Some points of it, in the link's frame, far apart.
    pub points: Vec<Vec3>,
    /// Per joint: bound of the distance of any point of the piece from its axis, metres.
    pub lever_arms: Vec<f64>,
}

impl RobotPiece {
    /// A piece that some joints move, placed in the frame of the last one's child; `None` where it is too far away.
    fn new(chain: &DrivenChain, piece: SolidPiece, joints: &[DrivingJoint]) -> Option<Self> {
        let reach = piece.center.length() + piece.radius;
        if !(reach <= ConvexObstacle::MAX_COORDINATE_M) {
            return None;
        }
        let link = joints.last()?.child;
        let lever_arms = lever_arms(chain, link, reach, joints)?;
        let depth = 1 + joints.iter().map(|joint| joint.axis).max()?;
        let points = piece.points(SAMPLE_POINTS);
        let SolidPiece { shape, in_solid: in_link, center, radius } = piece;
        Some(Self { shape, link, in_link, center, radius, depth, joints: joints.to_vec(), points, lever_arms })
    }
}

/// A closed mesh, undivided: an obstacle may be inside without touching its surface.
#[derive(Debug, Clone)]
pub(super) struct ClosedMesh {
    pub mesh: Arc<TriMesh>,
    pub piece: RobotPiece,
}

/// All pieces of the links that the map moves.
#[derive(Debug, Clone, Default)]
pub(super) struct RobotPieces {
    pub pieces: Vec<RobotPiece>,
    pub closed_meshes: Vec<ClosedMesh>,
    /// Swept volumes of links that no axis of the map moves, in the world.
    pub static_solids: Vec<(Shape, Pose)>,
}

/// The solids that the same joints of the map move.
#[derive(Debug, Default)]
struct RigidGroup {
    joints: Vec<DrivingJoint>,
    /// All flat-sided solids, in the frame of the last joint's child.
    soup: TriangleSoup,
    round: Vec<(Shape, Pose)>,
}

impl RobotPieces {
    pub fn new(robot: &Robot, chain: &DrivenChain) -> Result<Self, RobotMapError> {
        let mut all = Self::default();
        let mut groups: Vec<RigidGroup> = Vec::new();
        let state = chain.state();
        for (link, link_joints) in chain.links.iter().enumerate() {
            let Some(last) = link_joints.driving.last() else {
                all.add_static(robot, chain, link)?;
                continue;
            };
            let is_same = |group: &RigidGroup| group.joints.last().is_some_and(|joint| joint.child == last.child);
            let at = groups.iter().position(is_same).unwrap_or_else(|| {
                groups.push(RigidGroup { joints: link_joints.driving.clone(), ..RigidGroup::default() });
                groups.len() - 1
            });
            for collider in &robot.colliders[link] {
                let invalid = || RobotMapError::InvalidPlacement(format!("link `{}`", chain.chain.links()[link]));
                if !collider.in_link.is_finite() || collider.shape.validate().is_err() {
                    return Err(invalid());
                }
                let (shape, in_carrier) = match link_joints.swept.as_slice() {
                    [] => (collider.shape.clone(), collider.in_link),
                    swept => swept_enclosure(&collider.shape, collider.in_link, swept).ok_or_else(invalid)?,
                };
                let carrier = if link_joints.swept.is_empty() { LinkId(link) } else { link_joints.carrier };
                let in_last = relative_pose(&state, last.child, carrier) * in_carrier;
                all.add_solid(chain, &mut groups[at], &as_mesh(&shape), in_last).ok_or_else(invalid)?;
            }
        }
        for group in groups {
            let link = group.joints.last().map_or(String::new(), |joint| chain.chain.links()[joint.child.0].clone());
            let invalid = || RobotMapError::InvalidPlacement(format!("a solid that moves with link `{link}`"));
            all.add_pieces(chain, group).ok_or_else(invalid)?;
        }
        Ok(all)
    }

    /// Adds the swept volumes of a link that only swept joints move.
    fn add_static(&mut self, robot: &Robot, chain: &DrivenChain, link: usize) -> Result<(), RobotMapError> {
        let LinkJoints { swept, carrier, .. } = &chain.links[link];
        if swept.is_empty() {
            return Ok(());
        }
        let carrier_in_world = chain.link_in_world(&chain.state(), *carrier);
        for collider in &robot.colliders[link] {
            let invalid = || RobotMapError::InvalidPlacement(format!("link `{}`", chain.chain.links()[link]));
            let (shape, in_carrier) = swept_enclosure(&collider.shape, collider.in_link, swept).ok_or_else(invalid)?;
            self.static_solids.push((shape, carrier_in_world * in_carrier));
        }
        Ok(())
    }

    fn add_solid(&mut self, chain: &DrivenChain, group: &mut RigidGroup, shape: &Shape, in_last: Pose) -> Option<()> {
        let Shape::Mesh(mesh) = shape else {
            group.round.push((shape.clone(), in_last));
            return Some(());
        };
        group.soup.add(mesh, &in_last);
        if mesh.has_interior() {
            let piece = RobotPiece::new(chain, SolidPiece::new(shape.clone()).placed(&in_last), &group.joints)?;
            self.closed_meshes.push(ClosedMesh { mesh: Arc::clone(mesh), piece });
        }
        Some(())
    }

    fn add_pieces(&mut self, chain: &DrivenChain, group: RigidGroup) -> Option<()> {
        let RigidGroup { joints, soup, round } = group;
        let link = joints.last()?.child;
        let farthest_axis = lever_arms(chain, link, 0.0, &joints)?.into_iter().fold(0.0, f64::max);
        let size = |reach: f64| PIECE_SIZE_RATIO * (farthest_axis + reach);
        let soup_size = size(soup.reach());
        let mut found = soup.split(soup_size)?;
        for (shape, in_link) in round {
            let reach = SolidPiece::new(shape.clone()).radius + in_link.translation.length();
            found.extend(split_capsule(&shape, size(reach)).into_iter().map(|piece| piece.placed(&in_link)));
        }
        for piece in found {
            self.pieces.push(RobotPiece::new(chain, piece, &joints)?);
        }
        Some(())
    }
}

/// Pose of a link in the frame of another.
fn relative_pose(state: &ChainState, frame: LinkId, link: LinkId) -> Pose {
    state.link_in_root(frame).inverse_mul(&state.link_in_root(link))
}

/// Bounds of the distances of points within `reach` of a link's origin from the axes of the joints before it, metres.
fn lever_arms(chain: &DrivenChain, link: LinkId, reach: f64, joints: &[DrivingJoint]) -> Option<Vec<f64>> {
    let mut out = vec![0.0; joints.len()];
    let mut far = reach;
    for id in chain.chain.path(link).into_iter().rev() {
        let joint = &chain.chain.joints()[id.0];
        if let Some(at) = joints.iter().position(|driving| driving.child == joint.child) {
            out[at] = far;
        }
        if joint.kind == JointKind::Prismatic {
            far += max_slide(chain, id);
        }
        far += joint.origin.translation.length();
    }
    far.is_finite().then_some(out)
}

/// Largest absolute value of a prismatic joint, metres.
fn max_slide(chain: &DrivenChain, id: JointId) -> f64 {
    let mimic = chain.chain.mimic_source(id);
    let source = mimic.map_or(id, |m| m.joint);
    let limits = chain.chain.joints()[source.0].limits;
    let ends = match chain.chain.q_index(source) {
        Some(value) if !chain.joints.contains(&value) => [chain.fixed_values[value]; 2],
        _ => [limits.lower, limits.upper],
    };
    let (multiplier, offset) = mimic.map_or((1.0, 0.0), |m| (m.multiplier, m.offset));
    ends.map(|value| (multiplier * value + offset).abs()).into_iter().fold(0.0, f64::max)
}
