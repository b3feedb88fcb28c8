//! Continuous collision detection: the time of the first contact while robots move from one configuration to another.
//!
//! Proven, not sampled.
//!
//! One search over the time of the motion handles all pairs together ([`search`]). It needs the distance between the
//! geometry of a pair at an instant, and a bound on how much nearer the pair can come until another instant
//! ([`link_bounds`]). README.md has the proof.

mod link_bounds;
mod moves;
mod options;
mod search;
mod sweeper;
mod trajectory;

pub use moves::SweepMove;
pub use options::{SweepHit, SweepOptions};
pub(crate) use sweeper::Sweeper;
