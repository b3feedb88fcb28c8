//! Reacting while moving: near what is in the way the planned motion is corrected, and taken up again afterwards (S4.10, S4.11).
//!
//! | | |
//! | --- | --- |
//! | [`fuzzy`] | variables, rules as sentences, Mamdani inference, control surfaces: general, data in TOML |
//! | [`Rules`] | how near and how fast to how hard and where to |
//! | [`Reflex`] | one look: a wanted joint velocity becomes one that evades, by weighted least squares on the Jacobians of the collision points |
//! | [`Avoider`] | the loop: senses in a scene, corrects, checks by a sweep, commands; leaves its path, waits, returns |
//!
//! Avoidance proposes a motion. A monitor of interference regions stands above it and scales last; it never depends on
//! this crate.

mod advice;
mod avoider;
mod calm;
mod error;
pub mod fuzzy;
mod joint;
mod least;
mod levers;
mod proof;
mod reflex;
mod rules;
mod sense;
mod side;
mod threat;
mod way;

pub use advice::{Advice, Doing, PathKind, Reference, TickTimes};
pub use avoider::{Avoider, AvoiderSettings};
pub use error::AvoidanceError;
pub use joint::JointLimit;
pub use least::{LeastSquares, Wish};
pub use reflex::{Manner, Reaction, Reflex, ReflexSettings, Task, VelocityBounds};
pub use rules::{Correction, DEFAULT_RULES, Rules};
pub use sense::{Around, Neighbour, Seen};
pub use threat::{Other, Threat};
