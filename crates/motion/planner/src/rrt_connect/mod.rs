//! Path planning for any number of joints in the exact scene: RRT-Connect, then shortcutting. A sweep proves every
//! segment of the result.

mod clearance_exit;
mod error;
mod exact_time_parametrization;
mod interpolation;
mod joint_bounds;
mod joint_weights;
mod motion_validator;
mod path_constraint;
mod planned_path;
mod planner;
mod random;
mod settings;
mod shortcutting;
mod tree;
mod tree_search;

pub(crate) use interpolation::{length, lerp, path_length};
pub(crate) use joint_bounds::{JointBounds, JointRange, SamplingRegion};
pub(crate) use motion_validator::MotionValidator;
pub(crate) use path_constraint::ConstraintChecker;
pub use random::Random;

pub use error::{JointUnit, LinearMoveEnd, RrtConnectError};
pub use path_constraint::PathConstraint;
pub use planned_path::PlannedPath;
pub use planner::RrtConnect;
pub use settings::{RrtConnectSetting, RrtConnectSettings, ShortcuttingSettings};
