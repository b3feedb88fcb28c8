//! Robots that wait for each other for ever.

use elbowroom_monitor::{Board, Kind, Monitor, RegionId, RobotSlot, SlotId};

use super::ending::Halt;
use crate::configure::Setup;
use crate::{Cell, Deadlock};

/// Which robots stand in a circle of waiting robots, and since when.
#[derive(Debug)]
pub(super) struct Deadlocks {
    since_s: Vec<Option<f64>>,
}

impl Deadlocks {
    pub fn new(robots: usize) -> Self {
        Self { since_s: vec![None; robots] }
    }

    /// Takes note of one tick. A circle counts while all its robots stand: one that moves may pass by what it waits for.
    pub fn look(&mut self, t_s: f64, board: &Board, halts: &[Halt]) {
        for (robot, halt) in halts.iter().enumerate() {
            let circle = if halt.stopped { board.circle(RobotSlot(robot), t_s) } else { Vec::new() };
            let stands = !circle.is_empty() && circle.iter().all(|(r, _)| halts[r.0].stopped);
            self.since_s[robot] = if stands { self.since_s[robot].or(Some(t_s)) } else { None };
        }
    }

    /// True where the robot is in one now.
    pub fn holds(&self, robot: usize) -> bool {
        self.since_s[robot].is_some()
    }

    /// Those that the run ends with.
    pub fn finish(
        &self,
        t_s: f64,
        board: &Board,
        cell: &Cell,
        setups: &[Setup],
        monitors: &[Monitor],
    ) -> Vec<Deadlock> {
        let mut found: Vec<Deadlock> = Vec::new();
        let mut told = vec![false; self.since_s.len()];
        for robot in 0..self.since_s.len() {
            if told[robot] || !self.holds(robot) {
                continue;
            }
            let circle = board.circle(RobotSlot(robot), t_s);
            for (r, _) in &circle {
                told[r.0] = true;
            }
            let since = circle.iter().filter_map(|(r, _)| self.since_s[r.0]).fold(0.0, f64::max);
            let mut regions: Vec<String> = Vec::new();
            for (r, slot) in &circle {
                let names = waited_for(r.0, *slot, cell, setups, monitors);
                regions.extend(names.into_iter().filter(|n| !regions.contains(n)).collect::<Vec<_>>());
            }
            let robots = circle.iter().map(|(r, _)| cell.robots[r.0].name.clone()).collect();
            found.push(Deadlock { t_s: since, robots, regions });
        }
        found
    }
}

/// The regions of a slot in whose zone the robot is.
fn waited_for(robot: usize, slot: SlotId, cell: &Cell, setups: &[Setup], monitors: &[Monitor]) -> Vec<String> {
    let regions = setups[robot].configuration.regions().iter().enumerate();
    let of_slot = regions.filter(|(_, r)| r.kind == Kind::Exchange { slot });
    let near = of_slot.filter(|(i, _)| monitors[robot].is_warned(RegionId(*i)));
    near.map(|(i, _)| cell.regions[setups[robot].regions[i]].region.name.clone()).collect()
}
