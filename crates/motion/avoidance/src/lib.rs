//! Reactive avoidance: near an obstacle the planned motion is corrected and later resumed (Reichenbach and Kovačić
//! 2003).
//!
//! | | |
//! | --- | --- |
//! | [`fuzzy`] | general fuzzy control: variables, rules, Mamdani inference, control surfaces; data in TOML |
//! | [`Rules`] | size and direction of a correction from distance and approach speed |
//! | [`ReactiveController`] | one tick: turns a desired joint velocity into an evading one by weighted least squares |
//! | [`Avoider`] | the control loop in a scene: sense, correct, check by a sweep, command; also waits and returns |
//!
//! Avoidance proposes a motion, and a monitor of interference regions scales it afterwards. The monitor never depends
//! on this crate.
//!
//! ```
//! use elbowroom_avoidance::{
//!     Mode, ObstacleKind, ProximityPair, ReactiveController, ReactiveSettings, Rules, VelocityBounds, VelocityTask,
//! };
//! use elbowroom_kinematics::{ChainState, LinkId};
//! use elbowroom_spatial::Vec3;
//! let chain = elbowroom_robot::example::arm()?.chain;
//! let mut state = ChainState::new(&chain);
//! state.q.copy_from_slice(&[0.0, 1.2, 0.0]);
//! chain.forward(&mut state);
//! // A ball approaches the tip of the forearm from above.
//! let tip_in_link = Vec3::Z * 0.4;
//! let on_link = state.link_in_root(LinkId(3)).transform_point(tip_in_link);
//! let (away, distance_m) = (-Vec3::Z, 0.08);
//! let obstacle = ObstacleKind::Dynamic {
//!     velocity: Vec3::Z * -0.3, centre: on_link + Vec3::Z * 0.18, radius_m: 0.1, key: 0,
//! };
//! let pair = ProximityPair { link: LinkId(3), on_link, away, distance_m, on_obstacle: on_link - away * distance_m, obstacle };
//! let bounds = VelocityBounds { next: vec![[-1.0, 1.0]; 3], stoppable: vec![[-1.0, 1.0]; 3] };
//! let task = VelocityTask { desired: &[0.0; 3], bounds: &bounds, mode: Mode::Transit, is_on_collision_course: true };
//! let mut controller = ReactiveController::new(&chain, &[1.0; 3], Rules::default(), ReactiveSettings::default());
//! let mut evasion = [0.0; 3];
//! let reaction = controller.react(&chain, &state, &task, &[pair], &mut evasion);
//! assert!(reaction.is_active && reaction.size > 0.0);
//! // The tip yields.
//! state.q.iter_mut().zip(evasion).for_each(|(q, speed)| *q += 0.01 * speed);
//! chain.forward(&mut state);
//! assert!((state.link_in_root(LinkId(3)).transform_point(tip_in_link) - on_link).dot(away) > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Invariant.** While a proven escape is known and obstacles move as predicted, the avoidance never gives a command
//! after which no escape would be left: the robot follows the known escape instead.

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
mod escape_trial;
mod escape_work;
pub mod fuzzy;
mod hit_point;
mod joint_command;
mod joint_limits;
mod joint_profile;
mod known_escape;
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
pub use elbowroom_planner::{PathConstraint, PathConstraintSource};
pub use error::AvoidanceError;
pub use escape_search::{EscapeSettings, EscapeState};
pub use escape_tree::{EscapeTreeReport, search_escape_tree};
pub use joint_limits::LimitProblem;
pub use least_squares::{LeastSquares, SoftConstraint};
pub use output::{AvoiderOutput, StageTimes};
pub use proximity_pair::{ObstacleKind, ProximityPair};
pub use reactive_controller::{Mode, Reaction, ReactiveController, ReactiveSettings, VelocityTask};
pub use reference::{PathKind, Reference};
pub use rules::{Correction, DEFAULT_RULES, Rules};
pub use settings::AvoiderSettings;
pub use state::AvoiderState;
pub use velocity_bounds::VelocityBounds;
