//! Whether a robot must brake now because its path is blocked, or because a sensor is silent.

use crate::motion::ProgramClock;
use crate::recording::{Hold, HoldReason};

/// A robot at rest starts towards a blocked configuration only if it is farther away than this (s, at override 1).
const RESUME_S: f64 = 0.2;

/// Where the path of the present step is blocked.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockedPath {
    /// Time in the step (s, at override 1) up to which it is free.
    pub free_until_s: f64,
    /// The obstacle.
    pub by: String,
}

/// Holds a program because of what sensors see.
#[derive(Debug, Default)]
pub struct ProgramHold {
    /// The reason, and the obstacle or the sensor; `None` if the program is not held.
    held: Option<(HoldReason, String)>,
    holds: Vec<Hold>,
}

impl ProgramHold {
    /// Why the robot must brake or wait now: an obstacle in its way (which says more), or a sensor that is silent. It continues as
    /// long as it can still stop in time, `coast_s` (s) being the time until a command takes effect.
    pub fn update(
        &mut self,
        t_s: f64,
        clock: &ProgramClock,
        (blocked, stale): (Option<&BlockedPath>, Option<&str>),
        (coast_s, dt): (f64, f64),
    ) -> Option<&(HoldReason, String)> {
        let in_the_way = blocked.filter(|b| self.must_brake(b, clock, coast_s, dt));
        let held = in_the_way
            .map(|b| (HoldReason::Obstacle, b.by.clone()))
            .or_else(|| stale.map(|sensor| (HoldReason::Stale, sensor.to_owned())));
        if held != self.held {
            if let Some(open) = self.holds.last_mut().filter(|_| self.held.is_some()) {
                open.to_s = t_s;
            }
            self.holds.extend(held.iter().map(|(reason, by)| Hold {
                from_s: t_s,
                to_s: f64::INFINITY,
                reason: *reason,
                by: by.clone(),
            }));
            self.held = held;
        }
        self.held.as_ref()
    }

    /// Why the program is held, and by what; `None` if it is not.
    pub fn reason(&self) -> Option<&(HoldReason, String)> {
        self.held.as_ref()
    }

    fn must_brake(&self, blocked: &BlockedPath, clock: &ProgramClock, coast_s: f64, dt: f64) -> bool {
        let (_, time_s) = clock.position();
        let rests = self.held.is_some() && clock.rate() <= 0.0;
        if rests && blocked.free_until_s - time_s < RESUME_S {
            return true;
        }
        clock.rests_at(coast_s + dt, dt) > blocked.free_until_s
    }

    /// All holds, up to the end of the run (s), and why the program is still held then.
    pub(crate) fn finish(mut self, end_s: f64) -> (Vec<Hold>, Option<(HoldReason, String)>) {
        for hold in &mut self.holds {
            hold.to_s = hold.to_s.min(end_s);
        }
        (self.holds, self.held)
    }
}
