//! What the three joints of the map may do.

/// Largest speed, acceleration and jerk of each joint of the map; all finite and above 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionLimits {
    /// rad/s.
    pub velocity: [f64; 3],
    /// rad/s².
    pub acceleration: [f64; 3],
    /// rad/s³.
    pub jerk: [f64; 3],
}

/// Why a path cannot be timed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// A limit cannot be used.
    #[error("joint {joint}: the largest {what} is {value}: give a finite number above 0")]
    Limit {
        /// Number of the joint in the map.
        joint: usize,
        /// Speed, acceleration or jerk.
        what: &'static str,
        /// Its value, rad per s, s² or s³.
        value: f64,
    },
    /// A path without waypoints, or with one that is not finite.
    #[error("the path has no waypoints, or one that is not finite: time a path that was planned")]
    Path,
}

impl MotionLimits {
    /// Checks all numbers.
    pub(super) fn validate(&self) -> Result<(), MotionError> {
        let all = [("speed", self.velocity), ("acceleration", self.acceleration), ("jerk", self.jerk)];
        for (what, values) in all {
            for (joint, value) in values.into_iter().enumerate() {
                if !(value.is_finite() && value > 0.0) {
                    return Err(MotionError::Limit { joint, what, value });
                }
            }
        }
        Ok(())
    }

    /// What a point may do along a direction (unit vector): the joint that is at its limit first decides.
    pub(super) fn along(&self, direction: [f64; 3]) -> Along {
        let least = |limit: [f64; 3]| {
            let each = (0..3).filter(|&i| direction[i] != 0.0).map(|i| limit[i] / direction[i].abs());
            each.fold(f64::INFINITY, f64::min)
        };
        Along { speed: least(self.velocity), acceleration: least(self.acceleration), jerk: least(self.jerk) }
    }
}

/// Limits along a direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Along {
    pub speed: f64,
    pub acceleration: f64,
    pub jerk: f64,
}
