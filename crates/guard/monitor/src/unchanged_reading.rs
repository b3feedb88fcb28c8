//! How long the joint values have been the same to the last bit, and how far the robot may have travelled unseen.

use crate::laws::{stop_time, stopping_program_time};
use crate::override_history::OverrideRange;
use crate::{Laws, Snapshot};

/// Program time (s) after which a bitwise constant reading is frozen.
const FROZEN_S: f64 = 0.1;
/// Time (s) at override 0 after which a robot whose reading was frozen may try to move again.
const REST_S: f64 = 1.0;

/// The program time in which a reading has not changed.
///
/// A program at override 0 stands still, whatever was commanded: a controller that hears no override says so by it.
///
/// A frozen robot may try to move again after a rest: an answer was lost, or its brakes were slow. What it may have travelled unseen
/// still counts, the way in which it came to rest included, so that it stops before every region all the same.
#[derive(Debug, Default)]
pub(crate) struct UnchangedReading {
    /// Largest program time, s.
    max_s: f64,
    /// Smallest program time, s. Begins again where the robot has been at rest for long enough.
    min_s: f64,
    /// Time at override 0 since the reading is frozen, s.
    rest_s: f64,
    /// Override of the program at the last valid snapshot.
    programmed_override: f64,
    /// How the joints brake, and their largest plausible speeds; empty if nobody asks.
    deceleration: Vec<f64>,
    max_speed: Vec<f64>,
    /// Bound of the rate of change of the stop time by program time.
    growth: f64,
}

impl UnchangedReading {
    /// Of joints with these largest plausible speeds.
    pub(crate) fn new(laws: &Laws, max_speed: Vec<f64>) -> Self {
        let Some(stopping) = &laws.stopping_distance else { return Self::default() };
        let growth = stop_time(&stopping.joint_acceleration, &stopping.joint_deceleration);
        Self { deceleration: stopping.joint_deceleration.clone(), max_speed, growth, ..Self::default() }
    }

    /// Takes the override of the program at a valid snapshot.
    pub(crate) fn take_program(&mut self, s: &Snapshot) {
        self.programmed_override = s.programmed_override;
    }

    /// The reading has changed.
    pub(crate) fn forget(&mut self) {
        (self.max_s, self.min_s, self.rest_s) = (0.0, 0.0, 0.0);
    }

    /// Largest program time (s) since the reading last changed.
    pub(crate) fn max_s(&self) -> f64 {
        self.max_s
    }

    /// True if the robot must have moved, and its reading has not.
    pub(crate) fn is_frozen(&self) -> bool {
        self.min_s > FROZEN_S
    }

    /// The reading is the same as before this time (s).
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

    /// Program time in which the robot stops from this override.
    fn stop_of_program_s(&self, s: &Snapshot, speed_override: f64) -> f64 {
        let full_stop_s = stop_time(s.intent.unwrap_or(&self.max_speed), &self.deceleration);
        stopping_program_time(speed_override, full_stop_s, self.growth)
    }
}
