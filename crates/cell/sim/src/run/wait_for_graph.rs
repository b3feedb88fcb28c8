//! Wait-for graph at the end of a run. It reveals deadlocks that the zone arbiter cannot see: a robot that holds an
//! exchange region is blocked by a region that the robot waiting for it carries.

use elbowroom_cell::configure::MonitorSetup;
use elbowroom_cell::{Cell, CellRegionId, Follow};
use elbowroom_monitor::{RegionKind, RobotSlot, ZoneArbiter};

use super::outcome::stopped_at;
use super::stop_state::StopState;
use crate::recording::{Deadlock, RobotTrack};

/// Why a stopped, unfinished robot cannot continue.
#[derive(Debug)]
struct Blocked {
    region: CellRegionId,
    /// The robots that would have to move first.
    by: Vec<usize>,
}

/// The wait-for graph of all robots.
#[derive(Debug)]
pub(super) struct WaitForGraph<'a> {
    cell: &'a Cell,
    tracks: &'a [RobotTrack],
    /// Per robot.
    blocked: Vec<Option<Blocked>>,
}

impl<'a> WaitForGraph<'a> {
    pub fn new(
        cell: &'a Cell,
        setups: &[MonitorSetup],
        arbiter: Option<&ZoneArbiter>,
        stop_states: &[StopState],
        tracks: &'a [RobotTrack],
    ) -> Self {
        let wait = |robot: usize| {
            let track = &tracks[robot];
            let region = track.samples.last()?.region?;
            let is_stopped = stop_states[robot].stopped && !track.finished;
            is_stopped.then(|| Blocked { region, by: blockers(cell, &setups[robot], arbiter, robot, region) })
        };
        Self { cell, tracks, blocked: (0..tracks.len()).map(wait).collect() }
    }

    /// The cycles that are not among the known deadlocks.
    pub fn cycles(&self, known: &[Deadlock]) -> Vec<Deadlock> {
        let mut reported: Vec<bool> =
            self.tracks.iter().map(|t| known.iter().any(|d| d.robots.contains(&t.name))).collect();
        let mut found = Vec::new();
        for robot in 0..self.blocked.len() {
            let reached = self.reached(robot);
            if reported[robot] || !reached[robot] {
                continue;
            }
            // Robots reached that reach back are in the cycle.
            let cycle: Vec<usize> =
                (0..reached.len()).filter(|other| reached[*other] && self.reached(*other)[robot]).collect();
            for r in &cycle {
                reported[*r] = true;
            }
            found.push(self.deadlock(&cycle));
        }
        found
    }

    /// The robots that must move before this one can.
    fn reached(&self, from: usize) -> Vec<bool> {
        let mut reached = vec![false; self.blocked.len()];
        let mut open = vec![from];
        while let Some(robot) = open.pop() {
            for &next in self.blocked[robot].iter().flat_map(|b| &b.by) {
                if !reached[next] {
                    reached[next] = true;
                    open.push(next);
                }
            }
        }
        reached
    }

    fn deadlock(&self, cycle: &[usize]) -> Deadlock {
        let mut regions: Vec<String> = Vec::new();
        for blocked in cycle.iter().filter_map(|r| self.blocked[*r].as_ref()) {
            let name = &self.cell.regions[blocked.region.0].region.name;
            if !regions.contains(name) {
                regions.push(name.clone());
            }
        }
        let since = cycle.iter().filter_map(|r| stopped_at(&self.tracks[*r])).fold(0.0, f64::max);
        Deadlock { t_s: since, robots: cycle.iter().map(|r| self.tracks[*r].name.clone()).collect(), regions }
    }
}

/// The robots that keep this one out of a region: its carrier, its holder, and robots inside.
pub(super) fn blockers(
    cell: &Cell,
    setup: &MonitorSetup,
    arbiter: Option<&ZoneArbiter>,
    robot: usize,
    region: CellRegionId,
) -> Vec<usize> {
    let carrier = match cell.regions[region.0].follow {
        Some(Follow::Robot { robot, .. }) => Some(robot.0),
        _ => None,
    };
    let local = setup.regions.iter().position(|r| *r == region);
    let kind = local.map(|i| setup.configuration.regions()[i].kind);
    let (Some(RegionKind::Exchange { slot }), Some(arbiter)) = (kind, arbiter) else {
        return carrier.into_iter().collect();
    };
    let holds =
        |r: &usize| arbiter.holder(slot) == Some(RobotSlot(*r)) || arbiter.occupancy(slot, RobotSlot(*r)).occupies();
    (0..arbiter.robots()).filter(|r| *r != robot && (holds(r) || Some(*r) == carrier)).collect()
}
