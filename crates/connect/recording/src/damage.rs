//! Damage of an MCAP file.

use std::io;

/// Largest record, and largest chunk after decompression, bytes.
pub(crate) const MAX_BYTES: u64 = 1 << 30;

/// What is wrong with the bytes of a recording.
#[derive(Debug, thiserror::Error)]
pub enum Damage {
    /// The system does not read on.
    #[error("the file cannot be read: {0}")]
    Unreadable(io::Error),
    /// The claimed length of a record, bytes.
    #[error("a record claims {0} bytes, more than the {MAX_BYTES} that are read")]
    LongRecord(u64),
    /// The claimed length of the contents of a chunk, bytes.
    #[error("a chunk claims {0} bytes, more than the {MAX_BYTES} that are read")]
    LongChunk(u64),
    /// A record ends inside a field.
    #[error("a record is shorter than its fields")]
    ShortRecord,
    /// A text is not UTF-8.
    #[error("a text in a record is not UTF-8")]
    Text,
    /// A chunk cannot be decompressed.
    #[error("a chunk is not {format}: {source}")]
    Compressed {
        /// LZ4 or Zstandard.
        format: &'static str,
        /// Error of the decoder.
        source: io::Error,
    },
    /// A chunk names a compression that is not read.
    #[error("a chunk is compressed with \"{0}\"; lz4 and zstd can be read")]
    Compression(String),
    /// The contents of a chunk have another length than it claims.
    #[error("a chunk has {found} bytes, not the {claimed} that it claims")]
    ChunkLength {
        /// Number of bytes; not more than one above the claim.
        found: usize,
        /// The claimed number.
        claimed: u64,
    },
    /// The contents of a chunk were changed.
    #[error("a chunk does not have its checksum")]
    Checksum,
    /// A chunk contains a chunk.
    #[error("a chunk is inside of another one")]
    NestedChunk,
    /// A message names a channel that does not exist.
    #[error("a message is on channel {0}, which there is not")]
    Channel(u16),
}
