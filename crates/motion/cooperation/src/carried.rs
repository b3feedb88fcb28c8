//! The work-piece on its way.

use elbowroom_spatial::Pose;

use crate::CooperationSettings;
use crate::desired_path::DesiredPath;
use crate::look_ahead::LookAhead;

/// The work-piece on its desired path.
#[derive(Debug)]
pub(crate) struct Carried {
    pub path: DesiredPath,
    /// Path time of the work-piece, s.
    pub path_s: f64,
    /// Share of the desired speed, 0 to 1.
    pub rate: f64,
    /// Whether it stops until the next desired pose.
    pub is_paused: bool,
    /// Index of the holding that carries it.
    pub holder: usize,
    /// What the holder can do ahead.
    pub ahead: LookAhead,
    /// What the other arm can do ahead while both hold it.
    pub follower_ahead: LookAhead,
}

impl Carried {
    /// Whether there is a way to go.
    pub fn wants_to_move(&self) -> bool {
        self.path.end().0 - self.path_s > 1e-9
    }

    /// Its pose in the world.
    pub fn pose(&self) -> Pose {
        self.path.at(self.path_s)
    }

    /// The rate of the next `dt_s` seconds: at most `allowed`, and such that it stops before `room_s` of path time.
    pub fn next_rate(&self, room_s: f64, allowed: f64, dt_s: f64, settings: &CooperationSettings) -> f64 {
        let deceleration = 1.0 / settings.ramp_s;
        let room_s = room_s.max(0.0);
        // After a step at this rate, the way to stop fits into the room that is left.
        let stopping = deceleration * ((dt_s * dt_s + 2.0 * room_s / deceleration).sqrt() - dt_s);
        let rate = (self.rate + deceleration * dt_s).min(stopping).min(1.0).min(allowed);
        // The last of the way takes one step.
        rate.min(room_s / dt_s)
    }
}
