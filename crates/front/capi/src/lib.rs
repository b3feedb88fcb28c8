//! Proximity queries of robots and cells for C and C++: `include/elbowroom.h` declares and documents the functions.
//!
//! A model (a cell file, a robot, or several robots) is loaded once and never changes; threads share it. Each thread has its
//! own checker: joint values, and what earlier answers taught. Answers equal those of `elbowroom query` to the bit, because
//! both call [`QueryChecker`](elbowroom::query::QueryChecker).
//!
//! This crate allows `unsafe` code, as no other of the workspace: names that C links are exported by an unsafe attribute,
//! and strings and arrays of C are a pointer whose length only the caller knows. [`exports`] has the attributes, `raw`
//! everything that follows a pointer; the other files are forbidden it. Handles and results are `Option<&T>` and
//! `Option<&mut T>` for Rust: NULL is `None`, and is refused.
//!
//! From Rust, use [`elbowroom::query`]. The functions can be called for tests:
//!
//! ```
//! use elbowroom_capi::exports::{elbowroom_model_robot_count, elbowroom_version};
//! use elbowroom_capi::Status;
//! assert_eq!(elbowroom_model_robot_count(None, None), Status::NullPointer);
//! assert!(!elbowroom_version().is_null());
//! ```
//!
//! **Invariant.** A panic never leaves a function of this crate: it becomes [`Status::Panic`], and the checker in which it
//! happened refuses every later call.

mod checker;
pub mod exports;
mod failure;
mod model;
mod names;
mod raw;
mod records;

pub use checker::StateChecker;
pub use failure::Status;
pub use model::ModelHandle;
pub use records::{Answer, LevelCode, PoseRecord, RobotFile};
