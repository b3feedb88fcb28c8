//! Errors of surface inverse kinematics.

/// Why a point chain cannot be built, or a target is not reached.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PointError {
    /// The chain has no link with this index.
    #[error("link {link} is not of this chain, whose links are 0 to {last}; take it from Chain::link")]
    UnknownLink {
        /// The given index.
        link: usize,
        /// The largest index.
        last: usize,
    },
    /// The target was not met from any start. It may be out of reach, outside the limits, or only not found.
    #[error(
        "the point was not brought to the target from {starts} starts: the nearest is {position_error_m:.2e} m and {angle_error_rad:.2e} rad away; nearer targets, wider joint limits or more starts may help"
    )]
    NotReached {
        /// Remaining distance, m.
        position_error_m: f64,
        /// Remaining angle between the normals, rad.
        angle_error_rad: f64,
        /// Number of starting points tried.
        starts: usize,
    },
    /// The point has a NaN or infinite number.
    #[error("the point is not finite; write metres in the link's frame")]
    PointNotFinite,
    /// The normal has no direction.
    #[error("the normal is no direction; write a finite vector other than zero in the link's frame")]
    NormalWithoutDirection,
    /// A normal is needed, but the point has none.
    #[error("this point has no normal; give one to PointChain::new, or leave the normal out of the target")]
    NoNormal,
    /// The number of joint values differs from the number of independent joints.
    #[error("q needs one value per independent joint of the chain")]
    ConfigurationLength,
    /// A joint value is NaN or infinite.
    #[error("q holds a value that is not finite")]
    ConfigurationNotFinite,
    /// The target point has a NaN or infinite number.
    #[error("the target point is not finite")]
    TargetNotFinite,
    /// The target's normal has no direction.
    #[error("the target's normal is no direction; write a finite vector other than zero in the root's frame")]
    TargetNormalWithoutDirection,
    /// The number of starts is 0.
    #[error("SurfaceIkOptions::starts is 0; write 1 or more")]
    NoStarts,
}
