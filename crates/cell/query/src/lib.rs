//! Questions about a cell without a run: `query`, `map` and `plan`; sets of planning problems.
//!
//! [`evaluate`] answers collision, distance and tolerance for many joint states, [`map`] computes the blocked cells of a
//! robot's joint space, [`plan`] finds a collision-free path and times it, [`ReachQuery`] says which places a robot reaches
//! from which place of its base. All use the cell in its initial state.
//! [`problems`] solves the planning problems of a file; [`watch`] detects the obstacles that a camera or a source of
//! point clouds sees.
//!
//! ```
//! use elbowroom_query::{Level, QueryKind, QueryStates, evaluate};
//! use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel};
//! let cell = Cell::parse("c.toml", r#"
//! version = 1
//! units = { length = "m", angle = "rad" }
//! [robot.arm]
//! dh = [{ a = 1, min = -3, max = 3, speed = 1 }]
//! links = [{ capsule = { from = [-1, 0, 0], to = [0, 0, 0], radius = 0.1 } }]
//! [object.ball]
//! shape = "sphere"
//! at = [1, 0, 0]
//! radius = 0.5
//! "#)?;
//! let model = QueryModel::of_cell(&cell);
//! let states = QueryStates::parse("s.csv".as_ref(), "joint_1\n0\n1.5\n", &model)?;
//! let mut hits = Vec::new();
//! evaluate(&model.scene(OutOfReachProofs::Omit)?, &states, QueryKind::Collision, Level::Auto, &mut |rows| {
//!     hits.extend(rows.iter().map(|row| row.collides));
//!     true
//! })?;
//! assert_eq!(hits, [true, false]);
//! # Ok::<(), elbowroom_formats::Diagnostic>(())
//! ```
//!
//! **Invariant.** For a given cell and table of states, the rows of a query always come in the order of the table, and
//! the number of threads never changes them.

mod cover_cache;
mod link_cells;
pub mod map;
pub mod plan;
pub mod problems;
mod reach;
mod rows;
pub mod watch;

pub use cover_cache::CoverCache;
pub use elbowroom_scene::Level;
pub use link_cells::{LinkCells, blocked_by_link};
pub use reach::{Reach, ReachQuery, ReachTarget};
pub use rows::{
    BLOCK, ContactRecord, ContactRow, JointOvershoot, LimitRecord, LimitRow, MotionRecord, MotionRow, PairColumns,
    Query, QueryChecker, QueryEffort, QueryKind, QueryPairs, QueryPairsError, QueryRecord, QueryRow, QueryStates,
    UnknownQueryKind, evaluate, evaluate_contacts, evaluate_edges, evaluate_limits, evaluate_motions, evaluate_query,
};
