//! Settings and results of surface inverse kinematics.

/// Settings of a [`PointChain`](super::PointChain).
///
/// A search continues to 1e-9 m and 1e-9 rad if it can. The tolerances decide what is accepted if it cannot:
/// rotating a normal that is almost parallel to an axis takes very large joint motions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceIkOptions {
    /// Largest accepted distance from the target, m.
    pub position_tolerance_m: f64,
    /// Largest accepted angle between the normal and the required normal, rad.
    pub angle_tolerance_rad: f64,
    /// Largest number of starting points, including the given `q`.
    pub starts: usize,
    /// Largest number of steps from one starting point.
    pub iterations: usize,
}

impl Default for SurfaceIkOptions {
    fn default() -> Self {
        Self { position_tolerance_m: 1e-6, angle_tolerance_rad: 1e-6, starts: 100, iterations: 60 }
    }
}

/// The result if the target is met: the remaining error, and the effort.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceIkSolution {
    /// Distance from the target, m.
    pub position_error_m: f64,
    /// Angle between the normal and the required normal, rad; 0 if no normal was required.
    pub angle_error_rad: f64,
    /// Starting points tried beyond the given `q`.
    pub restarts: usize,
}
