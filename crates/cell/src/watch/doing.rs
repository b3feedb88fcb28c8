//! What the arm is doing, and why it is not going.

use std::fmt;

/// Why the arm slows, stands or waits.
#[derive(Debug, Clone, PartialEq)]
pub enum Reason {
    /// The newest picture that could be believed is too old.
    NoPicture {
        /// Its age, seconds; below 0 where its stamp is in the future.
        age_s: f64,
    },
    /// A tick without a length: not finite, or not above 0.
    NoTime {
        /// What was given, seconds.
        dt_s: f64,
    },
    /// It was given a goal; the way is planned at the next picture.
    Unplanned,
    /// Its way is blocked farther on and there is no other yet.
    Blocked,
    /// The planner found no way: what it said.
    NoPath(String),
    /// The exact scene does not agree with the path: what it said.
    NotProven(String),
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPicture { age_s } if age_s.is_finite() && *age_s < 0.0 => write!(
                f,
                "the newest picture is stamped {:.0} ms in the future: give ticks and frames times of the same clock",
                -age_s * 1e3
            ),
            Self::NoPicture { age_s } if age_s.is_finite() => {
                write!(f, "no picture that can be believed for {:.0} ms", age_s * 1e3)
            }
            Self::NoPicture { .. } => f.write_str("no picture yet that can be believed"),
            Self::NoTime { dt_s } => {
                write!(f, "a tick of {dt_s} seconds moves nothing: give the time since the last one, above 0")
            }
            Self::Unplanned => f.write_str("the way is planned at the next picture"),
            Self::Blocked => f.write_str("the way ahead is blocked"),
            Self::NoPath(why) | Self::NotProven(why) => f.write_str(why),
        }
    }
}

/// What the arm is doing.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Doing {
    /// It has no goal, or is at it.
    #[default]
    Arrived,
    /// It goes on as planned, at full speed or on its way back to it.
    Going,
    /// It goes more slowly than planned and more slowly than before.
    Slowing(Reason),
    /// It stands and would rather not.
    Waiting(Reason),
}

impl Doing {
    /// Why it does not go, where it does not.
    pub fn reason(&self) -> Option<&Reason> {
        match self {
            Self::Arrived | Self::Going => None,
            Self::Slowing(reason) | Self::Waiting(reason) => Some(reason),
        }
    }

    /// One word, the same for all reasons.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Arrived => "arrived",
            Self::Going => "going",
            Self::Slowing(_) => "slowing",
            Self::Waiting(_) => "waiting",
        }
    }
}
