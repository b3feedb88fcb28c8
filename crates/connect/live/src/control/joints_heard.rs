//! Last joint values of all robots of a cell, from their controllers.

use std::sync::{Arc, Mutex, PoisonError};

use elbowroom_cell::Cell;
use elbowroom_interlock::Micros;

use crate::clock::Clock;
use crate::configuration_number::configuration_number;
use crate::keys::Keys;
use crate::messages::JointState;
use crate::network::{Network, NetworkError, Subscription};
use crate::node::Heard;

/// Age above which joint values say nothing about where the robot is.
const TOO_OLD: Micros = Micros(500_000);

/// Subscriptions to the joint values of all robots of a cell.
pub(crate) struct JointsHeard {
    heard: Arc<Mutex<Vec<Heard>>>,
    clock: Clock,
    _subscriptions: Vec<Subscription>,
}

impl JointsHeard {
    pub(crate) fn start(cell: &Cell, network: &Arc<dyn Network>, clock: Clock) -> Result<Self, NetworkError> {
        let none = Heard::new(configuration_number(cell), cell);
        let heard = Arc::new(Mutex::new(vec![none; cell.robots.len()]));
        let keys = Keys::new(&cell.name);
        let subscribe = |(i, robot): (usize, &elbowroom_cell::CellRobot)| {
            let heard = heard.clone();
            let handler = Box::new(move |bytes: &[u8]| {
                heard.lock().unwrap_or_else(PoisonError::into_inner)[i].take(bytes, clock.micros());
            });
            network.subscribe(&keys.joint_states(&robot.name), handler)
        };
        let subscriptions = cell.robots.iter().enumerate().map(subscribe).collect::<Result<_, _>>()?;
        Ok(Self { heard, clock, _subscriptions: subscriptions })
    }

    /// Joint values per robot; `None` if the robot is not heard.
    pub(crate) fn states(&self) -> Vec<Option<JointState>> {
        let now = self.clock.micros();
        let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        let fresh = |heard: &mut Heard| {
            let age = heard.stamp.map(|stamp| heard.now(now) - stamp);
            age.filter(|age| *age <= TOO_OLD).map(|_| heard.state.clone())
        };
        heard.iter_mut().map(fresh).collect()
    }
}
