//! Errors of validity checks.

/// Why a robot cannot be checked, or a question not be answered.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ValidityError {
    /// A link cannot be enclosed by spheres.
    #[error(
        "link `{link}` cannot be enclosed by spheres: a shape is unbounded or too far away, or has NaN or infinite numbers"
    )]
    NotCovered {
        /// Its name.
        link: String,
    },
    /// A link that the chain does not have.
    #[error("there is no link number {index}")]
    NoSuchLink {
        /// Its index.
        index: usize,
    },
    /// A configuration with too few or too many values.
    #[error("a configuration has {found} values, the robot has {expected} joints: give one value per joint")]
    WrongCount {
        /// How many were given.
        found: usize,
        /// How many joints move independently.
        expected: usize,
    },
}
