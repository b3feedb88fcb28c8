//! Where the robots of a live cell were when a picture was taken.

use std::collections::VecDeque;

use elbowroom_cell::Cell;
use elbowroom_kinematics::ChainState;
use elbowroom_robot::RobotId;

use crate::control::JointsHeard;
use crate::messages::AttachedVolume;

/// Joint values are remembered for this long, s: longer than a picture takes from the lens to here.
const REMEMBERED_S: f64 = 2.0;

/// The joint values of all robots of a cell, as their controllers have said.
pub(super) struct JointHistory {
    joints: JointsHeard,
    /// Times (s) and joint values per robot, in order of time.
    rows: VecDeque<(f64, Vec<Vec<f64>>)>,
    states: Vec<ChainState>,
    /// Per robot what it carries.
    attached: Vec<Vec<AttachedVolume>>,
}

impl JointHistory {
    pub fn new(cell: &Cell, joints: JointsHeard) -> Self {
        let states = cell.robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect();
        Self { joints, rows: VecDeque::new(), states, attached: vec![Vec::new(); cell.robots.len()] }
    }

    /// Takes over what was said last.
    ///
    /// # Errors
    /// A robot that is not heard, so that its position is not known.
    pub fn update(&mut self, cell: &Cell, t_s: f64) -> Result<(), RobotId> {
        let mut row = Vec::with_capacity(self.states.len());
        for (i, heard) in self.joints.states().into_iter().enumerate() {
            let (state, robot) = (&mut self.states[i], &cell.robots[i]);
            let Some(heard) = heard.filter(|heard| heard.q.len() == state.q.len()) else {
                return Err(RobotId(i));
            };
            state.q.copy_from_slice(&heard.q);
            if heard.qd.len() == state.qd.len() {
                state.qd.copy_from_slice(&heard.qd);
            }
            robot.robot.chain.forward_motion(state);
            row.push(heard.q);
            self.attached[i] = heard.attached;
        }
        self.rows.push_back((t_s, row));
        while self.rows.front().is_some_and(|(first_s, _)| t_s - first_s > REMEMBERED_S) {
            self.rows.pop_front();
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

    /// The joint values at a time (s): of the last update before it, else of the first one.
    pub fn at(&self, t_s: f64) -> Vec<Vec<f64>> {
        let next = self.rows.partition_point(|(at_s, _)| *at_s <= t_s);
        let row = self.rows.get(next.saturating_sub(1));
        row.map_or_else(|| self.states.iter().map(|state| state.q.clone()).collect(), |(_, q)| q.clone())
    }
}
