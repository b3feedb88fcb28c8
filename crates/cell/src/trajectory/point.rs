//! Joint values on a path, with their derivatives.

/// Joint values on a path, with their first and second derivative by the parameter.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PathPoint {
    /// Joint values, rad or m.
    pub q: Vec<f64>,
    /// dq/ds.
    pub first: Vec<f64>,
    /// d²q/ds².
    pub second: Vec<f64>,
}
