//! RRT-Connect on sphere covers: edges are proven sixteen configurations at a time; the exact scene settles what the covers
//! leave open at the ends.

mod cover_model;
mod disconnection_proof;
mod edge_validator;
mod planner;
mod shortcutting;
mod time_optimal;
mod tree;
mod tree_search;

pub use cover_model::{CoverModel, CoverObstacles};
pub use planner::CoverRrtConnect;
pub use time_optimal::TimedMotion;
