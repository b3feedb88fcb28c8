//! Message with the joint values of a robot, from its controller.

use elbowroom_interlock::frame::{FRAME_BYTES, MessageError, Reader};
use elbowroom_monitor::VolumeId;
use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::protocol::{PROTOCOL, contents};

/// Most joints of a message.
pub const MAX_JOINTS: usize = 32;
/// Most attached volumes of a message.
pub const MAX_ATTACHED: usize = 16;
/// Length of the longest message, bytes.
pub const MAX_JOINT_STATE_BYTES: usize = FRAME_BYTES + 44 + 3 * 8 * MAX_JOINTS + MAX_ATTACHED * 58;

const KIND: u8 = 1;
const HAS_VELOCITY: u8 = 1;
const HAS_INTENT: u8 = 2;

/// Joint values of a robot at one instant, from its controller.
///
/// ```
/// use elbowroom_live::messages::JointState;
/// let sent = JointState { boot: 1, sequence: 7, stamp_us: 14_000, programmed_override: 1.0, q: vec![0.5], ..Default::default() };
/// let (mut bytes, mut received) = (Vec::new(), JointState::default());
/// sent.encode(&mut bytes);
/// received.decode(&bytes)?;
/// assert_eq!(received, sent);
/// # Ok::<(), elbowroom_live::messages::MessageError>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct JointState {
    /// The first 8 bytes of the checksum of the cell that the controller expects; 0 to accept any cell.
    pub checksum: u64,
    /// Number of the controller's start, higher for later starts: the time of day in nanoseconds.
    pub boot: u64,
    /// Number of the message, which increases with every message of this start.
    pub sequence: u64,
    /// Time at which the joints were read, on the controller's monotonic clock, µs.
    pub stamp_us: u64,
    /// The override set by the program or the operator, 0..1.
    pub programmed_override: f64,
    /// Joint positions in the order of the chain, rad or m.
    pub q: Vec<f64>,
    /// Joint velocities, rad/s or m/s; empty if unknown.
    pub qd: Vec<f64>,
    /// Velocities of the program at override 1, rad/s or m/s; empty if unknown.
    pub intent: Vec<f64>,
    /// Optional volumes of the monitor that are on the robot now: gripped parts and exchanged tools.
    pub attached: Vec<AttachedVolume>,
}

/// A volume that is on the robot only at times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttachedVolume {
    /// Index of the volume in the monitor's configuration.
    pub volume: VolumeId,
    /// Pose of the volume in the frame of its link.
    pub in_link: Pose,
}

impl JointState {
    /// Creates a message with memory for the longest one, so that [`Self::decode`] never allocates.
    pub fn with_capacity() -> Self {
        let numbers = || Vec::with_capacity(MAX_JOINTS);
        Self {
            q: numbers(),
            qd: numbers(),
            intent: numbers(),
            attached: Vec::with_capacity(MAX_ATTACHED),
            ..Self::default()
        }
    }

    /// Replaces `out` by the bytes of the message.
    ///
    /// With more than [`MAX_JOINTS`] joints or [`MAX_ATTACHED`] volumes the bytes are invalid: the receiver refuses
    /// them because of their counts, so that no volume is omitted silently.
    pub fn encode(&self, out: &mut Vec<u8>) {
        PROTOCOL.begin(KIND, out);
        let flag = |is_set: bool, flag: u8| if is_set { flag } else { 0 };
        let flags =
            flag(self.qd.len() == self.q.len(), HAS_VELOCITY) | flag(self.intent.len() == self.q.len(), HAS_INTENT);
        out.extend_from_slice(&[count(self.q.len()), flags, count(self.attached.len()), 0]);
        for word in [self.checksum, self.boot, self.sequence, self.stamp_us] {
            out.extend_from_slice(&word.to_le_bytes());
        }
        out.extend_from_slice(&self.programmed_override.to_le_bytes());
        let blocks = [(true, &self.q), (flags & HAS_VELOCITY != 0, &self.qd), (flags & HAS_INTENT != 0, &self.intent)];
        for (_, block) in blocks.iter().filter(|(is_there, _)| *is_there) {
            block.iter().take(MAX_JOINTS).for_each(|value| out.extend_from_slice(&value.to_le_bytes()));
        }
        for attached in self.attached.iter().take(MAX_ATTACHED) {
            out.extend_from_slice(&(attached.volume.0 as u16).to_le_bytes());
            let at = attached.in_link.translation.to_array();
            let rotation = attached.in_link.rotation.to_quaternion_xyzw();
            at.iter().chain(&rotation).for_each(|value| out.extend_from_slice(&value.to_le_bytes()));
        }
        PROTOCOL.end(out);
    }

    /// Reads the message from these bytes. After an error its contents must not be used.
    ///
    /// # Errors
    /// The reason, if the bytes are not a message. No bytes panic; nothing is allocated after [`Self::with_capacity`].
    pub fn decode(&mut self, bytes: &[u8]) -> Result<(), MessageError> {
        let length = MessageError::Length(bytes.len());
        if bytes.len() > MAX_JOINT_STATE_BYTES {
            return Err(length);
        }
        let mut reader = contents(KIND, bytes)?;
        self.read(&mut reader).filter(|()| reader.remaining() == 0).ok_or(length)
    }

    fn read(&mut self, reader: &mut Reader<'_>) -> Option<()> {
        let (joints, flags, attached, _) = (reader.u8()?, reader.u8()?, reader.u8()?, reader.u8()?);
        let joints = usize::from(joints);
        if joints > MAX_JOINTS || usize::from(attached) > MAX_ATTACHED {
            return None;
        }
        (self.checksum, self.boot) = (reader.u64()?, reader.u64()?);
        (self.sequence, self.stamp_us) = (reader.u64()?, reader.u64()?);
        self.programmed_override = reader.f64()?;
        let flagged = |flag: u8| if flags & flag == 0 { 0 } else { joints };
        reader.numbers(joints, &mut self.q)?;
        reader.numbers(flagged(HAS_VELOCITY), &mut self.qd)?;
        reader.numbers(flagged(HAS_INTENT), &mut self.intent)?;
        self.attached.clear();
        for _ in 0..attached {
            self.attached.push(attached_volume(reader)?);
        }
        Some(())
    }
}

/// Encodes a count in one byte. Larger counts saturate at 255, which is more than a message may have.
fn count(length: usize) -> u8 {
    u8::try_from(length).unwrap_or(u8::MAX)
}

fn attached_volume(reader: &mut Reader<'_>) -> Option<AttachedVolume> {
    let volume = VolumeId(usize::from(reader.u16()?));
    let mut values = [0.0; 7];
    for value in &mut values {
        *value = reader.f64()?;
    }
    let [x, y, z, i, j, k, w] = values;
    let translation = Vec3::new(x, y, z);
    let rotation = Rotation::from_quaternion_xyzw([i, j, k, w])?;
    translation.is_finite().then_some(AttachedVolume { volume, in_link: Pose { rotation, translation } })
}
