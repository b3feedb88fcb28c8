//! Detection of deadlocks among robots that wait for exchange regions.

use elbowroom_cell::Cell;
use elbowroom_monitor::{RegionId, RegionKind, RobotSlot, SlotId, ZoneArbiter};

use super::simulated_robot::SimulatedRobot;
use crate::recording::Deadlock;

/// Tracks which robots are in a cycle of waiting robots, and the start of each cycle.
#[derive(Debug)]
pub(super) struct DeadlockDetector {
    since_s: Vec<Option<f64>>,
}

impl DeadlockDetector {
    pub fn new(robots: usize) -> Self {
        Self { since_s: vec![None; robots] }
    }

    /// Observes one tick. A cycle counts while all its robots are stopped, because a moving robot may still clear it.
    pub fn observe(&mut self, t_s: f64, arbiter: &ZoneArbiter, robots: &[SimulatedRobot<'_>]) {
        let is_stopped = |robot: RobotSlot| robots[robot.0].stop_state.stopped;
        for (robot, since_s) in self.since_s.iter_mut().enumerate() {
            let robot = RobotSlot(robot);
            let cycle = if is_stopped(robot) { arbiter.wait_cycle(robot, t_s) } else { Vec::new() };
            let holds = !cycle.is_empty() && cycle.iter().all(|(r, _)| is_stopped(*r));
            *since_s = if holds { since_s.or(Some(t_s)) } else { None };
        }
    }

    /// The deadlocks at the end of the run.
    pub fn finish(&self, t_s: f64, arbiter: &ZoneArbiter, cell: &Cell, robots: &[SimulatedRobot<'_>]) -> Vec<Deadlock> {
        let mut found: Vec<Deadlock> = Vec::new();
        let mut reported = vec![false; self.since_s.len()];
        for robot in 0..self.since_s.len() {
            if reported[robot] || self.since_s[robot].is_none() {
                continue;
            }
            let cycle = arbiter.wait_cycle(RobotSlot(robot), t_s);
            for (r, _) in &cycle {
                reported[r.0] = true;
            }
            let since = cycle.iter().filter_map(|(r, _)| self.since_s[r.0]).fold(0.0, f64::max);
            let mut regions: Vec<String> = Vec::new();
            for (r, slot) in &cycle {
                let names = waited_for(&robots[r.0], *slot, cell);
                regions.extend(names.into_iter().filter(|n| !regions.contains(n)).collect::<Vec<_>>());
            }
            let names = cycle.iter().map(|(r, _)| cell.robots[r.0].name.clone()).collect();
            found.push(Deadlock { t_s: since, robots: names, regions });
        }
        found
    }
}

/// Regions of a slot in whose warning zone the robot is.
fn waited_for(robot: &SimulatedRobot<'_>, slot: SlotId, cell: &Cell) -> Vec<String> {
    let regions = robot.setup.configuration.regions().iter().enumerate();
    let of_slot = regions.filter(|(_, r)| r.kind == RegionKind::Exchange { slot });
    let near = of_slot.filter(|(i, _)| robot.monitor.is_warned(RegionId(*i)));
    near.map(|(i, _)| cell.regions[robot.setup.regions[i].0].region.name.clone()).collect()
}
