//! Fault in the input of a node, for people.

use thiserror::Error;

use super::input_gate::Rejected;

/// Fault in the input of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub(super) enum Doubt {
    /// The process that keeps the regions has another cell file.
    #[error(
        "the arbiter's process has loaded another cell file: load the same one on all computers, and start them again"
    )]
    OtherCell,
    /// No table of regions arrives, and the regions may have changed.
    #[error("the arbiter's process is not heard")]
    NoTable,
    /// The monitor for the present regions is not built yet.
    #[error("they are being taken over")]
    NotBuilt,
    /// The last message of the controller was rejected.
    #[error("the last message was refused, as {0}")]
    Refused(Rejected),
    /// The last message of a measured source was rejected, and the source is lost.
    #[error("the last message of a measured encoder or object was refused, as {0}")]
    SourceRefused(Rejected),
    /// The last message of a measured source has numbers that say no place.
    #[error(
        "the last message of a measured encoder or object says no place: an encoder needs 1 position, an object 7 or 13"
    )]
    SourceUnclear,
    /// The velocity of a measured source is not known.
    #[error(
        "the velocity of a measured encoder or object is not known: send it, or more messages (docs/live.md says how many)"
    )]
    SourceVelocity,
}

impl Doubt {
    /// Whether it is unknown which regions the robot must not enter.
    pub(super) fn is_of_regions(self) -> bool {
        matches!(self, Self::OtherCell | Self::NoTable | Self::NotBuilt)
    }
}
