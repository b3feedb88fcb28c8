//! Errors of inverse kinematics.

/// Why inverse kinematics has no solution.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IkError {
    /// No joint values reach the target, within the limits or not.
    #[error(
        "the target is out of reach: the closest found is {position_error_m:.6} m and {angle_error_rad:.6} rad away"
    )]
    Unreachable {
        /// Remaining distance, m.
        position_error_m: f64,
        /// Remaining angle, rad.
        angle_error_rad: f64,
    },
    /// Only joint values outside the limits reach the target.
    #[error(
        "the target is reached only outside the joint limits: joint `{joint}` would have to be at {value:.6} but may be {lower:.6} to {upper:.6}"
    )]
    Limits {
        /// The joint that is farthest outside, in the solution that is least outside.
        joint: String,
        /// The joint's value in that solution, rad or m.
        value: f64,
        /// The joint's lower bound, rad or m.
        lower: f64,
        /// The joint's upper bound, rad or m.
        upper: f64,
    },
    /// The search ended without a solution; one may exist.
    #[error(
        "no answer after {restarts} starts: the closest found is {position_error_m:.6} m and {angle_error_rad:.6} rad away; try a seed nearer to the answer, or more restarts"
    )]
    NoConvergence {
        /// Remaining distance, m.
        position_error_m: f64,
        /// Remaining angle, rad.
        angle_error_rad: f64,
        /// Number of starting points tried.
        restarts: usize,
    },
    /// The seed does not have one value per independent joint of the chain.
    #[error("the seed needs one value per independent joint of the chain")]
    SeedLength,
    /// The seed has a NaN or infinite value.
    #[error("the seed holds a value that is not finite")]
    SeedNotFinite,
    /// The target pose has a NaN or infinite number.
    #[error("the target pose is not finite")]
    TargetNotFinite,
}
