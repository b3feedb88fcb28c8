//! Robots and objects together, in one world, and the questions about them: does anything collide, how far apart is
//! everything, is anything closer than this?
//!
//! A [`Scene`] is constant and shared between threads: robots, objects, their models from coarse to exact
//! ([`Level`]) and the [`PairMatrix`]. A [`SceneState`] is where everything is now, and what is attached to what. A
//! [`Checker`] answers, one per thread. See `docs/scene.md`.
//!
//! ```
//! use elbowroom_scene::{Checker, Options, SceneState, example};
//! let scene = example::two_arms();
//! let mut state = SceneState::new(&scene);
//! let mut checker = Checker::new(&scene, Options::default());
//! assert!(checker.collides(&state).is_none());
//! state.set_q(&scene, 0, &[0.0, 1.57, 0.4])?;
//! let contact = checker.collides(&state).expect("the forearm is in the table");
//! assert_eq!(scene.name(contact.a), "left/forearm");
//! # Ok::<(), elbowroom_scene::SceneError>(())
//! ```

mod attach;
mod builder;
mod checker;
mod counts;
mod detail;
mod enclose;
mod error;
pub mod example;
mod exchange;
mod first_contacts;
mod level;
mod matrix;
mod member;
mod model;
mod motion;
mod obb;
mod object;
pub mod pairs;
mod rest;
mod robot;
mod scale;
mod scene;
mod selection;
mod state;
mod sweep;
mod weight;
mod world_box;

pub use attach::Attachment;
pub use builder::SceneBuilder;
pub use checker::{Between, Checker, CollisionPoint, Contact, Distance, Options};
pub use counts::{Counts, PerLevel};
pub use detail::{Approach, LevelOfDetail};
pub use elbowroom_proximity::contact::Detail;
pub use error::{MatrixError, SceneError};
pub use first_contacts::{FirstContact, FirstContacts, ObjectStep};
pub use level::{Level, UnknownLevel};
pub use matrix::{Edit, PairEntry, PairMatrix, PairState, Reason};
pub use member::Member;
pub use motion::SceneMotion;
pub use object::Object;
pub use robot::{Body, Robot};
pub use scene::{Scene, SceneRobot};
pub use selection::Selection;
pub use state::SceneState;
pub use sweep::{Impact, Move, SweepOptions};
