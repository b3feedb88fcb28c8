//! The robot arm that perception protects: its colliders, its planar model, and the mapping between the two.

use elbowroom_cspace::{Grid, GridAxis, JointConvention, PlanarArm};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_robot::Robot;
use elbowroom_spatial::Pose;
use elbowroom_vision::ArmPart;

use crate::error::PerceptionError;

/// An arm with a joint-space map over its three major joints.
#[derive(Debug, Clone)]
pub struct MappedArm {
    /// Links, joints, colliders.
    pub robot: Robot,
    /// Pose of the root link in the world.
    pub base_in_world: Pose,
    /// Planar model of the arm in the map. It must contain the colliders of all links that joints move, at any wrist
    /// pose.
    pub planar: PlanarArm,
    /// Signs and offsets between the robot's joint values and the map's.
    pub convention: JointConvention,
    /// Indices of the base, shoulder and elbow joints in `q`.
    pub joints: [usize; 3],
}

impl MappedArm {
    /// The KUKA KR125 of `examples/models/kr125`.
    pub fn kr125(robot: Robot, base_in_world: Pose) -> Self {
        Self { robot, base_in_world, planar: PlanarArm::KR125, convention: JointConvention::KR125, joints: [0, 1, 2] }
    }

    /// The grid of the map: the joint ranges in map joint values, cells `step_rad` wide.
    ///
    /// # Errors
    /// A joint that the robot does not have or that has no limits, or a step that is not usable.
    pub fn grid(&self, step_rad: f64) -> Result<Grid, PerceptionError> {
        let axis = |i: usize| -> Result<GridAxis, PerceptionError> {
            let (index, chain) = (self.joints[i], &self.robot.chain);
            let id = chain.active_joints().get(index).ok_or(PerceptionError::Joint { index, dof: chain.dof() })?;
            let joint = &chain.joints()[id.0];
            let [min, max] = self.convention.planar_range(i, [joint.limits.lower, joint.limits.upper]);
            Ok(GridAxis::new(joint.name.clone(), min, max, step_rad)?)
        };
        Ok(Grid::new([axis(0)?, axis(1)?, axis(2)?])?)
    }

    /// Map joint values (those of [`MappedArm::planar`]: sign and offset removed) for the robot's joint values `q`.
    pub fn to_planar(&self, q: &[f64]) -> [f64; 3] {
        self.convention.to_planar(self.joints.map(|i| q.get(i).copied().unwrap_or(f64::NAN)))
    }

    /// The robot's joint values for map joint values; the joints that the map does not have as in `held`.
    pub fn to_joints(&self, held: &[f64], planar: [f64; 3]) -> Vec<f64> {
        let mut q = held.to_vec();
        for (index, value) in self.joints.into_iter().zip(self.convention.from_planar(planar)) {
            if let Some(place) = q.get_mut(index) {
                *place = value;
            }
        }
        q
    }

    /// The colliders of all links that joints move, in the world, for the mask of the arm.
    pub fn parts_in_world(&self, state: &mut ChainState, q: &[f64], parts: &mut Vec<ArmPart>) {
        parts.clear();
        append_parts(&self.robot, self.base_in_world, state, q, parts);
    }
}

/// Appends the colliders of all links of a robot but its root link, in the world.
pub(super) fn append_parts(
    robot: &Robot,
    base_in_world: Pose,
    state: &mut ChainState,
    q: &[f64],
    parts: &mut Vec<ArmPart>,
) {
    let known = q.len().min(state.q.len());
    state.q[..known].copy_from_slice(&q[..known]);
    robot.chain.forward(state);
    for (link, colliders) in robot.colliders.iter().enumerate().filter(|(link, _)| *link != 0) {
        let link_in_world = base_in_world * state.link_in_root(LinkId(link));
        parts.extend(colliders.iter().filter_map(|c| ArmPart::from_shape(&c.shape, &(link_in_world * c.in_link))));
    }
}
