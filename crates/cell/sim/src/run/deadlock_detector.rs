//! Detection of deadlocks among robots that wait for exchange regions.

use elbowroom_cell::Cell;
use elbowroom_cell::configure::MonitorSetup;
use elbowroom_monitor::{Monitor, RegionId, RegionKind, RobotSlot, SlotId, ZoneArbiter};

use super::stop_state::StopState;
use crate::recording::Deadlock;

/// Tracks which robots are in a cycle of waiting robots, and since when.
#[derive(Debug)]
pub(super) struct DeadlockDetector {
    since_s: Vec<Option<f64>>,
}

impl DeadlockDetector {
    pub fn new(robots: usize) -> Self {
        Self { since_s: vec![None; robots] }
    }

    /// Observes one tick. A cycle counts while all its robots are stopped: a moving one may still clear it.
    pub fn observe(&mut self, t_s: f64, arbiter: &ZoneArbiter, stop_states: &[StopState]) {
        for (robot, stop_state) in stop_states.iter().enumerate() {
            let cycle = if stop_state.stopped { arbiter.wait_cycle(RobotSlot(robot), t_s) } else { Vec::new() };
            let is_stopped = !cycle.is_empty() && cycle.iter().all(|(r, _)| stop_states[r.0].stopped);
            self.since_s[robot] = if is_stopped { self.since_s[robot].or(Some(t_s)) } else { None };
        }
    }

    /// True where the robot is in a deadlock now.
    pub fn holds(&self, robot: usize) -> bool {
        self.since_s[robot].is_some()
    }

    /// The deadlocks at the end of the run.
    pub fn finish(
        &self,
        t_s: f64,
        arbiter: &ZoneArbiter,
        cell: &Cell,
        setups: &[MonitorSetup],
        monitors: &[Monitor],
    ) -> Vec<Deadlock> {
        let mut found: Vec<Deadlock> = Vec::new();
        let mut reported = vec![false; self.since_s.len()];
        for robot in 0..self.since_s.len() {
            if reported[robot] || !self.holds(robot) {
                continue;
            }
            let cycle = arbiter.wait_cycle(RobotSlot(robot), t_s);
            for (r, _) in &cycle {
                reported[r.0] = true;
            }
            let since = cycle.iter().filter_map(|(r, _)| self.since_s[r.0]).fold(0.0, f64::max);
            let mut regions: Vec<String> = Vec::new();
            for (r, slot) in &cycle {
                let names = waited_for(r.0, *slot, cell, setups, monitors);
                regions.extend(names.into_iter().filter(|n| !regions.contains(n)).collect::<Vec<_>>());
            }
            let robots = cycle.iter().map(|(r, _)| cell.robots[r.0].name.clone()).collect();
            found.push(Deadlock { t_s: since, robots, regions });
        }
        found
    }
}

/// The regions of a slot in whose warning zone the robot is.
fn waited_for(robot: usize, slot: SlotId, cell: &Cell, setups: &[MonitorSetup], monitors: &[Monitor]) -> Vec<String> {
    let regions = setups[robot].configuration.regions().iter().enumerate();
    let of_slot = regions.filter(|(_, r)| r.kind == RegionKind::Exchange { slot });
    let near = of_slot.filter(|(i, _)| monitors[robot].is_warned(RegionId(*i)));
    near.map(|(i, _)| cell.regions[setups[robot].regions[i].0].region.name.clone()).collect()
}
