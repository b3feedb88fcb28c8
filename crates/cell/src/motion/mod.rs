//! How a program becomes joint values over time.
//!
//! A [`Geometry`] says where the robot is at each point of a move, a [`Segment`] adds the time law within the joints'
//! limits, a [`Plan`] strings the steps of a program together, and a [`Clock`] walks along it as fast as the monitor's
//! override and the joints' decelerations allow.
//!
//! Defaults where neither model nor cell file say: full speed is reached in 0.25 s, full acceleration in 0.1 s, and a stop
//! from full speed takes 0.1 s.

mod clock;
mod demand;
mod geometry;
mod line;
mod plan;
mod playback;
mod segment;

pub use clock::Clock;
pub use demand::{accelerations, levers_of, recording_warnings};
pub use geometry::{Geometry, Point};
pub use line::Line;
pub use plan::{Plan, PlanStep, plan};
pub use playback::Playback;
pub use segment::Segment;
