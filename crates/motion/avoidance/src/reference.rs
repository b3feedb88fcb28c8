//! The reference motion of a tick.

/// The point of the path at the end of the tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference<'a> {
    /// Joint values, rad or m.
    pub q: &'a [f64],
    /// Joint velocities at the full rate of the path (override 1), rad/s or m/s.
    pub qd: &'a [f64],
    /// Largest fraction of a joint's top speed that the path uses, 0..1: detours and returns are not faster, unless
    /// [`return_speed_fraction`](crate::AvoiderSettings::return_speed_fraction) is set.
    pub speed_share: f64,
    /// The purpose of the path.
    pub path: PathKind,
}

/// The purpose of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathKind {
    /// Every point counts (a seam, a line): the robot prefers slowing down to leaving the path, and resumes it where it
    /// left it.
    Continuous,
    /// Only the end counts: the robot may leave the path and join it again farther on.
    PointToPoint,
}
