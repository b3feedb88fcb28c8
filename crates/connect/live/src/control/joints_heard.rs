//! Last joint values of all robots of a cell, from their controllers.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

use elbowroom_cell::Cell;
use elbowroom_interlock::Micros;

use crate::clock::Clock;
use crate::configuration_number::configuration_number;
use crate::keys::Keys;
use crate::locked::locked;
use crate::messages::JointState;
use crate::network::{Network, NetworkError, Subscription};
use crate::node::Heard;

/// Age above which joint values say nothing about where the robot is.
const TOO_OLD: Micros = Micros(500_000);

/// Joint values apart by more than this from a time say nothing about where the robot was then.
const TOO_FAR: Micros = Micros(100_000);

/// Joint values that were heard.
#[derive(Debug, Clone, Default)]
pub(crate) struct HeardJoints {
    pub(crate) state: JointState,
    /// Time since the joints were read, s.
    pub(crate) age_s: f64,
}

/// What a robot has said.
#[derive(Clone)]
struct RobotJoints {
    heard: Heard,
    /// Times and joint values, in order of time.
    rows: VecDeque<(Micros, Vec<f64>)>,
}

impl RobotJoints {
    fn take(&mut self, bytes: &[u8], now: Micros, remembered: Micros) {
        if !self.heard.take(bytes, now) || remembered == Micros(0) {
            return;
        }
        let age = self.heard.stamp.map_or(Micros(0), |stamp| self.heard.now(now) - stamp);
        self.rows.push_back((now - age, self.heard.state.q.clone()));
        while self.rows.front().is_some_and(|(first, _)| now - *first > remembered) {
            self.rows.pop_front();
        }
    }

    /// The joint values at a time; `None` if they are not known.
    fn at(&self, time: Micros) -> Option<&[f64]> {
        let next = self.rows.partition_point(|(at, _)| *at <= time);
        let distance = |at: Micros| if at > time { at - time } else { time - at };
        let neighbours = next.saturating_sub(1)..(next + 1).min(self.rows.len());
        let (at, q) = self.rows.range(neighbours).min_by_key(|(at, _)| distance(*at))?;
        (distance(*at) <= TOO_FAR).then_some(q)
    }
}

/// Subscriptions to the joint values of all robots of a cell.
pub(crate) struct JointsHeard {
    heard: Arc<Mutex<Vec<RobotJoints>>>,
    clock: Clock,
    _subscriptions: Vec<Subscription>,
}

impl JointsHeard {
    /// Listens to all robots, and remembers joint values for this long.
    pub(crate) fn start(
        cell: &Cell,
        network: &Arc<dyn Network>,
        clock: Clock,
        remembered: Micros,
    ) -> Result<Self, NetworkError> {
        let none = RobotJoints { heard: Heard::new(configuration_number(cell), cell), rows: VecDeque::new() };
        let heard = Arc::new(Mutex::new(vec![none; cell.robots.len()]));
        let keys = Keys::new(&cell.name);
        let subscribe = |(i, robot): (usize, &elbowroom_cell::CellRobot)| {
            let heard = heard.clone();
            let handler = Box::new(move |bytes: &[u8]| {
                locked(&heard)[i].take(bytes, clock.micros(), remembered);
            });
            network.subscribe(&keys.joint_states(&robot.name), handler)
        };
        let subscriptions = cell.robots.iter().enumerate().map(subscribe).collect::<Result<_, _>>()?;
        Ok(Self { heard, clock, _subscriptions: subscriptions })
    }

    /// Joint values per robot, with their age; `None` if the robot is not heard.
    pub(crate) fn states(&self) -> Vec<Option<HeardJoints>> {
        let now = self.clock.micros();
        let fresh = |RobotJoints { heard, .. }: &mut RobotJoints| {
            let age = heard.stamp.map(|stamp| heard.now(now) - stamp).filter(|age| *age <= TOO_OLD)?;
            Some(HeardJoints { state: heard.state.clone(), age_s: age.0 as f64 * 1e-6 })
        };
        locked(&self.heard).iter_mut().map(fresh).collect()
    }

    /// Joint values per robot at a time on this process's clock; `None` if one robot is unknown then.
    pub(crate) fn at(&self, time: Micros) -> Option<Vec<Vec<f64>>> {
        locked(&self.heard).iter().map(|robot| robot.at(time).map(<[f64]>::to_vec)).collect()
    }
}
