//! How far the arm may move along its path.

/// How far the arm may move along its path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ArcLimit {
    /// To the end.
    Unlimited,
    /// It stops before this arc length (rad, from the start of the execution), or as soon as possible beyond it.
    StopAt(f64),
    /// It stops as soon as possible, and drops the path.
    StopNow,
}
