//! Reading and writing numbers, and the frame of every message: magic, version, kind, contents, CRC-32.

use thiserror::Error;

/// Why bytes are no message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum MessageError {
    /// Too short, too long, or not as long as it says.
    #[error("{0} bytes are not the length of this message")]
    Length(usize),
    /// Of something else.
    #[error("these bytes are no message of this kind")]
    Kind,
    /// Of another version.
    #[error("the message has version {0}, this is version {VERSION}: run the same release on both sides")]
    Version(u8),
    /// Damaged.
    #[error("the checksum of the message is wrong")]
    Checksum,
}

const MAGIC: [u8; 2] = *b"EL";
const VERSION: u8 = 1;

/// Bytes of magic, version, kind and CRC-32.
pub(super) const FRAME_BYTES: usize = 8;

/// Starts a message in `out`, which is emptied.
pub(super) fn begin(kind: u8, out: &mut Vec<u8>) {
    out.clear();
    out.extend_from_slice(&MAGIC);
    out.extend_from_slice(&[VERSION, kind]);
}

/// Ends a message with its CRC-32.
pub(super) fn end(out: &mut Vec<u8>) {
    let crc = crc32fast::hash(out);
    out.extend_from_slice(&crc.to_le_bytes());
}

/// The contents of a message of this kind.
pub(super) fn contents(kind: u8, bytes: &[u8]) -> Result<Reader<'_>, MessageError> {
    let length = MessageError::Length(bytes.len());
    let (framed, crc) = bytes.split_last_chunk::<4>().ok_or(length)?;
    let ([m0, m1, version, found], rest) = framed.split_first_chunk::<4>().ok_or(length)?;
    if [*m0, *m1] != MAGIC || *found != kind {
        return Err(MessageError::Kind);
    }
    if *version != VERSION {
        return Err(MessageError::Version(*version));
    }
    if crc32fast::hash(framed).to_le_bytes() != *crc {
        return Err(MessageError::Checksum);
    }
    Ok(Reader { rest })
}

/// The bytes that are not read yet.
pub(super) struct Reader<'a> {
    rest: &'a [u8],
}

impl Reader<'_> {
    pub(super) fn remaining(&self) -> usize {
        self.rest.len()
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.rest.split_first_chunk::<N>()?;
        self.rest = rest;
        Some(*first)
    }

    pub(super) fn u8(&mut self) -> Option<u8> {
        self.take().map(|[b]: [u8; 1]| b)
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        self.take().map(u16::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    pub(super) fn f64(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    /// Replaces the contents of `out` by this many numbers.
    pub(super) fn numbers(&mut self, count: usize, out: &mut Vec<f64>) -> Option<()> {
        out.clear();
        for _ in 0..count {
            out.push(self.f64()?);
        }
        Some(())
    }
}
