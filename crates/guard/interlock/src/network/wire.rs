//! Binary format of the messages: little-endian, with a version and a checksum, at most [`MAX_BYTES`] long.
//!
//! | bytes | state | grants |
//! | --- | --- | --- |
//! | 2 | `ER` | the same |
//! | 1 | version, 2 | the same |
//! | 1 | kind, 1 | kind, 2 |
//! | 2 | robot | robot |
//! | 2 | number of slots | the same |
//! | 8 × 5 | configuration, boot, sequence, arbiter, 0 | configuration, arbiter, serial, robot's boot, echo |
//! | per slot | 1 occupancy, 1 wants, 16 token, 16 released | 16 granted, 1 release requested, 1 halt |
//! | 4 | CRC-32 of all before | the same |
//!
//! An absent token is written as 16 zero bytes, because start 0 means none.

use crate::frame::{FRAME_BYTES, MessageError, Protocol, Reader};
use crate::{Boot, GrantsMessage, Occupancy, RobotSlot, SlotAnswer, SlotReport, StateMessage, Token};

/// Largest number of slots; messages with more slots are not written.
pub const MAX_SLOTS: usize = 256;
/// Length of the longest message.
pub const MAX_BYTES: usize = FRAME_BYTES + 4 + WORDS * 8 + MAX_SLOTS * 34;

const PROTOCOL: Protocol = Protocol { letters: *b"ER", version: 2 };
const WORDS: usize = 5;
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

/// Encodes a message; `None` if it has more than [`MAX_SLOTS`] slots or its robot's index does not fit in two bytes.
pub fn encode(message: &Message) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(MAX_BYTES);
    match message {
        Message::State(m) => encode_state(m, &mut bytes),
        Message::Grants(m) => encode_grants(m, &mut bytes),
    }
    .then_some(bytes)
}

/// Replaces `bytes` by a guard's encoded message; returns false if [`encode`] would return `None`. Does not allocate
/// if `bytes` has the capacity [`MAX_BYTES`].
pub fn encode_state(m: &StateMessage, bytes: &mut Vec<u8>) -> bool {
    let words = [m.checksum, m.boot.0, m.sequence, m.arbiter.0, 0];
    let fits = write_header(STATE, m.robot, m.slots.len(), words, bytes);
    if fits {
        m.slots.iter().for_each(|slot| write_report(slot, bytes));
        PROTOCOL.end(bytes);
    }
    fits
}

/// Replaces `bytes` by the arbiter's encoded message; otherwise like [`encode_state`].
pub fn encode_grants(m: &GrantsMessage, bytes: &mut Vec<u8>) -> bool {
    let words = [m.checksum, m.arbiter.0, m.serial, m.robot_boot.0, m.echo];
    let fits = write_header(GRANTS, m.robot, m.slots.len(), words, bytes);
    if fits {
        m.slots.iter().for_each(|slot| write_answer(slot, bytes));
        PROTOCOL.end(bytes);
    }
    fits
}

/// Decodes a message.
///
/// # Errors
/// [`MessageError`] if the bytes are not a valid message. Never panics.
pub fn decode(bytes: &[u8]) -> Result<Message, MessageError> {
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
        _ => Err(MessageError::Value),
    }
}

/// Decodes a guard's message into `message`. Does not allocate if `message` has memory for its slots.
///
/// # Errors
/// [`MessageError`] if the bytes are not a valid message of a guard; then the contents of `message` are unspecified.
pub fn decode_state(bytes: &[u8], message: &mut StateMessage) -> Result<(), MessageError> {
    let (header, reader) = read_header(bytes)?;
    if header.kind == STATE { read_state(&header, reader, bytes, message) } else { Err(MessageError::Kind) }
}

/// Decodes the arbiter's message into `message`; otherwise like [`decode_state`].
///
/// # Errors
/// As for [`decode_state`].
pub fn decode_grants(bytes: &[u8], message: &mut GrantsMessage) -> Result<(), MessageError> {
    let (header, reader) = read_header(bytes)?;
    if header.kind == GRANTS { read_grants(&header, reader, bytes, message) } else { Err(MessageError::Kind) }
}

/// The part that both kinds of message begin with.
struct Header {
    kind: u8,
    robot: RobotSlot,
    slots: usize,
    words: [u64; WORDS],
}

