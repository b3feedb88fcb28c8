//! Limits of velocity, acceleration and jerk.

/// Largest velocity, acceleration and jerk of each joint; all finite and above 0. For prismatic joints, read m instead
/// of rad.
#[derive(Debug, Clone, PartialEq)]
pub struct KinematicLimits {
    /// rad/s.
    pub velocity: Vec<f64>,
    /// rad/s².
    pub acceleration: Vec<f64>,
    /// rad/s³.
    pub jerk: Vec<f64>,
}

/// A list of [`KinematicLimits`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LimitKind {
    /// [`KinematicLimits::velocity`].
    Velocity,
    /// [`KinematicLimits::acceleration`].
    Acceleration,
    /// [`KinematicLimits::jerk`].
    Jerk,
}

impl std::fmt::Display for LimitKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Velocity => "speed",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
        })
    }
}

/// Why a path has no time parametrization.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum TimeParametrizationError {
    /// A limit is invalid.
    #[error("joint {joint}: the largest {kind} is {value}: give a finite number above 0")]
    Limit {
        /// Index of the joint, counted from 0.
        joint: usize,
        /// Velocity, acceleration or jerk.
        kind: LimitKind,
        /// Value of the limit, rad per s, s² or s³.
        value: f64,
    },
    /// The number of limits differs from the number of joints.
    #[error("the largest {kind} is given for {given} joints, the path has {joints}: give one number per joint")]
    Count {
        /// Velocity, acceleration or jerk.
        kind: LimitKind,
        /// Length of the list.
        given: usize,
        /// Number of joints of the path.
        joints: usize,
    },
    /// The path has no waypoints, or a waypoint that is not finite or has another number of values.
    #[error("the path has no waypoints, or one that is not finite or of another length: time a path that was planned")]
    Path,
    /// The period is invalid.
    #[error("the period is {0} s: give a finite number above 0")]
    Period(f64),
}

impl KinematicLimits {
    /// Checks all limits, for a number of joints.
    pub(super) fn validate(&self, joints: usize) -> Result<(), TimeParametrizationError> {
        let all = [
            (LimitKind::Velocity, &self.velocity),
            (LimitKind::Acceleration, &self.acceleration),
            (LimitKind::Jerk, &self.jerk),
        ];
        for (kind, values) in all {
            if values.len() != joints {
                return Err(TimeParametrizationError::Count { kind, given: values.len(), joints });
            }
            for (joint, &value) in values.iter().enumerate() {
                if !(value.is_finite() && value > 0.0) {
                    return Err(TimeParametrizationError::Limit { joint, kind, value });
                }
            }
        }
        Ok(())
    }

    /// Limits along a direction (unit vector), set by the joint that reaches its limit first.
    pub(super) fn in_direction(&self, direction: &[f64]) -> DirectionalLimits {
        let least = |limit: &[f64]| {
            let each = limit.iter().zip(direction).filter(|(_, d)| **d != 0.0).map(|(l, d)| l / d.abs());
            each.fold(f64::INFINITY, f64::min)
        };
        DirectionalLimits {
            speed: least(&self.velocity),
            acceleration: least(&self.acceleration),
            jerk: least(&self.jerk),
        }
    }
}

/// Limits along a direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct DirectionalLimits {
    pub speed: f64,
    pub acceleration: f64,
    pub jerk: f64,
}
