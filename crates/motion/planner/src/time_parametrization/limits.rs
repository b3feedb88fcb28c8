//! Limits of velocity, acceleration and jerk.

use elbowroom_kinematics::JointLimits;

/// A limit among the [`JointLimits`] of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LimitKind {
    /// [`JointLimits::velocity`].
    Velocity,
    /// [`JointLimits::acceleration`].
    Acceleration,
    /// [`JointLimits::jerk`].
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
    #[error("limits are given for {given} joints, the path has {joints}: give the limits of each joint")]
    Count {
        /// Number of joints with limits.
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
    /// The motion has too many rows.
    #[error(
        "a motion of {seconds:.3} s with a row every {period_s} s has more than {most} rows: give a longer period, or a higher speed"
    )]
    Rows {
        /// Duration, s.
        seconds: f64,
        /// Period, s.
        period_s: f64,
        /// Most rows of a motion.
        most: usize,
    },
}

/// Checks that there are valid limits for each of a number of joints.
pub(super) fn validate(limits: &[JointLimits], joints: usize) -> Result<(), TimeParametrizationError> {
    if limits.len() != joints {
        return Err(TimeParametrizationError::Count { given: limits.len(), joints });
    }
    for (joint, limit) in limits.iter().enumerate() {
        let all = [
            (LimitKind::Velocity, limit.velocity),
            (LimitKind::Acceleration, limit.acceleration),
            (LimitKind::Jerk, limit.jerk),
        ];
        if let Some((kind, value)) = all.into_iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
            return Err(TimeParametrizationError::Limit { joint, kind, value });
        }
    }
    Ok(())
}

/// Limits along a direction (unit vector), set by the joint that reaches its limit first.
pub(super) fn in_direction(limits: &[JointLimits], direction: &[f64]) -> JointLimits {
    let least = |limit: fn(&JointLimits) -> f64| {
        let each = limits.iter().map(limit).zip(direction).filter(|(_, d)| **d != 0.0).map(|(l, d)| l / d.abs());
        each.fold(f64::INFINITY, f64::min)
    };
    JointLimits::new(least(|l| l.velocity), least(|l| l.acceleration), least(|l| l.jerk))
}
