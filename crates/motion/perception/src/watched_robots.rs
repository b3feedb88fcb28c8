//! The robots in view of a sensor.

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_robot::Robot;
use elbowroom_spatial::Pose;
use elbowroom_vision::ArmPart;

use crate::error::PerceptionError;

/// A robot in view of a sensor.
#[derive(Debug, Clone)]
pub struct WatchedRobot {
    /// Links, joints, colliders.
    pub robot: Robot,
    /// Pose of the root link in the world.
    pub base_in_world: Pose,
}

impl WatchedRobot {
    /// The colliders of all links except the root link, in the world, at these joint values (rad or m).
    pub fn parts(&self, q: &[f64]) -> Vec<ArmPart> {
        let mut parts = Vec::new();
        self.append_parts(&mut ChainState::new(&self.robot.chain), q, &mut parts);
        parts
    }

    fn append_parts(&self, state: &mut ChainState, q: &[f64], parts: &mut Vec<ArmPart>) {
        let known = q.len().min(state.q.len());
        state.q[..known].copy_from_slice(&q[..known]);
        self.robot.chain.forward(state);
        for (link, colliders) in self.robot.colliders.iter().enumerate().filter(|(link, _)| *link != 0) {
            let link_in_world = self.base_in_world * state.link_in_root(LinkId(link));
            parts.extend(colliders.iter().filter_map(|c| ArmPart::from_shape(&c.shape, &(link_in_world * c.in_link))));
        }
    }
}

/// All robots in view of a sensor.
#[derive(Debug)]
pub(super) struct WatchedRobots {
    robots: Vec<WatchedRobot>,
    states: Vec<ChainState>,
}

impl WatchedRobots {
    pub fn new(robots: Vec<WatchedRobot>) -> Self {
        Self { states: robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect(), robots }
    }

    /// The colliders of all links except root links, in the world; `q` holds the joint values of each robot.
    ///
    /// # Errors
    /// The joint values do not match the robots.
    pub fn parts(&mut self, q: &[&[f64]]) -> Result<Vec<ArmPart>, PerceptionError> {
        self.validate(q)?;
        let mut parts = Vec::new();
        for ((robot, state), q) in self.robots.iter().zip(&mut self.states).zip(q) {
            robot.append_parts(state, q, &mut parts);
        }
        Ok(parts)
    }

    fn validate(&self, q: &[&[f64]]) -> Result<(), PerceptionError> {
        let dof: usize = self.robots.iter().map(|r| r.robot.chain.dof()).sum();
        let fits = q.len() == self.robots.len()
            && self.robots.iter().zip(q).all(|(r, q)| q.len() == r.robot.chain.dof())
            && q.iter().copied().flatten().all(|value| value.is_finite());
        if fits { Ok(()) } else { Err(PerceptionError::Values { found: q.iter().map(|q| q.len()).sum(), dof }) }
    }
}
