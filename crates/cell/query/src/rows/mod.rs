//! Collision, distance and tolerance queries for many states of a cell or of one robot (`elbowroom query`).
//!
//! A [`QueryModel`](elbowroom_cell::QueryModel) holds the robots and objects, [`QueryStates`] the joint values;
//! [`evaluate`] computes one [`QueryRow`] per state, in order, in parallel. A row depends only on its state and the
//! rows before it in its block of [`BLOCK`], so the results are independent of the number of threads.

mod evaluate;
mod kind;
mod limits;
mod motion;
mod pairs;
mod query_checker;
mod row;
mod states;

pub(crate) use evaluate::cores;
pub use evaluate::{BLOCK, Query, QueryEffort, evaluate, evaluate_contacts, evaluate_query};
pub use kind::{QueryKind, UnknownQueryKind};
pub use limits::{JointOvershoot, LimitRecord, LimitRow, evaluate_limits};
pub use motion::{MotionRecord, MotionRow, evaluate_edges, evaluate_motions};
pub use pairs::{QueryPairs, QueryPairsError};
pub use query_checker::QueryChecker;
pub use row::{ContactRecord, ContactRow, PairColumns, QueryRecord, QueryRow};
pub use states::QueryStates;
