//! Errors of validity checks.

/// Why a robot cannot be checked, or a query cannot be answered.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ValidityError {
    /// Spheres cannot enclose a link.
    #[error(
        "link `{link}` cannot be enclosed by spheres: a shape is unbounded or too far away, or has NaN or infinite numbers"
    )]
    NotCovered {
        /// Name of the link.
        link: String,
    },
    /// The chain does not have this link.
    #[error("there is no link number {index}")]
    NoSuchLink {
        /// Index of the link.
        index: usize,
    },
    /// A configuration has too few or too many values.
    #[error("a configuration has {found} values, the robot has {expected} joints: give one value per joint")]
    WrongCount {
        /// Number of given values.
        found: usize,
        /// Number of joints that move independently.
        expected: usize,
    },
}
