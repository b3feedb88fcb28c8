//! The exact-mesh engine: wide trees, sixteen boxes a test. See README.md beside this file.

// A kernel that is not inlined into the function its instruction set is chosen for is compiled for the lowest one.
#![allow(clippy::inline_always)]

mod any;
mod approach;
#[cfg(test)]
mod audit;
mod coarse;
mod exact;
mod gilbert;
mod landmarks;
mod lanes;
mod leaf;
mod limit;
mod nearest;
mod node;
mod order;
mod placement;
mod probe;
mod scratch;
mod search;
mod swallowed;
mod ties;
mod touch;
mod tree;

pub use coarse::{Coarse, bound_at, bound_of, depth};
pub use landmarks::{Landmarks, PlacedLandmarks};
pub use nearest::{Hint, Nearest, distance, distance_at, farther, guess, within};
pub(crate) use probe::{Box as BoxProbe, Height, Ray};
pub(crate) use scratch::with_scratch;
pub use scratch::{Scratch, Visits};
pub use touch::{Pair, collide, contacts};
pub(crate) use tree::Tree;
