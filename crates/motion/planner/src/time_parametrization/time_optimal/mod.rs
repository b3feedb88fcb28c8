//! Time-optimal parametrization of a whole path: corners are blended, and the speed along the path is the largest
//! within limits of velocity, acceleration and jerk.
//!
//! TOPP-RA (H. Pham, Q.-C. Pham, *A New Approach to Time-Optimal Path Parameterization Based on Reachability Analysis*,
//! IEEE T-RO 34(3), 2018) solves the problem under limits of velocity and acceleration. For the limit of jerk, an
//! interior-point method improves a slow profile while all constraints hold.

mod banded_matrix;
mod blended_path;
mod corner_blend;
mod interior_point;
mod jerk_constraints;
mod limit_excess;
mod path_element;
mod path_grid;
mod path_speed;
mod scaled_limits;
mod section_motion;
mod speed_spline;
mod topp_ra;
mod trajectory;

pub use blended_path::BlendedPath;
pub use corner_blend::CornerBlend;
pub use trajectory::TimeOptimalTrajectory;
