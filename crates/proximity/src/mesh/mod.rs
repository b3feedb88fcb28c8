//! The exact-mesh engine: wide trees, sixteen boxes a test. See README.md beside this file.

mod any;
mod exact;
mod lanes;
mod leaf;
mod limit;
mod nearest;
mod node;
mod order;
mod placement;
mod search;
mod swallowed;
mod toward;
mod tree;
mod touch;

pub use nearest::{Hint, Nearest, distance, distance_at, within};
pub use search::{Scratch, Visits};
pub(crate) use search::with_scratch;
pub(crate) use tree::Tree;
pub use touch::{Pair, collide, contacts};
