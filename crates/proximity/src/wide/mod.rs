//! The exact-mesh engine: wide trees, sixteen boxes a test. See README.md beside this file.

mod exact;
mod lanes;
mod leaf;
mod limit;
mod mesh;
mod nearest;
mod node;
mod order;
mod placement;
mod search;
mod toward;
mod tree;
mod within;

pub use mesh::WideMesh;
pub use nearest::{Hint, Nearest, distance, distance_at};
pub use search::{Scratch, Visits};
pub use within::{Pair, collide, within};
