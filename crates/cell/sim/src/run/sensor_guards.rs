//! Per-tick processing of what sensors see: pictures are loaded, paths checked, searches started and ended.

use std::time::Instant;

use elbowroom_kinematics::ChainState;

use super::simulated_robot::SimulatedRobot;
use super::simulation::Simulation;
use crate::recording::{HoldReason, RunEvent};
use crate::replanning::{ClosedRegions, PerceivedObstacles};

impl Simulation<'_> {
    /// Loads the pictures that are due. Guarded robots replan or are held.
    pub(super) fn perceive(&mut self, t_s: f64) {
        let Some(mut perceived) = self.perceived.take() else { return };
        self.end_path_searches(t_s);
        let begin = Instant::now();
        let has_news = perceived.process_due(t_s, &|stamp_s| self.joint_values_at(stamp_s));
        for i in 0..self.robots.len() {
            if !self.options.is_silent(self.robots[i].id, t_s) {
                self.keep_clear(i, &perceived, has_news, t_s);
            }
        }
        if has_news {
            perceived.add_processing_time(begin.elapsed().as_nanos() as u64);
        }
        self.perceived = Some(perceived);
    }

    /// Whether pictures remain, or a search is running.
    pub(super) fn expects_news(&self) -> bool {
        let is_searching =
            |robot: &SimulatedRobot<'_>| robot.guard.as_ref().is_some_and(|(guard, _)| guard.is_searching());
        self.perceived.as_ref().is_some_and(PerceivedObstacles::has_more) || self.robots.iter().any(is_searching)
    }

    /// Ends the searches whose time is over. Robots with a new path continue along it.
    fn end_path_searches(&mut self, t_s: f64) {
        let Self { options, robots, states, frames, contacts, journal, .. } = self;
        for robot in robots.iter_mut().filter(|robot| !options.is_silent(robot.id, t_s)) {
            let SimulatedRobot { id, setup, monitor, clock, guard: Some((guard, replanner)), .. } = robot else {
                continue;
            };
            if !guard.is_search_due(t_s, clock.path_number()) {
                continue;
            }
            let surroundings = |perceived| contacts.surroundings(states, perceived);
            let Some(request) = guard.take_search(clock.executed_motion(), surroundings) else { continue };
            let regions = ClosedRegions { monitor, sources: frames.sources(&setup.sources, states, t_s) };
            let result = replanner.search(&request, &regions);
            let is_entered = result.new_path.as_ref().is_some_and(|new| new.enter(clock));
            guard.end_search(t_s, &request, &result, is_entered);
            if is_entered {
                journal.event(t_s, *id, "", RunEvent::Replan);
            }
        }
    }

    /// Checks the path of a robot, and holds the robot if it must brake for an obstacle or a stale sensor.
    fn keep_clear(&mut self, i: usize, perceived: &PerceivedObstacles<'_>, has_news: bool, t_s: f64) {
        let Self { cell, robots, states, frames, contacts, journal, .. } = self;
        let SimulatedRobot { id, setup, monitor, clock, guard: Some((guard, _)), hold, delay, .. } = &mut robots[i]
        else {
            return;
        };
        if guard.is_due(clock.path_number(), has_news) {
            let seen = || perceived.obstacles(*id).cloned().collect();
            let surroundings = || contacts.surroundings(states, seen());
            let regions = || ClosedRegions { monitor, sources: frames.sources(&setup.sources, states, t_s) };
            guard.observe(t_s, &clock.executed_motion(), perceived, surroundings, regions);
        }
        let silent = perceived.last_sights(*id).find(|last| clock.moving() && last.is_stale(t_s));
        let stale = silent.map(|last| last.sensor.as_str());
        let (_, blocked) = guard.checked();
        let before = hold.reason().cloned();
        let held = hold.update(t_s, clock, (blocked, stale), (cell.monitoring.reaction_delay_s, cell.timing.tick_s));
        if let Some((reason, by)) = held.filter(|_| held != before.as_ref()) {
            let event = if *reason == HoldReason::Stale { RunEvent::Stale } else { RunEvent::Wait };
            journal.event(t_s, *id, by, event);
        }
        if held.is_some() && clock.is_at_start() {
            delay.drop_sent();
        }
    }

    /// The joint values of all robots at a time up to now, from the last tick at or before it.
    fn joint_values_at(&self, t_s: f64) -> Vec<Vec<f64>> {
        let of_robot = |(robot, state): (&SimulatedRobot<'_>, &ChainState)| {
            let samples = &robot.track.samples;
            let next = samples.partition_point(|s| s.t_s <= t_s);
            match (next.checked_sub(1).and_then(|i| samples.get(i)), samples.get(next)) {
                (Some(before), Some(_)) => before.q.clone(),
                (None, Some(first)) => first.q.clone(),
                (_, None) => state.q.clone(),
            }
        };
        self.robots.iter().zip(&self.states).map(of_robot).collect()
    }
}
