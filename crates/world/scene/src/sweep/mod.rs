//! Continuous collision detection: when does anything first touch while robots move from one configuration to another? Proven,
//! not sampled.
//!
//! One search over the time of the motion serves all pairs together ([`search`]). It rests on how far apart the geometry of a
//! pair is at an instant, and on a bound of how much nearer it can come until another ([`link_bounds`]). README.md has the
//! proof.

mod link_bounds;
mod moves;
mod options;
mod search;
mod sweeper;
mod trajectory;

pub use moves::SweepMove;
pub use options::{SweepHit, SweepOptions};
pub(crate) use sweeper::Sweeper;
