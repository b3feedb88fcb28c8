//! Collision, distance and tolerance queries for many states of a cell or of one robot (`elbowroom query`).
//!
//! A [`QueryModel`](elbowroom_cell::QueryModel) holds the robots and objects, [`QueryStates`] the joint values;
//! [`evaluate`] computes one [`QueryRow`] per state, in order, in parallel. A row depends only on its state and the
//! rows before it in its block of [`BLOCK`], so the results are independent of the number of threads.
//!
//! ```
//! use elbowroom_analysis::query::{QueryStates, Level, QueryKind, evaluate};
//! use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel};
//! let cell = Cell::parse("c.toml", r#"
//! version = 1
//! units = { length = "m", angle = "rad" }
//! [robot.arm]
//! dh = [{ a = 1, min = -3, max = 3, speed = 1 }]
//! links = [{ capsule = { from = [-1, 0, 0], to = [0, 0, 0], radius = 0.1 } }]
//! [object.ball]
//! shape = "sphere"
//! at = [2, 0, 0]
//! radius = 0.5
//! "#)?;
//! let model = QueryModel::of_cell(&cell);
//! let states = QueryStates::parse("s.csv".as_ref(), "joint_1\n0\n1.5\n", &model)?;
//! let mut rows = Vec::new();
//! evaluate(&model.scene(OutOfReachProofs::Omit)?, &states, QueryKind::Distance, Level::Auto, &mut |block| {
//!     rows.extend_from_slice(block);
//!     true
//! })?;
//! assert!((rows[0].distance_m.unwrap() - 0.4).abs() < 1e-9); // 2 - 0.5 - 1 - 0.1
//! assert!(rows[1].distance_m > rows[0].distance_m);
//! # Ok::<(), elbowroom_formats::FormatError>(())
//! ```

mod evaluate;
mod kind;
mod pairs;
mod row;
mod states;

pub use elbowroom_scene::Level;
pub use evaluate::{BLOCK, Query, evaluate, evaluate_contacts, evaluate_query};
pub use kind::{QueryKind, UnknownQueryKind};
pub use pairs::{QueryPairs, QueryPairsError};
pub use row::{ContactRecord, ContactRow, QueryRecord, QueryRow};
pub use states::QueryStates;
