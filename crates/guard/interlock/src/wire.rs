//! The bytes of the messages: little-endian, with a version and a checksum, at most [`MAX_BYTES`].
//!
//! | bytes | state | grants |
//! | --- | --- | --- |
//! | 2 | `ER` | the same |
//! | 1 | version, 1 | the same |
//! | 1 | kind, 1 | kind, 2 |
//! | 2 | robot | robot |
//! | 2 | number of slots | the same |
//! | 8 × 4 | boot, sequence, configuration, arbiter | arbiter, serial, robot's boot, echo |
//! | per slot | 1 occupancy, 1 wants, 16 token, 16 released | 16 granted, 1 release requested, 1 halt |
//! | 4 | CRC-32 of all before | the same |
//!
//! No token is 16 zero bytes, as the start 0 is none.

use elbowroom_monitor::{Occupancy, RobotSlot};
use thiserror::Error;

use crate::{Boot, GrantsMessage, SlotAnswer, SlotReport, StateMessage, Token};

/// More slots than this are not written.
pub const MAX_SLOTS: usize = 256;
/// Length of the longest message.
pub const MAX_BYTES: usize = 8 + 32 + MAX_SLOTS * 34 + 4;

const MAGIC: [u8; 2] = *b"ER";
const VERSION: u8 = 1;
const STATE: u8 = 1;
const GRANTS: u8 = 2;

/// A message of either kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Message {
    /// From a guard.
    State(StateMessage),
    /// From the arbiter.
    Grants(GrantsMessage),
}

/// Why bytes are no message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum WireError {
    /// Not as long as it says, or longer than any message.
    #[error("the message has {0} bytes, which its number of slots does not explain")]
    Length(usize),
    /// Of something else.
    #[error("the bytes are no message of an interlock")]
    Magic,
    /// Of another version of the protocol.
    #[error(
        "the message is of version {0} of the protocol, this is version {VERSION}: run the same release on all controllers"
    )]
    Version(u8),
    /// Damaged.
    #[error("the checksum of the message is wrong")]
    Checksum,
    /// A message of the other kind: sent to the wrong port.
    #[error("the message is not from the side that it was expected from: guards send states, the arbiter sends grants")]
    Kind,
    /// A value that no guard and no arbiter writes.
    #[error("the message has a value that means nothing")]
    Value,
}

/// The bytes of a message; `None` where it has more than [`MAX_SLOTS`] slots or its robot's index does not fit in two bytes.
pub fn encode(message: &Message) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(MAX_BYTES);
    match message {
        Message::State(m) => encode_state(m, &mut bytes),
        Message::Grants(m) => encode_grants(m, &mut bytes),
    }
    .then_some(bytes)
}

/// Replaces `bytes` by those of a guard's message; false as [`encode`] gives `None`. Does not allocate where `bytes` has the
/// capacity [`MAX_BYTES`].
pub fn encode_state(m: &StateMessage, bytes: &mut Vec<u8>) -> bool {
    let words = [m.boot.0, m.sequence, m.checksum, m.arbiter.0];
    let fits = write_header(STATE, m.robot, m.slots.len(), words, bytes);
    if fits {
        m.slots.iter().for_each(|slot| write_report(slot, bytes));
        write_checksum(bytes);
    }
    fits
}

/// Replaces `bytes` by those of the arbiter's message; otherwise as [`encode_state`].
pub fn encode_grants(m: &GrantsMessage, bytes: &mut Vec<u8>) -> bool {
    let words = [m.arbiter.0, m.serial, m.robot_boot.0, m.echo];
    let fits = write_header(GRANTS, m.robot, m.slots.len(), words, bytes);
    if fits {
        m.slots.iter().for_each(|slot| write_answer(slot, bytes));
        write_checksum(bytes);
    }
    fits
}

/// The message of these bytes.
///
/// # Errors
/// Why they are none. No bytes panic.
pub fn decode(bytes: &[u8]) -> Result<Message, WireError> {
    let (header, reader) = read_header(bytes)?;
    match header.kind {
        STATE => {
            let mut message = StateMessage::with_slots(header.slots);
            read_state(&header, reader, bytes, &mut message)?;
            Ok(Message::State(message))
        }
        GRANTS => {
            let mut message = GrantsMessage::with_slots(header.slots);
            read_grants(&header, reader, bytes, &mut message)?;
            Ok(Message::Grants(message))
        }
        _ => Err(WireError::Value),
    }
}

/// Reads a guard's message into `message`. Does not allocate where that has memory for its slots.
///
/// # Errors
/// Why the bytes are no such message; `message` means nothing then.
pub fn decode_state(bytes: &[u8], message: &mut StateMessage) -> Result<(), WireError> {
    let (header, reader) = read_header(bytes)?;
    if header.kind == STATE { read_state(&header, reader, bytes, message) } else { Err(WireError::Kind) }
}

/// Reads the arbiter's message into `message`; otherwise as [`decode_state`].
///
/// # Errors
/// As for [`decode_state`].
pub fn decode_grants(bytes: &[u8], message: &mut GrantsMessage) -> Result<(), WireError> {
    let (header, reader) = read_header(bytes)?;
    if header.kind == GRANTS { read_grants(&header, reader, bytes, message) } else { Err(WireError::Kind) }
}

/// What both kinds begin with.
struct Header {
    kind: u8,
    robot: RobotSlot,
    slots: usize,
    words: [u64; 4],
}

