//! RRT-Connect on sphere covers: edges are proven sixteen configurations at a time; what the covers leave open at the
//! ends is proven in the exact scene.

mod anytime;
mod cost_bounded_search;
mod cover_model;
mod disconnection_proof;
mod edge_search;
mod edge_validator;
mod informed_sampler;
mod inner_balls;
mod linear_move;
mod node_packs;
mod planner;
mod query_ends;
mod region_sampler;
mod separating_value;
mod shortcutting;
mod time_optimal;
mod tree;
mod tree_search;

pub use anytime::AnytimePath;
pub use cover_model::{CoverModel, CoverObstacles};
pub use linear_move::LinearMove;
pub use planner::CoverRrtConnect;
pub use time_optimal::TimedMotion;
