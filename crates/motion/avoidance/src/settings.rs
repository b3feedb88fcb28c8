//! Settings of the avoidance.

use crate::{EscapeSettings, ReactiveSettings};

/// Settings of the control loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AvoiderSettings {
    /// Settings of the reactive controller.
    pub reactive: ReactiveSettings,
    /// Settings of the search for escapes.
    pub escape: EscapeSettings,
    /// Speed of detours and of the return to the path, as a fraction of the joints' top speeds.
    pub return_speed_fraction: f64,
    /// Deviation at which a path that may be left stops, in seconds of joint motion at full speed.
    pub max_deviation_s: f64,
    /// Shortest time between two reversals of a joint, s.
    pub min_reversal_interval_s: f64,
    /// Time without progress after which a detour is requested, s.
    pub stall_timeout_s: f64,
}

impl Default for AvoiderSettings {
    /// Half the speed; 0.4 s of deviation; 0.25 s between reversals; a stall timeout of 0.6 s.
    fn default() -> Self {
        Self {
            reactive: ReactiveSettings::default(),
            escape: EscapeSettings::default(),
            return_speed_fraction: 0.5,
            max_deviation_s: 0.4,
            min_reversal_interval_s: 0.25,
            stall_timeout_s: 0.6,
        }
    }
}
