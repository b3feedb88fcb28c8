//! What is wrong with what a node hears, for people.

use thiserror::Error;

use super::input_gate::Rejected;

/// What is wrong with what a node hears.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub(super) enum Doubt {
    /// The process that keeps the regions has another cell file.
    #[error(
        "the arbiter's process has loaded another cell file: load the same one on all computers, and start them again"
    )]
    OtherCell,
    /// Nobody says which regions there are, and they may have changed.
    #[error("the arbiter's process is not heard")]
    NoTable,
    /// The monitor is not built for the present regions yet.
    #[error("they are being taken over")]
    NotBuilt,
    /// The last message of the controller did not count.
    #[error("the last message was refused, as {0}")]
    Refused(Rejected),
}

impl Doubt {
    /// True if it is not known which regions the robot must not enter.
    pub(super) fn is_of_regions(self) -> bool {
        !matches!(self, Self::Refused(_))
    }
}
