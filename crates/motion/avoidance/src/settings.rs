//! Settings of the avoidance.

use crate::{EscapeSettings, ReactiveSettings};

/// Settings of the control loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AvoiderSettings {
    /// Settings of the reactive controller.
    pub reactive: ReactiveSettings,
    /// Settings of the search for escapes.
    pub escape: EscapeSettings,
    /// Speed of detours and of the return to the path, as a fraction of the joints' top speeds. `None`: half of the top
    /// speeds, but never faster than the path ([`speed_share`](crate::Reference::speed_share)).
    pub return_speed_fraction: Option<f64>,
    /// Deviation at which a path that may be left stops, in seconds of joint motion at full speed.
    pub max_deviation_s: f64,
    /// Shortest time between two reversals of a joint, s.
    pub min_reversal_interval_s: f64,
    /// Time without progress after which a detour is requested, s.
    pub stall_timeout_s: f64,
}

/// Speed of detours and returns unless the path is slower, as a fraction of the joints' top speeds.
const RETURN_SPEED: f64 = 0.5;
/// Smallest speed of the return to the path, as a fraction of the joints' top speeds, however slow the path is.
const LEAST_RETURN_SPEED: f64 = 0.01;

impl AvoiderSettings {
    /// Speed of detours and returns to a path, as a fraction of the joints' top speeds.
    pub(crate) fn return_speed(&self, path_share: f64) -> f64 {
        self.return_speed_fraction.unwrap_or(path_share.clamp(LEAST_RETURN_SPEED, RETURN_SPEED))
    }
}

impl Default for AvoiderSettings {
    /// Half the top speeds or the speed of the path; 0.4 s of deviation; 0.25 s between reversals; a stall timeout of
    /// 0.6 s.
    fn default() -> Self {
        Self {
            reactive: ReactiveSettings::default(),
            escape: EscapeSettings::default(),
            return_speed_fraction: None,
            max_deviation_s: 0.4,
            min_reversal_interval_s: 0.25,
            stall_timeout_s: 0.6,
        }
    }
}
