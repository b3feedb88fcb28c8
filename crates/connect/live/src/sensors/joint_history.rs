//! Where the robots of a live cell are, and where they were when a picture was taken.

use std::sync::Arc;

use elbowroom_cell::Cell;
use elbowroom_interlock::Micros;
use elbowroom_kinematics::ChainState;
use elbowroom_robot::RobotId;

use crate::clock::Clock;
use crate::control::JointsHeard;
use crate::messages::AttachedVolume;
use crate::network::{Network, NetworkError};

/// Joint values are remembered for this long: longer than a picture takes from the lens to its evaluation.
const REMEMBERED: Micros = Micros(2_000_000);

/// The joint values of all robots of a cell, as their controllers have said.
pub(super) struct JointHistory {
    joints: JointsHeard,
    states: Vec<ChainState>,
    /// Per robot what it carries.
    attached: Vec<Vec<AttachedVolume>>,
}

impl JointHistory {
    pub fn start(cell: &Cell, network: &Arc<dyn Network>, clock: Clock) -> Result<Self, NetworkError> {
        let joints = JointsHeard::start(cell, network, clock, REMEMBERED)?;
        let states = cell.robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect();
        Ok(Self { joints, states, attached: vec![Vec::new(); cell.robots.len()] })
    }

    /// Takes over what was said last.
    ///
    /// # Errors
    /// A robot that is not heard, so that its position is not known.
    pub fn update(&mut self, cell: &Cell) -> Result<(), RobotId> {
        for (i, heard) in self.joints.states().into_iter().enumerate() {
            let (state, robot) = (&mut self.states[i], &cell.robots[i]);
            let Some(heard) = heard.map(|heard| heard.state).filter(|heard| heard.q.len() == state.q.len()) else {
                return Err(RobotId(i));
            };
            state.q.copy_from_slice(&heard.q);
            if heard.qd.len() == state.qd.len() {
                state.qd.copy_from_slice(&heard.qd);
            }
            robot.robot.chain.forward_motion(state);
            self.attached[i] = heard.attached;
        }
        Ok(())
    }

    /// The robots as they were said to be last.
    pub fn states(&self) -> &[ChainState] {
        &self.states
    }

    /// What a robot carries, as was said last.
    pub fn attached(&self, robot: RobotId) -> &[AttachedVolume] {
        &self.attached[robot.0]
    }

    /// The joint values of all robots at a time (s); `None` if one robot is unknown then.
    pub fn at(&self, t_s: f64) -> Option<Vec<Vec<f64>>> {
        let q = self.joints.at(Micros::from_seconds(t_s))?;
        let fits = |(q, state): (&Vec<f64>, &ChainState)| q.len() == state.q.len();
        q.iter().zip(&self.states).all(fits).then_some(q)
    }
}
