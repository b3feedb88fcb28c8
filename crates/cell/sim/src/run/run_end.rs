//! Detection of the end of a run, and its reason.

use super::simulated_robot::SimulatedRobot;
use super::simulation::Simulation;
use crate::recording::RunEnd;

impl Simulation<'_> {
    /// Reason why the run ends now; `None` if it continues.
    pub(super) fn end(&mut self, t_s: f64) -> Option<RunEnd> {
        let present = || self.robots.iter().filter(|robot| !self.options.is_silent(robot.id, t_s));
        if present().all(SimulatedRobot::is_finished) {
            return Some(RunEnd::Finished);
        }
        if t_s >= self.cell.timing.max_s {
            return Some(RunEnd::TimeLimit);
        }
        // A robot that is held may continue after the next picture, or when its search ends.
        let waits = |robot: &SimulatedRobot<'_>| {
            robot.clock.waiting() && robot.is_on_path() || robot.own_motion.awaits_operator()
        };
        let waiting = present().any(waits) || self.expects_news();
        let ends_here = |robot| self.is_held_for_good(robot, t_s);
        let can_continue = waiting
            || self.frames.is_any_moving_but_endless_belts(t_s)
            || !present().all(|robot| robot.is_finished() || robot.is_on_path() && ends_here(robot));
        let moves = waiting || self.frames.is_any_moving(t_s);
        self.ends.end(t_s, &self.states, moves, can_continue)
    }

    /// True if the monitor has stopped a robot, unless at a region that moves on by itself.
    fn is_held_for_good(&self, robot: &SimulatedRobot<'_>, t_s: f64) -> bool {
        let region = robot.track.samples.last().and_then(|s| s.region);
        let follow = region.and_then(|r| self.cell.regions[r.0].follow);
        robot.stop_state.stopped && !follow.is_some_and(|f| self.frames.travels(&f, t_s))
    }
}
