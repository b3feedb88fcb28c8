//! Robots and objects in one world, with collision queries.
//!
//! The queries are collision, tolerance, distance, contact points, and continuous collision detection.
//!
//! A [`Scene`] is constant and shared between threads: robots, objects, their models from coarse to exact ([`Level`]) and
//! the [`AllowedCollisionMatrix`]. A [`SceneState`] holds the current configuration and the attachments of objects. A
//! [`Checker`] answers queries, one checker per thread. See `docs/scene.md`.
//!
//! ```
//! use elbowroom_robot::RobotId;
//! use elbowroom_scene::{Checker, CheckerOptions, SceneState, example};
//! let scene = example::two_arms();
//! let mut state = SceneState::new(&scene);
//! let mut checker = Checker::new(&scene, CheckerOptions::default());
//! assert!(checker.collides(&state).is_none());
//! state.set_q(&scene, RobotId(0), &[0.0, 1.57, 0.4])?;
//! let contact = checker.collides(&state).expect("the forearm is in the table");
//! assert_eq!(scene.name(contact.a), "left/forearm");
//! # Ok::<(), elbowroom_scene::SceneError>(())
//! ```
//!
//! **Invariant.** If a pair is tested and its exact models are in contact, a [`Checker`] never answers "free", at any
//! [`Level`], with any weights and any order of pairs. A state with joint values that are not finite is always refused.

mod allowed_collision_matrix;
mod attach;
mod attachment;
mod bounding_volume;
mod box_descent;
mod builder;
mod checker;
mod contact_surfaces;
mod enclosing_cuboid;
mod error;
pub mod example;
mod first_contacts;
mod geometry_model;
mod level;
mod level_of_detail;
mod local_shape;
mod merge_robots;
mod narrow_phase;
mod nearer_separation;
mod obb_gap;
mod obb_tree;
mod object;
mod pair_rules;
mod pair_weight;
mod replace_objects;
mod scale;
mod scene;
mod scene_motion;
mod selection;
mod state;
mod stats;
mod sweep;
mod with_base;
mod world_box;

pub use allowed_collision_matrix::{AllowedCollisionMatrix, PairEdit, PairEntry, PairNumber, PairState, Reason};
pub use attachment::Attachment;
pub use builder::SceneBuilder;
pub use checker::{ApproachingPair, Checker, CheckerOptions, CollisionPoint, PairContact, PairDistance, PairQuery};
pub use contact_surfaces::{ContactSurfaces, SurfaceContact};
pub use elbowroom_proximity::contact::Detail;
pub use error::{MatrixError, SceneError};
pub use first_contacts::{FirstContact, FirstContacts, MovedObject};
pub use level::{Level, LevelError};
pub use level_of_detail::LevelOfDetail;
pub use merge_robots::MergedRobots;
pub use object::Object;
pub use pair_rules::{PairRule, PairRules};
pub use scene::{Scene, SceneRobot};
pub use scene_motion::SceneMotion;
pub use selection::Selection;
pub use state::SceneState;
pub use stats::{CheckerStats, PerLevel};
pub use sweep::{SweepHit, SweepMove, SweepOptions};
