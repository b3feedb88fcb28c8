//! State of the executor, and why it slows the arm down or stops it.

use std::fmt;

/// Why the arm slows down or waits.
#[derive(Debug, Clone, PartialEq)]
pub enum HoldReason {
    /// The newest image that was accepted is too old.
    NoRecentImage {
        /// Its age, seconds; below 0 where its stamp is in the future.
        age_s: f64,
    },
    /// The time step is not finite, or not above 0.
    InvalidTimeStep {
        /// The given time step, seconds.
        dt_s: f64,
    },
    /// A goal was set; the path is planned with the next obstacle update.
    NotPlanned,
    /// The path is blocked ahead and no other path is known yet.
    Blocked,
    /// The planner found no path: its message.
    NoPath(String),
    /// The exact collision check rejected the path: its message.
    CheckFailed(String),
}

impl fmt::Display for HoldReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoRecentImage { age_s } if age_s.is_finite() && *age_s < 0.0 => write!(
                f,
                "the newest image is stamped {:.0} ms in the future: give ticks and frames times of the same clock",
                -age_s * 1e3
            ),
            Self::NoRecentImage { age_s } if age_s.is_finite() => {
                write!(f, "no accepted image for {:.0} ms", age_s * 1e3)
            }
            Self::NoRecentImage { .. } => f.write_str("no image was accepted yet"),
            Self::InvalidTimeStep { dt_s } => {
                write!(f, "a time step of {dt_s} seconds moves nothing: give the time since the last tick, above 0")
            }
            Self::NotPlanned => f.write_str("the path is planned with the next image"),
            Self::Blocked => f.write_str("the path ahead is blocked"),
            Self::NoPath(why) | Self::CheckFailed(why) => f.write_str(why),
        }
    }
}

/// State of the executor.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum ExecutorState {
    /// No goal is set, or the goal is reached.
    #[default]
    Arrived,
    /// The arm follows its path at full speed, or accelerates to it.
    Moving,
    /// The arm decelerates below the planned speed.
    Slowing(HoldReason),
    /// The arm is stopped before its goal.
    Waiting(HoldReason),
}

impl ExecutorState {
    /// Why the arm is slowed down or stopped; `None` where it is not.
    pub fn reason(&self) -> Option<&HoldReason> {
        match self {
            Self::Arrived | Self::Moving => None,
            Self::Slowing(reason) | Self::Waiting(reason) => Some(reason),
        }
    }
}
