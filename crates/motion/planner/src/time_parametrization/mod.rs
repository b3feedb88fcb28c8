//! Time parametrization: turns waypoints into a trajectory within limits of velocity, acceleration and jerk, for any
//! number of joints.

mod blend;
mod blended_trajectory;
mod limits;
mod segments;
mod speed_profile;
mod speed_ramp;
mod time_optimal;

pub use blended_trajectory::BlendedTrajectory;
pub(crate) use blended_trajectory::PathElement;
pub use limits::{LimitKind, TimeParametrizationError};
pub(crate) use segments::PathSegments;
pub use time_optimal::{BlendedPath, CornerBlend, TimeOptimalTrajectory};
