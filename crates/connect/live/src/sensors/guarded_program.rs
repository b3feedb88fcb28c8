//! A program that avoids what sensors see: its tick, and what the thread of the sensors says about its path.

use elbowroom_sim::HoldReason;
use elbowroom_sim::motion::ProgramClock;
use elbowroom_sim::replanning::{BlockedPath, LastSight, ProgramHold};

/// What is known of the path of a program.
#[derive(Debug, Clone, Default)]
pub(crate) struct PathCheck {
    /// The number of the path that was checked; `None` before the first one.
    pub path: Option<u64>,
    /// Where it is blocked.
    pub blocked: Option<BlockedPath>,
    /// What the sensors of the robot saw last.
    pub sights: Vec<LastSight>,
}

/// A program, shared by the controller that executes it and the thread that checks its path.
#[derive(Debug)]
pub(crate) struct GuardedProgram {
    pub clock: ProgramClock,
    /// `None` for a robot that no sensor guards.
    pub check: Option<PathCheck>,
    hold: ProgramHold,
}

impl GuardedProgram {
    pub fn new(clock: ProgramClock) -> Self {
        Self { clock, check: None, hold: ProgramHold::default() }
    }

    /// Whether the program must not move on now: its path is blocked ahead, a sensor is silent, or the path was not checked yet.
    /// Returns what to tell, too, if it has just become so.
    pub fn must_hold(&mut self, t_s: f64, reaction_s: f64, tick_s: f64) -> (bool, Option<String>) {
        let Some(check) = self.check.as_ref().filter(|_| self.clock.moving()) else { return (false, None) };
        let is_checked = check.path == Some(self.clock.path_number());
        let blocked = check.blocked.as_ref().filter(|_| is_checked);
        let silent = check.sights.iter().find(|last| last.is_stale(t_s)).map(|last| last.sensor.as_str());
        let before = self.hold.reason().cloned();
        let held = self.hold.update(t_s, &self.clock, (blocked, silent), (reaction_s, tick_s));
        let news = held.filter(|_| held != before.as_ref()).map(|(reason, by)| match reason {
            HoldReason::Obstacle => format!("waits: {by} is in its way"),
            HoldReason::Stale => format!("waits: the sensor {by} has sent nothing that can be used"),
        });
        (held.is_some() || !is_checked, news)
    }
}
