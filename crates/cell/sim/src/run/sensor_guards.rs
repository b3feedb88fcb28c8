//! Robots keep clear of what sensors see: pictures are taken in, paths checked, searches begun and ended, tick by tick.

use std::time::Instant;

use elbowroom_cell::Cell;
use elbowroom_kinematics::ChainState;
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::{FirstContacts, Object};

use super::Simulation;
use super::carried_parts::CarriedParts;
use super::obstacle_guard::ObstacleGuard;
use super::path_search::ClosedRegions;
use super::perceived_obstacles::{PerceivedObstacle, PerceivedObstacles};
use super::surroundings::Surroundings;
use crate::recording::{HoldReason, RobotTrack, RunEvent};

/// Everything around the robots now, with obstacles that sensors saw.
fn surroundings(
    cell: &Cell,
    states: &[ChainState],
    (checker, parts): (&FirstContacts, &CarriedParts),
    perceived: Vec<PerceivedObstacle>,
) -> Surroundings {
    let object = |o| Object { in_world: checker.object_in_world(ObjectId(o)), ..cell.objects[o].clone() };
    Surroundings {
        states: states.to_vec(),
        objects: (0..cell.objects.len()).map(object).collect(),
        attachments: parts.attachments().to_vec(),
        perceived,
    }
}

impl Simulation<'_> {
    /// Takes in the pictures that are due; guarded robots replan, or are held.
    pub(super) fn perceive(&mut self, t_s: f64) {
        let Some(mut perceived) = self.perceived.take() else { return };
        self.end_path_searches(t_s);
        let begin = Instant::now();
        let has_news = perceived.take_in(t_s, &|stamp_s| self.joint_values_at(stamp_s));
        for i in 0..self.guards.len() {
            if self.is_silent(i, t_s) {
                continue;
            }
            let Some(mut guard) = self.guards[i].take() else { continue };
            self.keep_clear(i, &mut guard, &perceived, has_news, t_s);
            self.guards[i] = Some(guard);
        }
        if has_news {
            perceived.add_processing_time(begin.elapsed().as_nanos() as u64);
        }
        self.perceived = Some(perceived);
    }

    /// Whether pictures are still to come, or a search is under way.
    pub(super) fn expects_news(&self) -> bool {
        self.perceived.as_ref().is_some_and(PerceivedObstacles::has_more)
            || self.guards.iter().flatten().any(ObstacleGuard::is_searching)
    }

    /// Robots whose search for another path has taken its time go on along that path.
    fn end_path_searches(&mut self, t_s: f64) {
        let (cell, setups, states, monitors) = (self.cell, self.setups, &self.states[..], &self.monitors);
        let (frames, checker, parts) = (&self.frames, &self.checker, &self.parts);
        let mut replanned = Vec::new();
        for (i, guard) in self.guards.iter_mut().enumerate() {
            let Some(guard) = guard.as_mut().filter(|_| !self.options.is_silent(RobotId(i), t_s)) else { continue };
            let regions =
                || ClosedRegions { monitor: &monitors[i], sources: frames.sources(&setups[i].sources, states, t_s) };
            let surroundings = |perceived| surroundings(cell, states, (checker, parts), perceived);
            if guard.end_search(t_s, &mut self.clocks[i], surroundings, regions) {
                replanned.push(i);
            }
        }
        for robot in replanned {
            self.event(t_s, robot, "", RunEvent::Replan);
        }
    }

    /// Checks the path of a robot, and holds it, so that it keeps clear of what sensors see.
    fn keep_clear(
        &mut self,
        i: usize,
        guard: &mut ObstacleGuard<'_>,
        perceived: &PerceivedObstacles<'_>,
        has_news: bool,
        t_s: f64,
    ) {
        let (cell, setups, states, monitors) = (self.cell, self.setups, &self.states[..], &self.monitors);
        let (frames, checker, parts) = (&self.frames, &self.checker, &self.parts);
        let clock = &self.clocks[i];
        let seen = || perceived.obstacles(RobotId(i)).cloned().collect();
        let surroundings = || surroundings(cell, states, (checker, parts), seen());
        let regions =
            || ClosedRegions { monitor: &monitors[i], sources: frames.sources(&setups[i].sources, states, t_s) };
        guard.observe(t_s, clock, perceived, has_news, surroundings, regions);
        let stale = if clock.moving() { perceived.stale(RobotId(i), t_s) } else { None };
        let held = guard.hold(t_s, clock, stale, cell.laws.reaction_delay_s, cell.tick_s).cloned();
        if let Some((reason, by)) = held.as_ref().filter(|_| held != self.holds[i]) {
            let event = if *reason == HoldReason::Stale { RunEvent::Stale } else { RunEvent::Wait };
            self.event(t_s, i, by, event);
        }
        self.holds[i] = held;
    }

    /// The joint values of all robots at a time up to now: from the last tick before it.
    fn joint_values_at(&self, t_s: f64) -> Vec<Vec<f64>> {
        let of_robot = |(track, state): (&RobotTrack, &ChainState)| {
            let next = track.samples.partition_point(|s| s.t_s <= t_s);
            match (next.checked_sub(1).and_then(|i| track.samples.get(i)), track.samples.get(next)) {
                (Some(before), Some(_)) => before.q.clone(),
                (None, Some(first)) => first.q.clone(),
                (_, None) => state.q.clone(),
            }
        };
        self.tracks.iter().zip(&self.states).map(of_robot).collect()
    }
}
