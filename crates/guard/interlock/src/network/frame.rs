//! The frame of every binary message of a cell (little-endian): two letters of the protocol, version, kind,
//! contents, CRC-32.

use thiserror::Error;

/// Number of bytes of a frame around its contents.
pub const FRAME_BYTES: usize = 8;

/// Why bytes are not a valid message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum MessageError {
    /// The length is too short, too long, or different from the stated one.
    #[error("{0} bytes are not the length of this message")]
    Length(usize),
    /// The message has another protocol.
    #[error("the bytes are no message of this protocol")]
    Protocol,
    /// The message has another version of the protocol.
    #[error("the message has version {found}, this is version {here}: run the same release on both sides")]
    Version {
        /// Version of the message.
        found: u8,
        /// Version of this release.
        here: u8,
    },
    /// The message is damaged.
    #[error("the checksum of the message is wrong")]
    Checksum,
    /// The message has another kind: it comes from the other side.
    #[error("the message is of another kind: it comes from the other side")]
    Kind,
    /// The message has a value that no sender writes.
    #[error("the message has a value that means nothing")]
    Value,
}

/// A protocol: the letters and the version at the start of its messages.
///
/// ```
/// use elbowroom_interlock::frame::{MessageError, Protocol};
/// const GREETINGS: Protocol = Protocol { letters: *b"HI", version: 1 };
/// let mut bytes = Vec::new();
/// GREETINGS.begin(7, &mut bytes);
/// bytes.extend_from_slice(&258_u16.to_le_bytes());
/// GREETINGS.end(&mut bytes);
/// let (kind, mut contents) = GREETINGS.contents(&bytes)?;
/// assert_eq!((kind, contents.u16()), (7, Some(258)));
/// bytes[4] ^= 1;
/// assert!(matches!(GREETINGS.contents(&bytes), Err(MessageError::Checksum)));
/// # Ok::<(), MessageError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Protocol {
    /// The first two bytes of a message.
    pub letters: [u8; 2],
    /// The third byte of a message.
    pub version: u8,
}

impl Protocol {
    /// Starts a message of this kind in `out`, after clearing it.
    pub fn begin(&self, kind: u8, out: &mut Vec<u8>) {
        out.clear();
        out.extend_from_slice(&self.letters);
        out.extend_from_slice(&[self.version, kind]);
    }

    /// Ends a message with its CRC-32.
    pub fn end(&self, out: &mut Vec<u8>) {
        let crc = crc32fast::hash(out);
        out.extend_from_slice(&crc.to_le_bytes());
    }

    /// The kind and the contents of a message.
    ///
    /// # Errors
    /// [`MessageError`] if the bytes are not a message of this protocol and version, or were damaged.
    pub fn contents<'a>(&self, bytes: &'a [u8]) -> Result<(u8, Reader<'a>), MessageError> {
        let length = MessageError::Length(bytes.len());
        let (framed, crc) = bytes.split_last_chunk::<4>().ok_or(length)?;
        let ([l0, l1, version, kind], rest) = framed.split_first_chunk::<4>().ok_or(length)?;
        if [*l0, *l1] != self.letters {
            return Err(MessageError::Protocol);
        }
        if *version != self.version {
            return Err(MessageError::Version { found: *version, here: self.version });
        }
        if crc32fast::hash(framed).to_le_bytes() != *crc {
            return Err(MessageError::Checksum);
        }
        Ok((*kind, Reader { rest }))
    }
}

/// A reader of the bytes that are not read yet. All numbers are little-endian; `None` if too few bytes are left.
#[derive(Debug)]
pub struct Reader<'a> {
    rest: &'a [u8],
}

impl Reader<'_> {
    /// Number of bytes that are left.
    pub fn remaining(&self) -> usize {
        self.rest.len()
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.rest.split_first_chunk::<N>()?;
        self.rest = rest;
        Some(*first)
    }

    /// Reads one byte.
    pub fn u8(&mut self) -> Option<u8> {
        self.take().map(|[b]: [u8; 1]| b)
    }

    /// Reads two bytes.
    pub fn u16(&mut self) -> Option<u16> {
        self.take().map(u16::from_le_bytes)
    }

    /// Reads eight bytes.
    pub fn u64(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    /// Reads a double-precision number.
    pub fn f64(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    /// Replaces the contents of `out` by `count` numbers.
    pub fn numbers(&mut self, count: usize, out: &mut Vec<f64>) -> Option<()> {
        out.clear();
        for _ in 0..count {
            out.push(self.f64()?);
        }
        Some(())
    }
}
