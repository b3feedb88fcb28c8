//! From waypoints to a motion in time, within limits of speed, acceleration and jerk, for any number of joints.

mod blend;
mod corner;
mod leg;
mod legs;
mod limits;
mod ramp;
mod trajectory;

pub(crate) use legs::Legs;
pub use limits::{MotionError, MotionLimits};
pub(crate) use trajectory::On;
pub use trajectory::{State, Trajectory};
