//! The joints of a robot that are axes of the map, and the axes that move each link.

use elbowroom_kinematics::{Chain, ChainState, JointId, JointKind, LinkId};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::error::RobotMapError;
use super::settings::MAX_JOINTS;
use crate::GridAxis;

/// Values of the joints that are not axes of the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RemainingJoints<'a> {
    /// Any value within their limits: the links beyond them are replaced by the volume that they sweep.
    Swept,
    /// Fixed joint values (rad or m, one for each joint of the robot).
    Fixed(&'a [f64]),
}

/// A joint of the chain that an axis of the map moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct DrivingJoint {
    /// Index of the map's axis.
    pub axis: usize,
    /// The joint's child; its frame is the joint's frame.
    pub child: LinkId,
    /// Unit vector in the child's frame.
    pub along: Vec3,
    /// Whether the joint rotates; otherwise it translates.
    pub turns: bool,
    /// Multiplier of the axis's value.
    pub multiplier: f64,
}

/// A joint that is not an axis of the map and may have any value.
#[derive(Debug, Clone, Copy)]
pub(super) struct SweptJoint {
    pub child: LinkId,
    pub parent: LinkId,
    /// Pose of the child at value 0, in the parent's frame.
    pub origin: Pose,
    /// Unit vector in the child's frame.
    pub along: Vec3,
    /// Range of a prismatic joint, metres; `None` for a rotation.
    pub slide: Option<[f64; 2]>,
}

/// The joints that move a link.
#[derive(Debug, Clone)]
pub(super) struct LinkJoints {
    pub driving: Vec<DrivingJoint>,
    /// Joints that may have any value, from the root on, and the fixed joints between and after them.
    pub swept: Vec<SweptJoint>,
    /// The last link before the first swept joint: only axes of the map move it.
    pub carrier: LinkId,
}

/// A chain in which the axes of a map move some joints.
#[derive(Debug, Clone)]
pub(super) struct DrivenChain {
    pub chain: Chain,
    pub base_in_world: Pose,
    /// Index of each axis among the joint values.
    pub joints: Vec<usize>,
    /// First and last border of each axis, rad or m.
    pub ranges: Vec<[f64; 2]>,
    /// Values of the remaining joints.
    pub fixed_values: Vec<f64>,
    pub links: Vec<LinkJoints>,
}

impl DrivenChain {
    pub fn new(
        chain: &Chain,
        base_in_world: Pose,
        axes: &[GridAxis],
        joints: &[usize],
        remaining: RemainingJoints<'_>,
    ) -> Result<Self, RobotMapError> {
        let dof = chain.dof();
        if joints.is_empty() || joints.len() > MAX_JOINTS {
            return Err(RobotMapError::Count(joints.len()));
        }
        if let Some(at) = (0..joints.len()).find(|&i| joints[i] >= dof || joints[..i].contains(&joints[i])) {
            return Err(RobotMapError::Joint { joint: joints[at], dof });
        }
        let fixed_values = match remaining {
            RemainingJoints::Swept => range_centers(chain),
            RemainingJoints::Fixed(q) if q.len() == dof && q.iter().all(|x| x.is_finite()) => q.to_vec(),
            RemainingJoints::Fixed(q) => return Err(RobotMapError::FixedValues { given: q.len(), dof }),
        };
        if !base_in_world.is_finite() {
            return Err(RobotMapError::InvalidPlacement("the robot's base".into()));
        }
        let sweeps = remaining == RemainingJoints::Swept;
        let links = (0..chain.links().len()).map(|link| link_joints(chain, LinkId(link), joints, sweeps)).collect();
        let ranges = axes.iter().map(|axis| [axis.border(0), axis.border(axis.count())]).collect();
        Ok(Self { chain: chain.clone(), base_in_world, joints: joints.to_vec(), ranges, fixed_values, links })
    }

