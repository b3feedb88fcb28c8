//! Errors of convex hulls.

/// Why points have no convex hull with an interior.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum HullError {
    /// The set has fewer than four points.
    #[error("a convex hull needs at least 4 points, not {0}")]
    TooFew(usize),
    /// A coordinate is NaN or infinite.
    #[error("point {0} has a coordinate that is not a finite number")]
    NotFinite(usize),
    /// All points are the same within rounding.
    #[error("all points coincide: a convex hull needs an inside; use a sphere instead")]
    Point,
    /// All points lie on one line within rounding.
    #[error("all points lie on one line: a convex hull needs an inside; use a capsule instead")]
    Line,
    /// All points lie in one plane within rounding.
    #[error("all points lie in one plane: a convex hull needs an inside; use a thin box instead")]
    Flat,
    /// The faces are not the faces of a convex hull.
    #[error("the faces are not the surface of a convex hull of these corners")]
    Faces,
    /// Rounding prevents a closed surface: f64 cannot separate the points at their scale.
    #[error("the points are too close to degenerate for a closed hull; scale or thin them out")]
    Numeric,
}
