//! Message with the speed override of a robot, to its controller.

use elbowroom_interlock::frame::{FRAME_BYTES, MessageError};

use super::protocol::{PROTOCOL, contents};

/// Length of the message, bytes.
pub const OVERRIDE_ANSWER_BYTES: usize = FRAME_BYTES + 6 * 8 + 4;

const KIND: u8 = 2;

/// Answer of a node to a [`JointState`](super::JointState).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OverrideAnswer {
    /// The first 8 bytes of the checksum of the cell that the node guards.
    pub checksum: u64,
    /// Number of the controller's start that is answered.
    pub boot: u64,
    /// Sequence number of the message that is answered: the newest one that the node has accepted.
    pub echo: u64,
    /// Number of the answer, which increases with every answer of a start of the node.
    pub sequence: u64,
    /// The speed override to apply, 0..1.
    pub speed_override: f64,
    /// Digital outputs, bit i is channel i.
    pub outputs: u64,
    /// Why the override has this value: 0 free, 1 region, 2 speed zone, 3 waiting for an exchange region, 4 rate, 5 fault,
    /// 6 halted: another robot is in the same exchange region.
    pub reason: u8,
    /// Index, in the node's configuration, of the region that limits the override; 0xFFFF if none does.
    pub region: u16,
}

impl OverrideAnswer {
    /// Replaces `out` by the bytes of the answer.
    pub fn encode(&self, out: &mut Vec<u8>) {
        PROTOCOL.begin(KIND, out);
        for word in [self.checksum, self.boot, self.echo, self.sequence] {
            out.extend_from_slice(&word.to_le_bytes());
        }
        out.extend_from_slice(&self.speed_override.to_le_bytes());
        out.extend_from_slice(&self.outputs.to_le_bytes());
        out.extend_from_slice(&[self.reason, 0]);
        out.extend_from_slice(&self.region.to_le_bytes());
        PROTOCOL.end(out);
    }

    /// Reads an answer from these bytes.
    ///
    /// # Errors
    /// The reason, if the bytes are not an answer. No bytes panic.
    pub fn decode(bytes: &[u8]) -> Result<Self, MessageError> {
        let length = MessageError::Length(bytes.len());
        if bytes.len() != OVERRIDE_ANSWER_BYTES {
            return Err(length);
        }
        let mut reader = contents(KIND, bytes)?;
        let mut read = || {
            let (checksum, boot) = (reader.u64()?, reader.u64()?);
            let (echo, sequence) = (reader.u64()?, reader.u64()?);
            let (speed_override, outputs) = (reader.f64()?, reader.u64()?);
            let (reason, _) = (reader.u8()?, reader.u8()?);
            Some(Self { checksum, boot, echo, sequence, speed_override, outputs, reason, region: reader.u16()? })
        };
        read().ok_or(length)
    }
}
