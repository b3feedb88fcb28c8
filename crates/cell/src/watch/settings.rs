//! What a guide goes by, and why it may refuse.

use elbowroom_planner::{MotionError, MotionLimits, PlanError};

/// What a [`Guide`](super::Guide) goes by. Joints are those of the map, planar values.
#[derive(Debug, Clone, PartialEq)]
pub struct GuideSettings {
    /// Speed, acceleration and jerk of planned motions, three joints.
    pub limits: MotionLimits,
    /// Deceleration while slowing for something, rad/s² per joint. Jerk is not limited then.
    pub stop: [f64; 3],
    /// Without a picture that can be believed for so long, the arm slows to a stop, seconds; so it does where the newest is
    /// stamped more than this in the future.
    pub stale_s: f64,
    /// The arm stops at least so far before the first blocked cell of its way, radians in joint space.
    pub short_rad: f64,
    /// Where the arm stands in a cell that becomes blocked, a free one is looked for within this, radians.
    pub escape_rad: f64,
    /// Where the arm goes if it stands in the way and has no way to its goal: planar values, radians.
    pub retreat: Option<[f64; 3]>,
    /// Weights of the joints in lengths of paths; finite, above 0.
    pub weights: [f64; 3],
}

impl GuideSettings {
    /// Limits of motion; stops as hard as it accelerates, after 150 ms without a picture, 2° before what is blocked.
    pub fn new(limits: MotionLimits) -> Self {
        Self {
            stop: three(&limits.acceleration),
            limits,
            stale_s: 0.15,
            short_rad: 2.0_f64.to_radians(),
            escape_rad: 1.0,
            retreat: None,
            weights: [1.0; 3],
        }
    }
}

/// Why an arm cannot be guided.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GuideError {
    /// A place, a grid or a weight.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A limit of motion.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// A setting that is negative or not finite.
    #[error("the setting `{name}` is {value}: write a finite number above 0")]
    Setting {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The number of joint values is not the robot's.
    #[error("{found} joint values were given, the robot has {dof}")]
    Values {
        /// How many came.
        found: usize,
        /// How many there are.
        dof: usize,
    },
}

/// The first three; what is missing is no number, and refused where limits are checked.
pub(super) fn three(values: &[f64]) -> [f64; 3] {
    [0, 1, 2].map(|i| values.get(i).copied().unwrap_or(f64::NAN))
}

pub(super) fn check(settings: &GuideSettings) -> Result<(), GuideError> {
    let joints = settings.stop.map(|value| ("stop", value));
    let others = [("stale_s", settings.stale_s)];
    let bad = joints.into_iter().chain(others).find(|(_, value)| !(value.is_finite() && *value > 0.0));
    let short = [("short_rad", settings.short_rad), ("escape_rad", settings.escape_rad)];
    let negative = short.into_iter().find(|(_, value)| !(value.is_finite() && *value >= 0.0));
    bad.or(negative).map_or(Ok(()), |(name, value)| Err(GuideError::Setting { name, value }))
}
