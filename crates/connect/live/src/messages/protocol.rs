//! Header of the messages between controllers and nodes.

use elbowroom_interlock::frame::{MessageError, Protocol, Reader};

pub(super) const PROTOCOL: Protocol = Protocol { letters: *b"EL", version: 1 };

/// Returns the contents of a message of this kind.
pub(super) fn contents(kind: u8, bytes: &[u8]) -> Result<Reader<'_>, MessageError> {
    let (found, reader) = PROTOCOL.contents(bytes)?;
    if found == kind { Ok(reader) } else { Err(MessageError::Kind) }
}
