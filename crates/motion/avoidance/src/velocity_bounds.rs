//! Bounds of the joint velocities.

/// Bounds of the joint velocities, rad/s or m/s.
#[derive(Debug, Clone, PartialEq)]
pub struct VelocityBounds {
    /// Bounds of the next command: speed, acceleration and joint limits.
    pub next: Vec<[f64; 2]>,
    /// Bounds from which the joint can still stop before its limits: speed and joint limits, without the acceleration.
    pub stoppable: Vec<[f64; 2]>,
}