/// Writes the header; returns false if the message cannot be written.
fn write_header(kind: u8, robot: RobotSlot, slots: usize, words: [u64; WORDS], bytes: &mut Vec<u8>) -> bool {
    PROTOCOL.begin(kind, bytes);
    let (Ok(robot), Ok(count)) = (u16::try_from(robot.0), u16::try_from(slots)) else { return false };
    if slots > MAX_SLOTS {
        return false;
    }
    bytes.extend_from_slice(&robot.to_le_bytes());
    bytes.extend_from_slice(&count.to_le_bytes());
    for word in words {
        bytes.extend_from_slice(&word.to_le_bytes());
    }
    true
}

fn read_header(bytes: &[u8]) -> Result<(Header, Reader<'_>), MessageError> {
    let length = MessageError::Length(bytes.len());
    if bytes.len() > MAX_BYTES {
        return Err(length);
    }
    let (kind, mut reader) = PROTOCOL.contents(bytes)?;
    let header = header(&mut reader, kind).ok_or(length)?;
    if header.slots > MAX_SLOTS { Err(MessageError::Value) } else { Ok((header, reader)) }
}

fn read_state(header: &Header, reader: Reader<'_>, bytes: &[u8], m: &mut StateMessage) -> Result<(), MessageError> {
    let [checksum, boot, sequence, arbiter, _] = header.words;
    (m.robot, m.boot, m.arbiter) = (header.robot, Boot(boot), Boot(arbiter));
    (m.sequence, m.checksum) = (sequence, checksum);
    read_slots(header, reader, bytes, &mut m.slots, report)
}

fn read_grants(header: &Header, reader: Reader<'_>, bytes: &[u8], m: &mut GrantsMessage) -> Result<(), MessageError> {
    let [checksum, arbiter, serial, robot_boot, echo] = header.words;
    (m.robot, m.arbiter, m.robot_boot) = (header.robot, Boot(arbiter), Boot(robot_boot));
    (m.checksum, m.serial, m.echo) = (checksum, serial, echo);
    read_slots(header, reader, bytes, &mut m.slots, answer)
}

fn read_slots<'a, T>(
    header: &Header,
    mut reader: Reader<'a>,
    bytes: &[u8],
    slots: &mut Vec<T>,
    read: impl Fn(&mut Reader<'a>) -> Option<T>,
) -> Result<(), MessageError> {
    slots.clear();
    for _ in 0..header.slots {
        slots.push(read(&mut reader).ok_or(MessageError::Value)?);
    }
    if reader.remaining() == 0 { Ok(()) } else { Err(MessageError::Length(bytes.len())) }
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

/// Error: bytes that guards and arbiters never write.
struct Meaningless;

fn header(reader: &mut Reader<'_>, kind: u8) -> Option<Header> {
    let (robot, slots) = (RobotSlot(usize::from(reader.u16()?)), usize::from(reader.u16()?));
    let mut words = [0; WORDS];
    for word in &mut words {
        *word = reader.u64()?;
    }
    Some(Header { kind, robot, slots, words })
}

fn flag(reader: &mut Reader<'_>) -> Option<bool> {
    match reader.u8()? {
        0 => Some(false),
        1 => Some(true),
        _ => None,
    }
}

/// Reads a token; `None` if the token is absent.
fn token(reader: &mut Reader<'_>) -> Result<Option<Token>, Meaningless> {
    match (reader.u64().ok_or(Meaningless)?, reader.u64().ok_or(Meaningless)?) {
        (0, 0) => Ok(None),
        (0, _) => Err(Meaningless),
        (boot, number) => Ok(Some(Token { boot: Boot(boot), number })),
    }
}

fn report(reader: &mut Reader<'_>) -> Option<SlotReport> {
    let occupancy = match reader.u8()? {
        0 => Occupancy::Unknown,
        1 => Occupancy::Outside,
        2 => Occupancy::Warning,
        3 => Occupancy::Committed,
        4 => Occupancy::Inside,
        _ => return None,
    };
    let wants = flag(reader)?;
    Some(SlotReport { occupancy, wants, token: token(reader).ok()?, released: token(reader).ok()? })
}

fn answer(reader: &mut Reader<'_>) -> Option<SlotAnswer> {
    Some(SlotAnswer { granted: token(reader).ok()?, release_requested: flag(reader)?, halt: flag(reader)? })
}
