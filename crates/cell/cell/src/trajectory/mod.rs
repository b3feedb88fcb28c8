//! Recorded trajectories: their playback, and their demand on the joints.

mod demand;
mod playback;

pub use demand::{accelerations, motion_bounds, recording_warnings, volume_motion_bounds};
pub use playback::Playback;
