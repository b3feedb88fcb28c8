//! Bounds of the program time since any joint value last changed: they detect a frozen reading and bound the unseen
//! travel.

use crate::laws::{stop_time, stopping_program_time};
use crate::override_history::OverrideRange;
use crate::{Laws, Snapshot};

/// Program time (s) after which a bitwise constant reading is frozen.
const FROZEN_S: f64 = 0.1;
/// Time (s) at override 0 after which a robot whose reading was frozen may try to move again.
const REST_S: f64 = 1.0;

/// The program time since a reading last changed.
///
/// At programmed override 0 the program does not advance, whatever was commanded: a controller that receives no
/// override reports programmed override 0.
///
/// A frozen robot may try to move again after a rest: an answer may have been lost, or its brakes may have been
/// slow. Its possible unseen travel, including the travel while it came to rest, still counts, so that the robot
/// still stops before every region.
#[derive(Debug, Default)]
pub(crate) struct UnchangedReading {
    /// Largest program time, s.
    max_s: f64,
    /// Smallest program time, s. Restarts at 0 after the robot has been at rest for long enough.
    min_s: f64,
    /// Time at override 0 since the reading froze, s.
    rest_s: f64,
    /// Programmed override at the last valid snapshot.
    programmed_override: f64,
    /// Decelerations of the joints, and their largest plausible speeds; empty without the stopping-distance law.
    deceleration: Vec<f64>,
    max_speed: Vec<f64>,
    /// Bound of the rate of change of the stop time by program time.
    growth: f64,
}

impl UnchangedReading {
    /// Creates the state for joints with these largest plausible speeds.
    pub(crate) fn new(laws: &Laws, max_speed: Vec<f64>) -> Self {
        let Some(stopping) = &laws.stopping_distance else { return Self::default() };
        let growth = stop_time(&stopping.joint_acceleration, &stopping.joint_deceleration);
        Self { deceleration: stopping.joint_deceleration.clone(), max_speed, growth, ..Self::default() }
    }

    /// Stores the programmed override of a valid snapshot.
    pub(crate) fn take_program(&mut self, s: &Snapshot) {
        self.programmed_override = s.programmed_override;
    }

    /// Restarts at 0, because the reading has changed.
    pub(crate) fn forget(&mut self) {
        (self.max_s, self.min_s, self.rest_s) = (0.0, 0.0, 0.0);
    }

    /// Largest program time (s) since the reading last changed.
    pub(crate) fn max_s(&self) -> f64 {
        self.max_s
    }

    /// True if the robot must have moved but its reading has not changed.
    pub(crate) fn is_frozen(&self) -> bool {
        self.min_s > FROZEN_S
    }

    /// Counts a reading that is the same as `passed_s` (s) before.
    pub(crate) fn count(&mut self, s: &Snapshot, passed_s: f64, overrides: OverrideRange) {
        let (before, after) = (self.programmed_override, s.programmed_override);
        let max = overrides.max.min(before.max(after));
        let min = overrides.min.min(before.min(after));
        let was_frozen = self.is_frozen();
        if s.intent.unwrap_or(s.qd).iter().any(|v| *v != 0.0) {
            self.max_s += max * passed_s;
            self.min_s += min * passed_s;
        }
        if !was_frozen && self.is_frozen() {
            self.max_s += self.stop_of_program_s(s, max);
            self.rest_s = 0.0;
        } else if was_frozen {
            self.rest_s = if max > 0.0 { 0.0 } else { self.rest_s + passed_s };
            if self.rest_s >= REST_S {
                self.min_s = 0.0;
            }
        }
    }

    /// Program time (s) in which the robot stops from this override.
    fn stop_of_program_s(&self, s: &Snapshot, speed_override: f64) -> f64 {
        let full_stop_s = stop_time(s.intent.unwrap_or(&self.max_speed), &self.deceleration);
        stopping_program_time(speed_override, full_stop_s, self.growth)
    }
}
