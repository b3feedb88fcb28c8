//! The arm that is kept clear: its solids, its planar model, and what joins the two.

use elbowroom_cspace::{Axis, AxisError, Grid, JointSigns, PlanarArm};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_scene::Robot;
use elbowroom_spatial::Pose;
use elbowroom_vision::ArmPart;

use super::WatchError;

/// An arm whose three major joints the joint map is made for.
#[derive(Debug, Clone)]
pub struct WatchedArm {
    /// Links, joints, solids.
    pub robot: Robot,
    /// Where its root link stands.
    pub base_in_world: Pose,
    /// Its model in the map: must contain the solids of all links that the joints move, whatever the wrist does.
    pub planar: PlanarArm,
    /// How its joints are counted.
    pub signs: JointSigns,
    /// Places of base, shoulder and elbow among the robot's joint values.
    pub joints: [usize; 3],
}

impl WatchedArm {
    /// The KUKA KR125 of `examples/models/kr125`.
    pub fn kr125(robot: Robot, base_in_world: Pose) -> Self {
        Self { robot, base_in_world, planar: PlanarArm::KR125, signs: JointSigns::KR125, joints: [0, 1, 2] }
    }

    /// The grid of the map: the joints' ranges in planar values, cells `step_rad` wide.
    ///
    /// # Errors
    /// A joint that the robot does not have or that has no limits, a step that is no use.
    pub fn grid(&self, step_rad: f64) -> Result<Grid, WatchError> {
        let axis = |i: usize| -> Result<Axis, WatchError> {
            let (index, chain) = (self.joints[i], &self.robot.chain);
            let id = chain.active_joints().get(index).ok_or(WatchError::Joint { index, dof: chain.dof() })?;
            let joint = &chain.joints()[id.0];
            let [min, max] = self.signs.planar_range(i, [joint.limits.lower, joint.limits.upper]);
            Ok(Axis::new(joint.name.clone(), min, max, step_rad)?)
        };
        Ok(Grid::new([axis(0)?, axis(1)?, axis(2)?])?)
    }

    /// The map's joints in planar values, of the robot's joint values.
    pub fn to_planar(&self, q: &[f64]) -> [f64; 3] {
        self.signs.to_planar(self.joints.map(|i| q.get(i).copied().unwrap_or(f64::NAN)))
    }

    /// The robot's joint values at planar ones, the other joints as in `held`.
    pub fn to_joints(&self, held: &[f64], planar: [f64; 3]) -> Vec<f64> {
        let mut q = held.to_vec();
        for (index, value) in self.joints.into_iter().zip(self.signs.from_planar(planar)) {
            if let Some(place) = q.get_mut(index) {
                *place = value;
            }
        }
        q
    }

    /// The solids of all links that joints move, in the world, for the mask of the arm.
    pub fn parts_in_world(&self, state: &mut ChainState, q: &[f64], parts: &mut Vec<ArmPart>) {
        parts.clear();
        let known = q.len().min(state.q.len());
        state.q[..known].copy_from_slice(&q[..known]);
        self.robot.chain.forward(state);
        for (link, bodies) in self.robot.bodies.iter().enumerate().filter(|(link, _)| *link != 0) {
            let link_in_world = self.base_in_world * state.link_in_root(LinkId(link));
            parts.extend(bodies.iter().filter_map(|b| ArmPart::from_shape(&b.shape, &(link_in_world * b.in_link))));
        }
    }
}

impl From<AxisError> for WatchError {
    fn from(error: AxisError) -> Self {
        Self::Grid(error.to_string())
    }
}

impl From<elbowroom_cspace::TooManyCells> for WatchError {
    fn from(error: elbowroom_cspace::TooManyCells) -> Self {
        Self::Grid(error.to_string())
    }
}
