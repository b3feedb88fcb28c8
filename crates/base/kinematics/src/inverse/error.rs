//! Why there is no solution.

/// Why inverse kinematics has no solution.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IkError {
    /// No joint values reach the target, within the limits or not.
    #[error(
        "the target is out of reach: the closest found is {position_error_m:.6} m and {angle_error_rad:.6} rad away"
    )]
    Unreachable {
        /// Distance that remains, m.
        position_error_m: f64,
        /// Angle that remains, rad.
        angle_error_rad: f64,
    },
    /// Only joint values outside the limits reach the target.
    #[error(
        "the target is reached only outside the joint limits: joint `{joint}` would have to be at {value:.6} but may be {lower:.6} to {upper:.6}"
    )]
    Limits {
        /// The joint that is farthest outside, in the solution that is least outside.
        joint: String,
        /// Its value there, rad or m.
        value: f64,
        /// Its lower bound, rad or m.
        lower: f64,
        /// Its upper bound, rad or m.
        upper: f64,
    },
    /// The search ended without a solution; there may be one.
    #[error(
        "no answer after {restarts} starts: the closest found is {position_error_m:.6} m and {angle_error_rad:.6} rad away; try a seed nearer to the answer, or more restarts"
    )]
    NoConvergence {
        /// Distance that remains, m.
        position_error_m: f64,
        /// Angle that remains, rad.
        angle_error_rad: f64,
        /// Starting points tried.
        restarts: usize,
    },
    /// The seed needs one value per independent joint of the chain.
    #[error("the seed needs one value per independent joint of the chain")]
    SeedLength,
    /// The seed holds a value that is NaN or infinite.
    #[error("the seed holds a value that is not finite")]
    SeedNotFinite,
    /// The target pose holds a number that is NaN or infinite.
    #[error("the target pose is not finite")]
    TargetNotFinite,
}
