//! Recorded trajectories: their playback, and their demand on the joints.

mod demand;
mod playback;
mod point;

pub use demand::{accelerations, motion_bounds, recording_warnings, volume_motion_bounds};
pub use playback::Playback;
pub use point::PathPoint;
