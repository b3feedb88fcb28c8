//! Joint values on a path, with their derivatives.

/// Joint values on a path, with their first and second derivatives with respect to a parameter: the
/// fraction s of a path, or time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PathPoint {
    /// Joint values, rad or m.
    pub q: Vec<f64>,
    /// First derivative: dq/ds or dq/dt.
    pub dq: Vec<f64>,
    /// Second derivative: d²q/ds² or d²q/dt².
    pub ddq: Vec<f64>,
}
