//! Path planning for any number of joints: RRT-Connect over a motion validator, then shortcutting; and the planner with
//! the validator of the exact scene, in which a sweep proves every segment of the result.

mod clearance_exit;
mod error;
mod exact_time_parametrization;
mod joint_bounds;
mod joint_weights;
mod motion_validator;
mod path_constraint;
mod planner;
mod random;
mod region_sampler;
mod scene_validator;
mod settings;
mod shortcutting;
mod tree;
mod tree_search;

pub(crate) use joint_bounds::{JointBounds, JointRange, SamplingRegion};
pub(crate) use motion_validator::MotionValidator;
pub use random::Random;
pub(crate) use region_sampler::RegionSampler;
pub(crate) use scene_validator::SceneValidator;
pub(crate) use shortcutting::Shortcutting;
pub(crate) use tree::Tree;
pub(crate) use tree_search::{LEAST_PROGRESS, TreeSearch};

pub use error::{JointUnit, LinearMoveEnd, RrtConnectError};
pub use path_constraint::PathConstraint;
pub use planner::RrtConnect;
pub use settings::{RrtConnectSetting, RrtConnectSettings};
