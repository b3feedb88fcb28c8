//! Reactive avoidance: near an obstacle the planned motion is corrected, and resumed afterwards (Reichenbach and Kovačić
//! 2003).
//!
//! | | |
//! | --- | --- |
//! | [`fuzzy`] | fuzzy control in general: variables, rules as sentences, Mamdani inference, control surfaces; data in TOML |
//! | [`Rules`] | from distance and approach speed to the size and direction of a correction |
//! | [`ReactiveController`] | one tick: from a desired joint velocity to one that evades, by weighted least squares on the Jacobians of the collision points |
//! | [`Avoider`] | the control loop in a scene: sense, correct, check by a sweep, command; it leaves its path, waits, and returns |
//!
//! Avoidance proposes a motion. A monitor of interference regions scales it afterwards; the monitor never depends on this
//! crate.

mod avoider;
mod border;
mod detour;
mod dynamic_obstacles;
mod error;
mod escape_check;
mod escape_search;
mod escape_targets;
mod escape_trajectory;
mod escape_tree;
mod escape_work;
pub mod fuzzy;
mod joint_command;
mod joint_limit;
mod joint_profile;
mod least_squares;
mod motion_bounds;
mod objective;
mod output;
mod path_rate;
mod prediction;
mod proximity_pair;
mod proximity_query;
mod reactive_controller;
mod reference;
mod reversal_limiter;
mod rules;
mod settings;
mod side_selector;
mod state;
mod state_machine;
mod sweep_check;
mod velocity_bounds;

pub use avoider::{Avoider, PlannedDetour};
pub use border::Border;
pub use dynamic_obstacles::{DynamicObstacles, Neighbour, ObservedObject};
pub use error::AvoidanceError;
pub use escape_search::{EscapeSettings, EscapeState};
pub use escape_tree::{EscapeTreeReport, search_escape_tree};
pub use joint_limit::{JointLimit, LimitProblem};
pub use least_squares::{LeastSquares, SoftConstraint};
pub use output::{AvoiderOutput, StageTimes};
pub use proximity_pair::{ObstacleKind, ProximityPair};
pub use reactive_controller::{Mode, Reaction, ReactiveController, ReactiveSettings, VelocityTask};
pub use reference::{PathKind, Reference};
pub use rules::{Correction, DEFAULT_RULES, Rules};
pub use settings::AvoiderSettings;
pub use state::AvoiderState;
pub use velocity_bounds::VelocityBounds;
