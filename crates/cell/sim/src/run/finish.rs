//! The recording of a finished run.

use elbowroom_cell::Cell;
use elbowroom_monitor::ZoneArbiter;

use super::final_waits::FinalWaits;
use super::own_motion::OwnMotion;
use super::simulated_robot::SimulatedRobot;
use super::simulation::Simulation;
use super::virtual_robot::CooperatingRobots;
use super::{outcome, release};
use crate::recording::{Deadlock, PerceptionTrack, Recording, RobotTrack, RunEnd, TickTimes};
use crate::replanning::PerceivedObstacles;

impl Simulation<'_> {
    /// The recording of a run that has ended at `t_s`.
    pub(super) fn finish(mut self, t_s: f64, end: RunEnd) -> Recording {
        let finished: Vec<bool> = self.robots.iter().map(SimulatedRobot::is_finished).collect();
        for (robot, is_finished) in self.robots.iter_mut().zip(&finished) {
            robot.track.finished = *is_finished;
            robot.track.stops.iter_mut().for_each(|stop| stop.to_s = stop.to_s.min(t_s));
        }
        let (cell, arbiter) = (self.cell, self.arbiter.as_deref());
        let known = |arbiter| self.deadlocks.finish(t_s, arbiter, cell, &self.robots);
        let mut deadlocks = arbiter.map_or_else(Vec::new, known);
        deadlocks.extend(FinalWaits::new(cell, arbiter, &self.robots).deadlocks(&deadlocks));
        let ended = Ended { cell, arbiter, t_s, deadlocks: &deadlocks, finished: &finished };
        let robots = self.robots.into_iter().map(|robot| ended.track(robot)).collect();
        Recording {
            cell: cell.name.clone(),
            checksum: cell.approval.checksum.clone(),
            tick_s: cell.timing.tick_s,
            duration_s: t_s,
            end,
            monitored: self.options.apply_override,
            robots,
            regions: self.regions.finish(t_s),
            grids: cell.monitoring.grids.clone(),
            objects: self.contacts.objects,
            sensors: self.perceived.map(PerceivedObstacles::finish).unwrap_or_default(),
            virtual_robots: self.virtual_robots.into_iter().map(CooperatingRobots::finish).collect(),
            deadlocks,
            events: self.journal.events,
            tick_ns: TickTimes::of(self.journal.tick_ns),
        }
    }
}

/// State at the end of a run.
struct Ended<'a> {
    cell: &'a Cell,
    arbiter: Option<&'a ZoneArbiter>,
    t_s: f64,
    deadlocks: &'a [Deadlock],
    /// Per robot whether its program is over.
    finished: &'a [bool],
}

impl Ended<'_> {
    /// The recording of a robot, with how its run ended.
    fn track(&self, robot: SimulatedRobot<'_>) -> RobotTrack {
        let SimulatedRobot { id, setup, mut track, own_motion, guard, hold, governing, present, .. } = robot;
        match own_motion {
            OwnMotion::None | OwnMotion::Cooperating(_) => {}
            OwnMotion::Avoiding(avoiding) => track.avoidance = Some(avoiding.finish()),
            OwnMotion::Guided(guided) => track.guidance = Some(guided.finish()),
        }
        track.perception = guard.map(|(guard, _)| guard.into_replans()).map(|replans| {
            let (holds, ends_held) = hold.finish(self.t_s);
            PerceptionTrack { replans, holds, ends_held }
        });
        // Collisions within one tick are found in the order of the pairs, not of time.
        track.collisions.sort_by(|a, b| a.t_s.total_cmp(&b.t_s));
        if present.is_mechanism() {
            track.ending = outcome::of_mechanism(&track);
            return track;
        }
        let region = track.samples.last().and_then(|s| s.region).map(|r| &*self.cell.regions[r.0].region.name);
        let is_deadlocked = self.deadlocks.iter().any(|d| d.robots.contains(&track.name));
        track.ending = outcome::ending(&track, is_deadlocked, region, governing.as_ref(), &setup.configuration);
        track.ending.release = release::release(self.cell, setup, self.arbiter, id, &track, self.finished);
        track
    }
}
