//! From waypoints to a motion in time, within limits of speed, acceleration and jerk, on cells that are free.

mod blend;
mod corner;
mod leg;
mod limits;
mod ramp;
mod trajectory;

pub use limits::{MotionError, MotionLimits};
pub use trajectory::{State, Trajectory};
