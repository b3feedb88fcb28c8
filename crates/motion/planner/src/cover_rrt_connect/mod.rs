//! RRT-Connect on sphere covers: edges are proven sixteen configurations at a time; what the covers leave open at the
//! ends is proven in the exact scene.

mod anytime;
mod constrained_validator;
mod cost_bounded_search;
mod cover_model;
mod cover_validator;
mod disconnection_proof;
mod informed_sampler;
mod inner_balls;
mod linear_move;
mod path_refinement;
mod planner;
mod query_ends;
mod separating_value;
mod time_optimal;

pub use anytime::AnytimePath;
pub use cover_model::{CoverModel, CoverObstacles};
pub use linear_move::LinearMove;
pub use planner::CoverRrtConnect;
