//! Settings of the watchers of a sensor.

use crate::error::PerceptionError;

/// Settings of an [`ObstacleWatcher`](crate::ObstacleWatcher) or a [`CloudWatcher`](crate::CloudWatcher), in addition
/// to the settings of its tracker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PerceptionSettings {
    /// Prediction horizon, seconds: a moving obstacle also blocks its predicted positions until this time after the
    /// frame.
    pub prediction_s: f64,
    /// Margin by which the silhouettes of robots are dilated, metres: covers the calibration error and the robots'
    /// motion between the frame and its joint values.
    pub mask_margin_m: f64,
}

impl PerceptionSettings {
    /// Returns an error if a setting is negative or not finite.
    pub(super) fn validate(&self) -> Result<(), PerceptionError> {
        let all = [("prediction_s", self.prediction_s), ("mask_margin_m", self.mask_margin_m)];
        match all.into_iter().find(|(_, value)| !(value.is_finite() && *value >= 0.0)) {
            Some((name, value)) => Err(PerceptionError::Setting { name, value }),
            None => Ok(()),
        }
    }
}

impl Default for PerceptionSettings {
    /// Half a second of prediction, 3 cm around the robots.
    fn default() -> Self {
        Self { prediction_s: 0.5, mask_margin_m: 0.03 }
    }
}
