//! The robot in pieces, each with the joints that move it.

use std::sync::Arc;

use elbowroom_kinematics::{JointId, JointKind, LinkId};
use elbowroom_proximity::{Shape, TriMesh};
use elbowroom_robot::Robot;
use elbowroom_spatial::{Pose, Vec3};

use super::driven_chain::{DrivenChain, DrivingJoint};
use super::error::RobotMapError;
use super::rigid_groups::{RigidGroup, RigidGroups};
use super::solid_pieces::{SolidPiece, as_mesh, split_capsule};
use super::triangle_soup::TriangleSoup;
use crate::ConvexObstacle;

/// Size of a piece as a fraction of its distance from the farthest axis: rotation adds an equally small fraction to its
/// motion.
const PIECE_SIZE_RATIO: f64 = 0.15;

/// Number of sample points of a piece, for its penetration depth in an obstacle.
const SAMPLE_POINTS: usize = 6;

/// A piece of the robot.
#[derive(Debug, Clone)]
pub(super) struct RobotPiece {
    pub shape: Shape,
    /// The link with which the piece moves.
    pub link: LinkId,
    pub in_link: Pose,
    /// Centre of a ball around the piece, in the link's frame.
    pub center: Vec3,
    pub radius: f64,
    /// Number of axes, counted from the first, that can move the piece.
    pub depth: usize,
    /// The joints that move the piece.
    pub joints: Vec<DrivingJoint>,
    /// Some points of the piece that are far apart, in the link's frame.
    pub points: Vec<Vec3>,
    /// Per joint, a bound of the distance of any point of the piece from its axis, metres.
    pub lever_arms: Vec<f64>,
}

impl RobotPiece {
    /// Creates a piece that some joints move, placed in the frame of the last joint's child; `None` if it is too far
    /// away.
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

/// The solids of a group by kind, in the frame of the last joint's child.
#[derive(Debug, Default)]
struct GroupShapes {
    /// All flat-sided solids.
    soup: TriangleSoup,
    round: Vec<(Shape, Pose)>,
}

impl RobotPieces {
    pub fn new(robot: &Robot, chain: &DrivenChain) -> Result<Self, RobotMapError> {
        let mut all = Self::default();
        let RigidGroups { groups, static_solids } = RigidGroups::new(robot, chain)?;
        all.static_solids = static_solids;
        for group in groups {
            let link = group.joints.last().map_or(String::new(), |joint| chain.chain.links()[joint.child.0].clone());
            let invalid = || RobotMapError::InvalidPlacement(format!("a solid that moves with link `{link}`"));
            all.add_pieces(chain, group).ok_or_else(invalid)?;
        }
        Ok(all)
    }

    /// Adds a solid of a group to the flat-sided or to the round solids, and to the closed meshes.
    fn add_solid(
        &mut self,
        chain: &DrivenChain,
        joints: &[DrivingJoint],
        shapes: &mut GroupShapes,
        solid: &(Shape, Pose),
    ) -> Option<()> {
        let (shape, in_last) = (as_mesh(&solid.0), solid.1);
        let Shape::Mesh(mesh) = &shape else {
            shapes.round.push((shape, in_last));
            return Some(());
        };
        shapes.soup.add(mesh, &in_last);
        if mesh.has_interior() {
            let piece = RobotPiece::new(chain, SolidPiece::new(shape.clone()).placed(&in_last), joints)?;
            self.closed_meshes.push(ClosedMesh { mesh: Arc::clone(mesh), piece });
        }
        Some(())
    }

    fn add_pieces(&mut self, chain: &DrivenChain, group: RigidGroup) -> Option<()> {
        let RigidGroup { joints, solids } = group;
        let mut shapes = GroupShapes::default();
        for solid in &solids {
            self.add_solid(chain, &joints, &mut shapes, solid)?;
        }
        let GroupShapes { soup, round } = shapes;
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

/// Largest absolute value of a prismatic joint, metres: within its limits, and on its axis of the map.
fn max_slide(chain: &DrivenChain, id: JointId) -> f64 {
    let mimic = chain.chain.mimic_source(id);
    let source = mimic.map_or(id, |m| m.joint);
    let limits = chain.chain.joints()[source.0].limits;
    let value = chain.chain.q_index(source);
    let axis = value.and_then(|value| chain.joints.iter().position(|&joint| joint == value));
    let ends = match (axis, value) {
        (Some(axis), _) => chain.ranges[axis],
        (None, Some(value)) => [chain.fixed_values[value]; 2],
        (None, None) => [limits.lower, limits.upper],
    };
    let (multiplier, offset) = mimic.map_or((1.0, 0.0), |m| (m.multiplier, m.offset));
    ends.map(|value| (multiplier * value + offset).abs()).into_iter().fold(0.0, f64::max)
}
