//! What the joints may do.

/// Largest speed, acceleration and jerk of each joint; all finite and above 0. Where a joint slides, read m for rad.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionLimits {
    /// rad/s.
    pub velocity: Vec<f64>,
    /// rad/s².
    pub acceleration: Vec<f64>,
    /// rad/s³.
    pub jerk: Vec<f64>,
}

/// Why a path cannot be timed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// A limit cannot be used.
    #[error("joint {joint}: the largest {what} is {value}: give a finite number above 0")]
    Limit {
        /// Number of the joint, counted from 0.
        joint: usize,
        /// Speed, acceleration or jerk.
        what: &'static str,
        /// Its value, rad per s, s² or s³.
        value: f64,
    },
    /// Not one limit per joint.
    #[error("the largest {what} is given for {given} joints, the path has {joints}: give one number per joint")]
    Count {
        /// Speed, acceleration or jerk.
        what: &'static str,
        /// Length of the list.
        given: usize,
        /// Number of joints of the path.
        joints: usize,
    },
    /// A path without waypoints, or with one that is not finite or of another length.
    #[error("the path has no waypoints, or one that is not finite or of another length: time a path that was planned")]
    Path,
    /// A period that cannot be.
    #[error("the period is {0} s: give a finite number above 0")]
    Period(f64),
}

impl MotionLimits {
    /// Checks all numbers, for so many joints.
    pub(super) fn validate(&self, joints: usize) -> Result<(), MotionError> {
        let all = [("speed", &self.velocity), ("acceleration", &self.acceleration), ("jerk", &self.jerk)];
        for (what, values) in all {
            if values.len() != joints {
                return Err(MotionError::Count { what, given: values.len(), joints });
            }
            for (joint, &value) in values.iter().enumerate() {
                if !(value.is_finite() && value > 0.0) {
                    return Err(MotionError::Limit { joint, what, value });
                }
            }
        }
        Ok(())
    }

    /// What a point may do along a direction (unit vector): the joint that is at its limit first decides.
    pub(super) fn along(&self, direction: &[f64]) -> Along {
        let least = |limit: &[f64]| {
            let each = limit.iter().zip(direction).filter(|(_, d)| **d != 0.0).map(|(l, d)| l / d.abs());
            each.fold(f64::INFINITY, f64::min)
        };
        Along { speed: least(&self.velocity), acceleration: least(&self.acceleration), jerk: least(&self.jerk) }
    }
}

/// Limits along a direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Along {
    pub speed: f64,
    pub acceleration: f64,
    pub jerk: f64,
}
