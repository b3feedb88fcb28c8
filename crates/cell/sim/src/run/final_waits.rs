//! Robots that wait for each other at the end of a run.
//!
//! This reveals deadlocks that the zone arbiter cannot see: a robot that holds an exchange region is blocked by a
//! region that the robot waiting for it carries.

use elbowroom_cell::configure::MonitorSetup;
use elbowroom_cell::{Cell, CellRegionId, Follow};
use elbowroom_monitor::{RegionKind, RobotSet, RobotSlot, WaitForGraph, ZoneArbiter};
use elbowroom_robot::RobotId;

use super::outcome::stopped_at;
use super::simulated_robot::SimulatedRobot;
use crate::recording::Deadlock;

/// The robots that stopped before they were finished, and the robots that would have to move first.
pub(super) struct FinalWaits<'a> {
    cell: &'a Cell,
    robots: &'a [SimulatedRobot<'a>],
    /// Per robot the region that stopped it.
    stopped_by: Vec<Option<CellRegionId>>,
    graph: WaitForGraph,
}

impl<'a> FinalWaits<'a> {
    pub fn new(cell: &'a Cell, arbiter: Option<&ZoneArbiter>, robots: &'a [SimulatedRobot<'a>]) -> Self {
        let stopped_by = |robot: &SimulatedRobot<'_>| {
            let is_blocked = robot.stop_state.stopped && !robot.track.finished;
            robot.track.samples.last().filter(|_| is_blocked)?.region
        };
        let stopped_by: Vec<Option<CellRegionId>> = robots.iter().map(stopped_by).collect();
        let mut graph = WaitForGraph::default();
        for (robot, region) in robots.iter().zip(&stopped_by) {
            for blocker in region.iter().flat_map(|region| blockers(cell, robot.setup, arbiter, robot.id, *region)) {
                graph.add(RobotSlot(robot.id.0), RobotSlot(blocker.0));
            }
        }
        Self { cell, robots, stopped_by, graph }
    }

    /// Cycles with at least one robot that is in no known deadlock.
    pub fn deadlocks(&self, known: &[Deadlock]) -> Vec<Deadlock> {
        let is_known = |r: RobotSlot| known.iter().any(|d| d.robots.contains(&self.robots[r.0].track.name));
        self.graph.cycles().filter(|cycle| !cycle.iter().all(is_known)).map(|cycle| self.deadlock(cycle)).collect()
    }

    fn deadlock(&self, cycle: RobotSet) -> Deadlock {
        let mut regions: Vec<String> = Vec::new();
        for region in cycle.iter().filter_map(|r| self.stopped_by[r.0]) {
            let name = &self.cell.regions[region.0].region.name;
            if !regions.contains(name) {
                regions.push(name.clone());
            }
        }
        let since = cycle.iter().filter_map(|r| stopped_at(&self.robots[r.0].track)).fold(0.0, f64::max);
        Deadlock { t_s: since, robots: cycle.iter().map(|r| self.robots[r.0].track.name.clone()).collect(), regions }
    }
}

/// Robots that keep this robot out of a region: the carrier of the region, its holder, and robots inside it.
pub(super) fn blockers(
    cell: &Cell,
    setup: &MonitorSetup,
    arbiter: Option<&ZoneArbiter>,
    robot: RobotId,
    region: CellRegionId,
) -> Vec<RobotId> {
    let carrier = match cell.regions[region.0].follow {
        Some(Follow::Robot { robot, .. }) => Some(robot),
        _ => None,
    };
    let local = setup.regions.iter().position(|r| *r == region);
    let kind = local.map(|i| setup.configuration.regions()[i].kind);
    let (Some(RegionKind::Exchange { slot }), Some(arbiter)) = (kind, arbiter) else {
        return carrier.into_iter().collect();
    };
    let holds = |r: &RobotId| {
        arbiter.holder(slot) == Some(RobotSlot(r.0)) || arbiter.occupancy(slot, RobotSlot(r.0)).occupies()
    };
    (0..arbiter.robots()).map(RobotId).filter(|r| *r != robot && (holds(r) || Some(*r) == carrier)).collect()
}
