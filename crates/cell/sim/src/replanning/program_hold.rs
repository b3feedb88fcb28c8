//! Whether a robot must brake now because its path is blocked, or because a sensor is silent.

use crate::motion::ProgramClock;
use crate::recording::{HeldPeriod, HoldReason};

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
    /// `None` if they are not recorded: a live cell runs for years.
    holds: Option<Vec<HeldPeriod>>,
}

impl ProgramHold {
    /// A hold whose times are recorded.
    pub(crate) fn recorded() -> Self {
        Self { held: None, holds: Some(Vec::new()) }
    }

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
            self.record(t_s, held.as_ref());
            self.held = held;
        }
        self.held.as_ref()
    }

    /// Ends the present hold, and begins the next one.
    fn record(&mut self, t_s: f64, next: Option<&(HoldReason, String)>) {
        let Some(holds) = &mut self.holds else { return };
        if let Some(open) = holds.last_mut().filter(|_| self.held.is_some()) {
            open.to_s = t_s;
        }
        let hold = |(reason, by): &(HoldReason, String)| HeldPeriod {
            from_s: t_s,
            to_s: f64::INFINITY,
            reason: *reason,
            by: by.clone(),
        };
        holds.extend(next.map(hold));
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
    pub(crate) fn finish(self, end_s: f64) -> (Vec<HeldPeriod>, Option<(HoldReason, String)>) {
        let mut holds = self.holds.unwrap_or_default();
        for hold in &mut holds {
            hold.to_s = hold.to_s.min(end_s);
        }
        (holds, self.held)
    }
}