/// False where the message cannot be written.
fn write_header(kind: u8, robot: RobotSlot, slots: usize, words: [u64; 4], bytes: &mut Vec<u8>) -> bool {
    bytes.clear();
    let (Ok(robot), Ok(count)) = (u16::try_from(robot.0), u16::try_from(slots)) else { return false };
    if slots > MAX_SLOTS {
        return false;
    }
    bytes.extend_from_slice(&MAGIC);
    bytes.extend_from_slice(&[VERSION, kind]);
    bytes.extend_from_slice(&robot.to_le_bytes());
    bytes.extend_from_slice(&count.to_le_bytes());
    for word in words {
        bytes.extend_from_slice(&word.to_le_bytes());
    }
    true
}

fn write_checksum(bytes: &mut Vec<u8>) {
    let crc = crc32fast::hash(bytes);
    bytes.extend_from_slice(&crc.to_le_bytes());
}

fn read_header(bytes: &[u8]) -> Result<(Header, Reader<'_>), WireError> {
    let length = WireError::Length(bytes.len());
    if bytes.len() > MAX_BYTES {
        return Err(length);
    }
    let (content, crc) = bytes.split_last_chunk::<4>().ok_or(length)?;
    let mut reader = Reader { rest: content };
    if reader.take::<2>().ok_or(length)? != MAGIC {
        return Err(WireError::Magic);
    }
    let [version, kind] = reader.take().ok_or(length)?;
    if version != VERSION {
        return Err(WireError::Version(version));
    }
    if crc32fast::hash(content).to_le_bytes() != *crc {
        return Err(WireError::Checksum);
    }
    let header = reader.header(kind).ok_or(length)?;
    if header.slots > MAX_SLOTS { Err(WireError::Value) } else { Ok((header, reader)) }
}

fn read_state(header: &Header, reader: Reader<'_>, bytes: &[u8], m: &mut StateMessage) -> Result<(), WireError> {
    let [boot, sequence, checksum, arbiter] = header.words;
    (m.robot, m.boot, m.arbiter) = (header.robot, Boot(boot), Boot(arbiter));
    (m.sequence, m.checksum) = (sequence, checksum);
    read_slots(header, reader, bytes, &mut m.slots, Reader::report)
}

fn read_grants(header: &Header, reader: Reader<'_>, bytes: &[u8], m: &mut GrantsMessage) -> Result<(), WireError> {
    let [arbiter, serial, robot_boot, echo] = header.words;
    (m.robot, m.arbiter, m.robot_boot) = (header.robot, Boot(arbiter), Boot(robot_boot));
    (m.serial, m.echo) = (serial, echo);
    read_slots(header, reader, bytes, &mut m.slots, Reader::answer)
}

fn read_slots<'a, T>(
    header: &Header,
    mut reader: Reader<'a>,
    bytes: &[u8],
    slots: &mut Vec<T>,
    read: impl Fn(&mut Reader<'a>) -> Option<T>,
) -> Result<(), WireError> {
    slots.clear();
    for _ in 0..header.slots {
        slots.push(read(&mut reader).ok_or(WireError::Value)?);
    }
    if reader.rest.is_empty() { Ok(()) } else { Err(WireError::Length(bytes.len())) }
}

fn write_token(token: Option<Token>, bytes: &mut Vec<u8>) {
    let Token { boot, number } = token.unwrap_or(Token { boot: Boot::NONE, number: 0 });
    bytes.extend_from_slice(&boot.0.to_le_bytes());
    bytes.extend_from_slice(&number.to_le_bytes());
}

fn write_report(report: &SlotReport, bytes: &mut Vec<u8>) {
    bytes.extend_from_slice(&[report.occupancy as u8, u8::from(report.wants)]);
    write_token(report.token, bytes);
    write_token(report.released, bytes);
}

fn write_answer(answer: &SlotAnswer, bytes: &mut Vec<u8>) {
    write_token(answer.granted, bytes);
    bytes.extend_from_slice(&[u8::from(answer.release_requested), u8::from(answer.halt)]);
}

/// Bytes that no guard and no arbiter writes.
struct Meaningless;

/// The bytes that are not read yet.
struct Reader<'a> {
    rest: &'a [u8],
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.rest.split_first_chunk::<N>()?;
        self.rest = rest;
        Some(*first)
    }

    fn header(&mut self, kind: u8) -> Option<Header> {
        let robot = RobotSlot(usize::from(u16::from_le_bytes(self.take()?)));
        let slots = usize::from(u16::from_le_bytes(self.take()?));
        Some(Header { kind, robot, slots, words: [self.word()?, self.word()?, self.word()?, self.word()?] })
    }

    fn word(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    fn flag(&mut self) -> Option<bool> {
        match self.take()? {
            [0] => Some(false),
            [1] => Some(true),
            _ => None,
        }
    }

    /// A token that may be none.
    fn token(&mut self) -> Result<Option<Token>, Meaningless> {
        match (self.word().ok_or(Meaningless)?, self.word().ok_or(Meaningless)?) {
            (0, 0) => Ok(None),
            (0, _) => Err(Meaningless),
            (boot, number) => Ok(Some(Token { boot: Boot(boot), number })),
        }
    }

    fn report(&mut self) -> Option<SlotReport> {
        let occupancy = match self.take()? {
            [0] => Occupancy::Unknown,
            [1] => Occupancy::Outside,
            [2] => Occupancy::Warning,
            [3] => Occupancy::Committed,
            [4] => Occupancy::Inside,
            _ => return None,
        };
        Some(SlotReport { occupancy, wants: self.flag()?, token: self.token().ok()?, released: self.token().ok()? })
    }

    fn answer(&mut self) -> Option<SlotAnswer> {
        Some(SlotAnswer { granted: self.token().ok()?, release_requested: self.flag()?, halt: self.flag()? })
    }
}
