//! Errors of surface inverse kinematics.

/// Why there is no point chain, or no solution.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PointError {
    /// No such link.
    #[error("link {link} is not of this chain, whose links are 0 to {last}; take it from Chain::link")]
    UnknownLink {
        /// The given index.
        link: usize,
        /// The largest index.
        last: usize,
    },
    /// The target was not met from any start; it may be out of reach, outside the limits, or just not found.
    #[error(
        "the point was not brought to the target from {starts} starts: the nearest is {position_error_m:.2e} m and {angle_error_rad:.2e} rad away; nearer targets, wider joint limits or more starts may help"
    )]
    NotReached {
        /// Distance that remains, m.
        position_error_m: f64,
        /// Angle that remains between the normals, rad.
        angle_error_rad: f64,
        /// Starting points tried.
        starts: usize,
    },
    /// The point holds a number that is NaN or infinite.
    #[error("the point is not finite; write metres in the link's frame")]
    PointNotFinite,
    /// The normal has no direction.
    #[error("the normal is no direction; write a finite vector other than zero in the link's frame")]
    NormalWithoutDirection,
    /// A normal is needed, and the point has none.
    #[error("this point has no normal; give one to PointChain::new, or leave the normal out of the target")]
    NoNormal,
    /// The number of joint values is not that of the chain.
    #[error("q needs one value per independent joint of the chain")]
    ConfigurationLength,
    /// A joint value is NaN or infinite.
    #[error("q holds a value that is not finite")]
    ConfigurationNotFinite,
    /// The target point holds a number that is NaN or infinite.
    #[error("the target point is not finite")]
    TargetNotFinite,
    /// The target's normal has no direction.
    #[error("the target's normal is no direction; write a finite vector other than zero in the root's frame")]
    TargetNormalWithoutDirection,
    /// No start is allowed.
    #[error("SurfaceIkOptions::starts is 0; write 1 or more")]
    NoStarts,
}