    /// Creates a state for [`DrivenChain::set_axes`].
    pub fn state(&self) -> ChainState {
        let mut state = ChainState::new(&self.chain);
        state.q.copy_from_slice(&self.fixed_values);
        self.chain.forward(&mut state);
        state
    }

    /// Sets the values of the map's axes.
    pub fn set_axes(&self, state: &mut ChainState, q: &[f64]) {
        for (&joint, &value) in self.joints.iter().zip(q) {
            state.q[joint] = value;
        }
        self.chain.forward(state);
    }

    /// A frame on the first axis, with z along it.
    pub fn base_axis(&self) -> Pose {
        let driving = self.links.iter().flat_map(|l| &l.driving);
        let Some(first) = driving.into_iter().find(|joint| joint.axis == 0) else { return self.base_in_world };
        let child = self.link_in_world(&self.state(), first.child);
        let along = child.transform_vector(first.along);
        let base = self.base_in_world;
        // The base's own orientation if the axis is its z: then angles are the angles of the joint.
        let upright = base.transform_vector(Vec3::Z).dot(along) > 1.0 - 1e-12;
        let rotation = if upright { base.rotation } else { Rotation::from_z(along) };
        Pose::new(rotation, child.translation)
    }

    pub fn link_in_world(&self, state: &ChainState, link: LinkId) -> Pose {
        self.base_in_world * state.link_in_root(link)
    }
}

/// Joint values at the centres of their ranges; 0 for unlimited joints.
fn range_centers(chain: &Chain) -> Vec<f64> {
    let center = |(low, high): (f64, f64)| if low.is_finite() && high.is_finite() { 0.5 * (low + high) } else { 0.0 };
    chain.lower().into_iter().zip(chain.upper()).map(center).collect()
}

fn link_joints(chain: &Chain, link: LinkId, axes: &[usize], sweeps: bool) -> LinkJoints {
    let mut out = LinkJoints { driving: Vec::new(), swept: Vec::new(), carrier: chain.root() };
    for id in chain.path(link) {
        let joint = &chain.joints()[id.0];
        let mimic = chain.mimic_source(id);
        let source = mimic.map_or(id, |m| m.joint);
        let (multiplier, offset) = mimic.map_or((1.0, 0.0), |m| (m.multiplier, m.offset));
        let value = chain.q_index(source).filter(|_| joint.kind.moves());
        let axis = value.and_then(|value| axes.iter().position(|&a| a == value));
        match axis {
            Some(axis) if out.swept.is_empty() => {
                let turns = joint.kind.turns();
                out.driving.push(DrivingJoint { axis, child: joint.child, along: joint.axis, turns, multiplier });
                out.carrier = joint.child;
            }
            // After a swept joint, an axis of the map is also swept.
            Some(_) => out.swept.push(swept_joint(chain, id, multiplier, offset)),
            None if sweeps && value.is_some() => out.swept.push(swept_joint(chain, id, multiplier, offset)),
            None if out.swept.is_empty() => out.carrier = joint.child,
            None => out.swept.push(fixed_joint(chain, id)),
        }
    }
    out
}

fn swept_joint(chain: &Chain, id: JointId, multiplier: f64, offset: f64) -> SweptJoint {
    let joint = &chain.joints()[id.0];
    let source = chain.mimic_source(id).map_or(id, |m| m.joint);
    let limits = chain.joints()[source.0].limits;
    let ends = [limits.lower, limits.upper].map(|value| multiplier * value + offset);
    let slide = (joint.kind == JointKind::Prismatic).then_some([ends[0].min(ends[1]), ends[0].max(ends[1])]);
    SweptJoint { child: joint.child, parent: joint.parent, origin: joint.origin, along: joint.axis, slide }
}

/// A joint that does not move, between or after swept joints: a prismatic joint with a range of 0.
fn fixed_joint(chain: &Chain, id: JointId) -> SweptJoint {
    let joint = &chain.joints()[id.0];
    SweptJoint { child: joint.child, parent: joint.parent, origin: joint.origin, along: Vec3::Z, slide: Some([0.0; 2]) }
}
