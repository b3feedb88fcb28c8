//! Why a node stops its robot although its monitor would not, for people.

use thiserror::Error;

use super::input_gate::Rejected;

/// What is wrong with what a node hears.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub(super) enum Doubt {
    /// The arbiter's process has another cell file.
    #[error(
        "the arbiter's process has loaded another cell file: load the same one on all computers, and start them again"
    )]
    OtherCell,
    /// Nobody says which regions there are.
    #[error("the arbiter's process is not heard")]
    NoTable,
    /// The last message of the controller did not count.
    #[error("its last message was refused, as {0}")]
    Refused(Rejected),
}
