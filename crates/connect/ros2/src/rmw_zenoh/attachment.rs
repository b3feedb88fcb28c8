//! Attachment of each sample.

use super::gid::Gid;

/// The attachment of a sample: subscriptions of ROS 2 refuse samples without one.
///
/// ```
/// use elbowroom_ros2::rmw_zenoh::{Attachment, Gid};
/// let attachment = Attachment { sequence: 1, stamp_ns: 2, source: Gid([7; 16]) };
/// assert_eq!(Attachment::decode(&attachment.encode())?, attachment);
/// # Ok::<(), elbowroom_ros2::rmw_zenoh::AttachmentError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Attachment {
    /// Number of the sample, from 1 on.
    pub sequence: i64,
    /// Time of publication, ns since the Unix epoch.
    pub stamp_ns: i64,
    /// Identity of the publisher.
    pub source: Gid,
}

/// The bytes are not an attachment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("an attachment of {length} bytes is not that of rmw_zenoh 0.2.4 or later: 33 bytes, the 17th of them 16")]
pub struct AttachmentError {
    /// Number of the bytes.
    pub length: usize,
}

impl Attachment {
    /// Length of an attachment, bytes.
    pub const LENGTH: usize = 33;

    /// Encodes the attachment: the two numbers, little-endian, the length of the identity, the identity.
    pub fn encode(&self) -> [u8; Self::LENGTH] {
        let mut bytes = [0; Self::LENGTH];
        bytes[..8].copy_from_slice(&self.sequence.to_le_bytes());
        bytes[8..16].copy_from_slice(&self.stamp_ns.to_le_bytes());
        bytes[16] = 16;
        bytes[17..].copy_from_slice(&self.source.0);
        bytes
    }

    /// Decodes an attachment.
    ///
    /// # Errors
    /// [`AttachmentError`] for any other bytes, including the attachments of Jazzy's first releases (before 0.2.4).
    pub fn decode(bytes: &[u8]) -> Result<Self, AttachmentError> {
        let error = AttachmentError { length: bytes.len() };
        let (sequence, rest) = bytes.split_first_chunk().ok_or(error)?;
        let (stamp, rest) = rest.split_first_chunk().ok_or(error)?;
        match rest {
            [16, source @ ..] => Ok(Self {
                sequence: i64::from_le_bytes(*sequence),
                stamp_ns: i64::from_le_bytes(*stamp),
                source: Gid(source.try_into().map_err(|_| error)?),
            }),
            _ => Err(error),
        }
    }
}
