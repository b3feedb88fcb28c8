//! Time parametrization: turns waypoints into a trajectory within limits of velocity, acceleration and jerk, for any
//! number of joints.

mod blend;
mod limits;
mod segments;
mod speed_profile;
mod speed_ramp;
mod time_optimal;
mod trajectory;

pub use limits::{LimitKind, TimeParametrizationError};
pub(crate) use segments::PathSegments;
pub use time_optimal::{BlendedPath, CornerBlend, TimeOptimalTrajectory};
pub(crate) use trajectory::PathElement;
pub use trajectory::{Trajectory, TrajectoryPoint};
