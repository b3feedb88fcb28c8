//! The cells of `elbowroom-cell`'s tests.

#[path = "../../../cell/tests/common/mod.rs"]
mod cells;

#[allow(unused_imports)]
pub use cells::*;
