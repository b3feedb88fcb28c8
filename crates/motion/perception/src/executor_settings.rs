//! Settings of the executor, and the errors of invalid ones.

use elbowroom_planner::{GridPlannerError, KinematicLimits, TimeParametrizationError};

/// Settings of a [`ReplanningExecutor`](crate::ReplanningExecutor). Joints are those of the map, in
/// map joint values (see [`MappedArm::to_planar`](crate::MappedArm::to_planar)).
#[derive(Debug, Clone, PartialEq)]
pub struct ExecutorSettings {
    /// Velocity, acceleration and jerk limits of planned motions, three joints.
    pub limits: KinematicLimits,
    /// Deceleration while slowing down for an obstacle, rad/s² per joint; jerk is not limited then.
    pub stop: [f64; 3],
    /// Without an accepted image for this time the arm slows to a stop, seconds; likewise where the newest image is
    /// stamped more than this in the future.
    pub stale_s: f64,
    /// The arm stops at least this far before the first blocked cell of its path, radians in joint space.
    pub stop_margin_rad: f64,
    /// Where the cell of the arm becomes blocked, a free cell is searched within this distance, weighted radians.
    pub free_search_rad: f64,
    /// Configuration to retreat to where the arm is in a blocked cell and has no path to its goal: map joint
    /// values, radians.
    pub retreat: Option<[f64; 3]>,
    /// Weights of the joints in the lengths that the planner minimizes; finite, above 0. Arc lengths, stopping distances
    /// and margins are not weighted.
    pub weights: [f64; 3],
    /// At or below this time scaling rate (1: the planned speed) the arm counts as stopped.
    pub stopped_rate: f64,
    /// Where the planned speed is below this, the arm counts as stopped, rad/s in joint space.
    pub stopped_speed_rad_s: f64,
    /// Largest deviation (radians) of the polyline of the exact check from the trajectory.
    pub check_chord_rad: f64,
    /// Security margin of the exact check, metres. It must cover the deviation of the polyline: three joints that are 1
    /// mrad off move no point of an arm with 2.8 m of reach by more than √3 · 1 mrad · 2.8 m.
    pub check_clearance_m: f64,
}

impl ExecutorSettings {
    /// Decelerates as hard as it accelerates, stops after 150 ms without an image, and 2° before blocked cells.
    pub fn new(limits: KinematicLimits) -> Self {
        Self {
            stop: first_three(&limits.acceleration),
            limits,
            stale_s: 0.15,
            stop_margin_rad: 2.0_f64.to_radians(),
            free_search_rad: 1.0,
            retreat: None,
            weights: [1.0; 3],
            stopped_rate: 1e-3,
            stopped_speed_rad_s: 1e-3,
            check_chord_rad: 1e-3,
            check_clearance_m: 5e-3,
        }
    }
}

/// Why an executor cannot be created or a goal cannot be set.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExecutorError {
    /// A configuration, a grid or a weight.
    #[error(transparent)]
    Plan(#[from] GridPlannerError),
    /// A motion limit.
    #[error(transparent)]
    Limits(#[from] TimeParametrizationError),
    /// A setting that is negative or not finite.
    #[error("the setting `{name}` is {value}: write a finite number above 0")]
    Setting {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The number of joint values does not match the robot.
    #[error("{found} joint values were given, the robot has {dof}")]
    Values {
        /// Number of given values.
        found: usize,
        /// Number of joints of the robot.
        dof: usize,
    },
}

/// The first three values; missing ones are NaN, which the check of the limits refuses.
pub(super) fn first_three(values: &[f64]) -> [f64; 3] {
    [0, 1, 2].map(|i| values.get(i).copied().unwrap_or(f64::NAN))
}

pub(super) fn validate_settings(settings: &ExecutorSettings) -> Result<(), ExecutorError> {
    let joints = settings.stop.map(|value| ("stop", value));
    let others = [("stale_s", settings.stale_s)];
    let bad = joints.into_iter().chain(others).find(|(_, value)| !(value.is_finite() && *value > 0.0));
    let short = [("stop_margin_rad", settings.stop_margin_rad), ("free_search_rad", settings.free_search_rad)];
    let negative = short.into_iter().find(|(_, value)| !(value.is_finite() && *value >= 0.0));
    bad.or(negative).map_or(Ok(()), |(name, value)| Err(ExecutorError::Setting { name, value }))
}
