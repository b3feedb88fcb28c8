//! Defects of a recorded configuration.

use elbowroom_kinematics::ChainError;
use elbowroom_monitor::ConfigError;
use elbowroom_proximity::{HullError, MeshError};

/// Why a monitor cannot be built from a recorded configuration.
#[derive(Debug, thiserror::Error)]
pub enum ConfigurationDefect {
    /// The recording has more robots than are replayed.
    #[error("there are {0} robots already")]
    ManyRobots(usize),
    /// A kind has a number that does not exist.
    #[error("there is no {what} {number}")]
    Kind {
        /// The thing with the kind: `joint of kind`, `part` and the like.
        what: &'static str,
        /// The recorded number.
        number: u8,
    },
    /// A pose has no rotation.
    #[error("the pose of {0} has no rotation matrix")]
    Pose(String),
    /// The number of coordinates or corners is not a multiple of three.
    #[error("vertices and triangles have three numbers each")]
    Faces,
    /// The faces of a convex hull are not valid.
    #[error(transparent)]
    Hull(#[from] HullError),
    /// The triangles of a mesh are not valid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The travel after which a source repeats is not a vector.
    #[error("the travel of a source has three coordinates")]
    Travel,
    /// The axes of a grid are not complete.
    #[error("the axes of grid {0} have two ends and a number of divisions each")]
    Axes(String),
    /// The joints do not form a chain.
    #[error(transparent)]
    Chain(#[from] ChainError),
    /// The monitor refuses the configuration.
    #[error(transparent)]
    Configuration(#[from] ConfigError),
    /// The configuration is not the recorded one.
    #[error("it does not have the checksum that was recorded with it")]
    Checksum,
    /// The number of an exchange slot is too large for a replay.
    #[error("slot {slot} is beyond the {limit} that a replay has")]
    Slot {
        /// The number of the slot.
        slot: usize,
        /// Most slots of a replay.
        limit: usize,
    },
}
